// Where the samples of a picture look through a lens that bends straight lines.
//
// Rays are places (x, y) on faces of a cube around the eye: a face sees the points z (x, y, 1) of a
// frame of its own. On a face straight lines are straight, so triangles have there the edge
// functions that they have in the picture of a pin-hole; only the samples lie where the lens says.
// The tables mirror those of native/lens_tables.py and are made by render/cpu/cube_faces.py.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "lanes.h"
#include "vec3.h"

namespace sailenv {

constexpr int32_t CUBE_FACES = 6;
constexpr int32_t FACE_CELLS = 128;                           // of a face, along each side
constexpr int32_t BLOCK_CELLS = 8;                            // of a block of them, along each side
constexpr int32_t LENS_TILE_COLUMNS = 8, LENS_TILE_ROWS = 8;  // of samples
constexpr int32_t LENS_GROUP_COLUMNS = 2, LENS_GROUP_ROWS = 4;  // of a group of tiles
constexpr int32_t LENS_GROUP_TILES = LENS_GROUP_COLUMNS * LENS_GROUP_ROWS;
constexpr int32_t NO_FACE = -1;  // where the lens sees nothing
constexpr float UNKNOWN_BEND = 1e30f;

// Where a place of a face lies in the picture, at the nodes of a grid of cells [samples]. Within a
// cell and the next one on each side a straight line bends by at most `bend` over the length of a
// cell, within the next four by `wide_bend`; both are unknown where the lens does not map.
struct FaceNode {
    float u, v, bend, wide_bend;
};

// First column, first row, last column, last row; the first are greater where there is none.
struct SampleBox {
    int16_t x0, y0, x1, y1;
};

struct CubeFace {
    double turn[9];           // the face's frame from the camera's, by rows
    double low[2], high[2];   // least and greatest x and y of its samples
    float origin[2], per[2];  // node = (place - origin) * per
    const FaceNode* nodes;    // (FACE_CELLS + 1, FACE_CELLS + 1)
    const SampleBox* cells;   // (FACE_CELLS, FACE_CELLS): the samples that lie in each
    const SampleBox* blocks;  // (FACE_CELLS / BLOCK_CELLS, ...)
    SampleBox all;            // samples of the face; none where the face is not used
};

// A group of tiles: which faces their samples and those of the next row lie on, and the places'
// bounds if that is one. (Bands of fine samples end with the first row of the next tile.)
struct LensTiles {
    float low_x[LENS_GROUP_TILES], low_y[LENS_GROUP_TILES];
    float high_x[LENS_GROUP_TILES], high_y[LENS_GROUP_TILES];
    int32_t faces[LENS_GROUP_TILES];  // a bit for each
};

struct LensTable {
    const float *x, *y;      // (rows, stride): NaN where the lens sees nothing, and beyond the row
    const uint8_t* face;     // (rows, stride)
    const float* steps;      // (H, step_stride / 8, 4, 8), from pixel to pixel; see LensSteps
    const LensTiles* tiles;  // (rows of groups, tile_groups)
    const CubeFace* faces;   // (CUBE_FACES,)
    int64_t stride, tile_groups;
    int64_t rows, columns;  // samples
    int64_t step_stride, step_rows;
    int64_t several;  // 1: samples lie on several faces
    int64_t fine;     // 1: samples lie half a pixel apart
};

LANES_INLINE bool is_used(const CubeFace& face) { return face.all.x0 <= face.all.x1; }

// The faces of eight samples, and which of them lie on one.
LANES_INLINE i8 faces_at(const uint8_t* faces) {
    typedef uint8_t b8 __attribute__((vector_size(8)));
    b8 numbers;
    memcpy(&numbers, faces, 8);
    return __builtin_convertvector(numbers, i8);
}
LANES_INLINE i8 lies_on(const uint8_t* faces, int32_t face) { return faces_at(faces) == face; }

// How places change from pixel to pixel, at one pixel and at eight samples of a row.
struct PixelStep {
    float x_right, y_right, x_down, y_down;
};
struct LensSteps {
    f8 x_right, y_right, x_down, y_down;
};
// The numbers of a pixel are eight from each other, and those of eight pixels side by side.
LANES_INLINE const float* first_step(const LensTable& lens, int64_t row, int64_t x) {
    return lens.steps + 4 * (row * lens.step_stride + x / 8 * 8) + x % 8;
}
LANES_INLINE PixelStep step_at(const LensTable& lens, int32_t row, int32_t x) {
    const float* p = first_step(lens, row, x);
    return {p[0], p[8], p[16], p[24]};
}
LANES_INLINE LensSteps steps_at(const LensTable& lens, int32_t row, int32_t x) {
    if (!lens.fine && x % 8 == 0) {
        const float* p = first_step(lens, row, x);
        return {load(p), load(p + 8), load(p + 16), load(p + 24)};
    }
    // Of the pixels that fine samples lie in, or right beside.
    const auto pixel = [&lens](int32_t sample) {
        return !lens.fine ? sample : sample > 0 ? (sample - 1) / 2 : 0;
    };
    const int32_t last = static_cast<int32_t>(lens.step_rows - 1), v = std::min(pixel(row), last);
    if (x % 8 == 0) {
        // Five pixels, of which four are of one block.
        const float *before = first_step(lens, v, pixel(x)), *p = first_step(lens, v, x / 2);
        const auto steps = [&](int j) {
            const f8 four = two_fours(p + 8 * j, p + 8 * j);
            return SHUFFLE(four, splat(before[8 * j]), 8, 0, 0, 1, 1, 2, 2, 3);
        };
        return {steps(0), steps(1), steps(2), steps(3)};
    }
    alignas(32) float found[4][8];
    for (int32_t k = 0; k < 8; k++) {
        const float* p = first_step(lens, v, pixel(x + k));
        for (int j = 0; j < 4; j++) found[j][k] = p[8 * j];
    }
    return {load(found[0]), load(found[1]), load(found[2]), load(found[3])};
}

// Where samples lie a pixel apart along the axes of a face: in the picture of a pin-hole.
struct PixelSteps {};

// The change of a linear function with slopes a and b from pixel to pixel.
LANES_INLINE f8 to_right(const PixelSteps&, f8 a, f8) { return a; }
LANES_INLINE f8 downwards(const PixelSteps&, f8, f8 b) { return b; }
LANES_INLINE f8 to_right(const LensSteps& s, f8 a, f8 b) { return a * s.x_right + b * s.y_right; }
LANES_INLINE f8 downwards(const LensSteps& s, f8 a, f8 b) { return a * s.x_down + b * s.y_down; }

// Distance along the ray over depth on the face.
LANES_INLINE f8 stretch(f8 x, f8 y) { return sqrt8(x * x + y * y + 1.0f); }
LANES_INLINE float stretch(float x, float y) { return __builtin_sqrtf(x * x + y * y + 1.0f); }

}  // namespace sailenv
