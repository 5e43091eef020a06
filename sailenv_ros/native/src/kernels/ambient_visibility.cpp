// How much of the light from around reaches each surface past its neighbours in the picture; see
// render/ambient_occlusion.py for the method. Works at half resolution, on eight samples at a time.
#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "scratch.h"

namespace {

constexpr float FAR_M = 1e9f;  // depth that stands for no surface: its square is finite
constexpr int64_t TILE = 16;   // edge of the tiles that are left out where all around is baked
constexpr int64_t TAPS = 12;
constexpr int64_t MOST_STEP = 4;  // from one sample to the next of the second average
constexpr int64_t PAD = 16;       // samples beyond both ends of a row that count as on no surface
constexpr int64_t INSTANCES = 65536;

struct Settings {
    float focal, cx, cy;  // of the samples [px]
    float radius_m;
    float least_reach_px, reach_px;
    float bias, scale;  // scale: how much one tap that hides everything takes away
    float same_surface;
};

struct Samples {
    int64_t rows, columns;
    float* inverse;        // (rows, columns): 1 / depth, negative where light was baked
    float* depth;          // (rows, columns): 1 / inverse, with its sign
    const uint8_t* tiles;  // (tile rows, tile columns): 1 where something may be darkened
    int64_t tile_columns;
};

void halve_rows(const float* surface, int64_t width, const uint8_t* baked, const Samples& s,
                uint8_t* own_tiles, int64_t first, int64_t last) {
    for (int64_t v = first; v < last; v++) {
        const float* row = surface + 4 * v * width;
        for (int64_t u = 0; u < s.columns; u++) {
            const float z = row[4 * u], id = row[4 * u + 1];
            const bool hit = z > 1.0f / FAR_M && z < FAR_M;
            const bool known = id >= 0.0f && id < INSTANCES;
            const bool is_baked = hit && known && baked[static_cast<int32_t>(id)] != 0;
            const float inverse = !hit ? -1.0f / FAR_M : (is_baked ? -1.0f : 1.0f) / z;
            s.inverse[v * s.columns + u] = inverse;
            s.depth[v * s.columns + u] = 1.0f / inverse;
            if (inverse > 0.0f) own_tiles[u / TILE] = 1;
        }
    }
}

// Marks the tiles that a surface which is not baked may reach. `reach` in tiles.
void dilate_tiles(const uint8_t* own, int64_t rows, int64_t columns, int64_t reach,
                  uint8_t* tiles) {
    for (int64_t v = 0; v < rows; v++) {
        for (int64_t u = 0; u < columns; u++) {
            if (!own[v * columns + u]) continue;
            for (int64_t i = v - reach; i <= v + reach; i++) {
                for (int64_t j = u - reach; j <= u + reach; j++) {
                    if (i >= 0 && i < rows && j >= 0 && j < columns) tiles[i * columns + j] = 1;
                }
            }
        }
    }
}

LANES_INLINE f8 load_some(const float* p, int64_t count) {
    if (count >= 8) return load(p);
    f8 r = splat(1.0f);
    for (int64_t k = 0; k < count; k++) r[k] = p[k];
    return r;
}
LANES_INLINE void store_bytes(uint8_t* p, i8 x, int64_t count) {
    for (int64_t k = 0; k < count; k++) p[k] = static_cast<uint8_t>(x[k]);
}
LANES_INLINE f8 select8(i8 mask, f8 a, f8 b) { return mask ? a : b; }

// Slope of 1 / depth on the side where it changes less: the other crosses an edge.
LANES_INLINE f8 slope(f8 before, f8 after, i8 no_before, i8 no_after) {
    const i8 takes_after = no_before | ((abs8(after) < abs8(before)) & ~no_after);
    return select8(takes_after, after, before);
}

void find_row(const Samples& s, const Settings& set, const float* pattern, int64_t v,
              uint8_t* out) {
    const float* row = s.inverse + v * s.columns;
    const float* above = v > 0 ? row - s.columns : row;
    const float* below = v + 1 < s.rows ? row + s.columns : row;
    const uint8_t* tiles = s.tiles + v / TILE * s.tile_columns;
    const f8 zero = splat(0.0f), one = splat(1.0f);
    const float per_f = 1.0f / set.focal;
    const float per_r2 = 1.0f / (set.radius_m * set.radius_m);
    const float y = (static_cast<float>(v) - set.cy) * per_f;
    const f8 wide = splat(static_cast<float>(s.columns)), high = splat(static_cast<float>(s.rows));
    const f8 right = wide - 1.0f, bottom = high - 1.0f;
    const int32_t columns = static_cast<int32_t>(s.columns);
    f8 points[TAPS][2];
    for (int64_t tap = 0; tap < TAPS; tap++) {
        for (int32_t k = 0; k < 8; k++) {
            const float* of_block = pattern + ((v & 3) * 4 + (k & 3)) * 2 * TAPS;
            points[tap][0][k] = of_block[tap];
            points[tap][1][k] = of_block[TAPS + tap];
        }
    }
    for (int64_t u = 0; u < s.columns; u += 8) {
        const int64_t count = s.columns - u < 8 ? s.columns - u : 8;
        if (!tiles[u / TILE]) {
            memset(out + u, 255, static_cast<size_t>(count));
            continue;
        }
        const f8 own = load_some(row + u, count);
        const f8 w = abs8(own);
        const f8 reach = min8(set.radius_m * set.focal * w, splat(set.reach_px));
        const i8 active = reach >= set.least_reach_px;
        if (!any(active)) {
            memset(out + u, 255, static_cast<size_t>(count));
            continue;
        }
        // Over a plane 1/z is linear in the picture.
        f8 before, after;
        if (u > 0 && u + 9 <= s.columns) {
            before = load(row + u - 1);
            after = load(row + u + 1);
        } else {
            before = after = w;
            for (int64_t k = 0; k < count; k++) {
                before[k] = row[u + k > 0 ? u + k - 1 : 0];
                after[k] = row[u + k + 1 < s.columns ? u + k + 1 : s.columns - 1];
            }
        }
        const i8 lane = truncated(counting());
        const i8 at_left = lane == static_cast<int32_t>(-u);
        const i8 at_right = lane == static_cast<int32_t>(s.columns - 1 - u);
        const i8 none = lane < 0;
        f8 a = slope(w - abs8(before), abs8(after) - w, at_left, at_right);
        f8 b = slope(w - abs8(load_some(above + u, count)), abs8(load_some(below + u, count)) - w,
                     v == 0 ? ~none : none, v + 1 == s.rows ? ~none : none);
        // The plane is where (a, b, c) · point = 1.
        a = a * set.focal;
        b = b * set.focal;
        const f8 column = counting() + static_cast<float>(u);
        const f8 x = (column - set.cx) * per_f;
        const f8 c = w - a * x - b * y;
        const f8 plane_m = one / sqrt8(a * a + b * b + c * c);
        const f8 z = one / w;
        const f8 px = x * z, py = y * z;
        // Keeps rounding from making the point its own neighbour.
        const f8 self_m2 = 1e-7f * z * z;
        const f8 fu = column + 0.5f, fv = splat(static_cast<float>(v) + 0.5f);
        f8 hidden = zero;
        for (int64_t tap = 0; tap < TAPS; tap++) {
            const f8 at_u = fu + points[tap][0] * reach;
            const f8 at_v = fv + points[tap][1] * reach;
            const i8 inside = (at_u >= zero) & (at_u < wide) & (at_v >= zero) & (at_v < high);
            // NaN becomes 0.
            const i8 tu = truncated(min8(max8(at_u, zero), right));
            const i8 tv = truncated(min8(max8(at_v, zero), bottom));
            const i8 place = tv * columns + tu;
            f8 other;
            for (int k = 0; k < 8; k++) other[k] = s.depth[place[k]];
            const f8 tz = abs8(other);
            const f8 qx = (to_float(tu) - set.cx) * per_f * tz;
            const f8 qy = (to_float(tv) - set.cy) * per_f * tz;
            const f8 dx = qx - px, dy = qy - py, dz = tz - z;
            const f8 d2 = dx * dx + dy * dy + dz * dz + self_m2;
            const f8 fall = max8(one - d2 * per_r2, zero);
            const f8 height_m = (one - (a * qx + b * qy + c * tz)) * plane_m;
            const f8 rise = height_m / sqrt8(d2) - set.bias;
            const i8 counts = inside & ((own > zero) | (other > zero));
            hidden = hidden + select8(counts, max8(rise, zero) * fall, zero);
        }
        // What hides light gives some of it back: no place is black.
        const f8 share = 255.0f / (one + set.scale * hidden) + 0.5f;
        store_bytes(out + u, active ? truncated(share) : splat(255), count);
    }
}

// Averages over four samples, from the one before to the second after, that lie on one surface.
// `inverse` and `share` begin at the first of the four; `next` is the way to the others.
// Of unlike sign are surfaces with and without baked light, which do not count as one.
LANES_INLINE i8 mean_of_four(const float* inverse, const float* share, int64_t next, f8 own,
                             float same_surface) {
    const f8 off = same_surface * abs8(own);
    f8 total = splat(0.0f), count = splat(0.0f);
    for (int64_t k = 0; k < 4; k++) {
        const i8 same = abs8(load(inverse + k * next) - own) <= off;
        total = total + select8(same, load(share + k * next), splat(0.0f));
        count = count + select8(same, splat(1.0f), splat(0.0f));
    }
    // Half of the count is added before the division rounds down. Of such small numbers the
    // quotient is rounded down exactly.
    return truncated((total + to_float(truncated(count) >> 1)) / count);
}

// Averages a band of rows over samples `step` apart: first along the rows, 3 * step rows beyond
// included, then along the columns. `padded` has three rows of floats for each of these rows.
void average_rows(const Samples& s, const Settings& set, const uint8_t* share, int64_t step,
                  int64_t first, int64_t last, float* padded, uint8_t* out) {
    const int64_t stride = s.columns + 2 * PAD;
    const int64_t rows = last - first + 3 * step;
    float* inverse = padded;
    float* means = padded + rows * stride;
    float* shares = means + rows * stride;
    for (int64_t k = 0; k < rows * stride; k++) means[k] = 0.0f;
    // What lies beyond the picture is on no surface: no distance is near an infinite one.
    for (int64_t k = 0; k < rows * stride; k++) inverse[k] = __builtin_inff();
    for (int64_t k = 0; k < stride; k++) shares[k] = 0.0f;
    for (int64_t i = 0; i < rows; i++) {
        const int64_t v = first - step + i;
        if (v < 0 || v >= s.rows) continue;
        float* inverse_row = inverse + i * stride + PAD;
        float* mean_row = means + i * stride + PAD;
        memcpy(inverse_row, s.inverse + v * s.columns, sizeof(float) * s.columns);
        for (int64_t u = 0; u < s.columns; u++) shares[PAD + u] = share[v * s.columns + u];
        const uint8_t* tiles = s.tiles + v / TILE * s.tile_columns;
        for (int64_t u = 0; u < s.columns; u += 8) {
            const f8 own = load(inverse_row + u);
            const i8 mean = tiles[u / TILE]
                                ? mean_of_four(inverse_row + u - step, shares + PAD + u - step,
                                               step, own, set.same_surface)
                                : splat(255);
            store(mean_row + u, to_float(mean));
        }
    }
    for (int64_t v = first; v < last; v++) {
        const int64_t i = v - first + step;
        const uint8_t* tiles = s.tiles + v / TILE * s.tile_columns;
        for (int64_t u = 0; u < s.columns; u += 8) {
            const int64_t count = s.columns - u < 8 ? s.columns - u : 8;
            uint8_t* target = out + v * s.columns + u;
            if (!tiles[u / TILE]) {
                memset(target, 255, static_cast<size_t>(count));
                continue;
            }
            const float* of_inverse = inverse + i * stride + PAD + u;
            const float* of_means = means + i * stride + PAD + u;
            const f8 own = load(of_inverse);
            const int64_t next = step * stride;
            store_bytes(
                target,
                mean_of_four(of_inverse - next, of_means - next, next, own, set.same_surface),
                count);
        }
    }
}

}  // namespace

