// What rays meet: exactly, in doubles, for ground truth, and in floats for light.
#include "rays.h"

#include <cmath>
#include <limits>

#include "../threads.h"
#include "record.h"

// At instances of models, with a tree over the instances.
#define CAST_RAYS_FIELDS(FIELD)                                                    \
    FIELD(const sailenv::TreeNode*, nodes)                                         \
    FIELD(const int32_t*, order)            /* instances in the order of leaves */ \
    FIELD(const double*, model_from_world)  /* (I, 3, 4) */                        \
    FIELD(const int32_t*, models)           /* (I,): of each instance */           \
    FIELD(const sailenv::RayShape*, shapes) /* with triangles in doubles */        \
    FIELD(int64_t, instances)                                                      \
    FIELD(const double*, origins)    /* (R, 3) */                                  \
    FIELD(const double*, directions) /* (R, 3) */                                  \
    FIELD(const double*, nearest)    /* (R,): only what lies farther is met */     \
    FIELD(double*, distance)         /* (R,); inf for nothing */                   \
    FIELD(int32_t*, instance)        /* (R,); -1 for none */                       \
    FIELD(int64_t*, triangle)        /* (R,); -1 for none */                       \
    FIELD(double*, weights)          /* (R, 2): of the second and third corner */  \
    FIELD(int64_t, count)

SAILENV_RECORD(CastRays, cast_rays, CAST_RAYS_FIELDS)

// At everything that light meets, as one shape of triangles in floats.
#define MEET_LIGHT_RAYS_FIELDS(FIELD)                           \
    FIELD(const sailenv::RayShape*, solid)                      \
    FIELD(const float*, origins)    /* (R, 3) */                \
    FIELD(const float*, directions) /* (R, 3) */                \
    FIELD(int32_t*, triangle)       /* (R,); -1 for none */     \
    FIELD(float*, distance)         /* (R,) */                  \
    FIELD(float*, second)           /* (R,): corner's weight */ \
    FIELD(float*, third)            /* (R,) */                  \
    FIELD(int64_t, count)

SAILENV_RECORD(MeetLightRays, meet_light_rays, MEET_LIGHT_RAYS_FIELDS)

#define PASS_LIGHT_RAYS_FIELDS(FIELD)                                                        \
    FIELD(const sailenv::RayShape*, solid) /* or null: nothing solid is in the way */        \
    FIELD(const sailenv::RayShape*, glass)                                                   \
    FIELD(const float*, passes)     /* (leaves, WIDTH): share that each pane lets through */ \
    FIELD(const float*, origins)    /* (R, 3) */                                             \
    FIELD(const float*, directions) /* (R, 3) */                                             \
    FIELD(const float*, lengths)    /* (R,), in lengths of the directions */                 \
    FIELD(float*, share)            /* (R,) */                                               \
    FIELD(int64_t, count)

SAILENV_RECORD(PassLightRays, pass_light_rays, PASS_LIGHT_RAYS_FIELDS)

