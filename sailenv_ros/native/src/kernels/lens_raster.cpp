#include "lens_raster.h"

#include <algorithm>
#include <cmath>

#include "mask_test.h"

namespace sailenv {
namespace {

constexpr float LEAST_DEPTH_M = 1e-3f;  // corners nearer than that have no place on a face
constexpr float PLACE_MARGIN = 1e-5f;   // around the corners' places
constexpr double CLIP_MARGIN = 1e-4;    // the same, of triangles that come near the eye's plane
constexpr float NEAR_CELLS = 1.0f, WIDE_CELLS = 4.0f;  // as far as `bend` and `wide_bend` are known
// Of tiles of a group, those of the first column.
constexpr uint32_t FIRST_COLUMN = ((1u << LENS_GROUP_TILES) - 1) / ((1u << LENS_GROUP_COLUMNS) - 1);
// Triangles whose bounds are wider or higher than that are drawn tile by tile.
constexpr int32_t WIDE_SAMPLES = 24, HIGH_SAMPLES = 8;

// Bits `first` to `last` of so many; beyond both ends there are none.
uint32_t bits_between(int32_t first, int32_t last, int32_t count) {
    const uint32_t all = (1u << count) - 1;
    return (first > 0 ? all << first : all) & (last + 1 < count ? (1u << (last + 1)) - 1 : all);
}

void include(SampleBox& box, const SampleBox& other) {
    box.x0 = std::min(box.x0, other.x0);
    box.y0 = std::min(box.y0, other.y0);
    box.x1 = std::max(box.x1, other.x1);
    box.y1 = std::max(box.y1, other.y1);
}

int32_t cell_of(float place) {
    return place > 0.0f ? static_cast<int32_t>(std::min(place, FACE_CELLS - 1.0f)) : 0;
}

// The samples in all cells that a rectangle of a face touches.
SampleBox samples_within(const CubeFace& face, const float* low, const float* high) {
    const int32_t x0 = cell_of((low[0] - face.origin[0]) * face.per[0]),
                  x1 = cell_of((high[0] - face.origin[0]) * face.per[0]),
                  y0 = cell_of((low[1] - face.origin[1]) * face.per[1]),
                  y1 = cell_of((high[1] - face.origin[1]) * face.per[1]);
    SampleBox box = {INT16_MAX, INT16_MAX, -1, -1};
    const bool many = x1 - x0 >= BLOCK_CELLS || y1 - y0 >= BLOCK_CELLS;
    const int32_t size = many ? BLOCK_CELLS : 1, row = FACE_CELLS / size;
    const SampleBox* boxes = many ? face.blocks : face.cells;
    for (int32_t y = y0 / size; y <= y1 / size; y++) {
        for (int32_t x = x0 / size; x <= x1 / size; x++) include(box, boxes[y * row + x]);
    }
    return box;
}

// The rectangle of a face's places that a triangle reaches which comes near the eye's plane; false
// if it reaches none. The triangle is clipped side by side (Sutherland and Hodgman).
bool clip_to_face(const CubeFace& face, const ClusterRows& r, int32_t k, float* low, float* high) {
    struct Corner {
        double at[3];
    };
    constexpr int32_t MOST = 7;  // corners, but for rounding
    Corner polygon[MOST], clipped[MOST + 2];
    int32_t count = 3;
    for (int32_t j = 0; j < 9; j++) polygon[j / 3].at[j % 3] = r.corner[j][k];
    for (int32_t side = 0; side < 4; side++) {
        const int32_t axis = side / 2;
        const double sign = side % 2 ? -1.0 : 1.0;
        const double limit =
            side % 2 ? face.high[axis] + CLIP_MARGIN : face.low[axis] - CLIP_MARGIN;
        const auto inside = [&](const Corner& c) { return sign * (c.at[axis] - limit * c.at[2]); };
        int32_t kept = 0;
        for (int32_t j = 0; j < count && kept <= MOST; j++) {
            const Corner &from = polygon[j], &to = polygon[(j + 1) % count];
            const double here = inside(from), there = inside(to);
            if (here >= 0.0) clipped[kept++] = from;
            if ((here >= 0.0) == (there >= 0.0)) continue;
            Corner& border = clipped[kept++];
            for (int i = 0; i < 3; i++) {
                border.at[i] = from.at[i] + (to.at[i] - from.at[i]) * (here / (here - there));
            }
        }
        if (kept > MOST) {
            for (int j = 0; j < 2; j++) {
                low[j] = static_cast<float>(face.low[j]);
                high[j] = static_cast<float>(face.high[j]);
            }
            return true;
        }
        count = kept;
        std::copy(clipped, clipped + count, polygon);
    }
    for (int32_t axis = 0; axis < 2; axis++) {
        double least = face.high[axis], most = face.low[axis];
        for (int32_t j = 0; j < count; j++) {
            const double z = polygon[j].at[2];
            // A triangle through the eye itself.
            const bool known = z > 1e-9;
            least = known ? std::min(least, polygon[j].at[axis] / z) : face.low[axis];
            most = known ? std::max(most, polygon[j].at[axis] / z) : face.high[axis];
            if (!known) break;
        }
        low[axis] = static_cast<float>(std::max(least - CLIP_MARGIN, face.low[axis]));
        high[axis] = static_cast<float>(std::min(most + CLIP_MARGIN, face.high[axis]));
    }
    return count > 0;
}

// Which of eight triangles show their fronts, by the determinant of `set_edges_up` to the bit.
LANES_INLINE i8 shows_front(const ClusterRows& r, int32_t k) {
    i8 found;
    for (int32_t half = 0; half < 8; half += 4) {
        d4 at[9];
        for (int j = 0; j < 9; j++) at[j] = load_double(r.corner[j] + k + half);
        const d4 det = at[0] * (at[4] * at[8] - at[5] * at[7]) +
                       at[1] * (at[5] * at[6] - at[3] * at[8]) +
                       at[2] * (at[3] * at[7] - at[4] * at[6]);
        const l4 front = det < 0.0;
        for (int j = 0; j < 4; j++) found[half + j] = static_cast<int32_t>(front[j]);
    }
    return found;
}

// Of eight corners.
struct EightPlaces {
    f8 x, y, u, v, bend, wide_bend;

