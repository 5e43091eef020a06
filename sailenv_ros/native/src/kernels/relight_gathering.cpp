// What changes of light at patches, texels and points in the air; see relight/relighting.py.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "../abi.h"
#include "../threads.h"
#include "emitter_cones.h"
#include "light_changes.h"
#include "relight_types.h"
#include "sky_picture.h"

namespace sailenv {
namespace {

constexpr float FAR_M = 2.0f;  // what is farther is as good as endless

// A point that something which changes covers: it takes so much of the view, so near.
constexpr double COVERED = 0.95;
constexpr float COVERED_M = 0.015f;

// Rays from a point into the cone of each emitter: one for EACH of those in all directions, at
// most.
constexpr int64_t EACH = 16, MOST_EMITTER_RAYS = 8;

// An object takes light from surfaces nearer than this many of its radii.
constexpr float OWN_REACH = 2.0f;

// How much each of six sides of a body counts, where a ray meets a triangle: by the squares of the
// normal's parts along the body's axes (see `irradiance_of_terms`).
struct SideShares {
    float share[3];
    int32_t side[3];
};
SideShares side_shares(const Hit& hit, const Ray& world) {
    const Ray r = in_body(*hit.instance, world);
    const vec3 normal = triangle_normal(*hit.instance->shape, hit.triangle);
    const float square = std::max(dot(normal, normal), 1e-30f);
    const bool away = dot(normal, vec3(r.d[0], r.d[1], r.d[2])) > 0.0f;
    SideShares shares;
    for (int k = 0; k < 3; k++) {
        const float part = (&normal.x)[k];
        shares.share[k] = part * part / square;
        shares.side[k] = (part < 0.0f) != away ? k + 3 : k;
    }
    return shares;
}

// Adds what a ray sees, times `weight`, to `sum`; false if that is the back of a surface.
bool add_seen(const RayScene& s, const Hit& hit, const Ray& r, const float* table, float weight,
              float* sum) {
    if (hit.triangle < 0) {
        const float share = weight * glass_transmittance(s, r);
        double sky[3];
        picture_radiance(s.sky, s.sky_height, s.sky_width, r.d, sky);
        for (int c = 0; c < 3; c++) sum[c] += share * static_cast<float>(sky[c]);
        return true;
    }
    if (!hit.front) return false;
    const RayInstance& i = *hit.instance;
    if (!i.has_chart || i.shape->places == nullptr) {
        const SideShares shares = side_shares(hit, r);
        for (int k = 0; k < 3; k++) {
            const float* radiance = i.radiance + shares.side[k] * s.channels;
            const float share = weight * shares.share[k];
            for (int c = 0; c < s.channels; c++) sum[c] += share * radiance[c];
        }
        return true;
    }
    const float* p = i.shape->places + 6 * static_cast<int64_t>(hit.triangle);
    const float first = 1.0f - hit.second - hit.third;
    const float u = i.chart[0] + i.chart[2] * (first * p[0] + hit.second * p[2] + hit.third * p[4]);
    const float v = i.chart[1] + i.chart[3] * (first * p[1] + hit.second * p[3] + hit.third * p[5]);
    const int32_t x = std::min(std::max(static_cast<int32_t>(u * s.width), 0), s.width - 1);
    const int32_t y = std::min(std::max(static_cast<int32_t>(v * s.height), 0), s.height - 1);
    const int32_t patch = s.patches[static_cast<int64_t>(y) * s.width + x];
    if (patch < 0 || patch >= s.patch_count) return true;
    const float* radiance = table + static_cast<int64_t>(patch) * s.channels;
    for (int c = 0; c < s.channels; c++) sum[c] += weight * radiance[c];
    return true;
}

// The largest share of a hemisphere that something may take, seen from a point, or from one so far
// beside it.
float reach_of(const RayInstance& i, const float* p, const float* n, float beside) {
    const float* ball = i.sphere;
    const float to[3] = {ball[0] - p[0], ball[1] - p[1], ball[2] - p[2]};
    if (dot(to, n) < -ball[3]) return 0.0f;
    const float away = std::max(std::sqrt(dot(to, to)) - beside, 0.0f);
    return ball[3] * ball[3] / std::max(away * away, 1e-6f);
}

// The largest share of a hemisphere that things which change may take, seen from a point, or from
// one so far beside it.
float reach(const RayScene& s, const float* p, const float* n, float beside) {
    float most = 0.0f;
    for (int64_t k = 0; k < s.changed_count; k++) {
        most = std::max(most, reach_of(s.changed[k], p, n, beside));
    }
    return most;
}

// Which things that change may take a share of the view of more than `least` each.
SeenChanges seen_changes(const RayScene& s, const float* p, const float* n, float least) {
    SeenChanges seen;
    for (int64_t k = 0; k < s.changed_count; k++) {
        if (reach_of(s.changed[k], p, n, 0.0f) > least) seen.add(s.changed[k]);
    }
    return seen;
}

// What one patch gets by way of surfaces and from the sky.
struct Gathered {
    PatchState state;
    float nearness;
};

// A direction of a pattern about a normal, with the density of the cosine; the pattern is moved by
// random numbers of the point.
class CosineRays {
public:
    CosineRays(const float* p, const float* n, uint32_t number)
        : n_(n), turn_u_(scatter(2 * number)), turn_v_(scatter(2 * number + 1)) {
        for (int c = 0; c < 3; c++) origin_[c] = p[c] + n[c] * LIFT_M;
    }

