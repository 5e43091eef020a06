// Visibility: cull clusters, transform corners, set edge functions up, sort into bands, draw.
#include "raster.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "../threads.h"
#include "cluster_culling.h"
#include "cluster_rows.h"
#include "lens_raster.h"
#include "mask_test.h"

namespace sailenv {
namespace {

constexpr int64_t SEGMENT_CLUSTERS = 48;
constexpr float LEAST_DEPTH_M = 1e-3f;  // corners nearer than that have no bounds on the screen
constexpr double PARALLEL_EYE_M = 1e9;  // far enough that all is seen in one direction

LANES_INLINE float smaller(float a, float b) { return a < b ? a : b; }
LANES_INLINE float larger(float a, float b) { return a > b ? a : b; }

// Eye from object, row by row, times a pose with a scale.
void compose(const double* eye_from_world, const double* pose, const double* scale, double* out) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? eye_from_world[4 * i + 3] : 0.0;
            for (int k = 0; k < 3; k++) sum += eye_from_world[4 * i + k] * pose[4 * k + j];
            out[4 * i + j] = j == 3 ? sum : sum * scale[j];
        }
    }
}

// The rows of a rotation times a transform.
void turn_rows(const double* turn, const double* from_world, double* out) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++) sum += turn[3 * i + k] * from_world[4 * k + j];
            out[4 * i + j] = sum;
        }
    }
}

// Where a sample lies.
double pixel_of(const Projection& p, int32_t sample) {
    return p.fine ? 0.5 * (sample - 1) : sample;
}

// The same for what is drawn in a part of the picture alone.
Projection clipped(const Projection& p, const Instances& instances) {
    Projection result = p;
    const int32_t scale = p.fine ? 2 : 1, last = p.fine ? 2 : 0;
    result.x0 = std::max(p.x0, scale * instances.clip[0]);
    result.y0 = std::max(p.y0, scale * instances.clip[1]);
    result.x1 = std::min(p.x1, scale * instances.clip[2] + last);
    result.y1 = std::min(p.y1, scale * instances.clip[3] + last);
    return result;
}

// Least and greatest x and y of samples on a face.
struct FaceBounds {
    double low[2], high[2];
};

// Of those of a rectangle, give or take a tile.
FaceBounds bounds_within(const Projection& p, int32_t number) {
    const LensTable& lens = *p.table;
    const CubeFace& face = lens.faces[number];
    FaceBounds found = {{1e9, 1e9}, {-1e9, -1e9}};
    bool all = false, none = true;
    for (int32_t y = p.y0 / LENS_TILE_ROWS; y <= p.y1 / LENS_TILE_ROWS; y++) {
        for (int32_t x = p.x0 / LENS_TILE_COLUMNS; x <= p.x1 / LENS_TILE_COLUMNS; x++) {
            const LensTiles& group =
                lens.tiles[y / LENS_GROUP_ROWS * lens.tile_groups + x / LENS_GROUP_COLUMNS];
            const int32_t k = y % LENS_GROUP_ROWS * LENS_GROUP_COLUMNS + x % LENS_GROUP_COLUMNS;
            if (!(group.faces[k] >> number & 1)) continue;
            none = false;
            // Of several faces a tile has no bounds.
            all |= group.faces[k] != 1 << number;
            found.low[0] = std::min<double>(found.low[0], group.low_x[k]);
            found.low[1] = std::min<double>(found.low[1], group.low_y[k]);
            found.high[0] = std::max<double>(found.high[0], group.high_x[k]);
            found.high[1] = std::max<double>(found.high[1], group.high_y[k]);
        }
    }
    if (none) return {{1e9, 1e9}, {1e9, 1e9}};
    if (all) return {{face.low[0], face.low[1]}, {face.high[0], face.high[1]}};
    return found;
}

void set_sides(InstanceFrame& frame, const Projection& p, const FaceBounds* face) {
    const double* m = frame.eye_from_object;
    double wide[4];
    if (face != nullptr) {
        const double across = CULL_MARGIN * std::max(-face->low[0], face->high[0]);
        const double down = CULL_MARGIN * std::max(-face->low[1], face->high[1]);
        wide[0] = across - face->low[0];
        wide[1] = across + face->high[0];
        wide[2] = down - face->low[1];
        wide[3] = down + face->high[1];
    } else if (p.drawn != Drawn::SHADOW) {
        // A hundredth of the farther side's width beyond what is drawn.
        wide[0] = -ray_x(p.lens, pixel_of(p, p.x0) - 0.5);
        wide[1] = ray_x(p.lens, pixel_of(p, p.x1) + 0.5);
        wide[2] = -ray_y(p.lens, pixel_of(p, p.y0) - 0.5);
        wide[3] = ray_y(p.lens, pixel_of(p, p.y1) + 0.5);
        const double across = CULL_MARGIN * std::max(wide[0], wide[1]);
        const double down = CULL_MARGIN * std::max(wide[2], wide[3]);
        for (int s = 0; s < 4; s++) wide[s] += s < 2 ? across : down;
    }
    for (int s = 0; s < 4; s++) {
        const double sign = s % 2 ? -1.0 : 1.0;
        double* plane = frame.sides + 4 * s;
        for (int j = 0; j < 4; j++) {
            const double at = sign * m[4 * (s / 2) + j];
            if (p.drawn == Drawn::PERSPECTIVE) {
                plane[j] = wide[s] * m[8 + j] + at;
            } else if (p.drawn == Drawn::PARALLEL) {
                plane[j] = at + (j == 3 ? wide[s] : 0.0);
            } else {
                const double limit = s % 2 ? (s / 2 ? p.height : p.width) : 1.0;
                plane[j] = at + (j == 3 ? limit : 0.0);
            }
        }
        const double length =
            std::sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
        for (int j = 0; j < 4; j++) plane[j] /= length;
    }
}

