// From parts to triangles in bands of a picture, and from those to the surface that each pixel
// sees.
#pragma once

#include <cstdint>
#include <vector>

#include "lanes.h"
#include "lens.h"
#include "lens_table.h"
#include "render_types.h"

namespace sailenv {

// A triangle on the screen. `edge` holds a, b, c of three functions a x + b y + c of the pixel
// (integers are pixel centres): each is 0 on the edge opposite to its corner, positive inside, and
// together with `inverse_det` they are the corners' weights over depth; where rays are parallel the
// weights. `inverse_depth` is such a function too, the greater the nearer: 1 / depth in
// perspective, -depth where rays are parallel, 1 - depth in a shadow map. `x0` to `y1` are the
// first and last samples that it can cover.
struct Triangle {
    float edge[9];
    float inverse_depth[3];
    float inverse_det;
    int32_t vertex[3];
    int32_t part;
    int8_t back;     // 1: its back is seen
    int8_t face;     // of the cube, where the lens has a table; else 0
    int16_t masked;  // 1: its texture has holes
    int16_t x0, x1, y0, y1;
};

constexpr uint32_t NOTHING = 0xffffffffu;

// Numbers behind the last of a row, so that eight may be read and written at any column.
constexpr int64_t ROW_PADDING = 8;

// An edge belongs to one of the two triangles that share it: the one that lies to its right, or
// below it if it runs along a row. A function that is not of this triangle must be above 0.
LANES_INLINE float least_inside(const float* edge) {
    const bool own = edge[0] > 0.0f || (edge[0] == 0.0f && edge[1] > 0.0f);
    return own ? 0.0f : 1.1754944e-38f;
}

// Fine samples of even rows lie so far beside their columns, those of even columns so far below
// their rows [pixels]: so a pixel has them in four rows and four columns, which are a quarter of it
// apart, and narrow things along an axis are not broken into dashes.
constexpr float SAMPLE_SHIFT = 0.25f;

// How much of a triangle's nearness counts where surfaces lie in one another: of two sheets back to
// back the one that faces the eye is seen, as by rays (`meet_shape`). A few bits more than
// rounding.
LANES_INLINE float nearness_share(const Triangle& t, bool parallel) {
    constexpr float FARTHER = 4e-6f;
    if (t.back != 1 || t.masked != 0) return 1.0f;
    return parallel ? 1.0f + FARTHER : 1.0f - FARTHER;
}

// What a frame knows of an instance.
struct InstanceFrame {
    double eye_from_object[12];  // rows; in a shadow map: pixel, pixel, depth
    double sides[16];            // four planes around the picture, in the object's frame
    double eye[3];               // in the object's frame
    alignas(32) float normal_columns[3][8];  // world normal from object normal; beyond are 0
};

// What samples are drawn of: a picture in perspective, one of parallel rays, or a shadow map.
enum class Drawn : int32_t { PERSPECTIVE, PARALLEL, SHADOW };

// Onto the picture's pixels, in which triangles have straight edges; or onto the faces of a cube,
// in which they have, for a lens that bends lines.
struct Projection {
    Drawn drawn;
    Lens lens;               // 1, 1, 0, 0 in a shadow map and on a face
    const LensTable* table;  // of a lens that bends lines; else null
    int32_t width, height;   // pixels
    int32_t x0, y0, x1, y1;  // first and last samples that are drawn; may lie beside the picture
    // Samples are the centres of pixels. Fine ones are half a pixel apart: sample k lies at pixel
    // (k - 1) / 2, so there are 2 n + 1 to n pixels, and those of odd numbers are centres. Others
    // are shifted, see SAMPLE_SHIFT.
    bool fine;
    bool listed;                // parts hold what may be seen alone, and one band is drawn
    float least_inverse_depth;  // what is not nearer is not drawn
    float greatest_inverse_depth;
};
Projection projection_of(const View& view);

enum Facing : int32_t { FACING_BOTH = 0, FACING_FRONT = 1, FACING_BACK = 2 };

struct SeenCluster {
    int32_t part, cluster;
    Facing facing;
    int32_t face;
};

// Where a corner lies on a face and in the picture; see lens_raster.h.
struct CornerPlace {
    float x, y, u, v, bend, wide_bend, unused[2];  // eight numbers, to be loaded at once
};

// Some of the triangles, in their order, and which of them reach into which band.
struct Segment {
    int64_t first_cluster, last_cluster;
    int64_t first_triangle, triangle_count;
    std::vector<uint32_t> starts, entries;
};

struct TriangleSet {
    std::vector<SeenCluster> seen;
    std::vector<Segment> segments;
    int64_t segment_count = 0;
    std::vector<Triangle> triangles;
    std::vector<int32_t> part_of;  // of each triangle, where samples are fine
    // Of each part, face after face, in x, y, z; -1 where it is not seen.
    std::vector<int64_t> corners_at;
    std::vector<int64_t> parts_seen;  // numbers in `corners_at`
    std::vector<float> x, y, z;       // corners as the eye has them
    std::vector<CornerPlace> places;  // where the lens has a table
};

// Memory that is used again from frame to frame.
struct Scratch {
    std::vector<InstanceFrame> frames;  // face after face
    TriangleSet opaque, glass;
    std::vector<uint32_t> visible;  // number of the triangle that each pixel sees
    std::vector<float> inverse_depth;
    int64_t stride = 0;  // numbers from row to row, of both
    int32_t band_rows = 16;
    std::vector<int32_t> order;
    std::vector<double> distance;
};

void set_frames(Scratch& scratch, const Instances& instances, const double* eye_from_world,
                const Projection& projection);

// Makes the triangles that may be seen of some parts. `orders` lists numbers of parts in the order
// in which they are wanted; in pictures with `back_first`, each two-sided part is listed twice:
// its back and then its front.
void make_triangles(int64_t threads, const Scratch& scratch, const DrawList& parts,
                    const Instances& instances, const Projection& projection, const int32_t* order,
                    int64_t order_count, bool back_first, TriangleSet& set);

// The rows of samples of a band; neighbouring bands share a row of fine ones.
struct RowRange {
    int32_t first, last;
};
RowRange rows_of_band(const Projection& projection, int32_t band, int32_t band_rows);

// A table's triangles lie on several faces.
inline int32_t faces_of(const Projection& p) { return p.table == nullptr ? 1 : CUBE_FACES; }

// Calls use(number) for all triangles of a band, in their order.
template <class Use>
void for_triangles(const TriangleSet& set, int32_t band, const Use& use) {
    for (int64_t s = 0; s < set.segment_count; s++) {
        const Segment& segment = set.segments[static_cast<size_t>(s)];
        const uint32_t begin = segment.starts[static_cast<size_t>(band)];
        const uint32_t end = segment.starts[static_cast<size_t>(band) + 1];
        const uint32_t* entries = segment.entries.data();
        for (uint32_t k = begin; k < end; k++) {
            const char* ahead = reinterpret_cast<const char*>(
                set.triangles.data() + entries[k + 8 < end ? k + 8 : end - 1]);
            __builtin_prefetch(ahead);
            __builtin_prefetch(ahead + 64);
            use(entries[k]);
        }
    }
}

// Draws one band: `visible` (may be null) and `inverse_depth` begin at the band's first sample.
void draw_band(const TriangleSet& set, const DrawList& parts, const Projection& projection,
               int32_t band, int32_t band_rows, int64_t stride, uint32_t* visible,
               float* inverse_depth);

// Multiplies `through`, of each sample of a band, by `of_parts` for each triangle before what is
// opaque there. `nearest` begins and ends as a copy of `inverse_depth`.
void draw_layers(const TriangleSet& set, const DrawList& parts, const Projection& projection,
                 int32_t band, int32_t band_rows, int64_t stride, const float* inverse_depth,
                 float* nearest, float* through, const float* of_parts);

// Draws all triangles of a set into the window of a projection, whose first pixel is the first
// number of `inverse_depth`. Rows of the window are followed by room for eight numbers.
void draw_window(const TriangleSet& set, const DrawList& parts, const Projection& projection,
                 int64_t stride, float* inverse_depth);

// Makes that every sample of a band sees nothing.
void clear_band(const Projection& projection, int32_t band, int32_t band_rows, int64_t stride,
                uint32_t* visible, float* inverse_depth);

}  // namespace sailenv
