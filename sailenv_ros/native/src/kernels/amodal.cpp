// Each object drawn alone: which pixels it covers, whatever lies before it, and at what depth. The
// numbers of a pixel are those of a whole picture, bit for bit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <vector>

#include "../abi.h"
#include "../threads.h"
#include "clip_distances.h"
#include "raster.h"

namespace sailenv {

// Memory of a thread, and what was drawn of each object.
struct AmodalThread {
    TriangleSet set;
    std::vector<float> inverse_depth;
};
struct AmodalScratch {
    Scratch shared;  // frames alone
    std::vector<AmodalThread> threads;
    std::vector<std::vector<float>> crops;
};

namespace {

constexpr int64_t NUMBERS = 10;  // of a result: see draw_amodal
constexpr int32_t ONE_BAND = 1 << 20;

struct Rectangle {
    int32_t x0 = std::numeric_limits<int32_t>::max(), y0 = x0, x1 = -x0, y1 = -x0;
    void include(int32_t left, int32_t top, int32_t right, int32_t bottom) {
        x0 = std::min(x0, left);
        y0 = std::min(y0, top);
        x1 = std::max(x1, right);
        y1 = std::max(y1, bottom);
    }
    bool empty() const { return x0 > x1 || y0 > y1; }
};

// Turns a row of inverse_depth to depths, infinite where there is nothing; counts those that are
// not. Through a lens that has a table, whose row begins at `at`, to distances along the rays.
int64_t set_depths(float* row, int64_t count, const Projection& canvas, float far_m, int64_t at) {
    const LensTable* lens = canvas.table;
    const float least_inverse_depth = canvas.least_inverse_depth;
    const bool parallel = canvas.drawn == Drawn::PARALLEL;
    int32_t covered = 0;
    for (int64_t k = 0; k < count; k++) {
        const float n = row[k], depth = parallel ? -n : 1.0f / n;
        const float z = lens == nullptr ? depth : depth * stretch(lens->x[at + k], lens->y[at + k]);
        const bool there = n > least_inverse_depth && !(z > far_m);
        row[k] = there ? z : __builtin_inff();
        covered += there;
    }
    return covered;
}

bool is_there(float depth) { return depth < __builtin_inff(); }

// Grows a box by the part of a row from `begin` to `end` (pixels) that is covered; counts it.
int64_t include_row(const float* row, int32_t origin, int32_t begin, int32_t end, int32_t y,
                    Rectangle& box) {
    int64_t count = 0;
    for (int32_t x = begin; x <= end; x++) count += is_there(row[x - origin]);
    if (count == 0) return 0;
    while (!is_there(row[begin - origin])) begin++;
    while (!is_there(row[end - origin])) end--;
    box.include(begin, y, end, y);
    return count;
}

void draw_object(const Projection& canvas, const Scratch& shared, const Instances& instances,
                 const DrawList& parts, float far_m, float near_m, AmodalThread& own,
                 std::vector<float>& crop, int64_t* result) {
    crop.clear();
    std::fill(result, result + NUMBERS, 0);
    for (int j = 2; j < NUMBERS; j++) result[j] = -1;
    make_triangles(1, shared, parts, instances, canvas, nullptr, parts.count, false, own.set);
    Rectangle reach;
    for (int64_t s = 0; s < own.set.segment_count; s++) {
        const Segment& segment = own.set.segments[static_cast<size_t>(s)];
        for (int64_t k = 0; k < segment.triangle_count; k++) {
            const Triangle& t = own.set.triangles[static_cast<size_t>(segment.first_triangle + k)];
            reach.include(t.x0, t.y0, t.x1, t.y1);
        }
    }
    if (reach.empty()) return;
    Projection window = canvas;
    window.x0 = reach.x0;
    window.y0 = reach.y0;
    window.x1 = reach.x1;
    window.y1 = reach.y1;
    const int64_t width = reach.x1 - reach.x0 + 1, height = reach.y1 - reach.y0 + 1;
    const int64_t stride = width + ROW_PADDING;
    const size_t size = static_cast<size_t>(stride * height + 8);
    if (own.inverse_depth.size() < size) own.inverse_depth.resize(size);
    float* pixels = own.inverse_depth.data();
    std::fill(pixels, pixels + size, canvas.least_inverse_depth);
    draw_window(own.set, parts, window, stride, pixels);
    Rectangle whole, seen;
    const int32_t left = std::max(reach.x0, 0), right = std::min(reach.x1, canvas.width - 1);
    for (int32_t y = reach.y0; y <= reach.y1; y++) {
        float* row = pixels + (y - reach.y0) * stride;
        const LensTable* lens = canvas.table;
        const int64_t covered = set_depths(row, width, canvas, far_m,
                                           lens == nullptr ? 0 : y * lens->stride + reach.x0);
        if (covered == 0) continue;
        result[0] += include_row(row, reach.x0, reach.x0, reach.x1, y, whole);
        if (y >= 0 && y < canvas.height && left <= right) {
            result[1] += include_row(row, reach.x0, left, right, y, seen);
        }
    }
    const auto set_box = [&](const Rectangle& box, int64_t* out) {
        if (box.empty()) return;
        out[0] = box.x0;
        out[1] = box.y0;
        out[2] = box.x1;
        out[3] = box.y1;
    };
    set_box(whole, result + 2);
    set_box(seen, result + 6);
    if (seen.empty()) return;
    crop.reserve(static_cast<size_t>(seen.x1 - seen.x0 + 1) *
                 static_cast<size_t>(seen.y1 - seen.y0 + 1));
    for (int32_t y = seen.y0; y <= seen.y1; y++) {
        const float* row = pixels + (y - reach.y0) * stride - reach.x0;
        for (int32_t x = seen.x0; x <= seen.x1; x++) {
            crop.push_back(row[x] < near_m ? __builtin_nanf("") : row[x]);
        }
    }
}

}  // namespace
}  // namespace sailenv

