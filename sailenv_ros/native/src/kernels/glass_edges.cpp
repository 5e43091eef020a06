#include "glass_edges.h"

#include <algorithm>
#include <cstring>

#include "raster.h"

namespace sailenv {
namespace {

// Sixteenths of a pixel that its fine samples stand for. Of those at its corners the one above and
// to the left lies inside, see SAMPLE_SHIFT; in each direction all together are a quarter apart.
constexpr int CENTRE = 4, SIDE = 2, CORNER = 4, WHOLE = 16;

// Says of a pixel that its centre is covered.
constexpr int AT_CENTRE = 0x80;

// The columns of pixels that the triangles of a band may touch.
GlassEdges::Columns columns_of(const TriangleSet& set, int32_t band, int32_t width) {
    int32_t first = 2 * width, last = -1;
    for (int64_t k = 0; k < set.segment_count; k++) {
        const Segment& segment = set.segments[static_cast<size_t>(k)];
        const uint32_t end = segment.starts[static_cast<size_t>(band) + 1];
        for (uint32_t at = segment.starts[static_cast<size_t>(band)]; at < end; at++) {
            const Triangle& t = set.triangles[segment.entries[at]];
            first = std::min<int32_t>(first, t.x0);
            last = std::max<int32_t>(last, t.x1);
        }
    }
    // A fine sample between two pixels is of both.
    return {std::max(first - 1, 0) / 2, std::min(last / 2 + 1, width)};
}

// 1 of every second of eight fine samples that glass covers.
LANES_INLINE i8 covers(const float* nearest, const float* opaque) {
    return (every_second(nearest) > every_second(opaque)) & 1;
}

float value_of(uint16_t half) { return from_half(splat(static_cast<int32_t>(half)))[0]; }

uint16_t half_of(float value) { return static_cast<uint16_t>(to_half(splat(value))[0]); }

}  // namespace

void reserve_glass(GlassEdges& edges, int64_t pixels, int64_t bands) {
    const size_t count = static_cast<size_t>(pixels), lists = static_cast<size_t>(bands);
    if (edges.covered.size() < count) {
        edges.covered.resize(count);
        edges.without.resize(4 * count);
    }
    if (edges.of_bands.size() < lists) {
        edges.of_bands.resize(lists);
        edges.smoothed.resize(lists);
    }
}

void cover_glass_band(const Shading& s, const DrawList& glass, const Projection& fine, int32_t band,
                      int32_t first_band, int32_t band_rows, EdgeScratch& scratch,
                      GlassEdges& edges) {
    const int32_t width = static_cast<int32_t>(s.width);
    GlassEdges::Columns& columns = edges.of_bands[static_cast<size_t>(band - first_band)];
    columns = columns_of(edges.triangles, band, width);
    const RowRange rows = rows_of_band(fine, band, band_rows);
    memset(edges.covered.data() + rows.first / 2 * s.width, 0,
           static_cast<size_t>((rows.last / 2 - rows.first / 2) * s.width));
    if (columns.first >= columns.end) return;
    scratch.glazed.resize(scratch.inverse_depth.size());
    float* nearest = scratch.glazed.data();
    const float* opaque = scratch.inverse_depth.data();
    // Loads of the last eight pixels read as many samples more.
    const int64_t stride = scratch.stride, first = 2 * static_cast<int64_t>(columns.first);
    const int64_t count = std::min(2 * static_cast<int64_t>(columns.end) + 24, stride) - first;
    for (int64_t row = 0; row <= rows.last - rows.first; row++) {
        memcpy(nearest + row * stride + first, opaque + row * stride + first,
               static_cast<size_t>(count) * sizeof *nearest);
    }
    draw_band(edges.triangles, glass, fine, band, band_rows, stride, nullptr, nearest);
    for (int64_t row = rows.first + 1; row < rows.last; row += 2) {
        const int64_t from = (row - rows.first) * stride + 1;
        uint8_t* to = edges.covered.data() + row / 2 * s.width;
        for (int32_t x = columns.first; x < columns.end; x += 8) {
            const auto at = [&](int64_t offset) {
                const int64_t place = from + 2 * static_cast<int64_t>(x) + offset;
                return covers(nearest + place, opaque + place);
            };
            const i8 centre = at(0);
            const i8 sides = at(-stride) + at(stride) + at(-1) + at(1);
            const i8 found =
                CENTRE * centre + CORNER * at(-stride - 1) + SIDE * sides + AT_CENTRE * centre;
            for (int32_t k = 0; k < std::min(8, columns.end - x); k++) {
                to[x + k] = static_cast<uint8_t>(found[k]);
            }
        }
    }
}

void keep_without_glass(const Shading& s, int32_t first_row, int32_t end_row,
                        GlassEdges::Columns columns, GlassEdges& edges) {
    const size_t count = 4 * static_cast<size_t>(columns.end - columns.first);
    for (int64_t row = first_row; row < end_row; row++) {
        const int64_t first = 4 * (row * s.width + columns.first);
        memcpy(edges.without.data() + first, s.outputs->radiance + first, count * sizeof(uint16_t));
    }
}

void mix_glass(const Shading& s, int32_t begin, int32_t end, GlassEdges::Columns columns,
               int32_t first_row, int32_t end_row, const GlassEdges& edges,
               std::vector<GlassEdges::Smoothed>& smoothed) {
    smoothed.clear();
    const uint16_t *with = s.outputs->radiance, *without = edges.without.data();
    const int32_t width = static_cast<int32_t>(s.width);
    for (int32_t y = begin; y < end; y++) {
        for (int32_t x = columns.first; x < columns.end; x++) {
            const int64_t pixel = static_cast<int64_t>(y) * s.width + x;
            const int own = edges.covered[static_cast<size_t>(pixel)];
            const int share = own & ~AT_CENTRE;
            if (share == 0 || share == WHOLE) continue;
            float change[3] = {};
            int count = 0;
            const auto add = [&](int64_t at) {
                count++;
                for (int64_t c = 4 * at; c < 4 * at + 3; c++) {
                    change[c - 4 * at] += value_of(with[c]) - value_of(without[c]);
                }
            };
            if ((own & AT_CENTRE) != 0) {
                add(pixel);
            } else {
                for (int32_t row = std::max(y - 1, first_row); row < std::min(y + 2, end_row);
                     row++) {
                    for (int32_t at = std::max(x - 1, 0); at < std::min(x + 2, width); at++) {
                        const int64_t beside = static_cast<int64_t>(row) * s.width + at;
                        if ((edges.covered[static_cast<size_t>(beside)] & AT_CENTRE) != 0) {
                            add(beside);
                        }
                    }
                }
            }
            if (count == 0) continue;
            const float weight = static_cast<float>(share) / static_cast<float>(WHOLE * count);
            GlassEdges::Smoothed mixed{pixel, {}};
            for (int c = 0; c < 3; c++) {
                const float sum = value_of(without[4 * pixel + c]) + weight * change[c];
                mixed.light[c] = half_of(std::max(sum, 0.0f));
            }
            smoothed.push_back(mixed);
        }
    }
}

void take_mixed(const Shading& s, const std::vector<GlassEdges::Smoothed>& smoothed) {
    for (const GlassEdges::Smoothed& one : smoothed) {
        memcpy(s.outputs->radiance + 4 * one.pixel, one.light, sizeof one.light);
    }
}

}  // namespace sailenv