namespace sailenv {
namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double EDGE = 1e-9;  // how far beside a triangle its edge still counts as met
constexpr int64_t TILE_RAYS = 64;

struct ExactHit {
    double distance = INFINITE, second = 0.0, third = 0.0;
    int64_t instance = -1, triangle = -1;
};

// A ray in doubles, and as boxes are held against it: in lengths of `length`, which is 0 where
// nothing can be met.
struct ExactRay {
    double o[3], d[3], length;
    BoxRay boxes;
    float begin;
};

ExactRay exact_ray(const double* o, const double* d, double nearest) {
    ExactRay r{};
    double scale = 0.0, reach = 0.0;
    for (int k = 0; k < 3; k++) {
        r.o[k] = o[k];
        r.d[k] = d[k];
        scale = std::fmax(scale, std::fabs(d[k]));
        reach = std::fmax(reach, std::fabs(o[k]));
    }
    if (!(scale > 0.0 && scale < INFINITE && reach < 1e30)) return r;
    float near[3], along[3];
    double sum = 0.0;
    for (int k = 0; k < 3; k++) sum += (d[k] / scale) * (d[k] / scale);
    r.length = scale * std::sqrt(sum);
    for (int k = 0; k < 3; k++) {
        near[k] = static_cast<float>(o[k]);
        along[k] = static_cast<float>(d[k] / r.length);
    }
    r.boxes = box_ray(near, along, static_cast<float>(1.3e-7 * reach + 1e-30));
    r.begin = static_cast<float>(std::fmin(nearest * r.length * (1.0 - 1e-6), 1e30));
    return r;
}

// The farthest that a ray need be followed, in the lengths of its boxes.
float end_of(const ExactRay& r, const ExactHit& hit) {
    const double end = hit.distance * r.length * (1.0 + 1e-6);
    return end < 1e30 ? static_cast<float>(end) : ENDLESS;
}

// Which triangle is met does not depend on the tree: of equal distances the lower instance and the
// lower triangle win.
void cast_at_shape(const RayShape& s, const ExactRay& r, double nearest, int64_t instance,
                   ExactHit& hit) {
    if (s.count == 0 || !(r.length > 0.0)) return;
    walk_tree<true>(s.nodes, r.boxes, r.begin, end_of(r, hit), [&](int32_t leaf, float) {
        const double* from = static_cast<const double*>(s.triangles) + 9 * WIDTH * int64_t{leaf};
        for (int half = 0; half < WIDTH; half += 4) {
            d4 t[9];
            for (int k = 0; k < 9; k++) memcpy(&t[k], from + WIDTH * k + half, sizeof t[k]);
            const Intersection<d4> x = intersect_triangle(t, r.o, r.d);
            for (int k = 0; k < 4; k++) {
                const int64_t slot = WIDTH * int64_t{leaf} + half + k;
                // The side that a ray meets is the same in the model's own frame.
                if (!(x.determinant[k] > 0.0 ||
                      (s.two_sided[slot] != 0 && x.determinant[k] < 0.0))) {
                    continue;
                }
                const double second = x.second[k] / x.determinant[k];
                const double third = x.third[k] / x.determinant[k];
                if (!(second >= -EDGE && second <= 1.0 + EDGE)) continue;
                if (!(third >= -EDGE && second + third <= 1.0 + EDGE)) continue;
                const double distance = x.distance[k] / x.determinant[k];
                if (!(distance > nearest) || distance > hit.distance) continue;
                const int64_t triangle = s.first_triangle + s.order[slot];
                if (distance == hit.distance &&
                    (instance > hit.instance ||
                     (instance == hit.instance && triangle >= hit.triangle))) {
                    continue;
                }
                hit = {distance, second, third, instance, triangle};
            }
        }
        return end_of(r, hit);
    });
}

}  // namespace
}  // namespace sailenv

SAILENV_KERNEL(cast_rays)(int64_t threads, const CastRays* given) {
    using namespace sailenv;
    const CastRays& in = *given;
    if (in.count < 0 || in.instances < 0) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, in.count, TILE_RAYS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const double nearest = in.nearest[k];
            const ExactRay world = exact_ray(in.origins + 3 * k, in.directions + 3 * k, nearest);
            ExactHit hit;
            const auto cast = [&](int32_t leaf, float) {
                const int64_t instance = in.order[leaf];
                const double* m = in.model_from_world + 12 * instance;
                double o[3], d[3];
                for (int axis = 0; axis < 3; axis++) {
                    const double* r = m + 4 * axis;
                    o[axis] = r[0] * world.o[0] + r[1] * world.o[1] + r[2] * world.o[2] + r[3];
                    d[axis] = r[0] * world.d[0] + r[1] * world.d[1] + r[2] * world.d[2];
                }
                cast_at_shape(in.shapes[in.models[instance]], exact_ray(o, d, nearest), nearest,
                              instance, hit);
                return end_of(world, hit);
            };
            if (in.instances > 0 && world.length > 0.0) {
                walk_tree<true>(in.nodes, world.boxes, world.begin, ENDLESS, cast);
            }
            in.distance[k] = hit.distance;
            in.instance[k] = static_cast<int32_t>(hit.instance);
            in.triangle[k] = hit.triangle;
            in.weights[2 * k] = hit.second;
            in.weights[2 * k + 1] = hit.third;
        }
    });
    return STATUS_OK;
}

// What solid triangles light meets first.
SAILENV_KERNEL(meet_light_rays)(int64_t threads, const MeetLightRays* given) {
    using namespace sailenv;
    const MeetLightRays& in = *given;
    if (in.count < 0) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, in.count, TILE_RAYS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            Hit hit;
            meet_shape(*in.solid, ray_of(in.origins + 3 * k, in.directions + 3 * k, 0.0f), false,
                       hit);
            in.triangle[k] = hit.triangle < 0 ? -1 : in.solid->order[hit.triangle];
            in.distance[k] = hit.t;
            in.second[k] = hit.second;
            in.third[k] = hit.third;
        }
    });
    return STATUS_OK;
}

// The share of light that is let through before `lengths`.
SAILENV_KERNEL(pass_light_rays)(int64_t threads, const PassLightRays* given) {
    using namespace sailenv;
    const PassLightRays& in = *given;
    if (in.count < 0) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, in.count, TILE_RAYS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const Ray r = ray_of(in.origins + 3 * k, in.directions + 3 * k, 0.0f);
            if (in.solid != nullptr && shape_occludes(*in.solid, r, in.lengths[k])) {
                in.share[k] = 0.0f;
            } else {
                in.share[k] = glass_transmittance(*in.glass, in.passes, r, in.lengths[k]);
            }
        }
    });
    return STATUS_OK;
}