// Where the eye is in the object's frame: what is no number culls nothing. Where rays are parallel
// it is that far behind the camera.
void set_eye(InstanceFrame& frame, const Projection& p) {
    const double* m = frame.eye_from_object;
    const double behind = p.drawn == Drawn::PARALLEL ? PARALLEL_EYE_M : 0.0;
    const double a = m[0], b = m[1], c = m[2], d = m[4], e = m[5], f = m[6], g = m[8], h = m[9],
                 i = m[10];
    const double det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
    const double x = -m[3] / det, y = -m[7] / det, z = -(m[11] + behind) / det;
    frame.eye[0] = (e * i - f * h) * x + (c * h - b * i) * y + (b * f - c * e) * z;
    frame.eye[1] = (f * g - d * i) * x + (a * i - c * g) * y + (c * d - a * f) * z;
    frame.eye[2] = (d * h - e * g) * x + (b * g - a * h) * y + (a * e - b * d) * z;
}

// Edge functions and planes, in double precision. Two triangles that share an edge get the same
// numbers for it with opposite signs, so no pixel between them is lost or drawn twice. Nothing is
// snapped to a grid.
template <Drawn DRAWN>
void set_edges_up(ClusterRows& r, int32_t count, const Projection& p) {
    constexpr bool PERSPECTIVE = DRAWN == Drawn::PERSPECTIVE;
    const Lens lens = p.lens;
    for (int32_t k = 0; k < count; k += 4) {
        const d4 one = {1.0, 1.0, 1.0, 1.0};
        const d4 ax = load_double(r.corner[0] + k), ay = load_double(r.corner[1] + k);
        const d4 bx = load_double(r.corner[3] + k), by = load_double(r.corner[4] + k);
        const d4 cx = load_double(r.corner[6] + k), cy = load_double(r.corner[7] + k);
        const d4 ad = load_double(r.corner[2] + k), bd = load_double(r.corner[5] + k),
                 cd = load_double(r.corner[8] + k);
        const d4 az = PERSPECTIVE ? ad : one, bz = PERSPECTIVE ? bd : one,
                 cz = PERSPECTIVE ? cd : one;
        const d4 e0x = by * cz - bz * cy, e0y = bz * cx - bx * cz, e0z = bx * cy - by * cx;
        const d4 e1x = cy * az - cz * ay, e1y = cz * ax - cx * az, e1z = cx * ay - cy * ax;
        const d4 e2x = ay * bz - az * by, e2y = az * bx - ax * bz, e2z = ax * by - ay * bx;
        const d4 det = ax * e0x + ay * e0y + az * e0z;
        // Corners run counter-clockwise as seen from in front; with y downwards that is det < 0.
        const d4 sign = det < 0.0 ? -one : one;
        const d4 size = det * sign;
        const d4 inverse = 1.0 / size;
        const l4 back = det < 0.0 ? l4{} : l4{1, 1, 1, 1};
        // Without extent, or not a number: back is 2, nothing sees that.
        const l4 state = (size > 1e-30) & (inverse < 1e30) ? back : l4{2, 2, 2, 2};
        for (int j = 0; j < 4; j++) r.back[k + j] = static_cast<int32_t>(state[j]);
        const auto [a0, b0, c0] = share_along(lens, sign, e0x, e0y, e0z);
        const auto [a1, b1, c1] = share_along(lens, sign, e1x, e1y, e1z);
        const auto [a2, b2, c2] = share_along(lens, sign, e2x, e2y, e2z);
        store_double(r.edge[0] + k, a0);
        store_double(r.edge[1] + k, b0);
        store_double(r.edge[2] + k, c0);
        store_double(r.edge[3] + k, a1);
        store_double(r.edge[4] + k, b1);
        store_double(r.edge[5] + k, c1);
        store_double(r.edge[6] + k, a2);
        store_double(r.edge[7] + k, b2);
        store_double(r.edge[8] + k, c2);
        store_double(r.inverse_det + k, inverse);
        if (PERSPECTIVE) {
            store_double(r.inverse_depth[0] + k, (a0 + a1 + a2) * inverse);
            store_double(r.inverse_depth[1] + k, (b0 + b1 + b2) * inverse);
            store_double(r.inverse_depth[2] + k, (c0 + c1 + c2) * inverse);
        } else if (DRAWN == Drawn::PARALLEL) {
            const d4 nearer = -inverse;
            store_double(r.inverse_depth[0] + k, (a0 * ad + a1 * bd + a2 * cd) * nearer);
            store_double(r.inverse_depth[1] + k, (b0 * ad + b1 * bd + b2 * cd) * nearer);
            store_double(r.inverse_depth[2] + k, (c0 * ad + c1 * bd + c2 * cd) * nearer);
        } else {
            const d4 na = 1.0 - ad, nb = 1.0 - bd, nc = 1.0 - cd;
            const d4 nx = (a0 * na + a1 * nb + a2 * nc) * inverse;
            const d4 ny = (b0 * na + b1 * nb + b2 * nc) * inverse;
            const d4 steep_x = nx < 0.0 ? -nx : nx, steep_y = ny < 0.0 ? -ny : ny;
            // What shadow maps need so that surfaces do not shade themselves: as OpenGL's
            // polygon offset of 1.5 slopes and 2 units of 24 bits.
            const d4 offset = 1.5 * (steep_x > steep_y ? steep_x : steep_y) + 0x1p-23;
            store_double(r.inverse_depth[0] + k, nx);
            store_double(r.inverse_depth[1] + k, ny);
            store_double(r.inverse_depth[2] + k, (c0 * na + c1 * nb + c2 * nc) * inverse - offset);
        }
    }
}

