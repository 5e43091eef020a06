// Smooth edges of see-through surfaces: how dense they are on average in a pixel and at its centre,
// for which their light was found.
#pragma once

#include <cstdint>
#include <vector>

#include "edges.h"
#include "shade.h"

namespace sailenv {

// The share of what lies behind that surfaces take away, in 65535ths.
struct Density {
    uint16_t mean, centre;
};

// What is drawn of see-through surfaces to smooth their edges.
struct GlassEdges {
    TriangleSet triangles;           // of fine samples
    std::vector<float> passes;       // what each part lets through
    std::vector<Density> densities;  // of each pixel
    std::vector<uint16_t> without;   // radiance of the pixels before they are drawn
    // Columns of each band between which anything is drawn; none of most.
    struct Columns {
        int32_t first, end;
    };
    std::vector<Columns> of_bands;
    struct Smoothed {
        int64_t pixel;
        uint16_t light[3];
    };
    std::vector<std::vector<Smoothed>> smoothed;  // band by band
};

void reserve_glass(GlassEdges& edges, const DrawList& glass, int64_t pixels, int64_t bands);

// Finds the densities in a band whose opaque samples are drawn; `band` is counted from `first_band`
// on in the lists of bands.
void find_densities(const Shading& shading, const DrawList& glass, const Projection& fine,
                    int32_t band, int32_t first_band, int32_t band_rows, EdgeScratch& scratch,
                    GlassEdges& edges);

// Keeps the radiance of rows that glass is to be drawn over, between some columns.
void keep_without_glass(const Shading& shading, int32_t first_row, int32_t end_row,
                        GlassEdges::Columns columns, GlassEdges& edges);

// Lists the light of pixels that are denser or less dense than at their centres; all bands from
// `first_row` to `end_row` are drawn. Where there is nothing at the centre of a pixel those around
// it tell what glass does there.
void mix_glass(const Shading& shading, int32_t begin, int32_t end, GlassEdges::Columns columns,
               int32_t first_row, int32_t end_row, const GlassEdges& edges,
               std::vector<GlassEdges::Smoothed>& smoothed);

// Writes that light.
void take_mixed(const Shading& shading, const std::vector<GlassEdges::Smoothed>& smoothed);

}  // namespace sailenv
