// What changes of baked light when things that were baked move; see relight/relighting.py.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "rays.h"
#include "render_types.h"

namespace sailenv {
namespace {

constexpr float LIFT_M = 1e-3f;
constexpr float FAR_M = 2.0f;  // what is farther is as good as endless
constexpr float OVER_PI = 0.318309886f;

// A number from 0 to 1 that has nothing to do with its neighbours' (Wellons' integer hash).
float scatter(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    x ^= x >> 16;
    return static_cast<float>(x >> 8) * (1.0f / 16777216.0f);
}

// Two directions across a unit vector (Duff et al. 2017).
void frame_about(const float* n, float* a, float* b) {
    const float sign = n[2] >= 0.0f ? 1.0f : -1.0f;
    const float q = -1.0f / (sign + n[2]), w = n[0] * n[1] * q;
    a[0] = 1.0f + sign * n[0] * n[0] * q;
    a[1] = sign * w;
    a[2] = -sign * n[0];
    b[0] = w;
    b[1] = sign + n[1] * n[1] * q;
    b[2] = -n[1];
}

// Halves that are 0 or more.
float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Adds what a ray sees, times `weight`, to `sum`; false if that is the back of a surface.
bool add_seen(const RayScene& s, const Hit& hit, const Ray& r, const float* table, float weight,
              float* sum) {
    if (hit.triangle < 0) {
        const float polar = std::acos(std::min(std::max(r.d[2], -1.0f), 1.0f));
        const float around = 0.5f - std::atan2(r.d[1], r.d[0]) * 0.5f * OVER_PI;
        const int32_t y = std::min(
            std::max(static_cast<int32_t>(polar * OVER_PI * s.sky_height), 0), s.sky_height - 1);
        const int32_t x =
            std::min(std::max(static_cast<int32_t>(around * s.sky_width), 0), s.sky_width - 1);
        const float share = weight * through_panes(s, r);
        const float* sky = s.sky + 3 * (static_cast<int64_t>(y) * s.sky_width + x);
        for (int c = 0; c < 3; c++) sum[c] += share * sky[c];
        return true;
    }
    if (!hit.front) return false;
    const RayInstance& i = *hit.instance;
    const float* radiance = i.radiance;
    if (i.has_chart && i.shape->places != nullptr) {
        const float* p = i.shape->places + 6 * static_cast<int64_t>(hit.triangle);
        const float first = 1.0f - hit.second - hit.third;
        const float u =
            i.chart[0] + i.chart[2] * (first * p[0] + hit.second * p[2] + hit.third * p[4]);
        const float v =
            i.chart[1] + i.chart[3] * (first * p[1] + hit.second * p[3] + hit.third * p[5]);
        const int32_t x = std::min(std::max(static_cast<int32_t>(u * s.width), 0), s.width - 1);
        const int32_t y = std::min(std::max(static_cast<int32_t>(v * s.height), 0), s.height - 1);
        const int32_t patch = s.patches[static_cast<int64_t>(y) * s.width + x];
        if (patch < 0 || patch >= s.patch_count) return true;
        radiance = table + static_cast<int64_t>(patch) * s.channels;
    }
    for (int c = 0; c < s.channels; c++) sum[c] += weight * radiance[c];
    return true;
}

// What a ray meets first, before and after; true if that is not the same.
bool meet_both(const RayScene& s, const Ray& r, Hit& before, Hit& after) {
    for (int64_t k = 0; k < s.changed_count; k++) {
        const RayInstance& i = s.changed[k];
        if (!comes_near(i, r, ENDLESS)) continue;
        if (i.before) meet_instance(i, r, before);
        if (i.after) meet_instance(i, r, after);
    }
    if (before.triangle < 0 && after.triangle < 0) return false;
    Hit rest;
    meet_resting(s, r, rest);
    if (rest.t <= before.t && rest.t <= after.t) return false;
    if (rest.t < before.t) before = rest;
    if (rest.t < after.t) after = rest;
    return true;
}

Hit meet_after(const RayScene& s, const Ray& r) {
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

Stopped stopped(const RayScene& s, const Ray& r, float length, bool whole) {
    bool by_before = false, by_after = false;
    for (int64_t k = 0; k < s.changed_count; k++) {
        const RayInstance& i = s.changed[k];
        if ((i.before ? by_before : true) && (i.after ? by_after : true)) continue;
        if (!comes_near(i, r, length) || !stops_instance(i, r, length)) continue;
        by_before |= i.before != 0;
        by_after |= i.after != 0;
    }
    if (!whole && !by_before && !by_after) return {false, false, false};
    const bool rest = (by_before && by_after) ? true : stops_resting(s, r, length);
    return {by_before != by_after && !rest, by_before || rest, by_after || rest};
}

// The largest share of a hemisphere that things which change may take, seen from a point.
float reach(const RayScene& s, const float* p, const float* n) {
    float most = 0.0f;
    for (int64_t k = 0; k < s.changed_count; k++) {
        const float* ball = s.changed[k].sphere;
        const float to[3] = {ball[0] - p[0], ball[1] - p[1], ball[2] - p[2]};
        if (dot(to, n) < -ball[3]) continue;
        const float d2 = dot(to, to);
        most = std::max(most, ball[3] * ball[3] / std::max(d2, 1e-6f));
    }
    return most;
}

// A point of a light, seen from `p`: not unit length but for directional lights.
struct Sample {
    float towards[3], length, irradiance;  // on a surface that faces it
};

Sample sample_of(const RayLight& l, const float* p, float u, float v) {
    Sample s;
    if (l.kind == LIGHT_DIRECTIONAL) {
        // A disc, whose radius `range` holds.
        float a[3], b[3];
        frame_about(l.direction, a, b);
        const float radius = l.range * std::sqrt(u), turn = 6.28318531f * v;
        const float x = radius * std::cos(turn), y = radius * std::sin(turn);
        for (int k = 0; k < 3; k++) s.towards[k] = -l.direction[k] + x * a[k] + y * b[k];
        const float scale = 1.0f / std::sqrt(dot(s.towards, s.towards));
        for (float& t : s.towards) t *= scale;
        s.length = ENDLESS;
        s.irradiance = 1.0f;
        return s;
    }
    s.length = 0.999f;
    if (l.kind == LIGHT_AREA) {
        for (int k = 0; k < 3; k++) {
            s.towards[k] = l.position[k] + (u - 0.5f) * l.across[k] + (v - 0.5f) * l.up[k] - p[k];
        }
        const float d2 = std::max(dot(s.towards, s.towards), 1e-4f);
        const float leaving = std::max(-dot(s.towards, l.direction), 0.0f) / std::sqrt(d2);
        const float area = std::sqrt(dot(l.across, l.across)) * std::sqrt(dot(l.up, l.up));
        s.irradiance = area * leaving / d2;
        return s;
    }
    float middle[3];
    for (int k = 0; k < 3; k++) middle[k] = l.position[k] - p[k];
    const float d2 = std::max(dot(middle, middle), 1e-4f);
    const float part = d2 / (l.range * l.range), left = std::max(1.0f - part * part, 0.0f);
    s.irradiance = left * left / d2;
    if (l.kind == LIGHT_SPOT) {
        const float along = -dot(middle, l.direction) / std::sqrt(d2);
        const float t = std::min(
            std::max((along - l.outer_cosine) / std::max(l.inner_cosine - l.outer_cosine, 1e-6f),
                     0.0f),
            1.0f);
        s.irradiance *= t * t * (3.0f - 2.0f * t);
    }
    // The ball of the lamp, for the edges of shadows.
    const float z = 1.0f - 2.0f * u, ring = std::sqrt(std::max(1.0f - z * z, 0.0f));
    const float turn = 6.28318531f * v;
    s.towards[0] = middle[0] + l.across[0] * ring * std::cos(turn);
    s.towards[1] = middle[1] + l.across[0] * ring * std::sin(turn);
    s.towards[2] = middle[2] + l.across[0] * z;
    return s;
}

// Whether anything that changes may come between a point and a light.
bool comes_between(const RayScene& s, const RayLight& l, const float* p, const float* n) {
    float towards[3], reach_of = 0.0f;
    for (int c = 0; c < 3; c++) {
        towards[c] = l.kind == LIGHT_DIRECTIONAL ? -l.direction[c] : l.position[c] - p[c];
        reach_of += l.across[c] * l.across[c] + l.up[c] * l.up[c];
    }
    reach_of = 0.5f * std::sqrt(reach_of);
    if (dot(towards, n) < -reach_of) return false;
    const Ray r = ray_of(p, towards);
    const float length = l.kind == LIGHT_DIRECTIONAL ? ENDLESS : 1.0f;
    for (int64_t k = 0; k < s.changed_count; k++) {
        if (comes_near(s.changed[k], r, length, reach_of)) return true;
    }
    return false;
}

struct Shine {
    float change, total;            // of irradiance / pi
    float share_change, share_all;  // of the rays that arrive
    bool touched;
};

Shine shine(const RayScene& s, const RayLight& l, const float* p, const float* n,
            const float* pattern, int64_t rays, uint32_t number, bool whole) {
    Shine result = {0.0f, 0.0f, 0.0f, 0.0f, false};
    const float turn_u = scatter(2 * number), turn_v = scatter(2 * number + 1);
    const float o[3] = {p[0] + n[0] * LIFT_M, p[1] + n[1] * LIFT_M, p[2] + n[2] * LIFT_M};
    const float each = 1.0f / static_cast<float>(rays);
    for (int64_t m = 0; m < rays; m++) {
        float u = pattern[2 * m] + turn_u, v = pattern[2 * m + 1] + turn_v;
        u -= std::floor(u);
        v -= std::floor(v);
        const Sample light = sample_of(l, p, u, v);
        const float cosine = dot(light.towards, n);
        if (!(cosine > 0.0f) || !(light.irradiance > 0.0f)) continue;
        const Ray r = ray_of(o, light.towards);
        const Stopped way = stopped(s, r, light.length, whole);
        result.touched |= way.touched;
        const float freed = static_cast<float>(way.before) - static_cast<float>(way.after);
        if (freed == 0.0f && (!whole || way.after)) continue;
        const float clear = l.kind == LIGHT_DIRECTIONAL ? through_panes(s, r) : 1.0f;
        const float arriving = light.irradiance * cosine * OVER_PI * each * clear /
                               std::sqrt(dot(light.towards, light.towards));
        result.change += freed * arriving;
        result.share_change += freed * each * clear;
        if (!way.after) {
            result.total += arriving;
            result.share_all += each * clear;
        }
    }
    return result;
}

// Which tiles of 4 x 4 texels lie up to `radius` tiles from a patch where something was found.
class FoundTiles {
public:
    FoundTiles(int64_t side, int64_t patches, const float* places, const uint8_t* found,
               int64_t radius)
        : tiles_((side + 3) / 4), marks_(static_cast<size_t>(tiles_ * tiles_), 0) {
        for (int64_t q = 0; q < patches; q++) {
            if (found[q] == 0) continue;
            if (!(places[2 * q] >= 0.0f) || !(places[2 * q + 1] >= 0.0f)) continue;
            const int64_t x = static_cast<int64_t>(std::min(places[2 * q], 65536.0f)) / 4;
            const int64_t y = static_cast<int64_t>(std::min(places[2 * q + 1], 65536.0f)) / 4;
            const int64_t last = std::min(x + radius, tiles_ - 1);
            for (int64_t ty = std::max<int64_t>(y - radius, 0);
                 ty <= std::min(y + radius, tiles_ - 1); ty++) {
                for (int64_t tx = std::max<int64_t>(x - radius, 0); tx <= last; tx++) {
                    marks_[static_cast<size_t>(ty * tiles_ + tx)] = 1;
                }
            }
        }
    }

    // Whether the tile of a texel, in the map, is one of them.
    bool has(int64_t x, int64_t y) const {
        if (x < 0 || y < 0 || x / 4 >= tiles_ || y / 4 >= tiles_) return false;
        return marks_[static_cast<size_t>(y / 4 * tiles_ + x / 4)] != 0;
    }

private:
    int64_t tiles_;
    std::vector<uint8_t> marks_;
};

// Null where there is no memory.
std::unique_ptr<FoundTiles> found_tiles(int64_t side, int64_t patches, const float* places,
                                        const uint8_t* found, int64_t radius) {
    try {
        return std::make_unique<FoundTiles>(side, patches, places, found, radius);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

bool sound(const RayScene& s) {
    return s.channels >= 3 && s.channels % 3 == 0 && s.sky_height > 0 && s.sky_width > 0 &&
           s.height > 0 && s.width > 0 && s.changed_count >= 0 && s.resting_count >= 0;
}

}  // namespace
}  // namespace sailenv

// What arrives at patches by way of others and from the sky, and straight from area lights.
//
// positions, normals: (count, 3). wanted: (count,), 0 nothing, 1 the change, 2 all of it. Result:
// found: (count,), the same, and 2 where so much has changed that all of it was worked out, or 3
// where that could not be because the patch lies inside of something;
// change: (count, channels) and direct: (count, lights), irradiance / pi: the difference, or all;
// nearness: (count,), the harmonic mean of the distances of what was looked at [m].
SAILENV_KERNEL(gather_change)
(int64_t threads, const sailenv::RayScene* scene, int64_t count, const float* positions,
 const float* normals, const uint8_t* wanted, int64_t rays, const float* pattern, int64_t lights,
 const sailenv::RayLight* area, int64_t shots, const float* shot_pattern, double least,
 uint8_t* found, float* change, float* direct, float* nearness) {
    using namespace sailenv;
    const RayScene& s = *scene;
    if (count < 0 || rays < 1 || shots < 1 || lights < 0 || !sound(s)) {
        return STATUS_INVALID_ARGUMENT;
    }
    const float each = 1.0f / static_cast<float>(rays);
    parallel_for(threads, count, 64, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const float *p = positions + 3 * k, *n = normals + 3 * k;
            float* sum = change + k * s.channels;
            float* straight = direct + k * lights;
            found[k] = 0;
            nearness[k] = FAR_M;
            memset(sum, 0, static_cast<size_t>(s.channels) * sizeof(float));
            if (lights > 0) memset(straight, 0, static_cast<size_t>(lights) * sizeof(float));
            if (wanted[k] == 0) continue;
            bool whole = wanted[k] == 2;
            const uint32_t number = static_cast<uint32_t>(k);
            if (whole || reach(s, p, n) > static_cast<float>(least)) {
                float a[3], b[3];
                frame_about(n, a, b);
                const float turn_u = scatter(2 * number), turn_v = scatter(2 * number + 1);
                const float o[3] = {p[0] + n[0] * LIFT_M, p[1] + n[1] * LIFT_M,
                                    p[2] + n[2] * LIFT_M};
                for (int again = 0; again < 2; again++) {
                    int64_t changed = 0, backs = 0, looked = 0;
                    float near = 0.0f;
                    for (int64_t m = 0; m < rays; m++) {
                        float u = pattern[2 * m] + turn_u, v = pattern[2 * m + 1] + turn_v;
                        u -= std::floor(u);
                        v -= std::floor(v);
                        const float radius = std::sqrt(u), turn = 6.28318531f * v;
                        const float x = radius * std::cos(turn), y = radius * std::sin(turn);
                        const float z = std::sqrt(std::max(1.0f - u, 0.0f));
                        float d[3];
                        for (int c = 0; c < 3; c++) d[c] = x * a[c] + y * b[c] + z * n[c];
                        const Ray r = ray_of(o, d);
                        if (whole) {
                            const Hit hit = meet_after(s, r);
                            backs += !add_seen(s, hit, r, s.after, each, sum);
                            near += 1.0f / std::min(std::max(hit.t, 1e-3f), FAR_M);
                            looked++;
                            continue;
                        }
                        Hit before, after;
                        if (!meet_both(s, r, before, after)) continue;
                        changed++;
                        const float t = std::min(before.t, after.t);
                        near += 1.0f / std::min(std::max(t, 1e-3f), FAR_M);
                        looked++;
                        add_seen(s, before, r, s.before, -each, sum);
                        add_seen(s, after, r, s.after, each, sum);
                    }
                    if (looked > 0) nearness[k] = static_cast<float>(looked) / near;
                    if (changed > 0) found[k] = 1;
                    if (whole) found[k] = 4 * backs > rays ? 3 : 2;
                    if (whole || 4 * changed <= rays) break;
                    // Little of what was baked here is of use.
                    whole = true;
                    memset(sum, 0, static_cast<size_t>(s.channels) * sizeof(float));
                }
            }
            if (found[k] == 3) continue;
            for (int64_t l = 0; l < lights; l++) {
                if (!whole && !comes_between(s, area[l], p, n)) continue;
                const Shine way = shine(s, area[l], p, n, shot_pattern, shots, number, whole);
                straight[l] = whole ? way.total : way.change;
                if (way.touched && found[k] == 0) found[k] = 1;
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
    const size_t row = static_cast<size_t>(4 * s.channels);
    parallel_for(threads, count, 8, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            memset(far + k * 4 * s.channels, 0, row * sizeof(float));
            memset(near + k * 4 * s.channels, 0, row * sizeof(float));
            for (int64_t m = 0; m < rays; m++) {
                const float* d = directions + 3 * m;
                const Ray r = ray_of(positions + 3 * k, d);
                Hit before, after;
                const bool differs = meet_both(s, r, before, after);
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
// positions, normals: (count, 3); patch: (count,); wanted: (patches,) as `found` of gather_change.
// Result: state: (count,), 0 as it was, 1 the change, 2 all of it; direct: irradiance / pi; share:
// of the light that arrives.
SAILENV_KERNEL(shine_change)
(int64_t threads, const sailenv::RayScene* scene, const sailenv::RayLight* light, int64_t count,
 const float* positions, const float* normals, const int32_t* patch, const uint8_t* wanted,
 int64_t rays, const float* pattern, uint8_t* state, float* direct, float* share) {
    using namespace sailenv;
    const RayScene& s = *scene;
    const RayLight& l = *light;
    if (count < 0 || rays < 1 || !sound(s)) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            state[k] = 0;
            const float *p = positions + 3 * k, *n = normals + 3 * k;
            const int32_t own = patch[k];
            const bool whole = own >= 0 && own < s.patch_count && wanted[own] == 2;
            if (own >= 0 && own < s.patch_count && wanted[own] == 3) continue;
            if (!whole && !comes_between(s, l, p, n)) continue;
            const Shine way = shine(s, l, p, n, pattern, rays, static_cast<uint32_t>(k), whole);
            if (!whole && !way.touched) continue;
            state[k] = whole ? 2 : 1;
            direct[k] = whole ? way.total : way.change;
            share[k] = whole ? way.share_all : way.share_change;
        }
    });
    return STATUS_OK;
}

// Interpolates the light of probes at points that face along normals, without cutting off below 0.
// probes: (z, y, x, 4, channels); result: (count, channels).
SAILENV_KERNEL(light_of_probes)
(int64_t threads, int64_t nz, int64_t ny, int64_t nx, int64_t channels, const float* probes,
 const float* origin, const float* spacing, int64_t count, const float* positions,
 const float* normals, float* result) {
    using namespace sailenv;
    if (nz < 1 || ny < 1 || nx < 1 || channels < 1 || count < 0) return STATUS_INVALID_ARGUMENT;
    const int64_t size[3] = {nx, ny, nz};
    parallel_for(threads, count, 256, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            int64_t low[3], high[3];
            float share[3];
            for (int c = 0; c < 3; c++) {
                const float end = static_cast<float>(size[c] - 1);
                float at = (positions[3 * k + c] - origin[c]) / spacing[c];
                at = at > 0.0f ? (at < end ? at : end) : 0.0f;
                low[c] = std::min(static_cast<int64_t>(at), std::max<int64_t>(size[c] - 2, 0));
                high[c] = std::min(low[c] + 1, size[c] - 1);
                share[c] = at - static_cast<float>(low[c]);
            }
            float* out = result + k * channels;
            memset(out, 0, static_cast<size_t>(channels) * sizeof(float));
            const float* n = normals + 3 * k;
            for (int corner = 0; corner < 8; corner++) {
                int64_t at[3];
                float weight = 1.0f;
                for (int c = 0; c < 3; c++) {
                    const bool upper = corner >> c & 1;
                    at[c] = upper ? high[c] : low[c];
                    weight *= upper ? share[c] : 1.0f - share[c];
                }
                if (weight == 0.0f) continue;
                const float* q = probes + ((at[2] * ny + at[1]) * nx + at[0]) * 4 * channels;
                for (int64_t c = 0; c < channels; c++) {
                    out[c] += weight * (q[c] + n[0] * q[channels + c] + n[1] * q[2 * channels + c] +
                                        n[2] * q[3 * channels + c]);
                }
            }
        }
    });
    return STATUS_OK;
}

// Spreads what was found at patches over the texels between them.
//
// places: (count,), of the texels in the map; patch_places: (patches, 2), x and y of each patch's
// middle texel. found, change: of the patches, as gather_change gives them. Result: into `texels`,
// halves of the map's first texel by channel, of which one texel's follow `steps` after another's.
SAILENV_KERNEL(spread_change)
(int64_t threads, int64_t side, int64_t count, const int32_t* places, const float* positions,
 const float* normals, const int32_t* owners, int64_t patches, const int32_t* patch_of,
 const float* patch_places, const float* patch_positions, const float* patch_normals,
 const int32_t* patch_owners, const uint8_t* found, int64_t channels, const float* change,
 uint16_t* const* texels, const int64_t* steps) {
    using namespace sailenv;
    if (side < 1 || side > 65536 || count < 0 || patches < 1 || channels < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    const std::unique_ptr<FoundTiles> tiles = found_tiles(side, patches, patch_places, found, 1);
    if (!tiles) return STATUS_OUT_OF_MEMORY;
    parallel_for(threads, count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const int64_t place = places[k];
            if (place < 0 || place >= side * side) continue;
            const int32_t x = static_cast<int32_t>(place % side);
            const int32_t y = static_cast<int32_t>(place / side);
            if (!tiles->has(x, y)) continue;
            const float *p = positions + 3 * k, *n = normals + 3 * k;
            int32_t near[10];
            float weight[10], total = 0.0f;
            int count_near = 0;
            bool touched = false;
            for (int dy = -4; dy <= 4; dy += 4) {
                for (int dx = -4; dx <= 4; dx += 4) {
                    const int32_t tx = x + dx, ty = y + dy;
                    if (tx < 0 || ty < 0 || tx >= side || ty >= side) continue;
                    const int32_t q = patch_of[ty * side + tx];
                    if (q < 0 || q >= patches || patch_owners[q] != owners[k]) continue;
                    if (found[q] == 3) continue;  // knows nothing
                    bool known = false;
                    for (int j = 0; j < count_near; j++) known |= near[j] == q;
                    if (known) continue;
                    const float* pn = patch_normals + 3 * static_cast<int64_t>(q);
                    const float* pp = patch_positions + 3 * static_cast<int64_t>(q);
                    const float alike = dot(pn, n);
                    const float step[3] = {pp[0] - p[0], pp[1] - p[1], pp[2] - p[2]};
                    const float far2 = dot(step, step), off = dot(step, n);
                    const bool own = dx == 0 && dy == 0;
                    if (!own && (alike < 0.7f || far2 > 0.25f || off * off > 0.1f * far2 + 1e-4f)) {
                        continue;
                    }
                    const float wx = std::fabs(patch_places[2 * q] - static_cast<float>(x)) / 6.0f;
                    const float wy =
                        std::fabs(patch_places[2 * q + 1] - static_cast<float>(y)) / 6.0f;
                    const float w = std::max(1.0f - wx, 0.0f) * std::max(1.0f - wy, 0.0f) +
                                    (own ? 0.02f : 1e-4f);
                    near[count_near] = q;
                    weight[count_near++] = w;
                    total += w;
                    touched |= found[q] != 0;
                }
            }
            if (!touched || total <= 0.0f) continue;
            for (int64_t c = 0; c < channels; c += 8) {
                const int64_t width = std::min<int64_t>(channels - c, 8);
                i8 stored = {};
                for (int64_t j = 0; j < width; j++) {
                    stored[j] = texels[c + j][steps[c + j] * place];
                }
                const f8 was = from_half(stored);
                f8 sum = {};
                for (int j = 0; j < count_near; j++) {
                    const int32_t q = near[j];
                    f8 value = {};
                    const float* from = change + q * channels + c;
                    if (width == 8) {
                        value = load(from);
                    } else {
                        for (int64_t i = 0; i < width; i++) value[i] = from[i];
                    }
                    const f8 light = found[q] == 1 ? was + value : found[q] == 2 ? value : was;
                    sum = sum + weight[j] * light;
                }
                const i8 light = to_half(min8(max8(sum / total, splat(0.0f)), splat(60000.0f)));
                for (int64_t j = 0; j < width; j++) {
                    texels[c + j][steps[c + j] * place] = static_cast<uint16_t>(light[j]);
                }
            }
        }
    });
    return STATUS_OK;
}

// Averages what was found at patches over those around them, over less where other things are
// near: there light changes quickly. Patches whose light was worked out anew and others are kept
// apart. Result: smooth: (patches, channels).
SAILENV_KERNEL(smooth_change)
(int64_t threads, int64_t side, int64_t radius, int64_t patches, const int32_t* patch_of,
 const float* patch_places, const float* patch_positions, const float* patch_normals,
 const int32_t* patch_owners, const uint8_t* found, const float* nearness, int64_t channels,
 const float* change, uint8_t* smooth_found, float* smooth) {
    using namespace sailenv;
    if (side < 1 || side > 65536 || radius < 0 || radius > 8 || patches < 0 || channels < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    const std::unique_ptr<FoundTiles> tiles =
        found_tiles(side, patches, patch_places, found, radius);
    if (!tiles) return STATUS_OUT_OF_MEMORY;
    parallel_for(threads, patches, 256, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            float* out = smooth + k * channels;
            memset(out, 0, static_cast<size_t>(channels) * sizeof(float));
            smooth_found[k] = found[k];
            if (found[k] == 3) continue;
            const float *p = patch_positions + 3 * k, *n = patch_normals + 3 * k;
            const float near = std::max(nearness[k], 0.02f), scale = 2.0f / (near * near);
            const int32_t x = static_cast<int32_t>(patch_places[2 * k]);
            const int32_t y = static_cast<int32_t>(patch_places[2 * k + 1]);
            if (!tiles->has(x, y)) continue;
            const bool whole = found[k] == 2;
            float total = 0.0f;
            bool touched = false;
            int64_t before = -1;
            for (int64_t dy = -radius; dy <= radius; dy++) {
                for (int64_t dx = -radius; dx <= radius; dx++) {
                    const int64_t tx = x + 4 * dx, ty = y + 4 * dy;
                    if (tx < 0 || ty < 0 || tx >= side || ty >= side) continue;
                    const int64_t q = patch_of[ty * side + tx];
                    if (q < 0 || q >= patches || q == before) continue;
                    if (patch_owners[q] != patch_owners[k] || found[q] == 3 ||
                        (found[q] == 2) != whole) {
                        continue;
                    }
                    const float* pp = patch_positions + 3 * q;
                    const float alike = dot(patch_normals + 3 * q, n);
                    const float step[3] = {pp[0] - p[0], pp[1] - p[1], pp[2] - p[2]};
                    const float far2 = dot(step, step), off = dot(step, n);
                    if (q != k &&
                        (alike < 0.8f || far2 > 0.25f || off * off > 0.1f * far2 + 1e-6f)) {
                        continue;
                    }
                    before = q;
                    const float w = alike * std::exp(-far2 * scale);
                    total += w;
                    touched |= found[q] != 0;
                    const float* value = change + q * channels;
                    for (int64_t c = 0; c < channels; c++) out[c] += w * value[c];
                }
            }
            if (touched && found[k] == 0) smooth_found[k] = 1;
            if (!touched || !(total > 0.0f)) continue;
            for (int64_t c = 0; c < channels; c++) out[c] /= total;
        }
    });
    return STATUS_OK;
}
