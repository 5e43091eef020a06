// Where on surfaces whose vertices move the points of a picture are; see native/surface_kernels.py.
#include <cmath>
#include <limits>
#include <vector>

#include "../threads.h"
#include "id_runs.h"
#include "point.h"
#include "rays.h"
#include "record.h"
#include "render_types.h"

#define SURFACE_FIELDS(FIELD)                                                                  \
    FIELD(int64_t, height)                                                                     \
    FIELD(int64_t, width)                                                                      \
    FIELD(const float*, points)      /* (H, W, 3), own frames; null: all known, with places */ \
    FIELD(const uint16_t*, instance) /* (H, W) */                                              \
    FIELD(const sailenv::TrianglePlace*, places) /* (H, W), or null: looked for */             \
    FIELD(const uint16_t*, row_of_instance)      /* (65536,): 1 + row; 0 for what is rigid */  \
    FIELD(int64_t, rows)                                                                       \
    FIELD(const sailenv::RayShape*, shapes) /* (R,): in the picture; null with places */       \
    FIELD(const uint64_t*, addresses)       /* (R, 3): see SurfaceVertices */                  \
    FIELD(const int64_t*, vertex_counts)    /* (R,) */                                         \
    FIELD(const double*, scales)            /* (R, 3) */                                       \
    FIELD(int64_t, relative)                /* 1: from where they are; 0: from 0 */            \
    FIELD(float*, found)                    /* (H, W, 3): written where a row is */

SAILENV_RECORD(SurfacePoints, surface_points, SURFACE_FIELDS)

