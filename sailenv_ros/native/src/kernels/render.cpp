// The border to Python of everything that draws: pictures and shadow maps.
#include "render.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "../abi.h"
#include "../threads.h"

namespace sailenv {
namespace {

// Rows of a band: enough bands that threads finish together, few enough that triangles are not in
// many of them.
int32_t band_rows_of(int64_t height) { return height <= 128 ? 8 : 16; }

void reserve_pixels(Scratch& scratch, int64_t width, int64_t height) {
    // Rows are read and written in steps of eight pixels from any column.
    scratch.stride = (width + ROW_PADDING + 15) & ~static_cast<int64_t>(15);
    const size_t count = static_cast<size_t>(scratch.stride * height + 16);
    if (scratch.inverse_depth.size() < count) {
        scratch.inverse_depth.resize(count);
        scratch.visible.resize(count);
    }
}

void reserve_samples(std::vector<EdgeScratch>& edges, int64_t threads, int64_t width,
                     int64_t band_rows) {
    edges.resize(std::max(edges.size(), static_cast<size_t>(std::max<int64_t>(threads, 1))));
    for (EdgeScratch& scratch : edges) {
        scratch.stride = fine_stride(width);
        const size_t count = static_cast<size_t>(scratch.stride * (2 * band_rows + 1) + 16);
        if (scratch.visible.size() >= count) continue;
        scratch.visible.resize(count);
        scratch.inverse_depth.resize(count);
    }
}

// Numbers of the parts, the most distant first: by the middle of their spheres.
void sort_glass(Scratch& scratch, const DrawList& glass, bool bends) {
    scratch.order.resize(static_cast<size_t>(glass.count));
    scratch.distance.resize(static_cast<size_t>(glass.count));
    for (int64_t k = 0; k < glass.count; k++) {
        const Part& part = glass.parts[k];
        const double* m = scratch.frames[static_cast<size_t>(part.instance)].eye_from_object;
        const auto along = [&](int row) {
            const double* r = m + 4 * row;
            return r[0] * part.sphere[0] + r[1] * part.sphere[1] + r[2] * part.sphere[2] + r[3];
        };
        // Along the axis; through a lens that may see to all sides, from the eye.
        const double depth = bends ? std::hypot(along(0), along(1), along(2)) : along(2);
        scratch.distance[static_cast<size_t>(k)] = depth == depth ? depth : 0.0;
        scratch.order[static_cast<size_t>(k)] = static_cast<int32_t>(k);
    }
    const std::vector<double>& distance = scratch.distance;
    std::stable_sort(scratch.order.begin(), scratch.order.end(), [&](int32_t a, int32_t b) {
        return distance[static_cast<size_t>(a)] > distance[static_cast<size_t>(b)];
    });
}

// Draws a band of fine samples, and takes from it what the centres of pixels see.
void draw_fine_band(const Projection& fine, const DrawList& parts, int32_t band, Scratch& scratch,
                    EdgeScratch& edges) {
    const RowRange rows = rows_of_band(fine, band, scratch.band_rows);
    uint32_t* visible = edges.visible.data();
    float* inverse_depth = edges.inverse_depth.data();
    clear_band(fine, band, scratch.band_rows, edges.stride, visible, inverse_depth);
    draw_band(scratch.opaque, parts, fine, band, scratch.band_rows, edges.stride, visible,
              inverse_depth);
    for (int64_t row = rows.first + 1; row < rows.last; row += 2) {
        const int64_t from = (row - rows.first) * edges.stride, to = row / 2 * scratch.stride;
        take_centres(visible + from, fine.width, scratch.visible.data() + to);
        take_centres(inverse_depth + from, fine.width, scratch.inverse_depth.data() + to);
    }
}

// The rotation in a matrix of four rows, in single precision.
Mat3 turn_of(const double* m) {
    const auto row = [m](int k) {
        return vec3(static_cast<float>(m[4 * k]), static_cast<float>(m[4 * k + 1]),
                    static_cast<float>(m[4 * k + 2]));
    };
    return {{row(0), row(1), row(2)}};
}

// The frames of a lens's faces.
void set_face_turns(Shading& shading, const View& view) {
    for (int32_t k = 0; k < CUBE_FACES; k++) {
        const double* turn = view.table->faces[k].turn;
        double from_face[12] = {}, world[12] = {};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                from_face[4 * i + j] = turn[3 * j + i];
                for (int m = 0; m < 3; m++) {
                    world[4 * i + j] += view.world_from_camera[4 * i + m] * turn[3 * j + m];
                }
            }
        }
        shading.world_from_face[k] = turn_of(world);
        shading.camera_from_face[k] = turn_of(from_face);
    }
    shading.lens = FastLens(Lens{1.0, 1.0, 0.0, 0.0, view.lens.near_m, view.lens.far_m});
}

}  // namespace

