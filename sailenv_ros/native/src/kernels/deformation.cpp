// Surfaces whose vertices move: skinning, clusters of triangles as they lie now, and where on them
// the points of a picture are; see native/deformation_kernels.py.
#include <cmath>
#include <limits>
#include <vector>

#include "../threads.h"
#include "rays.h"
#include "record.h"
#include "render_types.h"

#define SKIN_FIELDS(FIELD)                                                             \
    FIELD(int64_t, count)                                                              \
    FIELD(int64_t, bone_count)                                                         \
    FIELD(const float*, positions) /* (V, 3), at rest */                               \
    FIELD(const float*, normals)   /* (V, 3) */                                        \
    FIELD(const uint16_t*, bones)  /* (V, 4) */                                        \
    FIELD(const float*, weights)   /* (V, 4) */                                        \
    FIELD(const double*, matrices) /* (B, 3, 4): where a bone takes what is at rest */ \
    FIELD(float*, moved)           /* (V, 3) */                                        \
    FIELD(float*, turned)          /* (V, 3): unit normals */

SAILENV_RECORD(Skin, skin_vertices, SKIN_FIELDS)

#define CLUSTERS_FIELDS(FIELD)                      \
    FIELD(int64_t, count)                           \
    FIELD(int64_t, corner_count)                    \
    FIELD(int64_t, index_count)                     \
    FIELD(const float*, corners)       /* (K, 3) */ \
    FIELD(const uint32_t*, indices)    /* (3 M,) */ \
    FIELD(sailenv::Cluster*, clusters) /* their indices are read, the rest is written */

SAILENV_RECORD(MovedClusters, move_clusters, CLUSTERS_FIELDS)

#define SURFACE_FIELDS(FIELD)                                                             \
    FIELD(int64_t, height)                                                                \
    FIELD(int64_t, width)                                                                 \
    FIELD(const float*, points)             /* (H, W, 3): in each instance's own frame */ \
    FIELD(const uint16_t*, instance)        /* (H, W) */                                  \
    FIELD(const uint16_t*, row_of_instance) /* (65536,): 1 + row; 0 for what is rigid */  \
    FIELD(int64_t, rows)                                                                  \
    FIELD(const sailenv::RayShape*, shapes) /* (R,): as they are in the picture */        \
    FIELD(const uint64_t*, targets)         /* (R,): addresses of (T, 3, 3) doubles */    \
    FIELD(const double*, scales)            /* (R, 3) */                                  \
    FIELD(int64_t, relative)                /* 1: from where they are; 0: from 0 */       \
    FIELD(float*, found)                    /* (H, W, 3): written where a row is */

SAILENV_RECORD(SurfacePoints, surface_points, SURFACE_FIELDS)

