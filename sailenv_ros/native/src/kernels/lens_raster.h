// The rasteriser through a lens that bends straight lines: which samples a triangle of a face can
// reach, and which of them see it.
#pragma once

#include "lens_table.h"
#include "raster.h"

namespace sailenv {

// Where corners lie on a face and in the picture [samples]. NaN behind the face.
void place_corners(const CubeFace& face, const float* x, const float* y, const float* z,
                   int32_t count, CornerPlace* out);

// The samples that a triangle can reach, of a face's; false if there are none. `corners` are the
// three, as the eye has them: x, y, z.
bool reach_through_lens(const CubeFace& face, const CornerPlace* const* places,
                        const float (&corners)[3][3], SampleBox& reach);

// Draws the samples of some rows; see `draw_triangle`.
void draw_through_lens(const Triangle& t, uint32_t number, const Part& part, const Projection& p,
                       int32_t first_row, int32_t last_row, int64_t stride, uint32_t* visible,
                       float* inverse_depth);

}  // namespace sailenv