// Which of eight intervals hold a number that is `first` and some times 2.
LANES_INLINE i8 hold(f8 low, f8 high, float first) {
    // Upwards is the negative floor of the negative.
    return -floor8((first - low) * 0.5f) <= floor8((high - first) * 0.5f);
}

// Which of eight rectangles [samples] hold a fine sample: each of odd or even rows and columns.
LANES_INLINE i8 hold_fine_sample(f8 x0, f8 x1, f8 y0, f8 y1) {
    constexpr float SHIFT = 2.0f * SAMPLE_SHIFT;
    return (hold(x0, x1, 1.0f) & hold(y0, y1, 1.0f)) |
           (hold(x0, x1, 0.0f) & hold(y0, y1, 1.0f + SHIFT)) |
           (hold(x0, x1, 1.0f + SHIFT) & hold(y0, y1, 0.0f)) |
           (hold(x0, x1, SHIFT) & hold(y0, y1, SHIFT));
}

// Which samples a triangle can reach: their bounds; x0 > x1 if there are none.
template <Drawn DRAWN>
void set_bounds(ClusterRows& r, int32_t count, const Projection& p) {
    constexpr bool PERSPECTIVE = DRAWN == Drawn::PERSPECTIVE;
    const float left = static_cast<float>(p.x0), right = static_cast<float>(p.x1);
    const float top = static_cast<float>(p.y0), bottom = static_cast<float>(p.y1);
    const FastLens lens(p.fine ? of_half_pixels(p.lens) : p.lens);
    for (int32_t k = 0; k < count; k += 8) {
        f8 x[3], y[3], depth[3];
        for (int j = 0; j < 3; j++) {
            x[j] = load(r.corner[3 * j] + k);
            y[j] = load(r.corner[3 * j + 1] + k);
            depth[j] = load(r.corner[3 * j + 2] + k);
            if (PERSPECTIVE) {
                project(lens, depth[j], x[j], y[j]);
            } else if (DRAWN == Drawn::PARALLEL) {
                x[j] = lens.cx + lens.fx * x[j];
                y[j] = lens.cy + lens.fy * y[j];
            }
        }
        f8 x0 = min8(x[0], min8(x[1], x[2])) - 0.01f, x1 = max8(x[0], max8(x[1], x[2])) + 0.01f;
        f8 y0 = min8(y[0], min8(y[1], y[2])) - 0.01f, y1 = max8(y[0], max8(y[1], y[2])) + 0.01f;
        i8 behind = splat(0);
        if (PERSPECTIVE) {
            const f8 nearest = min8(depth[0], min8(depth[1], depth[2]));
            const f8 farthest = max8(depth[0], max8(depth[1], depth[2]));
            const i8 crosses = nearest < LEAST_DEPTH_M;
            behind = farthest <= LEAST_DEPTH_M;
            x0 = crosses ? splat(left) : x0;
            y0 = crosses ? splat(top) : y0;
            x1 = crosses ? splat(right) : x1;
            y1 = crosses ? splat(bottom) : y1;
        } else if (DRAWN == Drawn::PARALLEL) {
            behind = max8(depth[0], max8(depth[1], depth[2])) <= 0.0f;
        }
        if (p.fine) {
            behind |= ~hold_fine_sample(x0, x1, y0, y1);
            x0 = x0 - 2.0f * SAMPLE_SHIFT;
            y0 = y0 - 2.0f * SAMPLE_SHIFT;
        }
        // Rounded inwards to samples: upwards is the negative floor of the negative.
        x0 = -floor8(-clamp8(x0, left, 1e5f));
        y0 = -floor8(-clamp8(y0, top, 1e5f));
        x1 = floor8(clamp8(x1, left - 1.0f, right));
        y1 = floor8(clamp8(y1, top - 1.0f, bottom));
        store(r.x0 + k, behind ? splat(1.0f) : x0);
        store(r.x1 + k, behind ? splat(0.0f) : x1);
        store(r.y0 + k, y0);
        store(r.y1 + k, y1);
    }
}

// Fills up to the next multiple of eight with triangles that are nowhere.
void pad(ClusterRows& r, int32_t count) {
    for (int32_t k = count; k < ((count + 7) & ~7); k++) {
        for (int j = 0; j < 9; j++) r.corner[j][k] = 0.0f;
    }
}