    Ray ray(const float* point) const {
        float u, v, d[3];
        turned(point, &u, &v);
        cosine_direction(n_, u, v, d);
        return ray_of(origin_, d);
    }

    Ray along(const float* direction) const { return ray_of(origin_, direction); }

    // Into a cone instead.
    Ray ray_into(const EmitterCone& cone, const float* point) const {
        float u, v, d[3];
        turned(point, &u, &v);
        double towards[3];
        cone.direction(u, v, towards);
        for (int c = 0; c < 3; c++) d[c] = static_cast<float>(towards[c]);
        return ray_of(origin_, d);
    }

private:
    void turned(const float* point, float* u, float* v) const {
        *u = point[0] + turn_u_;
        *v = point[1] + turn_v_;
        *u -= std::floor(*u);
        *v -= std::floor(*v);
    }

    const float* n_;
    float turn_u_, turn_v_, origin_[3];
};

float nearness_of(float t) { return 1.0f / std::min(std::max(t, 1e-3f), FAR_M); }

// Whether a surface that a ray met gets light from one direction, by a random one of those that its
// irradiance comes from, past an object that was not there when its light was baked.
bool gets_light(const Ray& r, const Hit& hit, const RayInstance& past, uint32_t number) {
    const float* m = hit.instance->body_from_world;
    const vec3 own = triangle_normal(*hit.instance->shape, hit.triangle);
    const vec3 normal(own.x * m[0] + own.y * m[4] + own.z * m[8],
                      own.x * m[1] + own.y * m[5] + own.z * m[9],
                      own.x * m[2] + own.y * m[6] + own.z * m[10]);
    const float length = std::sqrt(std::max(dot(normal, normal), 1e-30f));
    const bool away = dot(normal, vec3(r.d[0], r.d[1], r.d[2])) > 0.0f;
    const float scale = (away ? -1.0f : 1.0f) / length;
    const float n[3] = {normal.x * scale, normal.y * scale, normal.z * scale};
    float from[3], d[3];
    for (int c = 0; c < 3; c++) from[c] = r.o[c] + r.d[c] * hit.t + n[c] * LIFT_M;
    cosine_direction(n, scatter(2 * number), scatter(2 * number + 1), d);
    return !instance_occludes(past, ray_of(from, d), 1e30f);
}

// Rays into the cone of each emitter: lamps are so small and bright that few rays in all directions
// meet them, each for far too much. Those of them that lie in a cone count less.
int64_t emitter_rays(const PatchQuery& q) {
    return std::min({std::max(q.rays / EACH, int64_t{1}), MOST_EMITTER_RAYS, q.shots});
}

// How much a ray counts of those of a point.
double share_of_ray(const RayScene& s, const float* p, const float* n, const Ray& r,
                    const PatchQuery& q) {
    const double density = cone_density(s.emitters, p, r.d);
    if (density == 0.0) return 1.0 / static_cast<double>(q.rays);
    return balanced(OVER_PI * dot(r.d, n), q.rays, emitter_rays(q), density);
}

// Calls with each ray of a point into a cone for which `wanted` holds.
template <class Wanted, class Use>
void for_emitter_rays(const RayScene& s, const CosineRays& rays, const float* p, const float* n,
                      const PatchQuery& q, const Wanted& wanted, const Use& use) {
    const int64_t shots = emitter_rays(q);
    for (int64_t e = 0; e < s.emitters.count; e++) {
        EmitterCone cone;
        if (!cone.about(s.emitters.balls + 4 * e, p) || !wanted(cone)) continue;
        for (int64_t m = 0; m < shots; m++) {
            const Ray r = rays.ray_into(cone, q.shot_pattern + 2 * m);
            if (dot(r.d, n) > 0.0f) use(r);
        }
    }
}

// All of the light.
Gathered gather_whole(const RayScene& s, const float* p, const float* n, const PatchQuery& q,
                      uint32_t number, float* sum) {
    const CosineRays rays(p, n, number);
    uint32_t next = number * static_cast<uint32_t>(2 * q.rays);
    double backs = 0.0, near = 0.0;
    const auto look = [&](const Ray& r) {
        const Hit hit = meet_after(s, r);
        const double share = share_of_ray(s, p, n, r, q);
        near += share * nearness_of(hit.t);
        next++;
        if (q.own != nullptr && hit.triangle >= 0 && hit.front &&
            hit.t < OWN_REACH * q.own->sphere[3] && !gets_light(r, hit, *q.own, next)) {
            return;
        }
        if (!add_seen(s, hit, r, s.after, static_cast<float>(share), sum)) backs += share;
    };
    for (int64_t m = 0; m < q.rays; m++) look(rays.ray(q.pattern + 2 * m));
    const auto always = [](const EmitterCone&) { return true; };
    for_emitter_rays(s, rays, p, n, q, always, look);
    const bool inside = backs > q.inside_share;
    return {inside ? PATCH_INSIDE : PATCH_WHOLE, static_cast<float>(1.0 / near)};
}

// The change; or all of the light, where little of what was baked is of use.
Gathered gather_difference(const RayScene& s, const SeenChanges& seen, const float* p,
                           const float* n, const PatchQuery& q, uint32_t number, float* sum) {
    const CosineRays rays(p, n, number);
    // Shares of all rays: that met a change, by nearness, and that saw a back.
    double changed = 0.0, near = 0.0, backs = 0.0;
    const auto look = [&](const Ray& r) {
        Hit before, after;
        if (!meet_both(s, seen, r, before, after)) return;
        const double share = share_of_ray(s, p, n, r, q);
        const float weight = static_cast<float>(share);
        changed += share;
        near += share * nearness_of(std::min(before.t, after.t));
        add_seen(s, before, r, s.before, -weight, sum);
        if (!add_seen(s, after, r, s.after, weight, sum)) backs += share;
    };
    for (int64_t m = 0; m < q.rays; m++) look(rays.ray(q.pattern + 2 * m));
    const auto reached = [&](const EmitterCone& cone) {
        return reach_into(seen, rays.along(cone.axis), cone.edge);
    };
    for_emitter_rays(s, rays, p, n, q, reached, look);
    if (changed > q.most_changed) {
        memset(sum, 0, static_cast<size_t>(s.channels) * sizeof(float));
        return gather_whole(s, p, n, q, number, sum);
    }
    if (changed == 0.0) return {PATCH_AS_IT_WAS, FAR_M};
    const float nearness = static_cast<float>(changed / near);
    const bool covered = changed > COVERED && nearness < COVERED_M;
    const bool inside = backs > q.inside_share;
    return {inside || covered ? PATCH_INSIDE : PATCH_CHANGED, nearness};
}

// Everything that is wanted of the k-th patch.
void gather_patch(const RayScene& s, const PatchQuery& q, int64_t k, const PatchChange& result) {
    const float *p = q.positions + 3 * k, *n = q.normals + 3 * k;
    float *bounced = result.bounced + k * s.channels, *direct = result.direct + k * q.light_count;
    std::fill_n(bounced, s.channels, 0.0f);
    std::fill_n(direct, q.light_count, 0.0f);
    result.found[k] = PATCH_AS_IT_WAS;
    result.nearness[k] = FAR_M;
    if (q.wanted[k] == PATCH_AS_IT_WAS) return;
    const uint32_t number = q.numbers[k];
    Gathered own = {PATCH_AS_IT_WAS, FAR_M};
    if (q.wanted[k] == PATCH_WHOLE) {
        own = gather_whole(s, p, n, q, number, bounced);
    } else {
        const SeenChanges seen = seen_changes(s, p, n, static_cast<float>(q.least));
        if (seen.count > 0) {
            own = gather_difference(s, seen, p, n, q, number, bounced);
        }
    }
    result.found[k] = own.state;
    result.nearness[k] = own.nearness;
    if (own.state == PATCH_INSIDE) return;
    const bool whole = own.state == PATCH_WHOLE;
    for (int64_t l = 0; l < q.light_count; l++) {
        const SeenChanges way = between(s, q.lights[l], p, n);
        if (!whole && way.count == 0) continue;
        const DirectLightDelta delta =
            direct_light_delta(s, way, q.lights[l], p, n, q.shot_pattern, q.shots, number, whole);
        direct[l] = whole ? delta.total : delta.change;
        if (delta.touched && result.found[k] == PATCH_AS_IT_WAS) result.found[k] = PATCH_CHANGED;
    }
}

}  // namespace
}  // namespace sailenv