bool is_drawable(const View& view, const Light* light, const Outputs& outputs) {
    const bool sized =
        view.width > 0 && view.height > 0 && view.width <= 16384 && view.height <= 16384;
    const bool lacks_samples = view.table != nullptr && view.fine_table == nullptr &&
                               view.smooth_edges != 0 && outputs.radiance != nullptr;
    const bool one_law = view.parallel == 0 || view.table == nullptr;
    return sized && one_law && !lacks_samples && (outputs.radiance == nullptr || light != nullptr);
}

void draw_rows(int64_t threads, DrawingScratch& scratch, const View& view,
               const Instances& instances, const DrawList& parts, const DrawList& glass,
               const Light* light, const Outputs& outputs, const DrawnRows& rows) {
    Projection projection = projection_of(view);
    projection.y0 = rows.first;
    projection.y1 = rows.end - 1;
    projection.listed = rows.listed;
    const bool shaded = outputs.radiance != nullptr;
    const bool smoothed = shaded && view.smooth_edges != 0;
    Projection sampled = projection;
    if (smoothed) {
        sampled.fine = true;
        sampled.table = view.fine_table;
        sampled.x1 = 2 * projection.width;
        sampled.y0 = 2 * rows.first;
        sampled.y1 = 2 * rows.end;
    }
    reserve_pixels(scratch, view.width, view.height);
    scratch.band_rows = rows.band;
    if (smoothed) reserve_samples(scratch.edges, threads, view.width, scratch.band_rows);
    set_frames(scratch, instances, view.camera_from_world, sampled);
    make_triangles(threads, scratch, parts, instances, sampled, nullptr, parts.count, false,
                   scratch.opaque);
    const bool glazed = shaded && glass.count > 0;
    if (glazed) {
        sort_glass(scratch, glass, view.table != nullptr);
        make_triangles(threads, scratch, glass, instances, projection, scratch.order.data(),
                       glass.count, true, scratch.glass);
    }
    GlassEdges& glass_edges = scratch.glass_edges;
    const bool smooths_glass = glazed && smoothed;
    if (smooths_glass) {
        make_triangles(threads, scratch, glass, instances, sampled, nullptr, glass.count, false,
                       glass_edges.triangles);
    }
    Shading shading{};
    shading.set = &scratch.opaque;
    shading.parts = &parts;
    shading.frames = scratch.frames.data();
    shading.at_baked_pose = instances.at_baked_pose;
    shading.light = light;
    shading.outputs = &outputs;
    shading.width = view.width;
    shading.stride = scratch.stride;
    shading.visible = scratch.visible.data();
    shading.lens = FastLens(view.lens);
    shading.world_from_camera = turn_of(view.world_from_camera);
    shading.camera_from_world = turn_of(view.camera_from_world);
    shading.sight = view.parallel != 0 ? Sight::PARALLEL : Sight::CENTRAL;
    shading.table = view.table;
    shading.fine_table = view.fine_table;
    if (view.table != nullptr) set_face_turns(shading, view);
    const double* m = view.world_from_camera;
    shading.eye =
        vec3(static_cast<float>(m[3]), static_cast<float>(m[7]), static_cast<float>(m[11]));
    const int32_t band_rows = scratch.band_rows;
    const int64_t count = rows.end - rows.first;
    const int32_t first_band = rows.first / band_rows;
    if (smoothed) {
        const size_t bands = static_cast<size_t>((rows.end - 1) / band_rows + 1 - first_band);
        scratch.of_bands.resize(std::max(scratch.of_bands.size(), bands));
        if (smooths_glass) {
            reserve_glass(glass_edges, glass, int64_t{view.width} * view.height,
                          static_cast<int64_t>(bands));
        }
    }
    const auto edges_of = [&](int32_t band) -> BandEdges& {
        return scratch.of_bands[static_cast<size_t>(band - first_band)];
    };
    parallel_for(threads, count, band_rows, [&](int64_t begin, int64_t end, int64_t slot) {
        const int32_t first = rows.first + static_cast<int32_t>(begin), band = first / band_rows;
        if (smoothed) {
            EdgeScratch& edges = scratch.edges[static_cast<size_t>(slot)];
            draw_fine_band(sampled, parts, band, scratch, edges);
            list_edges(shading, first, rows.first + static_cast<int32_t>(end), edges,
                       edges_of(band));
            if (smooths_glass) {
                find_densities(shading, glass, sampled, band, first_band, band_rows, edges,
                               glass_edges);
            }
        } else {
            uint32_t* visible = scratch.visible.data() + first * scratch.stride;
            float* inverse_depth = scratch.inverse_depth.data() + first * scratch.stride;
            clear_band(projection, band, band_rows, scratch.stride, visible, inverse_depth);
            draw_band(scratch.opaque, parts, projection, band, band_rows, scratch.stride, visible,
                      inverse_depth);
        }
    });
    if (shaded && traces_reflections(shading)) {
        sample_mirrored(threads, shading, rows.first, rows.end, scratch.mirrored);
        shading.samples = &scratch.mirrored;
    }
    parallel_for(threads, count, band_rows, [&](int64_t begin, int64_t end, int64_t) {
        const int32_t first = rows.first + static_cast<int32_t>(begin), band = first / band_rows;
        shade_band(shading, first, rows.first + static_cast<int32_t>(end));
        if (smoothed) smooth_edges(shading, edges_of(band));
        if (smooths_glass) {
            const auto columns = glass_edges.of_bands[static_cast<size_t>(band - first_band)];
            if (columns.first >= columns.end) return;
            keep_without_glass(shading, first, rows.first + static_cast<int32_t>(end), columns,
                               glass_edges);
        }
        if (glazed) {
            draw_glass_band(shading, scratch.glass, glass, projection, band, band_rows,
                            scratch.inverse_depth.data());
        }
    });
    if (!smooths_glass) return;
    // Neighbours in other bands are looked at: nothing is written before all have been.
    using Smoothed = std::vector<GlassEdges::Smoothed>;
    const auto for_glass = [&](const auto& work) {
        parallel_for(threads, count, band_rows, [&](int64_t begin, int64_t end, int64_t) {
            const int32_t first = rows.first + static_cast<int32_t>(begin);
            const size_t number = static_cast<size_t>(first / band_rows - first_band);
            const auto columns = glass_edges.of_bands[number];
            if (columns.first >= columns.end) return;
            work(first, rows.first + static_cast<int32_t>(end), columns,
                 glass_edges.smoothed[number]);
        });
    };
    for_glass([&](int32_t first, int32_t end, GlassEdges::Columns columns, Smoothed& mixed) {
        mix_glass(shading, first, end, columns, rows.first, rows.end, glass_edges, mixed);
    });
    for_glass([&](int32_t, int32_t, GlassEdges::Columns, const Smoothed& mixed) {
        take_mixed(shading, mixed);
    });
}

}  // namespace sailenv