// Moves the triangles that reach a sample to the front; most small ones reach none.
int32_t keep_reaching(ClusterRows& r, int32_t count) {
    int32_t kept = 0;
    for (int32_t k = 0; k < count; k++) {
        if (!(r.x0[k] <= r.x1[k]) || !(r.y0[k] <= r.y1[k])) continue;
        if (kept != k) {
            for (int j = 0; j < 9; j++) r.corner[j][kept] = r.corner[j][k];
            for (int j = 0; j < 3; j++) r.vertex[j][kept] = r.vertex[j][k];
            r.x0[kept] = r.x0[k];
            r.x1[kept] = r.x1[k];
            r.y0[kept] = r.y0[k];
            r.y1[kept] = r.y1[k];
        }
        kept++;
    }
    return kept;
}

template <Drawn DRAWN>
int64_t set_cluster_up(const SeenCluster& seen, const Part& part, int64_t corners_at,
                       const TriangleSet& set, const Projection& p, ClusterRows& r, Triangle* out) {
    const Cluster& cluster = part.clusters[seen.cluster];
    const int32_t count = static_cast<int32_t>(cluster.index_count / 3);
    const uint32_t* corners = part.corner_indices + cluster.first_index;
    const uint32_t* vertices = part.vertex_indices + cluster.first_index;
    const float *x = set.x.data() + corners_at, *y = set.y.data() + corners_at,
                *z = set.z.data() + corners_at;
    const bool bends = DRAWN == Drawn::PERSPECTIVE && p.table != nullptr;
    const CornerPlace* places = bends ? set.places.data() + corners_at : nullptr;
    for (int32_t k = 0; k < count; k++) {
        for (int j = 0; j < 3; j++) {
            const uint32_t corner = corners[3 * k + j];
            r.corner[3 * j][k] = x[corner];
            r.corner[3 * j + 1][k] = y[corner];
            r.corner[3 * j + 2][k] = z[corner];
            r.vertex[j][k] = static_cast<int32_t>(vertices[3 * k + j]);
            if (bends) r.place[j][k] = places + corner;
        }
    }
    const bool two_sided = DRAWN == Drawn::SHADOW || (part.flags & PART_DOUBLE_SIDED);
    const bool front = seen.facing != FACING_BACK;
    const bool back = seen.facing == FACING_BACK || (seen.facing == FACING_BOTH && two_sided);
    const int32_t padded = (count + 7) & ~7;
    pad(r, count);
    if (bends) {
        for (int32_t k = count; k < padded; k++) {
            for (int j = 0; j < 3; j++) r.place[j][k] = places;
        }
        set_lens_bounds(r, padded, p, p.table->faces[seen.face], front, back);
    } else {
        set_bounds<DRAWN>(r, padded, p);
    }
    const int32_t reaching = keep_reaching(r, count);
    pad(r, reaching);
    set_edges_up<DRAWN>(r, (reaching + 3) & ~3, p);
    int64_t made = 0;
    for (int32_t k = 0; k < reaching; k++) {
        const bool faces = r.back[k] == 0 ? front : r.back[k] == 1 && back;
        if (!faces) continue;
        Triangle& t = out[made++];
        for (int j = 0; j < 9; j++) t.edge[j] = r.edge[j][k];
        for (int j = 0; j < 3; j++) t.inverse_depth[j] = r.inverse_depth[j][k];
        for (int j = 0; j < 3; j++) t.vertex[j] = r.vertex[j][k];
        t.inverse_det = r.inverse_det[k];
        t.part = seen.part;
        t.back = static_cast<int8_t>(r.back[k]);
        t.face = static_cast<int8_t>(seen.face);
        t.masked = DRAWN != Drawn::SHADOW && (part.flags & PART_MASKED) ? 1 : 0;
        t.x0 = static_cast<int16_t>(r.x0[k]);
        t.x1 = static_cast<int16_t>(r.x1[k]);
        t.y0 = static_cast<int16_t>(r.y0[k]);
        t.y1 = static_cast<int16_t>(r.y1[k]);
    }
    return made;
}

void transform_corners(const Part& part, const double* m, float* x, float* y, float* z) {
    for (int32_t k = 0; k < part.corner_count; k += 4) {
        const d4 a = load_double(part.corner_x + k), b = load_double(part.corner_y + k),
                 c = load_double(part.corner_z + k);
        store_double(x + k, m[0] * a + m[1] * b + m[2] * c + m[3]);
        store_double(y + k, m[4] * a + m[5] * b + m[6] * c + m[7]);
        store_double(z + k, m[8] * a + m[9] * b + m[10] * c + m[11]);
    }
}

// First and last band of a triangle. The last row of a band of fine samples is the first one of
// the next band.
RowRange bands_of(const Triangle& t, bool fine, int32_t bands, int32_t band_rows) {
    if (!fine) return {t.y0 / band_rows, t.y1 / band_rows};
    const int32_t rows = 2 * band_rows;
    return {std::max(t.y0 - 1, 0) / rows, std::min(t.y1 / rows, bands - 1)};
}