    LANES_METHOD explicit EightPlaces(const CornerPlace* const* places) {
        f8 rows[8];
        for (int j = 0; j < 8; j++) rows[j] = load(&places[j]->x);
        transpose(rows);
        x = rows[0];
        y = rows[1];
        u = rows[2];
        v = rows[3];
        bend = rows[4];
        wide_bend = rows[5];
    }
};

// Not greater, and not less, as a float.
float down(double x) { return std::nextafter(static_cast<float>(x), -1e30f); }
float up(double x) { return std::nextafter(static_cast<float>(x), 1e30f); }

// A function a x + b y + c of a place. A copy: stores must not make it be loaded again.
struct PlaceFunction {
    float a, b, c;

    explicit PlaceFunction(const float* f, float share = 1.0f)
        : a(f[0] * share), b(f[1] * share), c(f[2] * share) {}
    LANES_METHOD f8 at(f8 x, f8 y) const { return a * x + (b * y + c); }
};

// A function of an edge. Which bounds of tiles it is the most at is known once for all of them.
struct EdgeFunction : PlaceFunction {
    const float least;                               // of samples inside
    const int64_t most_x, most_y, least_x, least_y;  // bounds, from the first one

    explicit EdgeFunction(const float* edge)
        : PlaceFunction(edge),
          least(least_inside(edge)),
          most_x(a > 0.0f ? HIGH_X : LOW_X),
          most_y(b > 0.0f ? HIGH_Y : LOW_Y),
          least_x(HIGH_X + LOW_X - most_x),
          least_y(HIGH_Y + LOW_Y - most_y) {}
    // Which samples lie inside; tiles of which none does, and of which all do, as these compute it.
    LANES_METHOD i8 holds(f8 x, f8 y) const { return at(x, y) >= least; }
    LANES_METHOD i8 misses(const float* bounds) const {
        return a * load(bounds + most_x) + (b * load(bounds + most_y) + c) < least;
    }
    LANES_METHOD i8 covers(const float* bounds) const {
        return a * load(bounds + least_x) + (b * load(bounds + least_y) + c) >= least;
    }

private:
    static constexpr int64_t LOW_X = 0, LOW_Y = LENS_GROUP_TILES, HIGH_X = 2 * LENS_GROUP_TILES,
                             HIGH_Y = 3 * LENS_GROUP_TILES;
};

// A triangle and where it is drawn.
template <bool MASKED, bool SEVERAL>
struct LensDrawing {
    const Triangle& t;
    const LensTable& lens;
    const Part& part;
    const EdgeFunction edge0, edge1, edge2;
    const PlaceFunction nearness;
    const float greatest;
    const int32_t face;
    const i8 tag;
    const int64_t stride;
    int32_t* visible;  // or null
    float* inverse_depth;
    MaskedTriangle masked;

