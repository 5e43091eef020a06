// Clusters: small groups of neighbouring triangles that face alike. Drawing brings every corner of
// a cluster to the screen before it finds that its triangle faces away; asking a cluster first
// costs as much as a corner. See native/mesh_kernels.py.
#include "mesh_clusters.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <vector>

#include "../abi.h"
#include "record.h"

#define ORDERED_TRIANGLES_FIELDS(FIELD)                                   \
    FIELD(int64_t, vertex_count)                                          \
    FIELD(int64_t, triangle_count)                                        \
    FIELD(int64_t, room)               /* for so many clusters */         \
    FIELD(const float*, positions)     /* (V, 3) */                       \
    FIELD(const uint32_t*, triangles)  /* (M, 3) */                       \
    FIELD(uint32_t*, ordered)          /* (M, 3): the same, by cluster */ \
    FIELD(sailenv::Cluster*, clusters) /* (room,) */                      \
    FIELD(int64_t*, made)              /* (1,): how many clusters */

SAILENV_RECORD(OrderedTriangles, order_triangles, ORDERED_TRIANGLES_FIELDS)

#define NUMBERED_CORNERS_FIELDS(FIELD)                                 \
    FIELD(int64_t, vertex_count)                                       \
    FIELD(int64_t, index_count)                                        \
    FIELD(int64_t, room)            /* for so many corners */          \
    FIELD(const float*, positions)  /* (V, 3) */                       \
    FIELD(const uint32_t*, indices) /* (3 M,): of vertices */          \
    FIELD(float*, corners)          /* (room, 3): places, each once */ \
    FIELD(uint32_t*, numbers)       /* (3 M,): of corners */           \
    FIELD(int64_t*, made)           /* (1,): how many corners */

SAILENV_RECORD(NumberedCorners, number_corners, NUMBERED_CORNERS_FIELDS)

namespace sailenv {
namespace {

constexpr int64_t MOST_TRIANGLES = int64_t{1} << 31;
constexpr double CELLS = 1024.0;  // of Morton's curve, along each side

bool are_vertices(const uint32_t* indices, int64_t count, int64_t vertex_count) {
    for (int64_t k = 0; k < count; k++) {
        if (indices[k] >= vertex_count) return false;
    }
    return true;
}

Point centroid(const float* positions, const uint32_t* corners) {
    Point sum = vertex_at(positions, corners[0]);
    for (int k = 1; k < 3; k++) {
        const Point p = vertex_at(positions, corners[k]);
        for (int j = 0; j < 3; j++) sum.x[j] += p.x[j];
    }
    for (double& x : sum.x) x /= 3.0;
    return sum;
}

// Which of the six sides of a cube a triangle faces; the first one if it has no area.
uint64_t side_of(const float* positions, const uint32_t* corners) {
    const Point a = vertex_at(positions, corners[0]);
    const Point b = minus(vertex_at(positions, corners[1]), a);
    const Point c = minus(vertex_at(positions, corners[2]), a);
    Point n = {{b.x[1] * c.x[2] - b.x[2] * c.x[1], b.x[2] * c.x[0] - b.x[0] * c.x[2],
                b.x[0] * c.x[1] - b.x[1] * c.x[0]}};
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0.0)) return 0;
    // Sides that a triangle faces alike must not be chosen by how large it is.
    for (double& x : n.x) x /= length;
    size_t axis = 0;
    for (size_t j = 1; j < 3; j++) {
        if (std::fabs(n.x[j]) > std::fabs(n.x[axis])) axis = j;
    }
    return 2 * axis + (n.x[axis] < 0.0 ? 1 : 0);
}

// The bits of a cell's number, with two empty places after each: those of the other axes go there.
uint64_t spread(uint64_t cell) {
    cell = (cell | cell << 16) & 0x030000FF;
    cell = (cell | cell << 8) & 0x0300F00F;
    cell = (cell | cell << 4) & 0x030C30C3;
    return (cell | cell << 2) & 0x09249249;
}

uint64_t cell_of(double x) {
    return x > 0.0 ? static_cast<uint64_t>(std::min(x * CELLS, CELLS - 1.0)) : 0;
}

// Sorted by them, triangles of one side are beside each other, and of these neighbours in space: a
// side, a place on Morton's curve through the box of the middles, and the triangle's number.
std::vector<uint64_t> sorting_keys(const OrderedTriangles& in) {
    std::vector<Point> middles(static_cast<size_t>(in.triangle_count));
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
    for (int64_t t = 0; t < in.triangle_count; t++) {
        const Point p = centroid(in.positions, in.triangles + 3 * t);
        middles[static_cast<size_t>(t)] = p;
        for (int j = 0; j < 3; j++) {
            low[j] = std::min(low[j], p.x[j]);
            high[j] = std::max(high[j], p.x[j]);
        }
    }
    double size = 1e-12;
    for (int j = 0; j < 3; j++) size = std::max(size, high[j] - low[j]);
    std::vector<uint64_t> keys(middles.size());
    for (size_t t = 0; t < keys.size(); t++) {
        uint64_t place = 0;
        for (int j = 0; j < 3; j++)
            place |= spread(cell_of((middles[t].x[j] - low[j]) / size)) << j;
        keys[t] = side_of(in.positions, in.triangles + 3 * t) << 61 | place << 31 | t;
    }
    std::sort(keys.begin(), keys.end());
    return keys;
}