// Lists, for each band, the triangles that reach into it; none reaches beyond bands `low` to
// `high`.
void sort_into_bands(Segment& segment, const Triangle* triangles, bool fine, int32_t bands,
                     int32_t band_rows, int32_t low, int32_t high) {
    segment.starts.assign(static_cast<size_t>(bands) + 1, 0);
    uint32_t* starts = segment.starts.data();
    for (int64_t k = 0; k < segment.triangle_count; k++) {
        const auto reached =
            bands_of(triangles[segment.first_triangle + k], fine, bands, band_rows);
        for (int32_t b = reached.first; b <= reached.last; b++) starts[b + 1]++;
    }
    for (int32_t b = low; b <= high; b++) starts[b + 1] += starts[b];
    segment.entries.resize(starts[high + 1]);
    for (int64_t k = 0; k < segment.triangle_count; k++) {
        const int64_t number = segment.first_triangle + k;
        const auto reached = bands_of(triangles[number], fine, bands, band_rows);
        for (int32_t b = reached.first; b <= reached.last; b++) {
            segment.entries[starts[b]++] = static_cast<uint32_t>(number);
        }
    }
    // Each start has moved to the next one's place.
    for (int32_t b = high + 1; b > low; b--) starts[b] = starts[b - 1];
    starts[low] = 0;
}

// The same where all reach into the one band that is drawn.
void put_into_band(Segment& segment, int32_t band) {
    const size_t at = static_cast<size_t>(band);
    if (segment.starts.size() < at + 2) segment.starts.resize(at + 2);
    segment.starts[at] = 0;
    segment.starts[at + 1] = static_cast<uint32_t>(segment.triangle_count);
    segment.entries.resize(static_cast<size_t>(segment.triangle_count));
    std::iota(segment.entries.begin(), segment.entries.end(),
              static_cast<uint32_t>(segment.first_triangle));
}

// Where a row of a wide triangle begins and ends, give or take a sample. `down` is the edge's slope
// from row to row: some fine samples lie below their row.
template <bool FINE>
LANES_INLINE bool narrow(float slope, float down, float offset, float inverse, float& low,
                         float& high) {
    if (FINE) offset += larger(SAMPLE_SHIFT * down, 0.0f);
    const float pixel = offset * inverse, at = FINE ? 2.0f * pixel + 1.0f : pixel;
    if (slope > 0.0f) {
        low = larger(at - 1.0f, low);
    } else if (slope < 0.0f) {
        high = smaller(at + 1.0f, high);
    } else {
        return offset >= 0.0f;
    }
    return true;
}

// `inverse_depth` and `visible` (may be null) begin at the sample in row 0 and column 0.
template <bool MASKED, bool FINE>
void draw_triangle(const Triangle& t, uint32_t number, const Part& part, const Projection& p,
                   int32_t first_row, int32_t last_row, int64_t stride, uint32_t* visible,
                   float* inverse_depth) {
    const int32_t y0 = t.y0 > first_row ? t.y0 : first_row;
    const int32_t y1 = t.y1 < last_row ? t.y1 : last_row;
    const float share = visible == nullptr ? 1.0f : nearness_share(t, p.drawn == Drawn::PARALLEL);
    const float a0 = t.edge[0], a1 = t.edge[3], a2 = t.edge[6], an = t.inverse_depth[0] * share;
    const float least0 = least_inside(t.edge), least1 = least_inside(t.edge + 3),
                least2 = least_inside(t.edge + 6);
    const bool wide = t.x1 - t.x0 >= 16;
    float inverse0 = 0.0f, inverse1 = 0.0f, inverse2 = 0.0f;
    if (wide) {
        inverse0 = -1.0f / a0;
        inverse1 = -1.0f / a1;
        inverse2 = -1.0f / a2;
    }
    const i8 tag = splat(static_cast<int32_t>(number));
    MaskedTriangle masked;
    if (MASKED) masked = masked_triangle(t, part, p.drawn == Drawn::PARALLEL);
    for (int32_t row = y0; row <= y1; row++) {
        const float y = FINE ? 0.5f * static_cast<float>(row - 1) : static_cast<float>(row);
        const float c0 = t.edge[1] * y + t.edge[2], c1 = t.edge[4] * y + t.edge[5],
                    c2 = t.edge[7] * y + t.edge[8],
                    cn = (t.inverse_depth[1] * y + t.inverse_depth[2]) * share;
        int32_t first = t.x0, last = t.x1;
        if (wide) {
            float low = static_cast<float>(first), high = static_cast<float>(last);
            if (!narrow<FINE>(a0, t.edge[1], c0, inverse0, low, high) ||
                !narrow<FINE>(a1, t.edge[4], c1, inverse1, low, high) ||
                !narrow<FINE>(a2, t.edge[7], c2, inverse2, low, high) || !(low <= high)) {
                continue;
            }
            first = static_cast<int32_t>(low);
            last = static_cast<int32_t>(high);
        }
        // Where samples lie from the row and from their columns. A row of fine ones begins with an
        // even column.
        f8 down{};
        float across = 0.0f;
        if (FINE) {
            constexpr float S = SAMPLE_SHIFT;
            first &= ~1;
            down = f8{S, 0.0f, S, 0.0f, S, 0.0f, S, 0.0f};
            across = (row & 1) != 0 ? 0.0f : S;
        }
        const f8 r0 = t.edge[1] * down + c0, r1 = t.edge[4] * down + c1, r2 = t.edge[7] * down + c2,
                 rn = t.inverse_depth[1] * share * down + cn;
        float* near_row = inverse_depth + row * stride;
        int32_t* seen_row =
            visible == nullptr ? nullptr : reinterpret_cast<int32_t*>(visible + row * stride);
        for (int32_t x = first; x <= last; x += 8) {
            const f8 at = FINE ? 0.5f * (counting() + static_cast<float>(x - 1)) + across
                               : counting() + static_cast<float>(x);
            const f8 e0 = a0 * at + r0, e1 = a1 * at + r1, e2 = a2 * at + r2, n = an * at + rn;
            const f8 before = load(near_row + x);
            i8 drawn = (e0 >= least0) & (e1 >= least1) & (e2 >= least2) & (n > before) &
                       (n <= p.greatest_inverse_depth);
            if (MASKED) {
                if (!any(drawn)) continue;
                drawn = opaque_pixels(masked, part, at, y + down, PixelSteps{}, n, drawn);
            }
            store(near_row + x, drawn ? n : before);
            if (seen_row != nullptr) {
                const i8 old = load(seen_row + x);
                store(seen_row + x, drawn ? tag : old);
            }
        }
    }
}

}  // namespace

