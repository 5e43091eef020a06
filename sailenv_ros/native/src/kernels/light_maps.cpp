// Light maps and reflection maps, brought up to date when lights change.
#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "texture.h"

namespace {

// Three numbers, over and over: of eight texels with three channels each.
struct Pattern {
    f8 part[3];
};

LANES_INLINE Pattern repeated(const float* c) {
    return {{f8{c[0], c[1], c[2], c[0], c[1], c[2], c[0], c[1]},
             f8{c[2], c[0], c[1], c[2], c[0], c[1], c[2], c[0]},
             f8{c[1], c[2], c[0], c[1], c[2], c[0], c[1], c[2]}}};
}

}  // namespace

// The sum of layers of a light map, in the order of lightmap_compositing.sum_texels. `count` is a
// multiple of eight; `layers` holds the addresses of (count, 3) or (count,) halves.
SAILENV_KERNEL(sum_texels)
(int64_t threads, int64_t count, int64_t terms, const uint16_t* const* layers,
 const int32_t* channels, const float* factors, const float* more, const uint8_t* shown,
 uint16_t* out) {
    if (count < 0 || count % 8 != 0 || terms < 1 || terms > 256 || channels[0] != 3) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    const Pattern offset = repeated(more);
    sailenv::parallel_for(threads, count, 8192, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t at = first; at < last; at += 8) {
            f8 sum[3] = {offset.part[0], offset.part[1], offset.part[2]};
            for (int64_t t = 0; t < terms; t++) {
                const Pattern factor = repeated(factors + 3 * t);
                f8 value[3];
                if (channels[t] == 3) {
                    for (int k = 0; k < 3; k++) value[k] = load_halves(layers[t] + 3 * at + 8 * k);
                } else {
                    const f8 d = load_halves(layers[t] + at);
                    value[0] = SHUFFLE(d, d, 0, 0, 0, 1, 1, 1, 2, 2);
                    value[1] = SHUFFLE(d, d, 2, 3, 3, 3, 4, 4, 4, 5);
                    value[2] = SHUFFLE(d, d, 5, 5, 6, 6, 6, 7, 7, 7);
                }
                for (int k = 0; k < 3; k++) {
                    const f8 term = value[k] * factor.part[k];
                    sum[k] = sum[k] + term;
                }
            }
            alignas(32) int32_t colour[24];
            for (int k = 0; k < 3; k++) {
                store(colour + 8 * k, to_half(clamp8(sum[k], 0.0f, 65504.0f)));
            }
            f8 share;
            for (int k = 0; k < 8; k++) share[k] = shown[at + k];
            const i8 arriving = to_half(share * (1.0f / 255.0f));
            uint16_t* texel = out + 4 * at;
            for (int k = 0; k < 8; k++) {
                for (int c = 0; c < 3; c++) {
                    texel[4 * k + c] = static_cast<uint16_t>(colour[3 * k + c]);
                }
                texel[4 * k + 3] = static_cast<uint16_t>(arriving[k]);
            }
        }
    });
    return sailenv::STATUS_OK;
}

// The mean over a lobe about each direction of an octahedral map; see reflection_map.prefilter.
// `edge` is a multiple of eight; `radiance` has four channels, of which three are read, `lobe`
// holds directions about z and their weights.
SAILENV_KERNEL(blur_directions)
(int64_t threads, int64_t edge, const float* radiance, const float* directions, int64_t samples,
 const float* lobe, float* out) {
    if (edge < 8 || edge % 8 != 0 || edge > 4096) return sailenv::STATUS_INVALID_ARGUMENT;
    const float scale = 0.5f * static_cast<float>(edge), last = static_cast<float>(edge - 1);
    sailenv::parallel_for(threads, edge, 4, [&](int64_t first, int64_t end, int64_t) {
        for (int64_t at = first * edge; at < end * edge; at += 8) {
            f8 nx, ny, nz;
            for (int k = 0; k < 8; k++) {
                nx[k] = directions[3 * (at + k)];
                ny[k] = directions[3 * (at + k) + 1];
                nz[k] = directions[3 * (at + k) + 2];
            }
            // A frame about the normal without trigonometry (Duff et al. 2017).
            const f8 sign = nz >= 0.0f ? splat(1.0f) : splat(-1.0f);
            const f8 a = -1.0f / (sign + nz), b = nx * ny * a;
            const f8 xx = 1.0f + sign * nx * nx * a, yx = sign * b, zx = -sign * nx;
            const f8 yy = sign + ny * ny * a;
            f8 sum[3] = {splat(0.0f), splat(0.0f), splat(0.0f)};
            float total = 0.0f;
            for (int64_t s = 0; s < samples; s++) {
                const float lx = lobe[4 * s], ly = lobe[4 * s + 1], lz = lobe[4 * s + 2],
                            weight = lobe[4 * s + 3];
                if (!(weight > 0.0f)) continue;
                const f8 x = lx * xx + ly * b + lz * nx, y = lx * yx + ly * yy + lz * ny,
                         z = lx * zx - ly * ny + lz * nz;
                const f8 inverse = 1.0f / (abs8(x) + abs8(y) + abs8(z));
                const f8 px = x * inverse, py = y * inverse;
                const i8 below = z < 0.0f;
                const f8 qx = (1.0f - abs8(py)) * (px >= 0.0f ? splat(1.0f) : splat(-1.0f));
                const f8 qy = (1.0f - abs8(px)) * (py >= 0.0f ? splat(1.0f) : splat(-1.0f));
                const f8 u = clamp8((below ? qx : px) * scale + scale, 0.0f, last);
                const f8 v = clamp8((below ? qy : py) * scale + scale, 0.0f, last);
                const i8 place = truncated(v) * static_cast<int32_t>(edge) + truncated(u);
                alignas(32) float texels[4 * 8];
                for (int k = 0; k < 8; k++) {
                    memcpy(texels + 4 * k, radiance + 4 * static_cast<int64_t>(place[k]), 16);
                }
                f8 r, g, blue, unused;
                sailenv::transpose4(texels, r, g, blue, unused);
                sum[0] = sum[0] + r * weight;
                sum[1] = sum[1] + g * weight;
                sum[2] = sum[2] + blue * weight;
                total += weight;
            }
            for (int k = 0; k < 8; k++) {
                for (int c = 0; c < 3; c++) out[3 * (at + k) + c] = sum[c][k] / total;
            }
        }
    });
    return sailenv::STATUS_OK;
}
