// How much of the light from around reaches each surface past its neighbours in the picture; see
// render/ambient_occlusion.py for the method. Works at half resolution, on eight samples at a time.
#include "../threads.h"
#include "lanes.h"
#include "lens.h"
#include "record.h"
#include "scratch.h"

#define AMBIENT_FIELDS(FIELD)                                                            \
    FIELD(int64_t, height)                                                               \
    FIELD(int64_t, width)                                                                \
    FIELD(const float*, surface) /* (H, W, 2): depth [m], id */                          \
    FIELD(const uint8_t*, known) /* (65536,): 1 of instances whose light is known */     \
    FIELD(const float*, pattern) /* (16, 2, TAPS) */                                     \
    FIELD(const sailenv::Lens*, lens)                                                    \
    FIELD(const float*, rays) /* (3, h, w): rays of any length, and the surface holds */ \
                              /* distances along them; else null, and it holds depths */ \
    FIELD(int64_t, parallel)  /* 1: rays are; see `Sight` of lens.h */                   \
    FIELD(double, radius_m)                                                              \
    FIELD(double, least_reach_px) /* of the radius, in samples */                        \
    FIELD(double, reach_px)                                                              \
    FIELD(double, bias)                                                                  \
    FIELD(double, scale)        /* how much one tap that hides everything takes away */  \
    FIELD(double, same_surface) /* share of its depth a sample lies off another's */     \
    FIELD(int64_t, step)        /* from one sample to the next of the second average */  \
    FIELD(float*, inverse)      /* (h, w), half the size, rounded up */                  \
    FIELD(uint8_t*, visibility)

SAILENV_RECORD(Ambient, ambient_visibility, AMBIENT_FIELDS)