Projection projection_of(const View& view) {
    Projection p{};
    const bool parallel = view.parallel != 0;
    p.drawn = parallel ? Drawn::PARALLEL : Drawn::PERSPECTIVE;
    p.lens = view.lens;
    p.table = view.table;
    if (p.table != nullptr) {
        p.lens.fx = p.lens.fy = 1.0;
        p.lens.cx = p.lens.cy = 0.0;
    }
    p.width = static_cast<int32_t>(view.width);
    p.height = static_cast<int32_t>(view.height);
    p.x1 = p.width - 1;
    p.y1 = p.height - 1;
    // A little less: annotations compare depths with the far distance exactly.
    const float far = static_cast<float>(view.lens.far_m);
    p.least_inverse_depth = parallel
                                ? std::nextafter(-far, -2.0f * far)
                                : std::nextafter(static_cast<float>(1.0 / view.lens.far_m), 0.0f);
    // Parallel rays begin at the camera's plane.
    p.greatest_inverse_depth = parallel ? -1.1754944e-38f : 3e38f;
    return p;
}

void set_frames(Scratch& scratch, const Instances& instances, const double* eye_from_world,
                const Projection& projection) {
    const int32_t faces = faces_of(projection);
    scratch.frames.resize(static_cast<size_t>(faces * instances.count));
    for (int32_t number = 0; number < faces; number++) {
        const CubeFace* face =
            projection.table == nullptr ? nullptr : projection.table->faces + number;
        // The first face's frames hold what does not depend on the face.
        if (face != nullptr && number > 0 && !is_used(*face)) continue;
        double face_from_world[12];
        if (face != nullptr) turn_rows(face->turn, eye_from_world, face_from_world);
        const double* onto = face == nullptr ? eye_from_world : face_from_world;
        FaceBounds bounds{}, clipped_bounds{};
        if (face != nullptr) {
            const int32_t end = projection.fine ? 2 * projection.height : projection.height - 1;
            const bool whole = projection.y0 <= 0 && projection.y1 >= end;
            bounds = {{face->low[0], face->low[1]}, {face->high[0], face->high[1]}};
            if (!whole) bounds = bounds_within(projection, number);
            if (instances.clipped != 0) {
                clipped_bounds = bounds_within(clipped(projection, instances), number);
            }
        }
        for (int64_t k = 0; k < instances.count; k++) {
            InstanceFrame& frame =
                scratch.frames[static_cast<size_t>(number * instances.count + k)];
            const double *pose = instances.world_from_body + 16 * k,
                         *scale = instances.scales + 3 * k;
            compose(onto, pose, scale, frame.eye_from_object);
            const bool is_clipped = k + 1 == instances.clipped;
            if (face != nullptr) {
                set_sides(frame, projection, is_clipped ? &clipped_bounds : &bounds);
            } else if (!projection.listed) {
                set_sides(frame, is_clipped ? clipped(projection, instances) : projection, nullptr);
            }
            if (!projection.listed) set_eye(frame, projection);
            // Normals go by the inverse transpose: the rotation with the reciprocal scale.
            for (int j = 0; j < 3; j++) {
                for (int i = 0; i < 8; i++) {
                    frame.normal_columns[j][i] =
                        i < 3 ? static_cast<float>(pose[4 * i + j] / scale[j]) : 0.0f;
                }
            }
        }
    }
}

