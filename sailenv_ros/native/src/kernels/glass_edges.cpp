#include "glass_edges.h"

#include <algorithm>
#include <cstring>

#include "raster.h"

namespace sailenv {
namespace {

// Shares of a pixel that its fine samples stand for. Of those at its corners the one above and to
// the left lies inside, see SAMPLE_SHIFT; in each direction all together are a quarter apart.
constexpr float CENTRE = 0.25f, SIDE = 0.125f, CORNER = 0.25f;

constexpr float MIRRORED = 0.08f;  // of glass, however clear: it is seen by that, too
constexpr float WHOLE = 65535.0f;
constexpr int ALIKE = 64;  // difference of densities that is not seen

// The columns of pixels that the triangles of a band may touch.
GlassEdges::Columns columns_of(const TriangleSet& set, int32_t band, int32_t width) {
    int32_t first = 2 * width, last = -1;
    for_triangles(set, band, [&](uint32_t number) {
        const Triangle& t = set.triangles[number];
        first = std::min<int32_t>(first, t.x0);
        last = std::max<int32_t>(last, t.x1);
    });
    // A fine sample between two pixels is of both.
    return {std::max(first - 1, 0) / 2, std::min(last / 2 + 1, width)};
}

// What a part lets through, on average over the colours; see glass.cpp.
float passes_of(const Part& part) {
    const float alpha = part.colour[3];
    float most = 0.0f, sum = 0.0f;
    for (int c = 0; c < 3; c++) {
        most = std::max(most, part.colour[c] * part.colour[c]);
        sum += part.colour[c] * part.colour[c];
    }
    const float hue = sum / (3.0f * std::max(most, 1e-3f));
    const float kept = part.roughness < LEAST_CLOTH ? MIRRORED : 0.0f;
    return (1.0f - kept) * (1.0f - alpha) * (1.0f + alpha * (hue - 1.0f));
}

uint16_t half_of(float value) { return static_cast<uint16_t>(to_half(splat(value))[0]); }

// What glass does to pixels, as if it were as dense as can be: it dims what lies behind, by a
// share, or adds light.
struct Change {
    float dims[3] = {}, adds[3] = {};
    int count = 0;

    void add(const uint16_t* with, const uint16_t* without, int dense) {
        const float scale = WHOLE / static_cast<float>(dense);
        for (int c = 0; c < 3; c++) {
            const float before = number_of_half(without[c]);
            const float change = scale * (number_of_half(with[c]) - before);
            (change < 0.0f ? dims : adds)[c] += change < 0.0f ? change / before : change;
        }
        count++;
    }

    float at(int dense, float before, int c) const {
        const float weight = static_cast<float>(dense) / (WHOLE * static_cast<float>(count));
        return std::max((1.0f + weight * dims[c]) * before + weight * adds[c], 0.0f);
    }
};

// The light of some pixels.
struct Range {
    float low[3], high[3];

    explicit Range(const uint16_t* light) {
        for (int c = 0; c < 3; c++) low[c] = high[c] = number_of_half(light[c]);
    }

    void add(const uint16_t* light) {
        for (int c = 0; c < 3; c++) {
            low[c] = std::min(low[c], number_of_half(light[c]));
            high[c] = std::max(high[c], number_of_half(light[c]));
        }
    }

