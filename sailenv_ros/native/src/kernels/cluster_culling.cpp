// The indices of the triangles that an eye may see; see native/cluster_kernels.py.
#include "cluster_culling.h"

#include <algorithm>

#include "../abi.h"

namespace sailenv {
namespace {

// What is asked of the parts of a scene; mirrored in native/cluster_kernels.py.
struct ClusterQuery {
    const int64_t* parts;  // (count,), in the order in which their triangles are wanted
    const Cluster* clusters;
    const int64_t* ranges;           // (part_count, 3): first cluster, clusters, indices
    const double* sides;             // (part_count, 4, 4): planes that look inwards
    const double* eyes;              // (part_count, 3)
    const uint8_t* one_sided;        // (part_count,)
    const uint8_t* by_corner;        // (part_count,): the second of the two lists of indices
    const uint32_t* indices;         // (index_count,)
    const uint32_t* corner_indices;  // (index_count,)
    int64_t count, part_count, cluster_count, index_count;
};

}  // namespace
}  // namespace sailenv

// Result: seen: (room,), the indices; lies: (part_count, 2), first index and number of indices of
// each part in it; made: how many there are in all.
SAILENV_KERNEL(seen_indices)
(const sailenv::ClusterQuery* query, int64_t room, uint32_t* seen, int64_t* lies, int64_t* made) {
    using namespace sailenv;
    const ClusterQuery& q = *query;
    int64_t count = 0;
    for (int64_t k = 0; k < q.count; k++) {
        const int64_t part = q.parts[k], begun = count;
        if (part < 0 || part >= q.part_count) return STATUS_INVALID_ARGUMENT;
        const int64_t first = q.ranges[3 * part], last = first + q.ranges[3 * part + 1];
        if (first < 0 || last > q.cluster_count) return STATUS_INVALID_ARGUMENT;
        const uint32_t* source = q.by_corner[part] != 0 ? q.corner_indices : q.indices;
        for (int64_t number = first; number < last; number++) {
            const Cluster& cluster = q.clusters[number];
            if (is_beyond(cluster.centre, cluster.radius, q.sides + 16 * part)) continue;
            if (q.one_sided[part] != 0 && faces_away(cluster, q.eyes + 3 * part)) continue;
            const int64_t begin = cluster.first_index, size = cluster.index_count;
            if (begin < 0 || size < 0 || begin > q.index_count - size || count > room - size) {
                return STATUS_INVALID_ARGUMENT;
            }
            std::copy_n(source + begin, size, seen + count);
            count += size;
        }
        lies[2 * part] = begun;
        lies[2 * part + 1] = count - begun;
    }
    *made = count;
    return STATUS_OK;
}