namespace sailenv {
namespace {

constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
constexpr int64_t TILE_ROWS = 16;
constexpr double FIRST_REACH = 3e-5;  // how far beside a surface its points are looked for [m]
constexpr double LAST_REACH = 0.1;
constexpr double ON_SURFACE = 2e-6;  // what is no farther is on the leaf of its neighbour [m]

constexpr double BESIDE = 1e-4;  // share of a triangle by which a point may lie beside it

typedef double d8 __attribute__((vector_size(64)));
typedef int64_t l8 __attribute__((vector_size(64)));
typedef double d8_any __attribute__((vector_size(64), aligned(8), may_alias));

inline d8 vector_of(const double* p) { return *reinterpret_cast<const d8_any*>(p); }

// The point of a triangle that is nearest to another one, as weights of its corners.
// C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
void nearest_of_triangle(const Point& p, const Point& a, const Point& ab, const Point& ac,
                         double* weights) {
    const Point ap = minus(p, a);
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    const auto set = [weights](double second, double third) {
        weights[0] = 1.0 - second - third;
        weights[1] = second;
        weights[2] = third;
    };
    if (d1 <= 0.0 && d2 <= 0.0) return set(0.0, 0.0);
    const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
    const double d3 = d1 - bb, d4 = d2 - bc;
    if (d3 >= 0.0 && d4 <= d3) return set(1.0, 0.0);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return set(bb > 0.0 ? d1 / bb : 0.0, 0.0);
    const double d5 = d1 - bc, d6 = d2 - cc;
    if (d6 >= 0.0 && d5 <= d6) return set(0.0, 1.0);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return set(0.0, cc > 0.0 ? d2 / cc : 0.0);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        const double whole = (d4 - d3) + (d5 - d6);
        const double share = whole > 0.0 ? (d4 - d3) / whole : 0.0;
        return set(1.0 - share, share);
    }
    const double whole = va + vb + vc;
    if (!(whole > 0.0)) return set(0.0, 0.0);
    set(vb / whole, vc / whole);
}

struct Nearest {
    double square;
    int32_t triangle, leaf;
    double weights[3];
};

void look_in_leaf(const RayShape& s, int32_t leaf, const Point& p, Nearest& best) {
    const double* from = static_cast<const double*>(s.triangles) + 9 * WIDTH * int64_t{leaf};
    for (int k = 0; k < WIDTH; k++) {
        const int32_t triangle = s.order[WIDTH * int64_t{leaf} + k];
        if (triangle < 0) continue;
        Point a, ab, ac;
        for (int j = 0; j < 3; j++) {
            a.x[j] = from[WIDTH * j + k];
            ab.x[j] = from[WIDTH * (3 + j) + k];
            ac.x[j] = from[WIDTH * (6 + j) + k];
        }
        double w[3];
        nearest_of_triangle(p, a, ab, ac, w);
        Point off = minus(p, a);
        for (int j = 0; j < 3; j++) off.x[j] -= w[1] * ab.x[j] + w[2] * ac.x[j];
        const double square = dot(off, off);
        // Where two meet, the lower number wins, whatever the order of the leaves.
        if (square < best.square || (square == best.square && triangle < best.triangle)) {
            best = {square, triangle, leaf, {w[0], w[1], w[2]}};
        }
    }
}

// The same for points that lie over a triangle, eight triangles at a time.
void look_over_leaf(const RayShape& s, int32_t leaf, const Point& p, Nearest& best) {
    const double* from = static_cast<const double*>(s.triangles) + 9 * WIDTH * int64_t{leaf};
    d8 ap[3], ab[3], ac[3];
    for (int j = 0; j < 3; j++) {
        ap[j] = p.x[j] - vector_of(from + WIDTH * j);
        ab[j] = vector_of(from + WIDTH * (3 + j));
        ac[j] = vector_of(from + WIDTH * (6 + j));
    }
    const auto product = [](const d8* a, const d8* b) {
        return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
    };
    const d8 bb = product(ab, ab), bc = product(ab, ac), cc = product(ac, ac);
    const d8 d1 = product(ab, ap), d2 = product(ac, ap);
    const d8 whole = bb * cc - bc * bc;
    const d8 second = (cc * d1 - bc * d2) / whole, third = (bb * d2 - bc * d1) / whole;
    d8 off[3];
    for (int j = 0; j < 3; j++) off[j] = (ap[j] - second * ab[j]) - third * ac[j];
    const d8 square = product(off, off);
    // Of triangles without area nothing holds.
    const l8 over = (second >= -BESIDE) & (third >= -BESIDE) & (second + third <= 1.0 + BESIDE) &
                    (square < best.square);
    for (int k = 0; k < WIDTH; k++) {
        if (over[k] == 0) continue;
        const int32_t triangle = s.order[WIDTH * int64_t{leaf} + k];
        if (triangle < 0) continue;
        if (square[k] < best.square || (square[k] == best.square && triangle < best.triangle)) {
            best = {square[k], triangle, leaf, {(1.0 - second[k]) - third[k], second[k], third[k]}};
        }
    }
}

// The triangle that is nearest to a point, if one is within `reach`.
bool find_nearest(const RayShape& s, const Point& p, double reach, Nearest& best) {
    const bool is_over = reach == FIRST_REACH;
    best.square = reach * reach;
    best.triangle = std::numeric_limits<int32_t>::max();
    int32_t waiting[WAITING];
    int32_t count = 0, child = 0;
    while (true) {
        if (child < 0 && is_over) {
            look_over_leaf(s, ~child, p, best);
        } else if (child < 0) {
            look_in_leaf(s, ~child, p, best);
        } else {
            const TreeNode& n = s.nodes[child];
            const float far = static_cast<float>(std::sqrt(best.square)) * 1.00001f + 1e-6f;
            i8 within = load(n.children) != 0;
            for (int k = 0; k < 3; k++) {
                const float at = static_cast<float>(p.x[k]);
                const float margin = far + 2.4e-7f * std::fabs(at);
                within &=
                    (load(n.planes[k]) <= at + margin) & (load(n.planes[3 + k]) >= at - margin);
            }
            uint32_t met = lane_bits(within);
            while (met != 0 && count < WAITING) {
                waiting[count++] = n.children[__builtin_ctz(met)];
                met &= met - 1;
            }
        }
        if (count == 0) break;
        child = waiting[--count];
    }
    return best.triangle != std::numeric_limits<int32_t>::max();
}

// Vertices of a surface in the picture and where they are looked for, (V, 3) each; and the corners
// of the triangles of its tree, (T, 3), null without one.
struct SurfaceVertices {
    const float *present, *target;
    const uint32_t* corners;
};

// Where a neighbour was found; 0 for what is rigid.
struct Found {
    int32_t row = 0, leaf = -1;
};

// The point's place in the instance's frame, before the scale; false if it is not known.
bool place_of(const SurfacePoints& in, int64_t at, int64_t row, Point& p) {
    bool known = true;
    for (int k = 0; k < 3; k++) {
        p.x[k] = static_cast<double>(in.points[3 * at + k]) / in.scales[3 * row + k];
        known = known && p.x[k] - p.x[k] == 0.0;
    }
    return known;
}

void write_unknown(float* found) {
    for (int k = 0; k < 3; k++) found[k] = NOT_A_NUMBER;
}

// Writes the place at some weights of a triangle's corners.
void write_place(const SurfacePoints& in, int64_t at, int64_t row, const uint32_t* corners,
                 const double* weights) {
    const SurfaceVertices& v = reinterpret_cast<const SurfaceVertices*>(in.addresses)[row];
    for (int k = 0; k < 3; k++) {
        double sum = 0.0;
        for (int j = 0; j < 3; j++) {
            const int64_t place = 3 * static_cast<int64_t>(corners[j]) + k;
            const double from = in.relative != 0 ? v.present[place] : 0.0;
            sum += weights[j] * (v.target[place] - from);
        }
        in.found[3 * at + k] = static_cast<float>(sum * in.scales[3 * row + k]);
    }
}

// The same of a pixel whose place on a triangle is known.
void carry(const SurfacePoints& in, int64_t at, int64_t row) {
    const TrianglePlace& place = in.places[at];
    Point p;
    bool known = in.points == nullptr || place_of(in, at, row, p);
    double weights[3];
    for (int k = 0; k < 3; k++) {
        known = known && place.vertices[k] < in.vertex_counts[row];
        weights[k] = place.weights[k];
    }
    if (!known) return write_unknown(in.found + 3 * at);
    write_place(in, at, row, place.vertices, weights);
}

// `leaf` becomes where the point is; it is looked for first where its neighbours were found.
void find_pixel(const SurfacePoints& in, int64_t at, int64_t row, const int32_t* near_leaves,
                int64_t near_count, int32_t& leaf) {
    const RayShape& shape = in.shapes[row];
    Point p;
    const bool known = place_of(in, at, row, p) && shape.count > 0;
    Nearest best{ON_SURFACE * ON_SURFACE, std::numeric_limits<int32_t>::max(), -1, {}};
    for (int64_t k = 0; known && k < near_count && best.leaf < 0; k++) {
        look_over_leaf(shape, near_leaves[k], p, best);
    }
    bool near = best.leaf >= 0;
    double reach = FIRST_REACH;
    while (known && !near && reach <= LAST_REACH) {
        near = find_nearest(shape, p, reach, best);
        reach *= 15.0;
    }
    leaf = near ? best.leaf : -1;
    if (!near) return write_unknown(in.found + 3 * at);
    const SurfaceVertices& v = reinterpret_cast<const SurfaceVertices*>(in.addresses)[row];
    write_place(in, at, row, v.corners + 3 * static_cast<int64_t>(best.triangle), best.weights);
}

}  // namespace
}  // namespace sailenv