// What arrives at patches by way of others and from the sky, and straight from area lights.
SAILENV_KERNEL(gather_change)
(int64_t threads, const sailenv::RayScene* scene, const sailenv::PatchQuery* query,
 const sailenv::PatchChange* result) {
    using namespace sailenv;
    const PatchQuery& q = *query;
    if (q.count < 0 || q.rays < 1 || q.shots < 1 || q.light_count < 0 || !sound(*scene)) {
        return STATUS_INVALID_ARGUMENT;
    }
    parallel_for(threads, q.count, 64, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) gather_patch(*scene, q, k, *result);
    });
    return STATUS_OK;
}

// Which points may get other light by what changes: `found` becomes 1 where it may take a share of
// the view of more than `least`, else 2 where it may come between the point and one of the lights,
// else 0. What is within the point's margin of either counts.
SAILENV_KERNEL(reached_points)
(int64_t threads, const sailenv::RayScene* scene, int64_t count, const float* positions,
 const float* normals, const float* margins, double least, int64_t light_count,
 const sailenv::RayLight* lights, uint8_t* found) {
    using namespace sailenv;
    const RayScene& s = *scene;
    if (count < 0 || light_count < 0 || !sound(s)) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const float *p = positions + 3 * k, *n = normals + 3 * k;
            const float beyond = margins[k];
            found[k] = reach(s, p, n, beyond) > static_cast<float>(least) ? 1 : 0;
            for (int64_t l = 0; l < light_count && found[k] == 0; l++) {
                if (between(s, lights[l], p, n, beyond).count > 0) found[k] = 2;
            }
        }
    });
    return STATUS_OK;
}