// Makes the memory that pictures are drawn in, and frees it. One drawing at a time may use it.
SAILENV_KERNEL(make_scratch)(sailenv::DrawingScratch** made) {
    *made = new (std::nothrow) sailenv::DrawingScratch;
    return *made == nullptr ? sailenv::STATUS_OUT_OF_MEMORY : sailenv::STATUS_OK;
}

SAILENV_KERNEL(free_scratch)(sailenv::DrawingScratch** made) {
    delete *made;
    *made = nullptr;
    return sailenv::STATUS_OK;
}

// Draws what one camera sees. `light` may be null where no radiance is wanted.
SAILENV_KERNEL(draw_picture)
(int64_t threads, sailenv::DrawingScratch** scratch, const sailenv::View* view,
 const sailenv::Instances* instances, const sailenv::DrawList* parts,
 const sailenv::DrawList* glass, const sailenv::Light* light, const sailenv::Outputs* outputs) {
    using namespace sailenv;
    if (!is_drawable(*view, light, *outputs)) return STATUS_INVALID_ARGUMENT;
    try {
        const int32_t height = static_cast<int32_t>(view->height);
        draw_rows(threads, **scratch, *view, *instances, *parts, *glass, light, *outputs,
                  {0, height, band_rows_of(view->height), false});
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    return STATUS_OK;
}

// Draws what a directional light sees into a shadow map: 1 - depth of the nearest surface. Rows of
// `inverse_depth` and `resting` hold `size` + ROW_PADDING numbers. `map_from_world` (4, 4) leads to
// pixels (integers are centres) and depth, 0 to 1. Without `resting` the map is cleared first, else
// it begins as a copy of that, or as it is if it is the same. `changed` has a number for each 16
// rows: 1 where the map differs from `resting`.
SAILENV_KERNEL(draw_shadow_map)
(int64_t threads, sailenv::DrawingScratch** handle, const double* map_from_world,
 const sailenv::Instances* instances, const sailenv::DrawList* parts, int64_t size,
 const float* resting, uint8_t* changed, float* inverse_depth) {
    using namespace sailenv;
    constexpr int32_t BAND_ROWS = 16;
    if (size < 8 || size > 8192) return STATUS_INVALID_ARGUMENT;
    try {
        Scratch& scratch = **handle;
        Projection projection{};
        projection.drawn = Drawn::SHADOW;
        projection.lens.fx = projection.lens.fy = 1.0;
        projection.width = projection.height = static_cast<int32_t>(size);
        projection.x1 = projection.y1 = projection.width - 1;
        projection.greatest_inverse_depth = 1.0f;
        scratch.band_rows = BAND_ROWS;
        set_frames(scratch, *instances, map_from_world, projection);
        const TriangleSet& set = scratch.opaque;
        make_triangles(threads, scratch, *parts, *instances, projection, nullptr, parts->count,
                       false, scratch.opaque);
        const int64_t stride = size + ROW_PADDING;
        parallel_for(threads, size, BAND_ROWS, [&](int64_t first, int64_t last, int64_t) {
            const int32_t band = static_cast<int32_t>(first / BAND_ROWS);
            float* band_nearness = inverse_depth + first * stride;
            bool reached = false;
            for (int64_t k = 0; k < set.segment_count; k++) {
                const std::vector<uint32_t>& starts = set.segments[static_cast<size_t>(k)].starts;
                reached |=
                    starts[static_cast<size_t>(band)] < starts[static_cast<size_t>(band) + 1];
            }
            if (resting == nullptr) {
                clear_band(projection, band, BAND_ROWS, stride, nullptr, band_nearness);
            } else if ((reached || changed[band]) && resting != inverse_depth) {
                memcpy(band_nearness, resting + first * stride,
                       static_cast<size_t>((last - first) * stride) * sizeof(float));
            }
            if (reached) {
                draw_band(set, *parts, projection, band, BAND_ROWS, stride, nullptr, band_nearness);
            }
            changed[band] = resting == nullptr || reached;
        });
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    return STATUS_OK;
}