void make_triangles(int64_t threads, const Scratch& scratch, const DrawList& parts,
                    const Instances& instances, const Projection& projection, const int32_t* order,
                    int64_t order_count, bool back_first, TriangleSet& set) {
    set.seen.clear();
    set.parts_seen.clear();
    set.corners_at.assign(static_cast<size_t>(faces_of(projection) * parts.count), -1);
    const Projection part_of_it = clipped(projection, instances);
    const bool nowhere = part_of_it.x0 > part_of_it.x1 || part_of_it.y0 > part_of_it.y1;
    int64_t corners = 0, most_triangles = 0;
    set.segment_count = 0;
    auto end_segment = [&](int64_t first_cluster, int64_t first_triangle) {
        if (set.segments.size() <= static_cast<size_t>(set.segment_count)) {
            set.segments.emplace_back();
        }
        Segment& segment = set.segments[static_cast<size_t>(set.segment_count++)];
        segment.first_cluster = first_cluster;
        segment.last_cluster = static_cast<int64_t>(set.seen.size());
        segment.first_triangle = first_triangle;
        segment.triangle_count = 0;
    };
    int64_t first_cluster = 0, first_triangle = 0;
    for (int32_t face = 0; face < faces_of(projection); face++) {
        if (projection.table != nullptr && !is_used(projection.table->faces[face])) continue;
        const InstanceFrame* frames = scratch.frames.data() + face * instances.count;
        for (int64_t place = 0; place < order_count; place++) {
            const int32_t number = order == nullptr ? static_cast<int32_t>(place) : order[place];
            const Part& part = parts.parts[number];
            if (instances.drawn != nullptr && !instances.drawn[part.instance]) continue;
            if (part.instance + 1 == instances.clipped && nowhere) continue;
            const InstanceFrame& frame = frames[part.instance];
            const double centre[3] = {part.sphere[0], part.sphere[1], part.sphere[2]};
            const bool culled = !projection.listed;
            if (culled && is_beyond(centre, part.sphere[3], frame.sides)) continue;
            const bool two_sided =
                projection.drawn == Drawn::SHADOW || (part.flags & PART_DOUBLE_SIDED);
            const int passes = back_first && two_sided ? 2 : 1;
            for (int pass = 0; pass < passes; pass++) {
                const Facing facing = passes == 1 ? FACING_BOTH
                                      : pass == 0 ? FACING_BACK
                                                  : FACING_FRONT;
                for (int32_t c = 0; c < part.cluster_count; c++) {
                    const Cluster& cluster = part.clusters[c];
                    if (culled && is_beyond(cluster.centre, cluster.radius, frame.sides)) continue;
                    if (culled && !two_sided && faces_away(cluster, frame.eye)) continue;
                    set.seen.push_back({number, c, facing, face});
                    most_triangles += cluster.index_count / 3;
                    if (static_cast<int64_t>(set.seen.size()) - first_cluster == SEGMENT_CLUSTERS) {
                        end_segment(first_cluster, first_triangle);
                        first_cluster = static_cast<int64_t>(set.seen.size());
                        first_triangle = most_triangles;
                    }
                    int64_t& at = set.corners_at[static_cast<size_t>(face * parts.count + number)];
                    if (at < 0) {
                        at = corners;
                        set.parts_seen.push_back(face * parts.count + number);
                        corners += (part.corner_count + 7) & ~7;
                    }
                }
            }
        }
    }
    if (static_cast<int64_t>(set.seen.size()) > first_cluster)
        end_segment(first_cluster, first_triangle);
    if (set.x.size() < static_cast<size_t>(corners)) {
        set.x.resize(static_cast<size_t>(corners));
        set.y.resize(static_cast<size_t>(corners));
        set.z.resize(static_cast<size_t>(corners));
    }
    if (projection.table != nullptr && set.places.size() < static_cast<size_t>(corners)) {
        set.places.resize(static_cast<size_t>(corners));
    }
    if (set.triangles.size() < static_cast<size_t>(most_triangles)) {
        set.triangles.resize(static_cast<size_t>(most_triangles));
    }
    if (projection.fine && set.part_of.size() < static_cast<size_t>(most_triangles)) {
        set.part_of.resize(static_cast<size_t>(most_triangles));
    }
    parallel_for(threads, static_cast<int64_t>(set.parts_seen.size()), 1,
                 [&](int64_t first, int64_t, int64_t) {
                     const int64_t place = set.parts_seen[static_cast<size_t>(first)];
                     const int64_t face = place / parts.count;
                     const Part& part = parts.parts[place % parts.count];
                     const int64_t at = set.corners_at[static_cast<size_t>(place)];
                     const int64_t frame = face * instances.count + part.instance;
                     float *x = set.x.data() + at, *y = set.y.data() + at, *z = set.z.data() + at;
                     transform_corners(
                         part, scratch.frames[static_cast<size_t>(frame)].eye_from_object, x, y, z);
                     if (projection.table != nullptr) {
                         place_corners(projection.table->faces[face], x, y, z, part.corner_count,
                                       set.places.data() + at);
                     }
                 });
    const int32_t band_rows = scratch.band_rows;
    const int32_t bands = (projection.height + band_rows - 1) / band_rows;
    Triangle drawn{};
    drawn.y0 = static_cast<int16_t>(projection.y0);
    drawn.y1 = static_cast<int16_t>(projection.y1);
    const RowRange reached = bands_of(drawn, projection.fine, bands, band_rows);
    const int32_t low = std::max(reached.first, 0), high = std::min(reached.last, bands - 1);
    const int32_t only = projection.y0 / (projection.fine ? 2 * band_rows : band_rows);
    parallel_for(threads, set.segment_count, 1, [&](int64_t first, int64_t, int64_t) {
        Segment& segment = set.segments[static_cast<size_t>(first)];
        ClusterRows rows;
        for (int64_t k = segment.first_cluster; k < segment.last_cluster; k++) {
            const SeenCluster& seen = set.seen[static_cast<size_t>(k)];
            const Part& part = parts.parts[seen.part];
            const int64_t at =
                set.corners_at[static_cast<size_t>(seen.face * parts.count + seen.part)];
            const int64_t number = segment.first_triangle + segment.triangle_count;
            Triangle* next = set.triangles.data() + number;
            const Projection& onto =
                part.instance + 1 == instances.clipped ? part_of_it : projection;
            const auto set_up =
                projection.drawn == Drawn::PERSPECTIVE ? set_cluster_up<Drawn::PERSPECTIVE>
                : projection.drawn == Drawn::PARALLEL  ? set_cluster_up<Drawn::PARALLEL>
                                                       : set_cluster_up<Drawn::SHADOW>;
            const int64_t made = set_up(seen, part, at, set, onto, rows, next);
            if (projection.fine) std::fill_n(set.part_of.begin() + number, made, seen.part);
            segment.triangle_count += made;
        }
        if (projection.listed) {
            put_into_band(segment, only);
        } else {
            sort_into_bands(segment, set.triangles.data(), projection.fine, bands, band_rows, low,
                            high);
        }
    });
}