// What changes at points in the air; see LightLayer.probe_bounced. Result: far, near: (count, 4,
// channels): what rays bring that meet the same surface as before, and what the others do; far
// stays 0 if it is not wanted, which saves nearly all the work.
SAILENV_KERNEL(gather_probe_change)
(int64_t threads, const sailenv::RayScene* scene, int64_t count, const float* positions,
 int64_t rays, const float* directions, int64_t with_far, float* far, float* near) {
    using namespace sailenv;
    const RayScene& s = *scene;
    if (count < 0 || rays < 1 || !sound(s)) return STATUS_INVALID_ARGUMENT;
    const float each = 1.0f / static_cast<float>(rays);
    const size_t row = 4 * static_cast<size_t>(s.channels);
    SeenChanges all;
    all.count = SeenChanges::MOST + 1;
    parallel_for(threads, count, 8, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            memset(far + k * 4 * s.channels, 0, row * sizeof(float));
            memset(near + k * 4 * s.channels, 0, row * sizeof(float));
            for (int64_t m = 0; m < rays; m++) {
                const float* d = directions + 3 * m;
                const Ray r = ray_of(positions + 3 * k, d);
                Hit before, after;
                const bool differs = meet_both(s, all, r, before, after);
                if (!differs) {
                    if (with_far == 0) continue;
                    before = Hit();
                    meet_resting(s, r, before);
                    after = before;
                    if (before.triangle < 0) continue;
                }
                float* sum = (differs ? near : far) + k * 4 * s.channels;
                for (int c = 0; c < 4; c++) {
                    const float weight = c == 0 ? each : 2.0f * each * d[c - 1];
                    add_seen(s, before, r, s.before, -weight, sum + c * s.channels);
                    add_seen(s, after, r, s.after, weight, sum + c * s.channels);
                }
            }
        }
    });
    return STATUS_OK;
}

// What changes of a lamp's or the sun's direct light at texels.
//
// positions, normals: (count, 3); patch: (count,); numbers: (count,), seeds of random numbers;
// wanted: (patches,) as `found` of gather_change.
// Result: state: (count,), 0 as it was, 1 the change, 2 all of it; direct: irradiance / pi; share:
// of the light that arrives.
SAILENV_KERNEL(direct_light_delta)
(int64_t threads, const sailenv::RayScene* scene, const sailenv::RayLight* light, int64_t count,
 const float* positions, const float* normals, const int32_t* patch, const uint32_t* numbers,
 const uint8_t* wanted, int64_t rays, const float* pattern, uint8_t* state, float* direct,
 float* share) {
    using namespace sailenv;
    const RayScene& s = *scene;
    const RayLight& l = *light;
    if (count < 0 || rays < 1 || !sound(s)) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            state[k] = PATCH_AS_IT_WAS;
            const float *p = positions + 3 * k, *n = normals + 3 * k;
            const int32_t own = patch[k];
            const bool whole = own >= 0 && own < s.patch_count && wanted[own] == PATCH_WHOLE;
            if (own >= 0 && own < s.patch_count && wanted[own] == PATCH_INSIDE) continue;
            const SeenChanges in_the_way = between(s, l, p, n);
            if (!whole && in_the_way.count == 0) continue;
            const DirectLightDelta way =
                direct_light_delta(s, in_the_way, l, p, n, pattern, rays, numbers[k], whole);
            if (!whole && !way.touched) continue;
            state[k] = whole ? PATCH_WHOLE : PATCH_CHANGED;
            direct[k] = whole ? way.total : way.change;
            share[k] = whole ? way.share_all : way.share_change;
        }
    });
    return STATUS_OK;
}