namespace {

constexpr float FAR_M = 1e9f;  // depth that stands for no surface: its square is finite
constexpr int64_t TILE = 16;   // edge of the tiles that are left out where all around is baked
constexpr int64_t TAPS = 12;
constexpr int64_t MOST_STEP = 4;  // from one sample to the next of the second average
constexpr int64_t PAD = 16;       // samples beyond both ends of a row that count as on no surface
constexpr int64_t INSTANCES = 65536;

struct Settings {
    sailenv::FastLens lens;  // of the samples
    float radius_m;
    float least_reach_px, reach_px;
    float bias, scale;  // scale: how much one tap that hides everything takes away
    float same_surface;
};

struct Samples {
    int64_t rows, columns;
    float* inverse;        // (rows, columns): 1 / depth, negative where light was baked
    float* depth;          // (rows, columns): 1 / inverse
    const uint8_t* tiles;  // (tile rows, tile columns): 1 where something may be darkened
    int64_t tile_columns;
    const float* rays;  // (3, rows, columns), or null
    float* points;      // (rows, columns, 4), or null without rays: places [m], depth
};

// The length of a sample's ray, over which the surface's distance is; 1 through a pin-hole.
LANES_INLINE float ray_length(const Samples& s, int64_t place) {
    if (s.rays == nullptr) return 1.0f;
    const int64_t plane = s.rows * s.columns;
    const float *x = s.rays + place, *y = x + plane, *z = y + plane;
    return __builtin_sqrtf(*x * *x + *y * *y + *z * *z);
}

void set_point(const Samples& s, int64_t place, float told) {
    float* point = s.points + 4 * place;
    for (int axis = 0; axis < 3; axis++) {
        point[axis] = s.rays[axis * s.rows * s.columns + place] * __builtin_fabsf(told);
    }
    point[3] = told;
}

void halve_rows(const float* surface, int64_t width, const uint8_t* known, const Samples& s,
                uint8_t* own_tiles, int64_t first, int64_t last) {
    for (int64_t v = first; v < last; v++) {
        const float* row = surface + 4 * v * width;
        for (int64_t u = 0; u < s.columns; u++) {
            const float z = row[4 * u] / ray_length(s, v * s.columns + u), id = row[4 * u + 1];
            const bool hit = z > 1.0f / FAR_M && z < FAR_M;
            const bool has_id = hit && id >= 0.0f && id < INSTANCES;
            const bool is_known = has_id && known[static_cast<int32_t>(id)] != 0;
            const float inverse = !hit ? -1.0f / FAR_M : (is_known ? -1.0f : 1.0f) / z;
            s.inverse[v * s.columns + u] = inverse;
            const float told = 1.0f / inverse;
            s.depth[v * s.columns + u] = told;
            if (s.points != nullptr) set_point(s, v * s.columns + u, told);
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

// Rays of eight samples of a row from a column on; those beyond a last one are as it.
LANES_INLINE sailenv::Vec3x8 rays_at(const Samples& s, int64_t row, int64_t column, int64_t last) {
    const int64_t plane = s.rows * s.columns;
    const float* own = s.rays + row * s.columns;
    if (column + 7 <= last) {
        own += column;
        return {load(own), load(own + plane), load(own + 2 * plane)};
    }
    alignas(32) float found[3][8];
    for (int k = 0; k < 8; k++) {
        const float* ray = own + (column + k < last ? column + k : last);
        for (int axis = 0; axis < 3; axis++) found[axis][k] = ray[axis * plane];
    }
    return {load(found[0]), load(found[1]), load(found[2])};
}

// How rays change from each sample of a row to the next one, the last one's from the one before.
struct RayChanges {
    sailenv::Vec3x8 ray, right, down;
};
LANES_INLINE RayChanges ray_changes(const Samples& s, int64_t v, int64_t u) {
    const int64_t last = s.columns - 1;
    const int64_t upper = v + 1 < s.rows ? v : v - 1;
    const sailenv::Vec3x8 own = rays_at(s, v, u, last), after = rays_at(s, v, u + 1, last);
    sailenv::Vec3x8 right = after - own;
    if (u + 7 >= last) {
        const int64_t k = last - u;
        const sailenv::Vec3x8 before = rays_at(s, v, last - 1, last);
        right.x[k] = own.x[k] - before.x[0];
        right.y[k] = own.y[k] - before.y[0];
        right.z[k] = own.z[k] - before.z[0];
    }
    return {own, right, rays_at(s, upper + 1, u, last) - rays_at(s, upper, u, last)};
}

// Points of eight samples, and their depths as they are told.
LANES_INLINE sailenv::Vec3x8 points_at(const Samples& s, i8 places, f8& told) {
    const auto at = [&](int k) { return s.points + 4 * static_cast<int64_t>(places[k]); };
    const f8 rows[4] = {two_fours(at(0), at(4)), two_fours(at(1), at(5)), two_fours(at(2), at(6)),
                        two_fours(at(3), at(7))};
    sailenv::Vec3x8 found;
    transpose4(rows, found.x, found.y, found.z, told);
    return found;
}

// How samples see: from one point, at depths; side by side, at depths; through a lens that bends
// lines, at distances along its rays.
enum class Seen : int32_t { STRAIGHT, PARALLEL, BENT };

template <Seen SEEN>
void find_row(const Samples& s, const Settings& set, const float* pattern, int64_t v,
              uint8_t* out) {
    constexpr bool BENDS = SEEN == Seen::BENT, PARALLEL = SEEN == Seen::PARALLEL;
    const float* row = s.inverse + v * s.columns;
    const float* above = v > 0 ? row - s.columns : row;
    const float* below = v + 1 < s.rows ? row + s.columns : row;
    const uint8_t* tiles = s.tiles + v / TILE * s.tile_columns;
    const f8 zero = splat(0.0f), one = splat(1.0f);
    const float per_r2 = 1.0f / (set.radius_m * set.radius_m);
    const float y = set.lens.ray_y(static_cast<float>(v));
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
        const i8 own_moves = own > zero;
        const f8 w = abs8(own);
        const f8 column = counting() + static_cast<float>(u);
        RayChanges rays;
        if (BENDS) rays = ray_changes(s, v, u);
        const f8 focal = BENDS ? 1.0f / sqrt8(max8(dot(rays.right, rays.right), splat(1e-20f)))
                               : splat(set.lens.fx);
        const f8 reach =
            min8(PARALLEL ? set.radius_m * focal : set.radius_m * focal * w, splat(set.reach_px));
        const i8 active = reach >= set.least_reach_px;
        if (!any(active)) {
            memset(out + u, 255, static_cast<size_t>(count));
            continue;
        }
        // Over a plane 1/z is linear in the picture; where rays are parallel z is.
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
        const auto linear = [&](f8 n) { return PARALLEL ? one / abs8(n) : abs8(n); };
        const f8 middle = PARALLEL ? one / w : w;
        f8 a = slope(middle - linear(before), linear(after) - middle, at_left, at_right);
        f8 b = slope(middle - linear(load_some(above + u, count)),
                     linear(load_some(below + u, count)) - middle, v == 0 ? ~none : none,
                     v + 1 == s.rows ? ~none : none);
        // The plane is where (a, b, c) · point = level.
        f8 c, px, py, pz, level = one;
        const f8 z = one / w;
        if (BENDS) {
            // Of the plane's (a, b, c) the shares along the ray and its changes are known.
            const sailenv::Vec3x8 across = cross(rays.right, rays.down);
            const sailenv::Vec3x8 plane =
                (across * w + cross(rays.down, rays.ray) * a + cross(rays.ray, rays.right) * b) /
                dot(rays.ray, across);
            a = plane.x;
            b = plane.y;
            c = plane.z;
            px = rays.ray.x * z;
            py = rays.ray.y * z;
            pz = rays.ray.z * z;
        } else if (PARALLEL) {
            a = a * -set.lens.fx;
            b = b * -set.lens.fy;
            c = one;
            px = set.lens.ray_x(column);
            py = splat(y);
            pz = z;
            level = a * px + b * py + pz;
        } else {
            a = a * set.lens.fx;
            b = b * set.lens.fy;
            const f8 x = set.lens.ray_x(column);
            c = w - a * x - b * y;
            px = x * z;
            py = y * z;
            pz = z;
        }
        const f8 plane_m = one / sqrt8(a * a + b * b + c * c);
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
            f8 other, qx, qy, qz;
            if (BENDS) {
                const sailenv::Vec3x8 there = points_at(s, place, other);
                qx = there.x;
                qy = there.y;
                qz = there.z;
            } else {
                for (int k = 0; k < 8; k++) other[k] = s.depth[place[k]];
                qz = abs8(other);
                qx = set.lens.ray_x(to_float(tu));
                qy = set.lens.ray_y(to_float(tv));
                if (!PARALLEL) {
                    qx = qx * qz;
                    qy = qy * qz;
                }
            }
            const f8 dx = qx - px, dy = qy - py, dz = qz - pz;
            const f8 d2 = dx * dx + dy * dy + dz * dz + self_m2;
            const f8 fall = max8(one - d2 * per_r2, zero);
            const f8 height_m = (level - (a * qx + b * qy + c * qz)) * plane_m;
            const f8 rise = height_m / sqrt8(d2) - set.bias;
            const i8 counts = inside & ((other > zero) | own_moves);
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

SAILENV_KERNEL(ambient_visibility)(int64_t threads, const Ambient* given) {
    const Ambient& in = *given;
    const int64_t height = in.height, width = in.width, step = in.step;
    const bool narrow = in.rays != nullptr && (height < 3 || width < 3);
    const bool both = in.rays != nullptr && in.parallel != 0;
    if (height < 1 || width < 1 || step < 1 || step > MOST_STEP || narrow || both) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    const auto in_single = [](double x) { return static_cast<float>(x); };
    const Settings set{
        sailenv::FastLens(*in.lens, 0.5), in_single(in.radius_m), in_single(in.least_reach_px),
        in_single(in.reach_px),           in_single(in.bias),     in_single(in.scale),
        in_single(in.same_surface)};
    const int64_t rows = (height + 1) / 2, columns = (width + 1) / 2;
    const int64_t tile_rows = (rows + TILE - 1) / TILE, tile_columns = (columns + TILE - 1) / TILE;
    const int64_t tile_count = tile_rows * tile_columns;
    const int64_t band = 3 * (TILE + 3 * MOST_STEP) * (columns + 2 * PAD);
    const auto depth = sailenv::allocate<float>(rows * columns);
    const auto points = sailenv::allocate<float>(in.rays != nullptr ? 4 * rows * columns : 1);
    const auto tiles = sailenv::allocate<uint8_t>(2 * tile_count);
    const auto raw = sailenv::allocate<uint8_t>(2 * rows * columns);
    const auto bands = sailenv::allocate<float>(band * threads);
    if (!depth || !points || !tiles || !raw || !bands) return sailenv::STATUS_OUT_OF_MEMORY;
    uint8_t* own = tiles.get() + tile_count;
    memset(tiles.get(), 0, static_cast<size_t>(2 * tile_count));
    const Samples samples{
        rows,        columns,      in.inverse, depth.get(),
        tiles.get(), tile_columns, in.rays,    in.rays == nullptr ? nullptr : points.get()};
    sailenv::parallel_for(threads, rows, TILE, [&](int64_t first, int64_t last, int64_t) {
        halve_rows(in.surface, width, in.known, samples, own + first / TILE * tile_columns, first,
                   last);
    });
    const int64_t reach = static_cast<int64_t>(set.reach_px) / TILE;
    dilate_tiles(own, tile_rows, tile_columns, reach, tiles.get());
    sailenv::parallel_for(threads, rows, TILE, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            const auto find = in.parallel != 0     ? find_row<Seen::PARALLEL>
                              : in.rays == nullptr ? find_row<Seen::STRAIGHT>
                                                   : find_row<Seen::BENT>;
            find(samples, set, in.pattern, v, raw.get() + v * columns);
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
    average(means, step, in.visibility);
    if (in.rays != nullptr) {
        // From shares of the rays back to distances.
        for (int64_t k = 0; k < rows * columns; k++) {
            if (in.inverse[k] != -1.0f / FAR_M) in.inverse[k] /= ray_length(samples, k);
        }
    }
    return sailenv::STATUS_OK;
}