// `surface` is (height, width, 2); `inverse` and `visibility` are of half that size, rounded up.
// `numbers` holds fx, cx, cy of the samples, radius_m, least_reach_px, reach_px, bias, scale,
// same_surface, step of the second average.
SAILENV_KERNEL(ambient_visibility)
(int64_t threads, int64_t height, int64_t width, const float* surface, const uint8_t* baked,
 const float* numbers, const float* pattern, float* inverse, uint8_t* visibility) {
    if (height < 1 || width < 1) return sailenv::STATUS_INVALID_ARGUMENT;
    const Settings set{numbers[0], numbers[1], numbers[2], numbers[3], numbers[4],
                       numbers[5], numbers[6], numbers[7], numbers[8]};
    const int64_t step = numbers[9] >= 1.0f && numbers[9] <= MOST_STEP ? int64_t(numbers[9]) : 0;
    if (step == 0) return sailenv::STATUS_INVALID_ARGUMENT;
    const int64_t rows = (height + 1) / 2, columns = (width + 1) / 2;
    const int64_t tile_rows = (rows + TILE - 1) / TILE, tile_columns = (columns + TILE - 1) / TILE;
    const int64_t tile_count = tile_rows * tile_columns;
    const int64_t band = 3 * (TILE + 3 * MOST_STEP) * (columns + 2 * PAD);
    const auto depth = sailenv::allocate<float>(rows * columns);
    const auto tiles = sailenv::allocate<uint8_t>(2 * tile_count);
    const auto raw = sailenv::allocate<uint8_t>(2 * rows * columns);
    const auto bands = sailenv::allocate<float>(band * threads);
    if (!depth || !tiles || !raw || !bands) return sailenv::STATUS_OUT_OF_MEMORY;
    uint8_t* own = tiles.get() + tile_count;
    memset(tiles.get(), 0, static_cast<size_t>(2 * tile_count));
    const Samples samples{rows, columns, inverse, depth.get(), tiles.get(), tile_columns};
    sailenv::parallel_for(threads, rows, TILE, [&](int64_t first, int64_t last, int64_t) {
        halve_rows(surface, width, baked, samples, own + first / TILE * tile_columns, first, last);
    });
    const int64_t reach = static_cast<int64_t>(set.reach_px) / TILE;
    dilate_tiles(own, tile_rows, tile_columns, reach, tiles.get());
    sailenv::parallel_for(threads, rows, TILE, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            find_row(samples, set, pattern, v, raw.get() + v * columns);
        }
    });
    uint8_t* means = raw.get() + rows * columns;
    const auto average = [&](const uint8_t* from, int64_t apart, uint8_t* to) {
        sailenv::parallel_for(threads, rows, TILE, [&](int64_t first, int64_t last, int64_t slot) {
            float* scratch = bands.get() + slot * band;
            average_rows(samples, set, from, apart, first, last, scratch, to);
        });
    };
    average(raw.get(), 1, means);
    average(means, step, visibility);
    return sailenv::STATUS_OK;
}