    float nearest(float light, int c) const { return std::min(std::max(light, low[c]), high[c]); }
};

}  // namespace

void reserve_glass(GlassEdges& edges, const DrawList& glass, int64_t pixels, int64_t bands) {
    const size_t count = static_cast<size_t>(pixels), lists = static_cast<size_t>(bands);
    if (edges.densities.size() < count) {
        edges.densities.resize(count);
        edges.without.resize(4 * count);
    }
    if (edges.of_bands.size() < lists) {
        edges.of_bands.resize(lists);
        edges.smoothed.resize(lists);
    }
    edges.passes.resize(static_cast<size_t>(glass.count));
    for (int64_t k = 0; k < glass.count; k++) {
        edges.passes[static_cast<size_t>(k)] = passes_of(glass.parts[k]);
    }
}

void find_densities(const Shading& s, const DrawList& glass, const Projection& fine, int32_t band,
                    int32_t first_band, int32_t band_rows, EdgeScratch& scratch,
                    GlassEdges& edges) {
    const int32_t width = static_cast<int32_t>(s.width);
    GlassEdges::Columns& columns = edges.of_bands[static_cast<size_t>(band - first_band)];
    columns = columns_of(edges.triangles, band, width);
    const RowRange rows = rows_of_band(fine, band, band_rows);
    std::fill(edges.densities.data() + rows.first / 2 * s.width,
              edges.densities.data() + rows.last / 2 * s.width, Density{0, 0});
    if (columns.first >= columns.end) return;
    scratch.nearest.resize(scratch.inverse_depth.size());
    scratch.through.resize(scratch.inverse_depth.size());
    float *nearest = scratch.nearest.data(), *through = scratch.through.data();
    const float* opaque = scratch.inverse_depth.data();
    // Triangles are drawn in eights, and of the last pixels as many samples more are read.
    const int64_t stride = scratch.stride, first = 2 * static_cast<int64_t>(columns.first);
    const int64_t count = std::min(2 * static_cast<int64_t>(columns.end) + 24, stride) - first;
    for (int64_t row = 0; row <= rows.last - rows.first; row++) {
        memcpy(nearest + row * stride + first, opaque + row * stride + first,
               static_cast<size_t>(count) * sizeof *nearest);
        std::fill_n(through + row * stride + first, count, 1.0f);
    }
    draw_layers(edges.triangles, glass, fine, band, band_rows, stride, opaque, nearest, through,
                edges.passes.data());
    for (int64_t row = rows.first + 1; row < rows.last; row += 2) {
        const float* from = through + (row - rows.first) * stride + 1;
        Density* to = edges.densities.data() + row / 2 * s.width;
        for (int32_t x = columns.first; x < columns.end; x += 8) {
            const auto at = [&](int64_t offset) {
                return every_second(from + 2 * static_cast<int64_t>(x) + offset);
            };
            const f8 centre = at(0);
            const f8 sides = at(-stride) + at(stride) + at(-1) + at(1);
            const f8 mean = CENTRE * centre + CORNER * at(-stride - 1) + SIDE * sides;
            const i8 dense = truncated(WHOLE * (1.0f - mean) + 0.5f);
            const i8 own = truncated(WHOLE * (1.0f - centre) + 0.5f);
            for (int32_t k = 0; k < std::min(8, columns.end - x); k++) {
                to[x + k] = {static_cast<uint16_t>(dense[k]), static_cast<uint16_t>(own[k])};
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
            const Density own = edges.densities[static_cast<size_t>(pixel)];
            if (std::abs(own.mean - own.centre) < ALIKE) continue;
            // Its centre tells what glass does there, unless that meets nothing or an edge that is
            // denser than most of the pixel; then those around it do.
            const bool empty = own.centre < ALIKE;
            const int most = empty ? 65535 : own.mean + own.mean / 8;
            const bool elsewhere = empty || own.centre > most;
            Change change;
            Range range(without + 4 * pixel);
            if (elsewhere) {
                for (int32_t row = std::max(y - 1, first_row); row < std::min(y + 2, end_row);
                     row++) {
                    for (int32_t at = std::max(x - 1, 0); at < std::min(x + 2, width); at++) {
                        const int64_t beside = static_cast<int64_t>(row) * s.width + at;
                        range.add(with + 4 * beside);
                        const int dense = edges.densities[static_cast<size_t>(beside)].centre;
                        if (dense < ALIKE || dense > most) continue;
                        change.add(with + 4 * beside, without + 4 * beside, dense);
                    }
                }
            }
            if (change.count == 0) {
                if (empty) continue;
                change.add(with + 4 * pixel, without + 4 * pixel, own.centre);
            }
            GlassEdges::Smoothed mixed{pixel, {}};
            for (int c = 0; c < 3; c++) {
                const float light = change.at(own.mean, number_of_half(without[4 * pixel + c]), c);
                // Where surfaces beside are turned otherwise, densities tell little.
                mixed.light[c] = half_of(elsewhere ? range.nearest(light, c) : light);
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