namespace sailenv {
namespace {

constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
constexpr int64_t TILE_ROWS = 16;
constexpr int64_t TILE_VERTICES = 2048;
constexpr double FIRST_REACH = 3e-5;  // how far beside a surface its points are looked for [m]
constexpr double LAST_REACH = 0.1;
constexpr double ON_SURFACE = 2e-6;  // what is no farther is on the leaf of its neighbour [m]

constexpr double BESIDE = 1e-4;  // share of a triangle by which a point may lie beside it

typedef double d8 __attribute__((vector_size(64)));
typedef int64_t l8 __attribute__((vector_size(64)));
typedef double d8_any __attribute__((vector_size(64), aligned(8), may_alias));

inline d8 vector_of(const double* p) { return *reinterpret_cast<const d8_any*>(p); }

// Four columns of a matrix of three rows.
struct Columns {
    f4 c[4];
};

void skin(const Skin& in, const Columns* bones, int64_t begin, int64_t end) {
    for (int64_t v = begin; v < end; v++) {
        f4 c[4] = {};
        for (int k = 0; k < 4; k++) {
            const float w = in.weights[4 * v + k];
            if (w == 0.0f) continue;
            const Columns& bone = bones[in.bones[4 * v + k]];
            const f4 weight = {w, w, w, w};
            for (int j = 0; j < 4; j++) c[j] += weight * bone.c[j];
        }
        const float* p = in.positions + 3 * v;
        const float* n = in.normals + 3 * v;
        const f4 place = ((c[0] * p[0] + c[1] * p[1]) + c[2] * p[2]) + c[3];
        const f4 normal = (c[0] * n[0] + c[1] * n[1]) + c[2] * n[2];
        const float square =
            (normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2];
        const float length = std::sqrt(square);
        for (int k = 0; k < 3; k++) {
            in.moved[3 * v + k] = place[k];
            in.turned[3 * v + k] = length > 0.0f ? normal[k] / length : n[k];
        }
    }
}

struct Point {
    double x[3];
};

inline double dot(const Point& a, const Point& b) {
    return (a.x[0] * b.x[0] + a.x[1] * b.x[1]) + a.x[2] * b.x[2];
}

inline Point minus(const Point& a, const Point& b) {
    return {{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
}

void move_cluster(const MovedClusters& in, Cluster& cluster) {
    const uint32_t* from = in.indices + cluster.first_index;
    const auto corner = [&](int64_t k) {
        const float* p = in.corners + 3 * int64_t{from[k]};
        return Point{{p[0], p[1], p[2]}};
    };
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
    for (int64_t k = 0; k < cluster.index_count; k++) {
        const Point p = corner(k);
        for (int j = 0; j < 3; j++) {
            if (p.x[j] < low[j]) low[j] = p.x[j];
            if (p.x[j] > high[j]) high[j] = p.x[j];
        }
    }
    Point middle;
    for (int j = 0; j < 3; j++) middle.x[j] = cluster.centre[j] = 0.5 * (low[j] + high[j]);
    double farthest = 0.0;
    for (int64_t k = 0; k < cluster.index_count; k++) {
        const Point away = minus(corner(k), middle);
        const double square = dot(away, away);
        if (square > farthest) farthest = square;
    }
    cluster.radius = std::sqrt(farthest);
    const auto area_of = [&](int64_t k) {
        const Point a = corner(k), b = minus(corner(k + 1), a), c = minus(corner(k + 2), a);
        return Point{{b.x[1] * c.x[2] - b.x[2] * c.x[1], b.x[2] * c.x[0] - b.x[0] * c.x[2],
                      b.x[0] * c.x[1] - b.x[1] * c.x[0]}};
    };
    Point axis{{0.0, 0.0, 0.0}};
    for (int64_t k = 0; k + 2 < cluster.index_count; k += 3) {
        const Point area = area_of(k);
        for (int j = 0; j < 3; j++) axis.x[j] += area.x[j];
    }
    const double length = std::sqrt(dot(axis, axis));
    cluster.cosine = -1.0;
    for (int j = 0; j < 3; j++) cluster.axis[j] = length > 0.0 ? axis.x[j] / length : 0.0;
    if (!(length > 0.0)) return;
    double least = 1.0;
    for (int64_t k = 0; k + 2 < cluster.index_count; k += 3) {
        const Point area = area_of(k);
        const double size = std::sqrt(dot(area, area));
        if (!(size > 0.0)) continue;
        const double along = ((area.x[0] * cluster.axis[0] + area.x[1] * cluster.axis[1]) +
                              area.x[2] * cluster.axis[2]) /
                             size;
        if (along < least) least = along;
    }
    cluster.cosine = least;
}

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

// Where a neighbour was found; 0 for what is rigid.
struct Found {
    int32_t row = 0, leaf = -1;
};

// `leaf` becomes where the point is; it is looked for first where its neighbours were found.
void find_pixel(const SurfacePoints& in, int64_t at, int64_t row, const int32_t* near_leaves,
                int64_t near_count, int32_t& leaf) {
    const RayShape& shape = in.shapes[row];
    const double* scale = in.scales + 3 * row;
    float* found = in.found + 3 * at;
    Point p;
    bool known = shape.count > 0;
    for (int k = 0; k < 3; k++) {
        p.x[k] = static_cast<double>(in.points[3 * at + k]) / scale[k];
        known = known && p.x[k] - p.x[k] == 0.0;
    }
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
    if (!near) {
        for (int k = 0; k < 3; k++) found[k] = NOT_A_NUMBER;
        return;
    }
    const auto* addresses = reinterpret_cast<const double* const*>(in.targets);
    const double* targets = addresses[2 * row];
    const double* present = addresses[2 * row + 1];
    const int64_t first = 9 * int64_t{best.triangle};
    for (int k = 0; k < 3; k++) {
        double sum = 0.0;
        for (int j = 0; j < 3; j++) {
            const int64_t place = first + 3 * j + k;
            const double from = in.relative != 0 ? present[place] : 0.0;
            sum += best.weights[j] * (targets[place] - from);
        }
        found[k] = static_cast<float>(sum * scale[k]);
    }
}

}  // namespace
}  // namespace sailenv

// Linear blend skinning.
SAILENV_KERNEL(skin_vertices)(int64_t threads, const Skin* given) {
    using namespace sailenv;
    const Skin in = *given;
    if (in.count < 0 || in.bone_count < 1 || in.bone_count > 4096) return STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < 4 * in.count; k++) {
        if (in.bones[k] >= in.bone_count) return STATUS_INVALID_ARGUMENT;
    }
    Columns bones[4096];
    for (int64_t b = 0; b < in.bone_count; b++) {
        const double* m = in.matrices + 12 * b;
        for (int j = 0; j < 4; j++) {
            bones[b].c[j] = f4{static_cast<float>(m[j]), static_cast<float>(m[4 + j]),
                               static_cast<float>(m[8 + j]), 0.0f};
        }
    }
    parallel_for(threads, in.count, TILE_VERTICES,
                 [&](int64_t begin, int64_t end, int64_t) { skin(in, bones, begin, end); });
    return STATUS_OK;
}

// Spheres and cones of clusters whose corners have moved.
SAILENV_KERNEL(move_clusters)(int64_t, const MovedClusters* given) {
    using namespace sailenv;
    const MovedClusters in = *given;
    for (int64_t k = 0; k < in.count; k++) {
        const Cluster& cluster = in.clusters[k];
        const int64_t begin = cluster.first_index, size = cluster.index_count;
        if (begin < 0 || size < 0 || begin > in.index_count - size) return STATUS_INVALID_ARGUMENT;
    }
    for (int64_t k = 0; k < in.index_count; k++) {
        if (in.indices[k] >= in.corner_count) return STATUS_INVALID_ARGUMENT;
    }
    for (int64_t k = 0; k < in.count; k++) {
        if (in.clusters[k].index_count > 0) move_cluster(in, in.clusters[k]);
    }
    return STATUS_OK;
}

// Where the surface points of a picture are when their triangles have other corners.
SAILENV_KERNEL(surface_points)(int64_t threads, const SurfacePoints* given) {
    using namespace sailenv;
    const SurfacePoints in = *given;
    if (in.height < 0 || in.width < 0 || in.rows < 0) return STATUS_INVALID_ARGUMENT;
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
