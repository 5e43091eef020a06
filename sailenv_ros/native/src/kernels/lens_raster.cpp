#include "lens_raster.h"

#include <algorithm>
#include <cmath>

#include "mask_test.h"

namespace sailenv {
namespace {

constexpr float LEAST_DEPTH_M = 1e-3f;  // corners nearer than that have no place on a face
constexpr float NEAR_CELLS = 1.0f, WIDE_CELLS = 4.0f;  // as far as `bend` and `wide_bend` are known
// Triangles whose bounds are wider or higher than that are drawn tile by tile.
constexpr int32_t WIDE_SAMPLES = 16, HIGH_SAMPLES = 8;

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

// Whether all corners lie beyond one side of the face's samples, before or behind the eye.
bool is_beyond_a_side(const CubeFace& face, const float (&corners)[3][3]) {
    for (int axis = 0; axis < 2; axis++) {
        bool low = true, high = true;
        for (const auto& corner : corners) {
            const double at = corner[axis], z = corner[2];
            const double margin = 1e-5 * (std::fabs(at) + std::fabs(z));
            low = low && at < face.low[axis] * z - margin;
            high = high && at > face.high[axis] * z + margin;
        }
        if (low || high) return true;
    }
    return false;
}

// A function a x + b y + c of a place. A copy: stores must not make it be loaded again.
struct PlaceFunction {
    float a, b, c;

    explicit PlaceFunction(const float* f) : a(f[0]), b(f[1]), c(f[2]) {}
    LANES_METHOD f8 at(f8 x, f8 y) const { return a * x + (b * y + c); }
};

// A function of an edge. Which bounds of tiles it is the most at is known once for all of them.
struct EdgeFunction : PlaceFunction {
    const float least;  // of samples inside
    const ptrdiff_t most_x, most_y, least_x, least_y;  // bounds, from the first one

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
    static constexpr ptrdiff_t LOW_X = 0, LOW_Y = LENS_GROUP_TILES, HIGH_X = 2 * LENS_GROUP_TILES,
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
          nearness(t.inverse_depth),
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
    const int32_t first = t.x0 / LENS_TILE_COLUMNS, last = t.x1 / LENS_TILE_COLUMNS;
    // What reaches one row of a tile alone is drawn with the tile above.
    const int32_t last_row = std::max(y0, y1 - 1) / LENS_TILE_ROWS;
    for (int32_t row = y0 / LENS_TILE_ROWS; row <= last_row; row++) {
        const LensTiles* groups = lens.tiles + row * lens.tile_groups;
        const int32_t top = std::max(y0, row * LENS_TILE_ROWS),
                      bottom = row == last_row ? y1 : (row + 1) * LENS_TILE_ROWS - 1;
        for (int32_t g = first / LENS_GROUP_TILES; g <= last / LENS_GROUP_TILES; g++) {
            const int32_t begin = g * LENS_GROUP_TILES;
            uint32_t tiles = drawing.reached(groups[g]);
            if (begin < first) tiles &= ~0u << (first - begin);
            if (begin + LENS_GROUP_TILES > last) tiles &= (2u << (last - begin)) - 1;
            if (tiles == 0) continue;
            const uint32_t covered = drawing.covered(groups[g]);
            for (; tiles != 0; tiles &= tiles - 1) {
                const int32_t k = __builtin_ctz(tiles), left = (begin + k) * LENS_TILE_COLUMNS;
                if (covered >> k & 1) {
                    drawing.template draw<true>(top, bottom, left, left);
                } else {
                    drawing.template draw<false>(top, bottom, left, left);
                }
            }
        }
    }
}

}  // namespace

void place_corners(const CubeFace& face, const float* x, const float* y, const float* z,
                   int32_t count, CornerPlace* out) {
    for (int32_t k = 0; k < count; k++) {
        CornerPlace& place = out[k];
        place = {__builtin_nanf(""), 0.0f, 0.0f, 0.0f, UNKNOWN_BEND, UNKNOWN_BEND};
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
        const auto mean = [&](float a, float b, float c, float d) {
            const float above = a + (b - a) * right, below = c + (d - c) * right;
            return above + (below - above) * low;
        };
        place.u = mean(upper[0].u, upper[1].u, lower[0].u, lower[1].u);
        place.v = mean(upper[0].v, upper[1].v, lower[0].v, lower[1].v);
        place.bend = upper->bend;
        place.wide_bend = upper->wide_bend;
    }
}

bool reach_through_lens(const CubeFace& face, const CornerPlace* const* places,
                        const float (&corners)[3][3], SampleBox& reach) {
    const CornerPlace &a = *places[0], &b = *places[1], &c = *places[2];
    const bool crosses = !(a.x == a.x && b.x == b.x && c.x == c.x);
    if (crosses) {
        if (is_beyond_a_side(face, corners)) return false;
        if (corners[0][2] <= LEAST_DEPTH_M && corners[1][2] <= LEAST_DEPTH_M &&
            corners[2][2] <= LEAST_DEPTH_M) {
            return false;
        }
        reach = face.all;
        return true;
    }
    const float margin = 1e-5f;
    const float low[2] = {std::min(a.x, std::min(b.x, c.x)) - margin,
                          std::min(a.y, std::min(b.y, c.y)) - margin};
    const float high[2] = {std::max(a.x, std::max(b.x, c.x)) + margin,
                           std::max(a.y, std::max(b.y, c.y)) + margin};
    for (int axis = 0; axis < 2; axis++) {
        if (high[axis] < face.low[axis] || low[axis] > face.high[axis]) return false;
    }
    const float cells =
        std::max((high[0] - low[0]) * face.per[0], (high[1] - low[1]) * face.per[1]);
    float bend = UNKNOWN_BEND;
    if (cells <= NEAR_CELLS) {
        bend = std::max(a.bend, std::max(b.bend, c.bend));
    } else if (cells <= WIDE_CELLS) {
        bend = std::max(a.wide_bend, std::max(b.wide_bend, c.wide_bend));
    }
    if (!(bend < UNKNOWN_BEND)) {
        reach = samples_within(face, low, high);
        return reach.x0 <= reach.x1;
    }
    // A place lies off the plane through the corners' places by at most a third of the square of
    // the longest side, and these by an eighth.
    const float off = bend * (0.4f * cells * cells + 0.15f) + 0.01f;
    const auto first = [&](float p, float q, float r, int16_t least) {
        const float at = std::ceil(std::min(p, std::min(q, r)) - off);
        return at > least ? static_cast<int16_t>(std::min(at, 32000.0f)) : least;
    };
    const auto last = [&](float p, float q, float r, int16_t most) {
        const float at = std::floor(std::max(p, std::max(q, r)) + off);
        return at < most ? static_cast<int16_t>(std::max(at, -1.0f)) : most;
    };
    reach.x0 = first(a.u, b.u, c.u, face.all.x0);
    reach.x1 = last(a.u, b.u, c.u, face.all.x1);
    if (reach.x0 > reach.x1) return false;
    reach.y0 = first(a.v, b.v, c.v, face.all.y0);
    reach.y1 = last(a.v, b.v, c.v, face.all.y1);
    return reach.y0 <= reach.y1;
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