RowRange rows_of_band(const Projection& projection, int32_t band, int32_t band_rows) {
    const int32_t first = band * band_rows;
    const int32_t end = std::min(first + band_rows, projection.height);
    if (!projection.fine) return {first, end - 1};
    return {2 * first, 2 * end};
}

void clear_band(const Projection& projection, int32_t band, int32_t band_rows, int64_t stride,
                uint32_t* visible, float* inverse_depth) {
    const RowRange rows = rows_of_band(projection, band, band_rows);
    const int64_t count = (rows.last - rows.first + 1) * stride;
    for (int64_t k = 0; k < count; k++) inverse_depth[k] = projection.least_inverse_depth;
    if (visible != nullptr) memset(visible, 0xff, static_cast<size_t>(count) * 4);
}

// Brings where the samples of some rows look into the cache. Reading is quicker than prefetching.
void read_places(const LensTable& lens, const RowRange& rows) {
    constexpr int64_t LINE = 16;  // numbers of a line of the cache
    for (const volatile float* places : {lens.x, lens.y}) {
        for (int64_t k = rows.first * lens.stride; k < (rows.last + 1) * lens.stride; k += LINE) {
            static_cast<void>(places[k]);
        }
    }
}

// Draws one triangle into rows of samples; see `draw_triangle`.
using Draw = void (*)(const Triangle&, uint32_t, const Part&, const Projection&, int32_t, int32_t,
                      int64_t, uint32_t*, float*);

Draw drawing_of(const Projection& projection, bool masked) {
    if (projection.table != nullptr) return draw_through_lens;
    if (projection.fine) return masked ? draw_triangle<true, true> : draw_triangle<false, true>;
    return masked ? draw_triangle<true, false> : draw_triangle<false, false>;
}

void draw_band(const TriangleSet& set, const DrawList& parts, const Projection& projection,
               int32_t band, int32_t band_rows, int64_t stride, uint32_t* visible,
               float* inverse_depth) {
    const RowRange rows = rows_of_band(projection, band, band_rows);
    const int64_t before = rows.first * stride;
    uint32_t* seen = visible == nullptr ? nullptr : visible - before;
    if (projection.table != nullptr) read_places(*projection.table, rows);
    const Draw plain = drawing_of(projection, false), masked = drawing_of(projection, true);
    for_triangles(set, band, [&](uint32_t number) {
        const Triangle& t = set.triangles[number];
        const Draw draw = t.masked ? masked : plain;
        draw(t, number, parts.parts[t.part], projection, rows.first, rows.last, stride, seen,
             inverse_depth - before);
    });
}

void draw_layers(const TriangleSet& set, const DrawList& parts, const Projection& projection,
                 int32_t band, int32_t band_rows, int64_t stride, const float* inverse_depth,
                 float* nearest, float* through, const float* of_parts) {
    const RowRange rows = rows_of_band(projection, band, band_rows);
    const int64_t before = rows.first * stride;
    const Draw draw = drawing_of(projection, false);
    for_triangles(set, band, [&](uint32_t number) {
        const Triangle& t = set.triangles[number];
        draw(t, number, parts.parts[t.part], projection, rows.first, rows.last, stride, nullptr,
             nearest - before);
        const float share = of_parts[t.part];
        const int32_t y0 = std::max<int32_t>(t.y0, rows.first);
        const int32_t y1 = std::min<int32_t>(t.y1, rows.last);
        for (int64_t row = y0; row <= y1; row++) {
            const int64_t first = (row - rows.first) * stride;
            // Fine samples are drawn from an even column on.
            for (int64_t x = t.x0 & ~1; x <= t.x1; x += 8) {
                const f8 opaque = load(inverse_depth + first + x);
                const f8 before_it = load(through + first + x);
                const i8 drawn = load(nearest + first + x) > opaque;
                store(through + first + x, drawn ? before_it * share : before_it);
                store(nearest + first + x, opaque);
            }
        }
    });
}

void draw_window(const TriangleSet& set, const DrawList& parts, const Projection& projection,
                 int64_t stride, float* inverse_depth) {
    // Of the pixel (0, 0), which need not lie in the window.
    float* origin = inverse_depth - projection.y0 * stride - projection.x0;
    for (int64_t s = 0; s < set.segment_count; s++) {
        const Segment& segment = set.segments[static_cast<size_t>(s)];
        for (int64_t k = 0; k < segment.triangle_count; k++) {
            const int64_t number = segment.first_triangle + k;
            const Triangle& t = set.triangles[static_cast<size_t>(number)];
            const Part& part = parts.parts[t.part];
            const auto draw = projection.table != nullptr ? draw_through_lens
                              : t.masked                  ? draw_triangle<true, false>
                                                          : draw_triangle<false, false>;
            draw(t, static_cast<uint32_t>(number), part, projection, projection.y0, projection.y1,
                 stride, nullptr, origin);
        }
    }
}

}  // namespace sailenv
