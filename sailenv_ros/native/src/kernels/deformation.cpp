// Surfaces whose vertices move: skinning, and meshes and clusters of triangles as they lie now; see
// native/deformation_kernels.py.
#include <cmath>
#include <cstring>

#include "../threads.h"
#include "mesh_clusters.h"
#include "point.h"
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

#define SPHERE_FIELDS(FIELD)                            \
    FIELD(int64_t, count)                               \
    FIELD(int64_t, stride)       /* numbers of a row */ \
    FIELD(const float*, columns) /* (3, stride) */      \
    FIELD(double*, sphere)       /* (4,) */

SAILENV_RECORD(BoundedCorners, bounding_sphere, SPHERE_FIELDS)

#define MESH_FIELDS(FIELD)                                                    \
    FIELD(int64_t, vertex_count)                                              \
    FIELD(int64_t, corner_count)                                              \
    FIELD(int64_t, stride) /* numbers of a row of corners */                  \
    FIELD(int64_t, index_count)                                               \
    FIELD(int64_t, cluster_count)                                             \
    FIELD(const float*, positions)  /* (V, 3) */                              \
    FIELD(const float*, normals)    /* (V, 3) */                              \
    FIELD(const uint32_t*, sources) /* (K,): a vertex of each corner */       \
    FIELD(const uint32_t*, indices) /* (3 M,): of corners */                  \
    FIELD(float*, columns)          /* (3, stride): takes the corners */      \
    FIELD(float*, vertices)         /* (V, 8): takes the normals, in front */ \
    FIELD(sailenv::Cluster*, clusters)                                        \
    FIELD(double*, sphere) /* (4,): takes what `bounding_sphere` returns */

SAILENV_RECORD(MovedMesh, move_mesh, MESH_FIELDS)

namespace sailenv {
namespace {

constexpr int64_t TILE_VERTICES = 2048;

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

// Whether the indices of all clusters are there, and the corners that they name.
bool are_clusters(const Cluster* clusters, int64_t count, const uint32_t* indices,
                  int64_t index_count, int64_t corner_count) {
    for (int64_t k = 0; k < count; k++) {
        const int64_t begin = clusters[k].first_index, size = clusters[k].index_count;
        if (begin < 0 || size < 0 || begin > index_count - size) return false;
        if (size > 3 * CLUSTER_TRIANGLES) return false;
    }
    for (int64_t k = 0; k < index_count; k++) {
        if (indices[k] >= corner_count) return false;
    }
    return true;
}

// A sphere around corners: its centre, and a radius that is enough in single precision, too.
void bound(const float* columns, int64_t stride, int64_t count, double* sphere) {
    for (int k = 0; k < 4; k++) sphere[k] = 0.0;
    if (count == 0) return;
    for (int axis = 0; axis < 3; axis++) {
        const float* column = columns + axis * stride;
        float low = column[0], high = column[0];
        for (int64_t k = 1; k < count; k++) {
            low = column[k] < low ? column[k] : low;
            high = column[k] > high ? column[k] : high;
        }
        sphere[axis] = 0.5 * (static_cast<double>(low) + high);
    }
    double farthest = 0.0;
    for (int64_t k = 0; k < count; k++) {
        double square = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            const double away = columns[axis * stride + k] - sphere[axis];
            square += away * away;
        }
        farthest = square > farthest ? square : farthest;
    }
    sphere[3] = 1.0001 * std::sqrt(farthest) + 1e-6;
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
    if (!are_clusters(in.clusters, in.count, in.indices, in.index_count, in.corner_count)) {
        return STATUS_INVALID_ARGUMENT;
    }
    const auto corner_of = [&in](uint32_t k) { return vertex_at(in.corners, k); };
    for (int64_t k = 0; k < in.count; k++) {
        if (in.clusters[k].index_count > 0) move_cluster(corner_of, in.indices, in.clusters[k]);
    }
    return STATUS_OK;
}

// A sphere around corners.
SAILENV_KERNEL(bounding_sphere)(int64_t, const BoundedCorners* given) {
    using namespace sailenv;
    if (given->count < 0 || given->stride < given->count) return STATUS_INVALID_ARGUMENT;
    bound(given->columns, given->stride, given->count, given->sphere);
    return STATUS_OK;
}

// A mesh takes the vertices of an instant.
SAILENV_KERNEL(move_mesh)(int64_t, const MovedMesh* given) {
    using namespace sailenv;
    const MovedMesh in = *given;
    if (in.vertex_count < 0 || in.corner_count < 0 || in.stride < in.corner_count) {
        return STATUS_INVALID_ARGUMENT;
    }
    if (!are_clusters(in.clusters, in.cluster_count, in.indices, in.index_count, in.corner_count)) {
        return STATUS_INVALID_ARGUMENT;
    }
    for (int64_t k = 0; k < in.corner_count; k++) {
        if (in.sources[k] >= in.vertex_count) return STATUS_INVALID_ARGUMENT;
        const float* from = in.positions + 3 * static_cast<int64_t>(in.sources[k]);
        for (int axis = 0; axis < 3; axis++) in.columns[axis * in.stride + k] = from[axis];
    }
    for (int64_t v = 0; v < in.vertex_count; v++) {
        memcpy(in.vertices + 8 * v, in.normals + 3 * v, 3 * sizeof(float));
    }
    const float *x = in.columns, *y = x + in.stride, *z = y + in.stride;
    const auto corner_of = [x, y, z](uint32_t k) { return Point{{x[k], y[k], z[k]}}; };
    for (int64_t k = 0; k < in.cluster_count; k++) {
        if (in.clusters[k].index_count > 0) move_cluster(corner_of, in.indices, in.clusters[k]);
    }
    bound(in.columns, in.stride, in.corner_count, in.sphere);
    return STATUS_OK;
}
