// Shading: samples of what surfaces mirror of what stands around them, by rays.
//
// A point in each square of pixels looks along rays of its lobe, and points around it share what
// these meet. Of most surfaces one ray tells how wrong pictures of the room are there, and another
// whether an area light is seen; rough ones that mirror much look along as many rays as tell all
// they mirror. What pixels do with samples: shade_sampled.cpp.
#include "mirror_samples.h"

#include <algorithm>
#include <cstdlib>

#include "../threads.h"
#include "area_faces.h"
#include "shade_sampled.h"
#include "traced_hits.h"

namespace sailenv {
namespace {

constexpr int32_t SQUARE = MirrorSamples::SQUARE, FACES = MirrorSamples::FACES;
constexpr int32_t RAYS = 8;               // of a sample of what mirrors much
constexpr float LEAST_HIGHLIGHT = 1e-3f;  // over the lamp's radiant intensity
constexpr float LEAST_RISE = 0.02f;       // rays that rise less from a surface are below it
// What is nearer than NEAR_M stands near, and what is farther than FAR_M does not.
constexpr float NEAR_M = 0.1f, FAR_M = 0.3f;
// Roughness of the pictures of the room that rays see.
constexpr float PICTURE_ROUGHNESS = 0.2f;
// How many squares on each side of a sample share what is far, and at what distance four tenths of
// it count.
constexpr int32_t FAR_SQUARES = 2;
constexpr float FAR_REACH_M = 0.1f;
// Samples enough to share; with fewer around it, a sample has up to so many times as many rays.
constexpr float ENOUGH = 8.0f;
constexpr int32_t MOST_TIMES = 4;
// Where a ray and a picture are compared, neither counts for more than so many times the mean
// radiance around, or than light grey: one ray stands for many pixels.
constexpr float MOST_OF_MEAN = 4.0f, LIGHT_GREY = 0.5f;
// Luminance of an area light's face, as a surface mirrors it, over the mean radiance around, from
// where on it is looked at.
constexpr float LEAST_FACE = 0.02f;
// The face ends a little before where it is.
constexpr float BEFORE_FACE_M = 1e-3f;
// Points of pictures of the room from its middle, without lamps and with them: see
// reflection_points.py.
constexpr int32_t LAMPLESS = 0, MIDDLE = 1;

// The pixel of a square whose point looks: in each row of squares another column, and so on.
constexpr int32_t PLACES[SQUARE] = {0, 4, 2, 6, 1, 5, 3, 7};

// Numbers of four by four squares, of which neighbours are far apart (Bayer 1973, "An optimum
// method for two-level rendition of continuous-tone pictures").
constexpr int32_t APART[16] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
int32_t number_of_square(const MirrorSample& sample) {
    const int32_t column = sample.seen.pixel_x / SQUARE, row = sample.seen.pixel_y / SQUARE;
    return APART[(column & 3) + 4 * (row & 3)];
}

// Whether a triangle's part may have samples.
bool may_have_samples(const Shading& s, const Triangle& t) {
    const Part& part = s.parts->parts[t.part];
    return part.detail_map != nullptr || part.roughness < ROUGHEST;
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

// Finds a pixel of each of the first two faces in a square; returns how many there are. Where
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
        if (!may_have_samples(s, t)) continue;
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
    int32_t point, hit;  // `hit` is among the places that are shaded, or NO_HIT
    float weight, near;  // `near` is the share of what is met that stands near
    vec3 ray;
};

constexpr int32_t NO_HIT = -1;

// Follows the ray of a number of each point; returns how many there are.
int32_t follow_rays(const Shading& s, const Chunk& c, MirrorSample* const* samples,
                    const int32_t* ray_counts, int32_t number, LobeRay* rays, Chunk& hits) {
    int32_t count = 0, hit_count = 0;
    begin_hits(hits);
    for (int32_t i = 0; i < c.count; i++) {
        if (number >= ray_counts[i]) continue;
        const MirrorSample& own = *samples[i];
        const int32_t column = own.seen.pixel_x / SQUARE, row = own.seen.pixel_y / SQUARE;
        // Every second facet; neighbours have the others.
        const int32_t facet = own.of_room
                                  ? number * (LOBE / RAYS) + ((column + row + number / RAYS) & 1)
                                  : number_of_square(own);
        const vec3 ray = lobe_ray(c, i, vector_at(c.normal, i), facet,
                                  3 * column + 5 * row + 7 * (number / RAYS),
                                  c.roughness[i] * c.roughness[i], 1.0f);
        if (dot(ray, vector_at(c.normal, i)) < LEAST_RISE) continue;
        const vec3 begin = vector_at(c.point, i);
        LobeRay& one = rays[count++];
        one = {i, NO_HIT, lobe_weight(c, i, ray), 0.0f, ray};
        const SceneHit met = closest_hit(*s.light->traced, begin, ray, ENDLESS);
        if (!is_drawn(met)) continue;
        one.near = 1.0f - smoothstep(NEAR_M, FAR_M, met.hit.t);
        const vec3 along = vector_at(c.ray, i);
        const float distance = c.depth[i] * std::sqrt(dot(along, along));
        set_hit(s.light, met, begin, ray, distance, 0.5f * c.roughness[i] * c.roughness[i], hits,
                hit_count);
        one.hit = hit_count++;
    }
    if (hit_count > 0) shade_hits(s, hits, hit_count);
    return count;
}

// What pictures of the room have where rays lead: those that their surfaces use, but without lamps
// from the middle.
void see_pictures(const Light& light, const Chunk& c, const LobeRay* rays, int32_t count,
                  Vectors& seen) {
    for (int32_t first = 0; first < count; first += 8) {
        Vec3x8 from{}, along{};
        i8 point{};
        f8 roughness{};
        for (int32_t k = 0; k < 8; k++) {
            const LobeRay& one = rays[std::min(first + k, count - 1)];
            const int32_t i = one.point, own = light.reflection_table[c.id[i]];
            from.x[k] = c.point.x[i], along.x[k] = one.ray.x;
            from.y[k] = c.point.y[i], along.y[k] = one.ray.y;
            from.z[k] = c.point.z[i], along.z[k] = one.ray.z;
            point[k] = own == MIDDLE ? LAMPLESS : own;
            roughness[k] = min(c.roughness[i], PICTURE_ROUGHNESS);
        }
        seen.set(first, mirrored_room(light, point, from, along, roughness));
    }
}

vec3 no_brighter(vec3 light, float most) {
    const float bright = luminance(light);
    return bright > most ? light * (most / bright) : light;
}

// Looks along the rays of some points.
void look(const Shading& s, const Chunk& c, MirrorSample* const* samples,
          const int32_t* ray_counts) {
    Chunk hits;
    LobeRay rays[CHUNK];
    Vectors pictures;
    const Light& light = *s.light;
    const int32_t most = *std::max_element(ray_counts, ray_counts + c.count);
    for (int32_t number = 0; number < most; number++) {
        const int32_t count = follow_rays(s, c, samples, ray_counts, number, rays, hits);
        see_pictures(light, c, rays, count, pictures);
        for (int32_t k = 0; k < count; k++) {
            const LobeRay& one = rays[k];
            MirrorSample& own = *samples[one.point];
            const vec3 picture = vector_at(pictures, k);
            const vec3 met = one.hit == NO_HIT ? picture : vector_at(hits.light, one.hit);
            const ReflectionPoint& seen_from =
                light.reflection_points[light.reflection_table[own.id]];
            const float bright =
                max(MOST_OF_MEAN * seen_from.light[0], LIGHT_GREY / light.exposure);
            own.difference = own.difference +
                             (no_brighter(met, bright) - no_brighter(picture, bright)) * one.weight;
            own.difference_weight += one.weight;
            if (!own.of_room) continue;
            const float near = one.weight * one.near, open = one.weight - near;
            own.near = own.near + met * near;
            own.far = own.far + met * open;
            own.weight += one.weight;
            own.open += open;
        }
    }
}

// Looks at the face of an area light from where a sample is: at a place that its lobe meets.
bool sees_face(const Shading& s, const RayLight& light, const MirrorSample& sample,
               const LobeOnFace& met, int lane) {
    const int32_t number = number_of_square(sample), other = (5 * number + 3) & 15;
    const auto part = [](int32_t k) { return (static_cast<float>(k) + 0.5f) / 16.0f; };
    const float x = LobeOnFace::place(met.across, lane, part(number));
    const float y = LobeOnFace::place(met.up, lane, part(other));
    const vec3 to = place_on_face(light, x, y) - sample.point;
    const float distance = std::sqrt(dot(to, to));
    if (dot(to, sample.normal) < LEAST_RISE * distance) return false;
    return closest_hit(*s.light->traced, sample.point, to * (1.0f / distance),
                       distance - BEFORE_FACE_M)
               .instance == nullptr;
}

// Looks at the faces of area lights from some points.
void look_at_faces(const Shading& s, const Chunk& c, MirrorSample* const* samples) {
    const Light& light = *s.light;
    const float least = LEAST_FACE * light.reflection_points[LAMPLESS].light[0];
    for (int64_t n = 0; n < light.mirrored_light_count; n++) {
        const RayLight& l = light.mirrored_lights[n];
        if (l.lamp.kind != LIGHT_AREA) continue;
        const vec3 radiance = face_radiance(l);
        for (int32_t i = 0; i < c.padded; i += 8) {
            const Vec3x8 ray = c.ray.at(i), along = ray * inverse_length(ray);
            const Vec3x8 point = c.point.at(i), normal = c.normal.at(i);
            const f8 roughness = load(c.roughness + i);
            const LobeOnFace met = lobe_on_face(l, point, along, normal, roughness);
            const f8 head_on = luminance(reflectance_head_on(c.base.at(i), load(c.metallic + i)));
            const FaceLight one = light_of_face(l, met, point, along, normal, roughness, head_on);
            for (int32_t k = i; k < std::min(i + 8, c.count); k++) {
                const float bright = luminance(radiance) * one.share[k - i];
                if (!(bright > least)) continue;
                MirrorSample& own = *samples[k];
                own.faces = own.faces + radiance * one.share[k - i];
                own.around = own.around + radiance * one.around[k - i];
                own.faces_met += bright;
                if (sees_face(s, l, own, met, k - i)) own.faces_seen += bright;
            }
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
                  MirrorSamples& samples) {
    Chunk c;
    Fragment points[CHUNK];
    MirrorSample* of[CHUNK];
    for (int32_t column = 0; column < samples.columns;) {
        c.count = 0;
        for (; column < samples.columns && c.count + FACES <= CHUNK; column++) {
            MirrorSample* square = samples.square(column, row);
            for (int32_t face = 0; face < FACES; face++) square[face].id = 0;
            const int32_t count = points_of(s, column, row, first_row, end_row, points + c.count);
            for (int32_t face = 0; face < count; face++) of[c.count++] = square + face;
        }
        if (c.count == 0) continue;
        c.padded = (c.count + 7) & ~7;
        gather_points(s, points, c);
        for (int32_t i = 0; i < c.padded; i += 8) {
            const i8 sampled = (load(c.roughness + i) < ROUGHEST) & ~load(c.empty + i);
            if (!any(sampled)) continue;
            const f8 of_room = share_of_room(c, i);
            for (int32_t k = i; k < std::min(i + 8, c.count); k++) {
                if (!sampled[k - i]) continue;
                MirrorSample& own = *of[k] = MirrorSample{};
                own.of_room = of_room[k - i] > 0.0f;
                own.id = c.id[k];
                own.seen = points[k];
                own.normal = vector_at(c.normal, k);
                own.point = vector_at(c.point, k);
            }
        }
    }
}

// Calls found(other, columns, rows) for the samples around one that share with it, and for itself;
// they are so many squares apart.
template <class Found>
void around(const MirrorSamples& samples, const MirrorSample& own, const Found& found) {
    const int32_t column = own.seen.pixel_x / SQUARE, row = own.seen.pixel_y / SQUARE;
    for (int32_t y = -FAR_SQUARES; y <= FAR_SQUARES; y++) {
        for (int32_t x = -FAR_SQUARES; x <= FAR_SQUARES; x++) {
            const MirrorSample* square = samples.square(column + x, row + y);
            if (square == nullptr) continue;
            for (int32_t face = 0; face < FACES; face++) {
                const MirrorSample& other = square[face];
                if (other.id != own.id || !(dot(other.normal, own.normal) > ALIKE)) continue;
                found(other, x, y);
            }
        }
    }
}

// How much what is far from one sample counts for another.
float shared_far(const MirrorSample& own, const MirrorSample& other) {
    const vec3 apart = other.point - own.point;
    const float away = std::sqrt(dot(apart, apart)) * (1.0f / FAR_REACH_M);
    return 1.0f / (1.0f + away + 0.5f * away * away);
}

// Looks along the rays of a row's samples: of those that mirror much with few around them along
// more.
void look_around(const Shading& s, int32_t row, MirrorSamples& samples) {
    Chunk c;
    Fragment points[CHUNK];
    MirrorSample* of[CHUNK];
    int32_t ray_counts[CHUNK];
    MirrorSample* next = samples.square(0, row);
    const MirrorSample* end = next + FACES * samples.columns;
    while (next != end) {
        c.count = 0;
        for (; next != end && c.count < CHUNK; next++) {
            if (next->id == 0) continue;
            ray_counts[c.count] = 1;
            if (next->of_room) {
                float shared = 0.0f;
                around(samples, *next, [&](const MirrorSample& other, int32_t, int32_t) {
                    if (other.of_room) shared += shared_far(*next, other);
                });
                const int32_t times = static_cast<int32_t>(ENOUGH / shared);
                ray_counts[c.count] = RAYS * std::min(std::max(times, 1), MOST_TIMES);
            }
            points[c.count] = next->seen;
            of[c.count++] = next;
        }
        if (c.count == 0) continue;
        c.padded = (c.count + 7) & ~7;
        gather_points(s, points, c);
        look(s, c, of, ray_counts);
        look_at_faces(s, c, of);
        for (int32_t i = 0; i < c.count; i++) {
            if (of[i]->of_room) of[i]->mirrored = highlights(*s.light, c, i);
        }
    }
}

// Tells what a sample mirrors: of what is far the mean over those around it.
vec3 with_far(const MirrorSamples& samples, const MirrorSample& own) {
    vec3 far(0.0f, 0.0f, 0.0f);
    float open = 0.0f;
    around(samples, own, [&](const MirrorSample& other, int32_t, int32_t) {
        if (!other.of_room) return;
        const float weight = shared_far(own, other);
        far = far + other.far * weight;
        open += other.open * weight;
    });
    if (!(own.weight > 0.0f)) return own.near;
    const vec3 rest = open > 0.0f ? far * (own.open / open) : far;
    return (own.near + rest) * (1.0f / own.weight);
}

// Tells by how much pictures of the room are wrong, and which share of area lights is seen.
void mean_around(const MirrorSamples& samples, MirrorSample& own) {
    vec3 difference(0.0f, 0.0f, 0.0f);
    float weight = 0.0f, seen = 0.0f, met = 0.0f;
    around(samples, own, [&](const MirrorSample& other, int32_t columns, int32_t rows) {
        // One ray each is few, however far apart they are in the world.
        const float counts = static_cast<float>((FAR_SQUARES + 1 - std::abs(columns)) *
                                                (FAR_SQUARES + 1 - std::abs(rows)));
        difference = difference + other.difference * counts;
        weight += other.difference_weight * counts;
        seen += other.faces_seen * counts;
        met += other.faces_met * counts;
    });
    own.correction = weight > 0.0f ? difference * (1.0f / weight) : difference;
    own.faces_share = met > 0.0f ? seen / met : 1.0f;
}

}  // namespace

void sample_mirrored(int64_t threads, const Shading& s, int32_t first_row, int32_t end_row,
                     MirrorSamples& samples) {
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
        MirrorSample* own = samples.square(0, row);
        for (int32_t k = 0; k < FACES * samples.columns; k++, own++) {
            if (own->id == 0) continue;
            mean_around(samples, *own);
            if (own->of_room) own->mirrored = own->mirrored + with_far(samples, *own);
        }
    });
}

}  // namespace sailenv
