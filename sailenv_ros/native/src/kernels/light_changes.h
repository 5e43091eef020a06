// What changes of light along rays when things that were baked move; see relight/relighting.py.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lanes.h"
#include "light_sampling.h"
#include "rays.h"

namespace sailenv {

// A number from 0 to 1 that has nothing to do with its neighbours' (Wellons' integer hash).
static inline float scatter(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    x ^= x >> 16;
    return static_cast<float>(x >> 8) * (1.0f / 16777216.0f);
}

// Share of a light that something must be able to hide, by the balls around both.
constexpr float LEAST_OF_LIGHT = 0.02f;

// Things that change and count at a point; all do if they are too many.
struct SeenChanges {
    static constexpr int64_t MOST = 128;
    const RayInstance* instance[MOST];
    float balls[MOST / WIDTH][4][WIDTH];  // around them: x, y, z and radius of so many at a time
    int64_t count = 0;

    void add(const RayInstance& i) {
        if (count < MOST) {
            float (*group)[WIDTH] = balls[count / WIDTH];
            if (count % WIDTH == 0) memset(group, 0, sizeof balls[0]);
            for (int k = 0; k < 4; k++) group[k][count % WIDTH] = i.sphere[k];
            instance[count] = &i;
        }
        count++;
    }
};

// Where a ray comes nearest to the middles of some balls before `length`, and how near, squared;
// the arithmetic is `ray_passes_ball`'s.
struct Nearest {
    f8 t, square;
};
LANES_INLINE Nearest nearest_to_middles(const float (*balls)[WIDTH], const Ray& r, float length) {
    const f8 x = load(balls[0]) - r.o[0], y = load(balls[1]) - r.o[1], z = load(balls[2]) - r.o[2];
    const float d2 = r.d[0] * r.d[0] + r.d[1] * r.d[1] + r.d[2] * r.d[2];
    f8 t = (x * r.d[0] + y * r.d[1] + z * r.d[2]) / d2;
    t = t < 0.0f ? splat(0.0f) : t > length ? splat(length) : t;
    const f8 fx = x - t * r.d[0], fy = y - t * r.d[1], fz = z - t * r.d[2];
    return {t, fx * fx + fy * fy + fz * fz};
}

// Which of some balls a ray passes through before `length`.
LANES_INLINE uint32_t passed_balls(const float (*balls)[WIDTH], const Ray& r, float length) {
    const f8 reach = load(balls[3]);
    return lane_bits(nearest_to_middles(balls, r, length).square <= reach * reach);
}

// Whether any of them may reach into a cone about a ray of unit direction.
static inline bool reach_into(const SeenChanges& seen, const Ray& axis, double edge) {
    if (seen.count > SeenChanges::MOST) return true;
    const float cosine = std::max(static_cast<float>(edge), 1e-3f);
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
    for (int64_t first = 0; first < seen.count; first += WIDTH) {
        const float (*balls)[WIDTH] = seen.balls[first / WIDTH];
        const Nearest near = nearest_to_middles(balls, axis, ENDLESS);
        const f8 reach = (load(balls[3]) + near.t * sine) / cosine;
        if (lane_bits(near.square <= reach * reach) != 0) return true;
    }
    return false;
}

// Calls with each of them whose ball a ray passes through before `length`, in their order.
template <class Use>
static inline void for_each_passed(const RayScene& s, const SeenChanges& seen, const Ray& r,
                                   float length, const Use& use) {
    if (seen.count > SeenChanges::MOST) {
        for (int64_t k = 0; k < s.changed_count; k++) {
            if (ray_passes_ball(s.changed[k], r, length)) use(s.changed[k]);
        }
        return;
    }
    for (int64_t first = 0; first < seen.count; first += WIDTH) {
        uint32_t passed = passed_balls(seen.balls[first / WIDTH], r, length);
        // Of the last ones there may be fewer.
        if (seen.count - first < WIDTH) passed &= (1u << (seen.count - first)) - 1u;
        for (; passed != 0; passed &= passed - 1) {
            use(*seen.instance[first + __builtin_ctz(passed)]);
        }
    }
}

// What a ray meets first, before and after; true if that is not the same.
static inline bool meet_both(const RayScene& s, const SeenChanges& seen, const Ray& r, Hit& before,
                             Hit& after) {
    for_each_passed(s, seen, r, ENDLESS, [&](const RayInstance& i) {
        if (i.before) meet_instance(i, r, before);
        if (i.after) meet_instance(i, r, after);
    });
    if (before.triangle < 0 && after.triangle < 0) return false;
    Hit rest;
    meet_resting(s, r, rest);
    if (rest.t <= before.t && rest.t <= after.t) return false;
    if (rest.t < before.t) before = rest;
    if (rest.t < after.t) after = rest;
    return true;
}

static inline Hit meet_after(const RayScene& s, const Ray& r) {
    Hit hit;
    for (int64_t k = 0; k < s.changed_count; k++) {
        if (s.changed[k].after) meet_instance(s.changed[k], r, hit);
    }
    meet_resting(s, r, hit);
    return hit;
}

// Whether light is stopped on the way from a point, before and after; the same if nothing that
// changes is in the way.
struct Stopped {
    bool touched, before, after;
};

static inline Stopped stopped(const RayScene& s, const SeenChanges& between, const Ray& r,
                              float length, bool whole) {
    bool by_before = false, by_after = false;
    for_each_passed(s, between, r, length, [&](const RayInstance& i) {
        if ((i.before ? by_before : true) && (i.after ? by_after : true)) return;
        if (!instance_occludes(i, r, length)) return;
        by_before |= i.before != 0;
        by_after |= i.after != 0;
    });
    if (!whole && !by_before && !by_after) return {false, false, false};
    const bool rest = (by_before && by_after) ? true : resting_occlude(s, r, length);
    return {by_before != by_after && !rest, by_before || rest, by_after || rest};
}

// Which things that change may come between a point, or one so far beside it, and a light, and take
// more than a little of its light.
static inline SeenChanges between(const RayScene& s, const RayLight& l, const float* p,
                                  const float* n, float beside = 0.0f) {
    SeenChanges found;
    const bool far = l.lamp.kind == LIGHT_DIRECTIONAL;
    float towards[3], square = 0.0f;
    for (int c = 0; c < 3; c++) {
        towards[c] = far ? -(&l.lamp.direction.x)[c] : (&l.lamp.position.x)[c] - p[c];
        square += l.across[c] * l.across[c] + l.up[c] * l.up[c];
    }
    const float reach_of = 0.5f * std::sqrt(square) + (far ? 0.0f : l.radius);
    if (dot(towards, n) < -reach_of - beside) return found;
    const Ray r = ray_of(p, towards);
    const float way = std::sqrt(std::max(dot(towards, towards), 1e-12f));
    for (int64_t k = 0; k < s.changed_count; k++) {
        const float* ball = s.changed[k].sphere;
        float margin = beside + (far ? reach_of : 0.0f);
        if (!far) {
            // The rays to all of the light are a cone.
            const float to[3] = {ball[0] - p[0], ball[1] - p[1], ball[2] - p[2]};
            const float along = (dot(to, towards) / way + 1.2f * ball[3] + beside) / way;
            margin += reach_of * std::min(std::max(along, 0.0f), 1.0f);
            const float away = std::max(std::sqrt(dot(to, to)) - beside, 0.0f);
            const float seen = ball[3] * way, light = reach_of * away;
            if (seen * seen < LEAST_OF_LIGHT * light * light) continue;
        }
        if (ray_passes_ball(s.changed[k], r, far ? ENDLESS : 1.0f, margin)) {
            found.add(s.changed[k]);
        }
    }
    return found;
}

// What changes of the direct light of a lamp at a point.
struct DirectLightDelta {
    float change, total;            // of irradiance / pi
    float share_change, share_all;  // of the rays that arrive
    bool touched;
};

// No more rays than these are cast where all of them were stopped, or none.
constexpr int64_t LEAST_RAYS = 16;

// `whole`: all of the light is wanted, whatever changed. Of the pattern's points the first ones are
// spread evenly, too.
static inline DirectLightDelta direct_light_delta(const RayScene& s, const SeenChanges& between,
                                                  const RayLight& l, const float* p, const float* n,
                                                  const float* pattern, int64_t rays,
                                                  uint32_t number, bool whole) {
    DirectLightDelta result = {0.0f, 0.0f, 0.0f, 0.0f, false};
    const float turn_u = scatter(2 * number), turn_v = scatter(2 * number + 1);
    const float o[3] = {p[0] + n[0] * LIFT_M, p[1] + n[1] * LIFT_M, p[2] + n[2] * LIFT_M};
    float unhindered = 0.0f;
    int64_t cast = 0, stopped_rays = 0, m = 0;
    for (; m < rays; m++) {
        if (m == LEAST_RAYS && (stopped_rays == 0 || stopped_rays == cast)) break;
        float u = pattern[2 * m] + turn_u, v = pattern[2 * m + 1] + turn_v;
        u -= std::floor(u);
        v -= std::floor(v);
        const LightSample light = sample_light(l, p, u, v);
        const float power = sample_power(light, n);
        if (!(power > 0.0f)) continue;
        cast++;
        unhindered += power;
        const Ray r = ray_of(o, light.towards);
        const Stopped way = stopped(s, between, r, light.length, whole);
        result.touched |= way.touched;
        stopped_rays += whole ? way.after : way.touched;
        const float freed = static_cast<float>(way.before) - static_cast<float>(way.after);
        if (freed == 0.0f && (!whole || way.after)) continue;
        const float clear = l.lamp.kind == LIGHT_DIRECTIONAL ? glass_transmittance(s, r) : 1.0f;
        result.change += freed * power * clear;
        result.share_change += freed * clear;
        if (!way.after) {
            result.total += power * clear;
            result.share_all += clear;
        }
    }
    const float each = 1.0f / static_cast<float>(m);
    result.share_change *= each;
    result.share_all *= each;
    if (result.change != 0.0f || result.total != 0.0f) {
        const float scale = each * sample_scale(l, p, n, each * unhindered);
        result.change *= scale;
        result.total *= scale;
    }
    return result;
}

static inline bool sound(const RayScene& s) {
    return s.channels >= 3 && s.channels % 3 == 0 && s.sky_height > 0 && s.sky_width > 0 &&
           s.height > 0 && s.width > 0 && s.changed_count >= 0 && s.resting_count >= 0;
}

}  // namespace sailenv
