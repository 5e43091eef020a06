// Shading: what rough surfaces mirror of what stands around them, by rays.
//
// Lobes of rough surfaces are wide, so what they mirror changes slowly from pixel to pixel. A point
// in each square of pixels looks along a few rays of its lobe; points around it share what these
// meet, and pixels take over what the points around them mirror.
#include "shade_rough.h"

#include <algorithm>

#include "../threads.h"
#include "traced_hits.h"

namespace sailenv {
namespace {

constexpr int32_t SQUARE = 8;  // pixels along a side
constexpr int32_t FACES = RoughSamples::FACES;
constexpr int32_t RAYS = 8;               // of a sample
constexpr float LEAST_HIGHLIGHT = 1e-3f;  // over the lamp's radiant intensity
constexpr float LEAST_RISE = 0.02f;       // rays that rise less from a surface are below it
// Roughness up to where rays tell all that is mirrored, and from where on nothing: there it is the
// light around.
constexpr float ROUGHER = 0.6f, ROUGHEST = 0.75f;
// Roughness from where on samples tell of area lights, and from where on they do alone; and the
// share that is mirrored from where on what is smoother than ROUGH has other rays.
constexpr float SMOOTHEST = 0.2f, SMOOTHER = 0.3f, SMOOTH_SHARE = 0.25f;
// Roughness up to where and from where on highlights of area lights are too wide to be worth it.
constexpr float DULL = 0.45f, DULLER = 0.55f;
// Share that is mirrored of all light that is sent back: from where on rays are worth it, and count
// alone.
constexpr float LEAST_SHARE = 0.45f, WHOLE_SHARE = 0.6f;
// What is seen by a cosine of more than STEEP mirrors less than LEAST_SHARE if it sends back more
// than BRIGHT otherwise.
constexpr float BRIGHT = 0.12f, STEEP = 0.45f;
// Distances between a lobe's middle and an area light, in widths of the lobe: up to where rays tell
// the highlight alone, and from where on there is none.
constexpr float LAMP_NEAR = 1.5f, LAMP_FAR = 3.0f;
// What is nearer than NEAR_M stands near, and what is farther than FAR_M does not.
constexpr float NEAR_M = 0.1f, FAR_M = 0.3f;
// Roughness of the pictures of the room that rays see where they meet nothing.
constexpr float PICTURE_ROUGHNESS = 0.2f;
// How many squares on each side of a sample share what is far, and at what distance four tenths of
// it count.
constexpr int32_t FAR_SQUARES = 2;
constexpr float FAR_REACH_M = 0.1f;
// Samples enough to share; with fewer around it, a sample has up to so many times as many rays.
constexpr float ENOUGH = 8.0f;
constexpr int32_t MOST_TIMES = 4;
// The picture of the room without lamps, as reflection_points.py has it.
constexpr int32_t LAMPLESS = 0;
// Pixels take over what samples mirror that lie nearer [pixels], but for those with normals turned
// by more than this cosine, and those that lie off the pixel's plane by more than this share of its
// depth. At ENOUGH_WEIGHT half of what is mirrored is by samples, the rest by pictures of the room.
constexpr float REACH = 12.0f, TURNED = 0.9f, OFF_PLANE = 0.02f, ENOUGH_WEIGHT = 2.0f;

// The pixel of a square whose point looks: in each row of squares another column, and so on.
constexpr int32_t PLACES[SQUARE] = {0, 4, 2, 6, 1, 5, 3, 7};

// By how much eight surfaces mirror enough for rays to be worth it.
f8 share_of_room(const Chunk& c, int32_t i, i8 rough) {
    const Vec3x8 ray = c.ray.at(i);
    const f8 diffuse = luminance(c.base.at(i)) * (1.0f - load(c.metallic + i));
    const f8 along = dot(c.normal.at(i), ray);
    const i8 steep = along * along > dot(ray, ray) * (STEEP * STEEP);
    if (!any(rough & ~(steep & (diffuse > BRIGHT)))) return splat(0.0f);
    const f8 mirrored = mirrored_part(c, i);
    const f8 share = smoothstep(LEAST_SHARE, WHOLE_SHARE, mirrored);
    return rough & ~leads_everywhere(c, i, mirrored) ? share : splat(0.0f);
}

// By how much lobes of eight surfaces meet the faces of area lights, which outshine all else.
f8 share_of_lamps(const Light& light, const Chunk& c, int32_t i) {
    f8 share = splat(0.0f);
    const Vec3x8 ray = mirrored_ray(c, i), at = c.point.at(i);
    const f8 roughness = load(c.roughness + i);
    for (int64_t k = 0; k < light.mirrored_light_count; k++) {
        const RayLight& l = light.mirrored_lights[k];
        if (l.lamp.kind != LIGHT_AREA) continue;
        const vec3 across(l.across[0], l.across[1], l.across[2]), up(l.up[0], l.up[1], l.up[2]);
        const float radius = 0.5f * std::sqrt(dot(across, across) + dot(up, up));
        const Vec3x8 to = splat(l.lamp.position) - at;
        const f8 along = dot(to, ray), beside2 = max8(dot(to, to) - along * along, splat(0.0f));
        const f8 off = max8(sqrt8(beside2) - radius, splat(0.0f));
        const i8 ahead = (along > 0.0f) & (dot(to, splat(l.lamp.direction)) < 0.0f);
        const f8 lobe = roughness * roughness * max8(along, splat(0.01f));
        const f8 met = 1.0f - smoothstep(LAMP_NEAR, LAMP_FAR, off / lobe);
        share = max8(share, ahead ? met : splat(0.0f));
    }
    return share;
}

// By how much rays tell what eight surfaces mirror: `room` where they look at all that is there,
// `all` where they look at area lights alone, too.
struct TracedShare {
    f8 all, room;
};

TracedShare traced_share(const Light& light, const Chunk& c, int32_t i) {
    const f8 roughness = load(c.roughness + i), none = splat(0.0f);
    const i8 rough = (roughness >= SMOOTHEST) & (roughness < ROUGHEST) & ~load(c.empty + i);
    if (!any(rough)) return {none, none};
    const i8 very = rough & (roughness >= ROUGH);
    const f8 worth = any(very) ? share_of_room(c, i, very) : none;
    const f8 room = worth * (1.0f - smoothstep(ROUGHER, ROUGHEST, roughness));
    if (!any(rough & (roughness < DULLER) & (room < 1.0f))) return {room, room};
    const f8 sharp = share_of_lamps(light, c, i) * (1.0f - smoothstep(DULL, DULLER, roughness));
    const f8 lamps = rough ? sharp : none;
    if (!any(lamps > room)) return {room, room};
    // What is smoother and mirrors much has rays of its own.
    const f8 mirrored = mirrored_part(c, i);
    const f8 much = smoothstep(SMOOTH_SHARE, LEAST_SHARE, mirrored);
    const f8 own = leads_everywhere(c, i, mirrored) ? none : much;
    const f8 few = smoothstep(SMOOTHEST, SMOOTHER, roughness) *
                   (1.0f - own * (1.0f - smoothstep(SMOOTHER, ROUGH, roughness)));
    return {max8(room, lamps * (very ? splat(1.0f) : few)), room};
}

// Whether a triangle's part may be rough.
bool may_be_rough(const Shading& s, const Triangle& t) {
    const Part& part = s.parts->parts[t.part];
    return part.detail_map != nullptr || (part.roughness >= SMOOTHEST && part.roughness < ROUGHEST);
}

// The normal of a triangle's plane in the frame of the camera or of a face of the lens, with either
// sign.
vec3 plane_normal(const Shading& s, const Triangle& t) {
    vec3 along = s.lens.direction(t.inverse_depth);
    if (s.sight == Sight::PARALLEL) along.z = 1.0f;
    return unit(along);
}

// Whether two triangles are of one face of a surface.
bool are_of_one_face(const Shading& s, const Triangle& a, const Triangle& b) {
    if (a.part != b.part) return false;
    return a.face != b.face || std::fabs(dot(plane_normal(s, a), plane_normal(s, b))) > ALIKE;
}

// Finds a pixel of each of the first two rough faces in a square; returns how many there are. Where
// one face fills it, that is another pixel from square to square.
int32_t points_of(const Shading& s, int32_t column, int32_t row, int32_t first_row, int32_t end_row,
                  Fragment* found) {
    const int32_t across =
        std::min<int32_t>(SQUARE, static_cast<int32_t>(s.width) - SQUARE * column);
    const int32_t begin = PLACES[row & (SQUARE - 1)] + SQUARE * PLACES[column & (SQUARE - 1)];
    uint32_t last = NOTHING;
    int32_t count = 0;
    for (int32_t k = 0; k < SQUARE * SQUARE && count < FACES; k++) {
        const int32_t place = (begin + k) & (SQUARE * SQUARE - 1);
        const int32_t x = SQUARE * column + place % SQUARE, y = SQUARE * row + place / SQUARE;
        if (place % SQUARE >= across || y < first_row || y >= end_row) continue;
        const uint32_t tag = s.visible[y * s.stride + x];
        if (tag == last || tag == NOTHING) continue;
        last = tag;
        const Triangle& t = s.set->triangles[tag];
        if (!may_be_rough(s, t)) continue;
        if (count > 0 && are_of_one_face(s, t, s.set->triangles[found[0].tag])) continue;
        Fragment& own = found[count];
        own = {static_cast<float>(x), static_cast<float>(y), 0.0f, tag, x, y, 0};
        if (s.table != nullptr) {
            const int64_t at = y * s.table->stride + x;
            own.x = s.table->x[at];
            own.y = s.table->y[at];
            own.face = s.table->several ? s.table->face[at] : 0;
            if (!(own.x == own.x)) continue;
        }
        count++;
    }
    return count;
}

// A ray of a sample's lobe, and what it met.
struct LobeRay {
    int32_t point, hit;  // `hit` is among the places that are shaded; else NO_HIT or UNKNOWN
    float weight, near;  // `near` is the share of what is met that stands near
    vec3 ray, lamps;     // `lamps` is radiance of faces of lamps on its way
};

constexpr int32_t NO_HIT = -1, UNKNOWN = -2;

// Radiance of the faces of area lights that a ray passes before `end`.
vec3 radiance_of_lamps(const Light& light, vec3 from, vec3 ray, float end) {
    vec3 sum(0.0f, 0.0f, 0.0f);
    for (int64_t k = 0; k < light.mirrored_light_count; k++) {
        const RayLight& l = light.mirrored_lights[k];
        const float along = dot(ray, l.lamp.direction);
        if (l.lamp.kind != LIGHT_AREA || along > -1e-6f) continue;
        const vec3 to_middle = l.lamp.position - from;
        const float distance = dot(to_middle, l.lamp.direction) / along;
        if (!(distance > 0.0f && distance < end)) continue;
        const vec3 place = ray * distance - to_middle;
        const vec3 across(l.across[0], l.across[1], l.across[2]), up(l.up[0], l.up[1], l.up[2]);
        const float width2 = dot(across, across), height2 = dot(up, up);
        if (std::fabs(dot(place, across)) > 0.5f * width2) continue;
        if (std::fabs(dot(place, up)) > 0.5f * height2) continue;
        sum = sum + l.lamp.colour * (1.0f / std::sqrt(width2 * height2));
    }
    return sum;
}

// Follows the ray of a number of each point; returns how many there are.
int32_t follow_rays(const Shading& s, const Chunk& c, RoughSample* const* samples,
                    const int32_t* ray_counts, int32_t number, LobeRay* rays, Chunk& hits) {
    int32_t count = 0, hit_count = 0;
    begin_hits(hits);
    for (int32_t i = 0; i < c.count; i++) {
        if (number >= ray_counts[i]) continue;
        const int32_t column = samples[i]->seen.pixel_x / SQUARE;
        const int32_t row = samples[i]->seen.pixel_y / SQUARE;
        // Every second facet; neighbours have the others.
        const int32_t facet = number * (LOBE / RAYS) + ((column + row + number / RAYS) & 1);
        const vec3 ray = lobe_ray(c, i, vector_at(c.normal, i), facet,
                                  3 * column + 5 * row + 7 * (number / RAYS),
                                  c.roughness[i] * c.roughness[i], 1.0f);
        if (dot(ray, vector_at(c.normal, i)) < LEAST_RISE) continue;
        const vec3 begin = vector_at(c.point, i);
        LobeRay& one = rays[count++];
        one = {i,    UNKNOWN, lobe_weight(c, i, ray),
               0.0f, ray,     radiance_of_lamps(*s.light, begin, ray, ENDLESS)};
        const bool lit = dot(one.lamps, one.lamps) > 0.0f;
        if (!samples[i]->of_room && !lit) continue;
        const SceneHit met = closest_hit(*s.light->traced, begin, ray, ENDLESS);
        if (lit) one.lamps = radiance_of_lamps(*s.light, begin, ray, met.hit.t);
        if (!samples[i]->of_room) continue;
        one.hit = NO_HIT;
        if (!is_drawn(met)) continue;
        one.near = 1.0f - smoothstep(NEAR_M, FAR_M, met.hit.t);
        const vec3 along = vector_at(c.ray, i);
        const float distance = c.depth[i] * std::sqrt(dot(along, along));
        set_hit(met, begin, ray, distance, 0.5f * c.roughness[i] * c.roughness[i], hits, hit_count);
        one.hit = hit_count++;
    }
    if (hit_count > 0) shade_hits(s, hits, hit_count);
    return count;
}

// What pictures of the room without lamps have where rays lead that meet nothing.
void see_pictures(const Light& light, const Chunk& c, const LobeRay* rays, int32_t count,
                  Vectors& seen) {
    for (int32_t first = 0; first < count; first += 8) {
        Vec3x8 from{}, along{};
        bool missed = false;
        for (int32_t k = 0; k < 8; k++) {
            const LobeRay& one = rays[std::min(first + k, count - 1)];
            missed |= one.hit == NO_HIT;
            from.x[k] = c.point.x[one.point], along.x[k] = one.ray.x;
            from.y[k] = c.point.y[one.point], along.y[k] = one.ray.y;
            from.z[k] = c.point.z[one.point], along.z[k] = one.ray.z;
        }
        if (!missed) continue;
        seen.set(first,
                 mirrored_room(light, splat(LAMPLESS), from, along, splat(PICTURE_ROUGHNESS)));
    }
}

// Looks along the rays of some points.
void look(const Shading& s, const Chunk& c, RoughSample* const* samples,
          const int32_t* ray_counts) {
    Chunk hits;
    LobeRay rays[CHUNK];
    Vectors pictures;
    const int32_t most = *std::max_element(ray_counts, ray_counts + c.count);
    for (int32_t number = 0; number < most; number++) {
        const int32_t count = follow_rays(s, c, samples, ray_counts, number, rays, hits);
        see_pictures(*s.light, c, rays, count, pictures);
        for (int32_t k = 0; k < count; k++) {
            const LobeRay& one = rays[k];
            RoughSample& own = *samples[one.point];
            vec3 met = one.lamps;
            if (one.hit == NO_HIT) met = met + vector_at(pictures, k);
            if (one.hit >= 0) met = met + vector_at(hits.light, one.hit);
            const float near = one.weight * one.near, open = one.weight - near;
            own.near = own.near + met * near;
            own.far = own.far + met * open;
            own.weight += one.weight;
            own.open += open;
        }
    }
}

// Gives points whose rays look for area lights alone what pictures of the room have beside.
void see_room(const Shading& s, Chunk& c, RoughSample* const* samples) {
    const auto looks_at_room = [](const RoughSample* sample) { return sample->of_room; };
    if (std::all_of(samples, samples + c.count, looks_at_room)) return;
    light_from_bake(s, c);
    for (int32_t i = 0; i < c.padded; i += 8) {
        if (std::all_of(samples + i, samples + std::min(i + 8, c.count), looks_at_room)) continue;
        Vectors room;
        room.set(0, mirrored_around(*s.light, splat(LAMPLESS), c, i));
        for (int32_t k = i; k < std::min(i + 8, c.count); k++) {
            RoughSample& own = *samples[k];
            if (!own.of_room) own.far = own.far + vector_at(room, k - i) * own.weight;
        }
    }
}

// What bodiless lamps that have no face add to what a point mirrors: highlights, over the share
// of even light that it mirrors.
vec3 highlights(const Light& light, const Chunk& c, int32_t i) {
    vec3 sum(0.0f, 0.0f, 0.0f);
    const vec3 at = vector_at(c.point, i), normal = vector_at(c.normal, i);
    const vec3 view = unit(vector_at(c.ray, i)) * -1.0f;
    const float nv = std::fabs(dot(normal, view)) + 1e-4f, roughness = c.roughness[i];
    const float f0 = head_on_luminance(c, i);
    const float even =
        f0 * mirrored_scale(roughness, min(nv, 1.0f)) + mirrored_bias(roughness, min(nv, 1.0f));
    const float a2 = roughness * roughness * roughness * roughness;
    for (int64_t k = 0; k < light.mirrored_light_count; k++) {
        const Lamp& lamp = light.mirrored_lights[k].lamp;
        if (lamp.kind != LIGHT_POINT && lamp.kind != LIGHT_SPOT) continue;
        const vec3 offset = lamp.position - at;
        const float square = lamp_square(offset), distance = std::sqrt(square);
        const vec3 towards = offset * (1.0f / distance), halfway = unit(towards + view);
        const float nl = dot(normal, towards), nh = dot(normal, halfway), vh = dot(view, halfway);
        const float share = lamp_falloff(lamp, square, -dot(towards, lamp.direction));
        if (!(nl > 0.0f && share > 0.0f)) continue;
        const float fresnel = f0 + (1.0f - f0) * schlick_share(vh);
        const float sent = fresnel * microfacet_lobe(a2, nl, nv, nh) * nl * share / even;
        if (sent < LEAST_HIGHLIGHT) continue;
        if (closest_hit(*light.traced, at, towards, distance).instance != nullptr) continue;
        sum = sum + lamp.colour * sent;
    }
    return sum;
}

// Finds the points of a row of squares that are worth rays.
void find_samples(const Shading& s, int32_t row, int32_t first_row, int32_t end_row,
                  RoughSamples& samples) {
    Chunk c;
    Fragment points[CHUNK];
    RoughSample* of[CHUNK];
    for (int32_t column = 0; column < samples.columns;) {
        c.count = 0;
        for (; column < samples.columns && c.count + FACES <= CHUNK; column++) {
            RoughSample* square = samples.square(column, row);
            for (int32_t face = 0; face < FACES; face++) square[face].id = 0;
            const int32_t count = points_of(s, column, row, first_row, end_row, points + c.count);
            for (int32_t face = 0; face < count; face++) of[c.count++] = square + face;
        }
        if (c.count == 0) continue;
        c.padded = (c.count + 7) & ~7;
        gather_points(s, points, c);
        for (int32_t i = 0; i < c.padded; i += 8) {
            const TracedShare share = traced_share(*s.light, c, i);
            if (!any(share.all > 0.0f)) continue;
            for (int32_t k = i; k < std::min(i + 8, c.count); k++) {
                if (!(share.all[k - i] > 0.0f)) continue;
                RoughSample& own = *of[k] = RoughSample{};
                own.of_room = share.room[k - i] > 0.0f;
                own.id = c.id[k];
                own.seen = points[k];
                own.normal = vector_at(c.normal, k);
                own.point = vector_at(c.point, k);
            }
        }
    }
}

// Calls found(other, weight) for the samples around one that share with it, and for itself.
template <class Found>
void around(const RoughSamples& samples, const RoughSample& own, const Found& found) {
    const int32_t column = own.seen.pixel_x / SQUARE, row = own.seen.pixel_y / SQUARE;
    for (int32_t y = -FAR_SQUARES; y <= FAR_SQUARES; y++) {
        for (int32_t x = -FAR_SQUARES; x <= FAR_SQUARES; x++) {
            const RoughSample* square = samples.square(column + x, row + y);
            if (square == nullptr) continue;
            for (int32_t face = 0; face < FACES; face++) {
                const RoughSample& other = square[face];
                if (other.id != own.id || !(dot(other.normal, own.normal) > ALIKE)) continue;
                const vec3 apart = other.point - own.point;
                const float away = std::sqrt(dot(apart, apart)) * (1.0f / FAR_REACH_M);
                found(other, 1.0f / (1.0f + away + 0.5f * away * away));
            }
        }
    }
}

// Looks along the rays of a row's samples: of those with few around them along more.
void look_around(const Shading& s, int32_t row, RoughSamples& samples) {
    Chunk c;
    Fragment points[CHUNK];
    RoughSample* of[CHUNK];
    int32_t ray_counts[CHUNK];
    RoughSample* next = samples.square(0, row);
    const RoughSample* end = next + FACES * samples.columns;
    while (next != end) {
        c.count = 0;
        for (; next != end && c.count < CHUNK; next++) {
            if (next->id == 0) continue;
            float shared = 0.0f;
            around(samples, *next, [&](const RoughSample&, float weight) { shared += weight; });
            const int32_t times = static_cast<int32_t>(ENOUGH / shared);
            ray_counts[c.count] = RAYS * std::min(std::max(times, 1), MOST_TIMES);
            points[c.count] = next->seen;
            of[c.count++] = next;
        }
        if (c.count == 0) continue;
        c.padded = (c.count + 7) & ~7;
        gather_points(s, points, c);
        look(s, c, of, ray_counts);
        see_room(s, c, of);
        for (int32_t i = 0; i < c.count; i++) of[i]->mirrored = highlights(*s.light, c, i);
    }
}

// Tells what a sample mirrors: of what is far the mean over those around it.
vec3 with_far(const RoughSamples& samples, const RoughSample& own) {
    vec3 far(0.0f, 0.0f, 0.0f);
    float open = 0.0f;
    around(samples, own, [&](const RoughSample& other, float weight) {
        far = far + other.far * weight;
        open += other.open * weight;
    });
    if (!(own.weight > 0.0f)) return own.near;
    const vec3 rest = open > 0.0f ? far * (own.open / open) : far;
    return (own.near + rest) * (1.0f / own.weight);
}

// Adds what a sample mirrors to pixels around it.
void add_sample(const RoughSample& sample, const Chunk& c, int32_t i, i8 wanted, f8 x, f8 y,
                Vec3x8& sum, f8& weight) {
    const i8 own = wanted & (load(c.id + i) == sample.id);
    const f8 across = abs8(x - static_cast<float>(sample.seen.pixel_x)),
             down = abs8(y - static_cast<float>(sample.seen.pixel_y));
    const i8 near = own & (across < REACH) & (down < REACH);
    if (!any(near)) return;
    const f8 cosine = dot(c.normal.at(i), sample.normal);
    const f8 off = abs8(dot(c.point.at(i) - sample.point, sample.normal));
    const f8 turned = clamp8((cosine - TURNED) * (1.0f / (1.0f - TURNED)), 0.0f, 1.0f);
    const f8 facing = off < load(c.depth + i) * OFF_PLANE ? turned * turned : splat(0.0f);
    const f8 counts = near ? (REACH - across) * (REACH - down) * facing : splat(0.0f);
    sum = sum + counts * sample.mirrored;
    weight = weight + counts;
}

}  // namespace

void sample_rough(int64_t threads, const Shading& s, int32_t first_row, int32_t end_row,
                  RoughSamples& samples) {
    samples.first_row = first_row / SQUARE;
    samples.rows = (end_row - 1) / SQUARE + 1 - samples.first_row;
    samples.columns = static_cast<int32_t>((s.width + SQUARE - 1) / SQUARE);
    const size_t squares = static_cast<size_t>(samples.rows) * static_cast<size_t>(samples.columns);
    samples.samples.resize(FACES * squares);
    const auto for_rows = [&](const auto& each) {
        parallel_for(threads, samples.rows, 1, [&](int64_t begin, int64_t end, int64_t) {
            for (int64_t k = begin; k < end; k++) each(samples.first_row + static_cast<int32_t>(k));
        });
    };
    for_rows([&](int32_t row) { find_samples(s, row, first_row, end_row, samples); });
    for_rows([&](int32_t row) { look_around(s, row, samples); });
    for_rows([&](int32_t row) {
        RoughSample* own = samples.square(0, row);
        for (int32_t k = 0; k < FACES * samples.columns; k++, own++) {
            if (own->id != 0) own->mirrored = own->mirrored + with_far(samples, *own);
        }
    });
}

void mirror_rough(const Shading& s, const int32_t* x, const int32_t* y, Chunk& c) {
    const RoughSamples& samples = *s.rough;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 share = traced_share(*s.light, c, i).all;
        const i8 wanted = share > 0.0f;
        if (!any(wanted)) continue;
        const i8 px = load(x + i), py = load(y + i);
        const i8 column = px / SQUARE, row = py / SQUARE;
        const f8 at_x = to_float(px), at_y = to_float(py);
        Vec3x8 sum = splat(vec3(0.0f, 0.0f, 0.0f));
        f8 weight = splat(0.0f);
        // Pixels of a row are in one square.
        for (i8 left = wanted; any(left);) {
            const int k = __builtin_ctz(lane_bits(left));
            const i8 here = left & (column == column[k]) & (row == row[k]);
            left = left & ~here;
            for (int32_t n = 0; n < 9; n++) {
                const RoughSample* square =
                    samples.square(column[k] + n % 3 - 1, row[k] + n / 3 - 1);
                if (square == nullptr) continue;
                for (int32_t face = 0; face < FACES; face++) {
                    if (square[face].id == 0) continue;
                    add_sample(square[face], c, i, here, at_x, at_y, sum, weight);
                }
            }
        }
        const f8 scale = 1.0f / max8(weight, splat(1e-20f));
        const f8 part = share * weight / (weight + ENOUGH_WEIGHT);
        const Vec3x8 seen = c.mirrored.at(i);
        c.mirrored.set(i, seen + part * (sum * scale - seen));
    }
}

}  // namespace sailenv
