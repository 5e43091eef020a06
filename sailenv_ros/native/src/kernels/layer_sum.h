// Light maps as sums of layers; see render/lightmap_compositing.py.
#pragma once

#include <sched.h>

#include "lanes.h"
#include "render_types.h"

namespace sailenv {

constexpr int32_t LAYER_RUN = 8;  // texels that are added up together when one of them is needed

enum RunState : uint8_t { STATE_MISSING = 0, STATE_BEGUN = 1, STATE_MADE = 2 };

// Adds up the texels from `first` to `last`, both multiples of eight.
static inline void add_layers(const LayerSum& s, int64_t first, int64_t last) {
    for (int64_t at = first; at < last; at += 8) {
        // Eight texels of three channels each.
        f8 sum[3];
        for (int k = 0; k < 3; k++) sum[k] = load(s.more + 8 * k);
        for (int64_t t = 0; t < s.terms; t++) {
            const float* factor = s.factors + 24 * t;
            f8 value[3];
            if (s.channels[t] == 3) {
                for (int k = 0; k < 3; k++) value[k] = load_halves(s.layers[t] + 3 * at + 8 * k);
            } else {
                const f8 d = load_halves(s.layers[t] + at);
                value[0] = SHUFFLE(d, d, 0, 0, 0, 1, 1, 1, 2, 2);
                value[1] = SHUFFLE(d, d, 2, 3, 3, 3, 4, 4, 4, 5);
                value[2] = SHUFFLE(d, d, 5, 5, 6, 6, 6, 7, 7, 7);
            }
            for (int k = 0; k < 3; k++) {
                const f8 term = value[k] * load(factor + 8 * k);
                sum[k] = sum[k] + term;
            }
        }
        i8 c[3];
        for (int k = 0; k < 3; k++) c[k] = to_half(clamp8(sum[k], 0.0f, 65504.0f));
        const i8 arriving = to_half(load_bytes(s.shown + at) * (1.0f / 255.0f));
        // Red and blue, green and the share of four texels each, two halves in a number.
        const i8 green = SHUFFLE(c[0], c[1], 1, 1, 4, 4, 7, 7, 10, 10);
        const i8 more_green = SHUFFLE(c[1], c[2], 5, 5, 8, 8, 11, 11, 14, 14);
        const i8 lower = SHUFFLE(c[0], c[1], 0, 2, 3, 5, 6, 8, 9, 11) |
                         (SHUFFLE(green, arriving, 0, 8, 2, 9, 4, 10, 6, 11) << 16);
        const i8 upper = SHUFFLE(c[1], c[2], 4, 6, 7, 9, 10, 12, 13, 15) |
                         (SHUFFLE(more_green, arriving, 0, 12, 2, 13, 4, 14, 6, 15) << 16);
        int32_t* texels = reinterpret_cast<int32_t*>(s.texels + 4 * at);
        store(texels, lower);
        store(texels + 8, upper);
    }
}

// Has the memory of a run's texels fetched that are not made yet.
static inline void fetch_run(const LayerSum& s, int64_t run) {
    if (__atomic_load_n(s.states + run, __ATOMIC_RELAXED) != STATE_MISSING) return;
    const int64_t first = run * LAYER_RUN;
    for (int64_t t = 0; t < s.terms; t++) {
        __builtin_prefetch(s.layers[t] + s.channels[t] * first);
    }
    __builtin_prefetch(s.shown + first);
    __builtin_prefetch(s.texels + 4 * first, 1);
}

// Makes the run of texels number `run`, or waits for the thread that makes it.
static inline void make_run(const LayerSum& s, int64_t run) {
    uint8_t* state = s.states + run;
    uint8_t expected = STATE_MISSING;
    if (__atomic_compare_exchange_n(state, &expected, STATE_BEGUN, false, __ATOMIC_ACQUIRE,
                                    __ATOMIC_ACQUIRE)) {
        add_layers(s, run * LAYER_RUN, (run + 1) * LAYER_RUN);
        __atomic_store_n(state, STATE_MADE, __ATOMIC_RELEASE);
        return;
    }
    while (__atomic_load_n(state, __ATOMIC_ACQUIRE) != STATE_MADE) sched_yield();
}

// Sees to it that eight texels and their neighbours to the right and below have been made.
LANES_INLINE void need_texels(const LayerSum& s, const int32_t* at, int32_t width) {
    const int32_t ways[4] = {0, 1, width, width + 1};
    uint8_t made = STATE_MADE;
    for (int k = 0; k < 8; k++) {
        for (const int32_t way : ways) {
            made &= __atomic_load_n(s.states + (at[k] + way) / LAYER_RUN, __ATOMIC_ACQUIRE);
        }
    }
    if (__builtin_expect(made == STATE_MADE, 1)) return;
    // Layers lie far apart in memory: what is missing is fetched all at once, then added up.
    for (int k = 0; k < 8; k++) {
        fetch_run(s, at[k] / LAYER_RUN);
        fetch_run(s, (at[k] + width) / LAYER_RUN);
    }
    for (int k = 0; k < 8; k++) {
        for (const int32_t way : ways) make_run(s, (at[k] + way) / LAYER_RUN);
    }
}

}  // namespace sailenv