// Makes the memory that objects are drawn in, and frees it. One drawing at a time may use it.
SAILENV_KERNEL(make_amodal_scratch)(sailenv::AmodalScratch** made) {
    *made = new (std::nothrow) sailenv::AmodalScratch;
    return *made == nullptr ? sailenv::STATUS_OUT_OF_MEMORY : sailenv::STATUS_OK;
}

SAILENV_KERNEL(free_amodal_scratch)(sailenv::AmodalScratch** made) {
    delete *made;
    *made = nullptr;
    return sailenv::STATUS_OK;
}

// Draws `count` objects, each alone: the parts from `starts[k]` to `starts[k + 1]`. They are drawn
// on a canvas of three pictures' width and height, in whose middle the picture lies; through a lens
// that has a table on the picture alone, with distances along the rays for depths. `results`
// (count, 10) takes of each object: the pixels that it covers on the canvas and in the picture; the
// boxes around the ones and around the others (left, top, right, bottom, the last ones included; -1
// where it covers none).
SAILENV_KERNEL(draw_amodal)
(int64_t threads, sailenv::AmodalScratch** handle, const sailenv::View* view,
 const sailenv::Instances* instances, const sailenv::DrawList* parts, const int64_t* starts,
 int64_t count, int64_t* results) {
    using namespace sailenv;
    if (view->width <= 0 || view->height <= 0 || view->width > 8192 || view->height > 8192 ||
        count < 0 || threads < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    for (int64_t k = 0; k < count; k++) {
        if (starts[k] < 0 || starts[k] > starts[k + 1] || starts[k + 1] > parts->count) {
            return STATUS_INVALID_ARGUMENT;
        }
    }
    Projection canvas = projection_of(*view);
    if (canvas.table == nullptr) {
        canvas.x0 = -canvas.width;
        canvas.y0 = -canvas.height;
        canvas.x1 = 2 * canvas.width - 1;
        canvas.y1 = 2 * canvas.height - 1;
    }
    try {
        AmodalScratch& scratch = **handle;
        scratch.shared.band_rows = ONE_BAND;
        set_frames(scratch.shared, *instances, view->camera_from_world, canvas);
        if (scratch.threads.size() < static_cast<size_t>(threads)) {
            scratch.threads.resize(static_cast<size_t>(threads));
        }
        scratch.crops.resize(static_cast<size_t>(count));
        bool lacks_memory = false;
        parallel_for(threads, count, 1, [&](int64_t k, int64_t, int64_t slot) {
            const DrawList own{parts->parts + starts[k], starts[k + 1] - starts[k]};
            try {
                draw_object(canvas, scratch.shared, *instances, own, rounded_down(view->lens.far_m),
                            -rounded_down(-view->lens.near_m),
                            scratch.threads[static_cast<size_t>(slot)],
                            scratch.crops[static_cast<size_t>(k)], results + NUMBERS * k);
            } catch (const std::bad_alloc&) {
                __atomic_store_n(&lacks_memory, true, __ATOMIC_RELAXED);
            }
        });
        if (lacks_memory) return STATUS_OUT_OF_MEMORY;
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    return STATUS_OK;
}

// Copies the depths that were drawn: of each object those in its box in the picture, row by row,
// one object after the other; infinite where it is not, not a number where it is nearer than near.
SAILENV_KERNEL(copy_amodal)(sailenv::AmodalScratch** handle, int64_t size, float* depths) {
    int64_t at = 0;
    for (const std::vector<float>& crop : (*handle)->crops) {
        const int64_t count = static_cast<int64_t>(crop.size());
        if (at + count > size) return sailenv::STATUS_INVALID_ARGUMENT;
        std::copy(crop.begin(), crop.end(), depths + at);
        at += count;
    }
    return at == size ? sailenv::STATUS_OK : sailenv::STATUS_INVALID_ARGUMENT;
}