    LensDrawing(const Triangle& triangle, uint32_t number, const Part& of, const Projection& p,
                int64_t row_stride, uint32_t* seen, float* depths)
        : t(triangle),
          lens(*p.table),
          part(of),
          edge0(t.edge),
          edge1(t.edge + 3),
          edge2(t.edge + 6),
          nearness(t.inverse_depth, seen == nullptr ? 1.0f : nearness_share(t, false)),
          greatest(p.greatest_inverse_depth),
          face(t.face),
          tag(splat(static_cast<int32_t>(number))),
          stride(row_stride),
          visible(reinterpret_cast<int32_t*>(seen)),
          inverse_depth(depths) {
        if (MASKED) masked = masked_triangle(t, part, false);
    }

    // Draws a rectangle of samples; `WITHIN` if they all lie within the edges.
    template <bool WITHIN>
    LANES_METHOD void draw(int32_t top, int32_t bottom, int32_t left, int32_t right) const {
        // Copies, for the same reason.
        const float *xs = lens.x + top * lens.stride, *ys = lens.y + top * lens.stride;
        const uint8_t* faces = lens.face + top * lens.stride;
        float* near_row = inverse_depth + top * stride;
        int32_t* seen = visible == nullptr ? nullptr : visible + top * stride;
        const int64_t lens_step = lens.stride, step = stride;
        for (int32_t row = top; row <= bottom; row++) {
            for (int32_t x = left; x <= right; x += 8) {
                const f8 at = load(xs + x), down = load(ys + x), before = load(near_row + x);
                const f8 n = nearness.at(at, down);
                i8 drawn = (n > before) & (n <= greatest);
                if (!WITHIN) {
                    drawn &= edge0.holds(at, down) & edge1.holds(at, down) & edge2.holds(at, down);
                    if (SEVERAL) drawn &= lies_on(faces + x, face);
                }
                // A branch here would be foreseen too seldom to be worth it.
                if (MASKED && !any(drawn)) continue;
                if (MASKED) {
                    drawn = opaque_pixels(masked, part, at, down, steps_at(lens, row, x), n, drawn);
                }
                store(near_row + x, drawn ? n : before);
                if (seen != nullptr) store(seen + x, drawn ? tag : load(seen + x));
            }
            xs += lens_step;
            ys += lens_step;
            faces += lens_step;
            near_row += step;
            if (seen != nullptr) seen += step;
        }
    }

    // A bit for each tile of which samples may lie in the triangle.
    LANES_METHOD uint32_t reached(const LensTiles& tiles) const {
        const i8 here = (load(tiles.faces) & (1 << face)) != 0;
        const float* bounds = tiles.low_x;
        return lane_bits(here &
                         ~(edge0.misses(bounds) | edge1.misses(bounds) | edge2.misses(bounds)));
    }

