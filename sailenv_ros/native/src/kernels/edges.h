// Smooth edges of surfaces: which surfaces the fine samples of a pixel see, and the mean of their
// light.
#pragma once

#include <cstdint>
#include <vector>

#include "shade.h"

namespace sailenv {

// Memory of a thread for one band of fine samples.
struct EdgeScratch {
    std::vector<uint32_t> visible;  // as in `Scratch`, of fine samples
    std::vector<float> inverse_depth;
    int64_t stride = 0;
    std::vector<Fragment> fragments;
    std::vector<uint16_t> light;  // four halves of each
    RoughBand rough;
};

// Numbers from row to row of fine samples. Behind the last one is room for eight, and as many
// samples as a load of the last eight pixels reads.
int64_t fine_stride(int64_t width);

// Copies what the centres of a row of pixels see from its row of fine samples.
void take_centres(const uint32_t* fine, int64_t width, uint32_t* pixels);
void take_centres(const float* fine, int64_t width, float* pixels);

// Mixes into the radiance of a band what its pixels' fine samples see besides what their centres
// see.
void smooth_edges_of_band(const Shading& shading, int32_t first_row, int32_t last_row,
                          EdgeScratch& scratch);

}  // namespace sailenv