// Where the surface points of a picture are when their triangles have other corners.
SAILENV_KERNEL(surface_points)(int64_t threads, const SurfacePoints* given) {
    using namespace sailenv;
    const SurfacePoints in = *given;
    const bool is_told = in.points != nullptr || in.places != nullptr;
    if (in.height < 0 || in.width < 0 || in.rows < 0 || !is_told) return STATUS_INVALID_ARGUMENT;
    if (in.places != nullptr) {
        parallel_for(threads, in.height, TILE_ROWS, [&](int64_t begin, int64_t end, int64_t) {
            const uint16_t* ids = in.instance;
            for (int64_t at = begin * in.width, last = end * in.width; at < last;) {
                const int64_t row = in.row_of_instance[ids[at]];
                const bool deforms = row >= 1 && row <= in.rows;
                const int64_t end_of_run = same_until(ids, at, last);
                for (; deforms && at < end_of_run; at++) carry(in, at, row - 1);
                at = end_of_run;
            }
        });
        return STATUS_OK;
    }
    parallel_for(threads, in.height, TILE_ROWS, [&](int64_t begin, int64_t end, int64_t) {
        std::vector<Found> above(static_cast<size_t>(in.width) + 1);
        for (int64_t v = begin; v < end; v++) {
            Found left;
            for (int64_t u = 0; u < in.width; u++) {
                const int64_t at = v * in.width + u;
                const auto row = static_cast<int32_t>(in.row_of_instance[in.instance[at]]);
                Found here{row, -1};
                if (row >= 1 && row <= in.rows) {
                    int32_t leaves[3];
                    int64_t count = 0;
                    for (const Found& one : {left, above[u], above[u + 1]}) {
                        if (one.row != row || one.leaf < 0) continue;
                        bool is_new = true;
                        for (int64_t k = 0; k < count; k++) is_new &= leaves[k] != one.leaf;
                        if (is_new) leaves[count++] = one.leaf;
                    }
                    find_pixel(in, at, row - 1, leaves, count, here.leaf);
                }
                above[u] = left = here;
            }
        }
    });
    return STATUS_OK;
}