    // A bit for each tile all of whose samples do.
    LANES_METHOD uint32_t covered(const LensTiles& tiles) const {
        const float* bounds = tiles.low_x;
        return lane_bits(edge0.covers(bounds) & edge1.covers(bounds) & edge2.covers(bounds));
    }
};

template <bool MASKED, bool SEVERAL>
void draw_tiles(const Triangle& t, uint32_t number, const Part& part, const Projection& p,
                int32_t y0, int32_t y1, int64_t stride, uint32_t* visible, float* inverse_depth) {
    const LensDrawing<MASKED, SEVERAL> drawing(t, number, part, p, stride, visible, inverse_depth);
    if (t.x1 - t.x0 < WIDE_SAMPLES && y1 - y0 < HIGH_SAMPLES) {
        drawing.template draw<false>(y0, y1, t.x0, t.x1);
        return;
    }
    const LensTable& lens = *p.table;
    // What reaches one row of a tile alone is drawn with the tile above.
    const int32_t first_row = y0 / LENS_TILE_ROWS, last_row = std::max(y0, y1 - 1) / LENS_TILE_ROWS;
    const int32_t first = t.x0 / LENS_TILE_COLUMNS, last = t.x1 / LENS_TILE_COLUMNS;
    for (int32_t down = first_row / LENS_GROUP_ROWS; down <= last_row / LENS_GROUP_ROWS; down++) {
        const LensTiles* groups = lens.tiles + down * lens.tile_groups;
        const int32_t tile_row = down * LENS_GROUP_ROWS;
        const uint32_t rows =
            bits_between((first_row - tile_row) * LENS_GROUP_COLUMNS,
                         (last_row + 1 - tile_row) * LENS_GROUP_COLUMNS - 1, LENS_GROUP_TILES);
        for (int32_t across = first / LENS_GROUP_COLUMNS; across <= last / LENS_GROUP_COLUMNS;
             across++) {
            uint32_t tiles = drawing.reached(groups[across]);
            if (tiles == 0) continue;
            const int32_t column = across * LENS_GROUP_COLUMNS;
            tiles &= rows &
                     bits_between(first - column, last - column, LENS_GROUP_COLUMNS) * FIRST_COLUMN;
            const uint32_t covered = drawing.covered(groups[across]);
            for (; tiles != 0; tiles &= tiles - 1) {
                const int32_t k = __builtin_ctz(tiles), row = tile_row + k / LENS_GROUP_COLUMNS,
                              left = (column + k % LENS_GROUP_COLUMNS) * LENS_TILE_COLUMNS,
                              top = std::max(y0, row * LENS_TILE_ROWS),
                              bottom = row == last_row ? y1 : (row + 1) * LENS_TILE_ROWS - 1;
                if (covered >> k & 1) {
                    drawing.template draw<true>(top, bottom, left, left);
                } else {
                    drawing.template draw<false>(top, bottom, left, left);
                }
            }
        }
    }
}

LANES_INLINE f4 four(const FaceNode* node) { return *reinterpret_cast<const f4_any*>(node); }

}  // namespace

void place_corners(const CubeFace& face, const float* x, const float* y, const float* z,
                   int32_t count, CornerPlace* out) {
    for (int32_t k = 0; k < count; k++) {
        CornerPlace& place = out[k];
        place = {__builtin_nanf(""), 0.0f, 0.0f, 0.0f, UNKNOWN_BEND, UNKNOWN_BEND, {}};
        if (!(z[k] >= LEAST_DEPTH_M)) continue;
        const float per = 1.0f / z[k];
        place.x = x[k] * per;
        place.y = y[k] * per;
        const float across = (place.x - face.origin[0]) * face.per[0],
                    down = (place.y - face.origin[1]) * face.per[1];
        if (!(across >= 0.0f && across <= FACE_CELLS && down >= 0.0f && down <= FACE_CELLS)) {
            continue;
        }
        const int32_t i = cell_of(across), j = cell_of(down);
        const FaceNode *upper = face.nodes + j * (FACE_CELLS + 1) + i,
                       *lower = upper + FACE_CELLS + 1;
        const float right = across - static_cast<float>(i), low = down - static_cast<float>(j);
        const f4 above = four(upper) + (four(upper + 1) - four(upper)) * right,
                 below = four(lower) + (four(lower + 1) - four(lower)) * right,
                 mean = above + (below - above) * low;
        place.u = mean[0];
        place.v = mean[1];
        place.bend = upper->bend;
        place.wide_bend = upper->wide_bend;
    }
}

void set_lens_bounds(ClusterRows& r, int32_t count, const Projection& p, const CubeFace& face,
                     bool front, bool back) {
    for (int32_t k = 0; k < count; k += 8) {
        const EightPlaces a(r.place[0] + k), b(r.place[1] + k), c(r.place[2] + k);
        i8 drawn = splat(front ? -1 : 0);
        if (front != back) drawn = front ? shows_front(r, k) : ~shows_front(r, k);
        const f8 low_x = min8(a.x, min8(b.x, c.x)) - PLACE_MARGIN,
                 low_y = min8(a.y, min8(b.y, c.y)) - PLACE_MARGIN,
                 high_x = max8(a.x, max8(b.x, c.x)) + PLACE_MARGIN,
                 high_y = max8(a.y, max8(b.y, c.y)) + PLACE_MARGIN;
        const i8 crosses = ~((a.x == a.x) & (b.x == b.x) & (c.x == c.x));
        const i8 beyond = (high_x < down(face.low[0])) | (high_y < down(face.low[1])) |
                          (low_x > up(face.high[0])) | (low_y > up(face.high[1]));
        drawn &= crosses | ~beyond;
        const f8 cells = max8((high_x - low_x) * face.per[0], (high_y - low_y) * face.per[1]);
        const f8 near_bend = max8(a.bend, max8(b.bend, c.bend)),
                 wide_bend = max8(a.wide_bend, max8(b.wide_bend, c.wide_bend));
        const f8 bend = cells <= NEAR_CELLS   ? near_bend
                        : cells <= WIDE_CELLS ? wide_bend
                                              : splat(UNKNOWN_BEND);
        // A place lies off the plane through the corners' places by at most a third of the square
        // of the longest side, and these by an eighth.
        const f8 off = bend * (0.4f * cells * cells + 0.15f) + 0.01f;
        // Shifted samples lie behind what their numbers tell.
        const f8 before = off + (p.fine ? 2.0f * SAMPLE_SHIFT : 0.0f);
        const f8 left = min8(a.u, min8(b.u, c.u)) - before, right = max8(a.u, max8(b.u, c.u)) + off,
                 top = min8(a.v, min8(b.v, c.v)) - before, bottom = max8(a.v, max8(b.v, c.v)) + off;
        const auto within = [](int32_t first, int32_t other) {
            return static_cast<float>(std::max(first, other));
        };
        const float x0 = within(face.all.x0, p.x0), y0 = within(face.all.y0, p.y0),
                    x1 = -within(-face.all.x1, -p.x1), y1 = -within(-face.all.y1, -p.y1);
        // Rounded inwards to samples: upwards is the negative floor of the negative.
        store(r.x0 + k, drawn ? -floor8(-clamp8(left, x0, 1e5f)) : splat(1.0f));
        store(r.x1 + k, drawn ? floor8(clamp8(right, -1.0f, x1)) : splat(0.0f));
        store(r.y0 + k, -floor8(-clamp8(top, y0, 1e5f)));
        store(r.y1 + k, floor8(clamp8(bottom, -1.0f, y1)));
        const i8 unknown = crosses | ~(bend < UNKNOWN_BEND);
        for (uint32_t rest = lane_bits(drawn & unknown); rest != 0; rest &= rest - 1) {
            const int32_t lane = k + __builtin_ctz(rest);
            float low[2] = {low_x[lane - k], low_y[lane - k]},
                  high[2] = {high_x[lane - k], high_y[lane - k]};
            const bool reaches = crosses[lane - k] == 0 || clip_to_face(face, r, lane, low, high);
            const SampleBox box = reaches ? samples_within(face, low, high) : SampleBox{1, 1, 0, 0};
            r.x0[lane] = within(box.x0, p.x0);
            r.y0[lane] = within(box.y0, p.y0);
            r.x1[lane] = -within(-box.x1, -p.x1);
            r.y1[lane] = -within(-box.y1, -p.y1);
        }
    }
}

void draw_through_lens(const Triangle& t, uint32_t number, const Part& part, const Projection& p,
                       int32_t first_row, int32_t last_row, int64_t stride, uint32_t* visible,
                       float* inverse_depth) {
    const int32_t y0 = std::max<int32_t>(t.y0, first_row), y1 = std::min<int32_t>(t.y1, last_row);
    const bool several = p.table->several != 0;
    const auto draw = t.masked  ? several ? draw_tiles<true, true> : draw_tiles<true, false>
                      : several ? draw_tiles<false, true>
                                : draw_tiles<false, false>;
    draw(t, number, part, p, y0, y1, stride, visible, inverse_depth);
}

}  // namespace sailenv
