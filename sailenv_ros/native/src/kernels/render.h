// Drawing some rows of a picture.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "edges.h"
#include "glass_edges.h"
#include "mirror_samples.h"
#include "shade.h"

namespace sailenv {

// What a drawing keeps from picture to picture.
struct DrawingScratch : Scratch {
    std::vector<EdgeScratch> edges;  // of each thread
    std::vector<BandEdges> of_bands;
    MirrorSamples mirrored;
    GlassEdges glass_edges;
    std::vector<std::unique_ptr<DrawingScratch>> of_slots;  // of threads that draw rows apart
};

// Rows `first` to `end` - 1 of pixels, in bands of `band` from row 0 on; `first` begins a band.
// `listed` as in `Projection`.
struct DrawnRows {
    int32_t first, end, band;
    bool listed;
};

// Whether the sizes are drawable and what is wanted can be drawn.
bool is_drawable(const View& view, const Light* light, const Outputs& outputs);

// Draws what one camera sees in some rows; `outputs` are of the whole picture. `light` may be null
// where no radiance is wanted.
void draw_rows(int64_t threads, DrawingScratch& scratch, const View& view,
               const Instances& instances, const DrawList& parts, const DrawList& glass,
               const Light* light, const Outputs& outputs, const DrawnRows& rows);

}  // namespace sailenv
