// The rasteriser through a lens that bends straight lines: which samples a triangle of a face can
// reach, and which of them see it.
#pragma once

#include "cluster_rows.h"
#include "lens_table.h"
#include "raster.h"

namespace sailenv {

// Where corners lie on a face and in the picture [samples]. NaN behind the face.
void place_corners(const CubeFace& face, const float* x, const float* y, const float* z,
                   int32_t count, CornerPlace* out);

// Which samples triangles can reach: their bounds; x0 > x1 if there are none, as of those whose
// side that is seen is not drawn. `count` is a multiple of eight.
void set_lens_bounds(ClusterRows& r, int32_t count, const Projection& p, const CubeFace& face,
                     bool front, bool back);

// Draws the samples of some rows; see `draw_triangle`.
void draw_through_lens(const Triangle& t, uint32_t number, const Part& part, const Projection& p,
                       int32_t first_row, int32_t last_row, int64_t stride, uint32_t* visible,
                       float* inverse_depth);

}  // namespace sailenv