// Numbers of places that are met one after the other, each place once.
class Places {
public:
    explicit Places(int64_t most) {
        size_t size = 16;
        while (size < 2 * static_cast<size_t>(most)) size *= 2;
        slots_.assign(size, NONE);
    }

    // The number of a place; that of `next` if it has not been met. `corners` holds those met.
    uint32_t number_of(const float* place, const float* corners, uint32_t next) {
        uint32_t bits[3], other[3];
        memcpy(bits, place, sizeof bits);
        uint64_t hash = bits[0] * 0x9E3779B97F4A7C15u;
        hash = (hash ^ hash >> 29 ^ bits[1]) * 0xBF58476D1CE4E5B9u;
        hash = (hash ^ hash >> 32 ^ bits[2]) * 0x94D049BB133111EBu;
        size_t slot = (hash ^ hash >> 31) & (slots_.size() - 1);
        while (slots_[slot] != NONE) {
            memcpy(other, corners + 3 * static_cast<int64_t>(slots_[slot]), sizeof other);
            if (std::equal(bits, bits + 3, other)) return slots_[slot];
            slot = (slot + 1) & (slots_.size() - 1);
        }
        return slots_[slot] = next;
    }

    static constexpr uint32_t NONE = ~0u;

private:
    std::vector<uint32_t> slots_;
};

}  // namespace
}  // namespace sailenv

// Orders a mesh's triangles by cluster.
SAILENV_KERNEL(order_triangles)(int64_t, const OrderedTriangles* given) {
    using namespace sailenv;
    const OrderedTriangles in = *given;
    if (in.vertex_count < 0 || in.triangle_count < 0 || in.triangle_count >= MOST_TRIANGLES ||
        !are_vertices(in.triangles, 3 * in.triangle_count, in.vertex_count)) {
        return STATUS_INVALID_ARGUMENT;
    }
    const auto corner_of = [&in](uint32_t k) { return vertex_at(in.positions, k); };
    int64_t made = 0;
    try {
        const std::vector<uint64_t> keys = sorting_keys(in);
        for (size_t k = 0; k < keys.size(); k++) {
            const uint64_t number = keys[k] & (static_cast<uint64_t>(MOST_TRIANGLES) - 1);
            memcpy(in.ordered + 3 * k, in.triangles + 3 * number, 3 * sizeof(uint32_t));
            Cluster* last = made > 0 ? in.clusters + made - 1 : nullptr;
            const bool other_side = k == 0 || keys[k] >> 61 != keys[k - 1] >> 61;
            if (other_side || last->index_count == 3 * CLUSTER_TRIANGLES) {
                if (made == in.room) return STATUS_INVALID_ARGUMENT;
                last = in.clusters + made++;
                last->first_index = 3 * static_cast<int64_t>(k);
                last->index_count = 0;
            }
            last->index_count += 3;
        }
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    for (int64_t k = 0; k < made; k++) move_cluster(corner_of, in.ordered, in.clusters[k]);
    *in.made = made;
    return STATUS_OK;
}

// Gives each place that indices use a number, in the order in which they do.
SAILENV_KERNEL(number_corners)(int64_t, const NumberedCorners* given) {
    using namespace sailenv;
    const NumberedCorners in = *given;
    if (in.vertex_count < 0 || in.index_count < 0 ||
        !are_vertices(in.indices, in.index_count, in.vertex_count)) {
        return STATUS_INVALID_ARGUMENT;
    }
    uint32_t made = 0;
    try {
        std::vector<uint32_t> known(static_cast<size_t>(in.vertex_count), Places::NONE);
        Places places(in.room);
        for (int64_t k = 0; k < in.index_count; k++) {
            uint32_t& number = known[in.indices[k]];
            if (number == Places::NONE) {
                const float* place = in.positions + 3 * static_cast<int64_t>(in.indices[k]);
                number = places.number_of(place, in.corners, made);
                if (number == made) {
                    if (made >= in.room) return STATUS_INVALID_ARGUMENT;
                    memcpy(in.corners + 3 * static_cast<int64_t>(made++), place, 3 * sizeof(float));
                }
            }
            in.numbers[k] = number;
        }
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    *in.made = made;
    return STATUS_OK;
}
