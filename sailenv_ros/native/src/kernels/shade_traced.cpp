// Shading: what polished surfaces mirror of what stands around them, by rays.
//
// What a ray meets is lit like what the camera sees, and mirrors the pictures of the room. Where a
// surface bends within a pixel, rays go by other normals from pixel to pixel. For rough ones see
// shade_sampled.cpp.
#include <algorithm>
#include <cstring>

#include "area_faces.h"
#include "traced_hits.h"

namespace sailenv {
namespace {

// Roughness: up to SMOOTH rays tell all that is mirrored; up to ROUGH less and less of what is far.
constexpr float SMOOTH = 0.22f;
// What is nearer than NEAR_M is not far, and what is farther than FAR_M is: there few rays would
// not find what is bright and small, as pictures do.
constexpr float NEAR_M = 0.3f, FAR_M = 0.8f;
// Where few rays stand for many, what they meet counts no more than so many times what pictures
// have, or than light grey: lamps would be single bright pixels.
constexpr float MOST_TIMES = 2.0f, LIGHT_GREY = 0.5f;
// Share that is mirrored of all light that is sent back, where light is even: from where on rays
// are worth it, and count alone.
constexpr float LEAST_SHARE = 0.25f, WHOLE_SHARE = 0.4f;
// By how much more than these it has to be near ROUGH.
constexpr float MORE_OF_ROUGH = 0.2f;
// Of samples at edges, which lie anywhere: angle between the mirrored rays of pixels [rad].
constexpr float USUAL_ANGLE = 0.004f;
// What glass mirrors at both ends of eight pixels: what lies between differs no more.
constexpr float EVEN_SHARE = 0.1f;

// Where the lobe is wide, some pixels of every second row look along rays of it, the fewer the
// wider it is; those around share what these meet. Where much is mirrored sharply, each pixel has
// its own.
constexpr int32_t SHARED_RAYS = 4, OWN_RAYS = 2;
// Of what is too narrow for others beside to share.
constexpr int32_t NARROW_RAYS = 8;
constexpr float PART = 0.85f;  // of the lobe: a ray alone may not be of the steepest facets
// Share that counts of what the row above met, at most, and how far from there a third of it is
// left.
constexpr float KEPT_SHARE = 0.87f, KEPT_M = 0.05f;
// Pixels on either side that do for one where those that should look are of something else.
constexpr int32_t BESIDE = 3;
// Roughness squared over the angle between pixels' rays, from where on every second pixel, every
// fourth and every eighth looks.
constexpr float SECOND = 1.0f, FOURTH = 10.0f, EIGHTH = 24.0f;
// Angle between pixels' rays from where on pixels beside are looked at, so that nothing is missed.
constexpr float CURVED = 0.03f, FLAT_PLANE = 0.01f;

// What of a chunk is looked at by rays.
struct TracedPixels {
    alignas(32) float share[CHUNK];     // of what rays meet in what is mirrored; 0 for none
    alignas(32) float mirrored[CHUNK];  // share of all light that is sent back
    float angle[CHUNK];                 // to the ray of the pixel beside
    bool meets_faces[CHUNK];            // rays tell of the faces of area lights, too
    int32_t step[CHUNK];                // each so many pixels look; 1 for all
    int32_t ray_count[CHUNK];
    Vectors rays;
    TracedRow row;
};

// Whether two surfaces are one and turned alike, so that what the rays of one met counts for both.
bool is_alike(int32_t id, const Vectors& normals, int32_t k, int32_t other_id,
              const Vectors& others, int32_t other) {
    return id == other_id && dot(vector_at(normals, k), vector_at(others, other)) > ALIKE;
}

// Whether a pixel is of another face than its neighbour, which is as flat as the pixel beyond that.
bool is_beside_face(const Chunk& c, int32_t i, int32_t other) {
    const int32_t beyond = 2 * other - i;
    return !is_alike(c.id[i], c.normal, i, c.id[other], c.normal, other) && beyond >= 0 &&
           beyond < c.count && !c.empty[beyond] &&
           is_alike(c.id[beyond], c.normal, beyond, c.id[other], c.normal, other);
}

// The angle to the mirrored ray of a neighbour that is of the same face or bends with it.
float ray_spread(const Chunk& c, const Vectors& rays, int32_t i) {
    float least = 1e30f;
    for (int32_t other = i - 1; other <= i + 1; other += 2) {
        if (other < 0 || other >= c.count || c.empty[other] || c.id[other] != c.id[i]) continue;
        // Of rougher parts no rays are known.
        if (c.roughness[other] >= ROUGH || is_beside_face(c, i, other)) continue;
        const vec3 apart = vector_at(rays, other) - vector_at(rays, i);
        least = min(least, dot(apart, apart));
    }
    return least < 1e30f ? std::sqrt(least) : USUAL_ANGLE;
}

// Each so many pixels look.
int32_t step_of(float roughness, float angle, bool much) {
    const float angles = roughness * roughness / angle;
    if (angles > EIGHTH) return 8;
    if (angles > FOURTH) return 4;
    return angles > SECOND || !much ? 2 : 1;
}

// Finds the pixels that are worth rays: of a row, whose neighbours tell how it bends, or anywhere.
bool choose_pixels(const Chunk& c, bool of_row, TracedPixels& pixels) {
    bool some = false;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 roughness = load(c.roughness + i);
        const i8 smooth = (roughness < ROUGH) & ~load(c.empty + i);
        store(pixels.share + i, splat(0.0f));
        if (!any(smooth)) continue;
        // Those beside look at them, whatever comes of these.
        pixels.rays.set(i, mirrored_ray(c, i));
        const f8 mirrored = mirrored_part(c, i);
        const f8 more = MORE_OF_ROUGH * smoothstep(SMOOTH, ROUGH, roughness);
        const f8 share = smoothstep(LEAST_SHARE, WHOLE_SHARE, mirrored - more);
        const i8 chosen = smooth & ~leads_everywhere(c, i, mirrored);
        store(pixels.share + i, chosen ? share : splat(0.0f));
        store(pixels.mirrored + i, mirrored);
        some |= any(chosen & (share > 0.0f));
    }
    if (!some) return false;
    some = false;
    memset(pixels.ray_count, 0, sizeof pixels.ray_count);
    memset(pixels.row.weight, 0, sizeof pixels.row.weight);
    memset(&pixels.row.sum, 0, sizeof pixels.row.sum);
    memcpy(&pixels.row.normal, &c.normal, sizeof c.normal);
    memcpy(&pixels.row.point, &c.point, sizeof c.point);
    memcpy(pixels.row.id, c.id, sizeof c.id);
    for (int32_t i = 0; i < c.count; i++) {
        if (!(pixels.share[i] > 0.0f)) continue;
        // Where normals turn, mirrored rays turn twice as far.
        const float beside = of_row ? ray_spread(c, pixels.rays, i) : USUAL_ANGLE;
        const vec3 bend = vector_at(c.bend, i);
        const float angle = pixels.angle[i] = max(beside, 2.0f * std::sqrt(dot(bend, bend)));
        pixels.meets_faces[i] = c.roughness[i] < SMOOTH && angle <= FLAT;
        pixels.step[i] = step_of(c.roughness[i], angle, pixels.mirrored[i] >= LARGE_SHARE);
        some |= pixels.share[i] > 0.0f;
    }
    return some;
}

// Whether what the rays of a pixel of a row met counts for another one, too.
bool shares(const Chunk& c, int32_t i, const TracedRow& row, int32_t other) {
    return other >= 0 && other < CHUNK && row.weight[other] > 0.0f &&
           is_alike(c.id[i], c.normal, i, row.id[other], row.normal, other);
}

// Whether pixels that look anyway do for one: those of `above`, the row before it, or, where that
// is null, of its own row.
bool neighbours_do(const Chunk& c, const TracedPixels& pixels, const TracedRow* above, int32_t i) {
    const int32_t step = pixels.step[i], left = i - i % step;
    if (above == nullptr && left == i) return false;
    for (int32_t other = left; other <= left + step && other < c.count; other += step) {
        if (above != nullptr) {
            if (shares(c, i, *above, other)) return true;
        } else if (pixels.share[other] > 0.0f && other % pixels.step[other] == 0 &&
                   is_alike(c.id[i], c.normal, i, c.id[other], c.normal, other)) {
            return true;
        }
    }
    return false;
}

// The same of those beside it, of something narrow.
bool one_beside_does(const Chunk& c, const TracedPixels& pixels, const TracedRow* above,
                     int32_t i) {
    for (int32_t other = i - BESIDE; other <= i + BESIDE; other++) {
        if (above != nullptr && shares(c, i, *above, other)) return true;
        // Those that look for themselves alone, as on a round edge, have few rays.
        if (other < 0 || other >= i || pixels.ray_count[other] == 0 || pixels.step[other] <= 2) {
            continue;
        }
        if (is_alike(c.id[i], c.normal, i, c.id[other], c.normal, other)) return true;
    }
    return false;
}

// Whether a pixel lies on something so narrow that none of those that look is beside it.
bool is_narrow(const Chunk& c, int32_t i, int32_t step) {
    const auto is_of_it = [&](int32_t other) {
        return other < 0 || other >= c.count ||
               is_alike(c.id[i], c.normal, i, c.id[other], c.normal, other);
    };
    return !is_of_it(i - step) && !is_of_it(i + step);
}

// Says how many rays each pixel has; `last` is the nearest row above that has some.
void count_rays(const Chunk& c, bool of_row, const TracedRow* last, TracedPixels& pixels) {
    const TracedRow* above = (c.y & 1) != 0 ? last : nullptr;
    for (int32_t i = 0; i < c.count; i++) {
        if (!(pixels.share[i] > 0.0f)) continue;
        const bool much = pixels.mirrored[i] >= LARGE_SHARE;
        const bool within = pixels.angle[i] < BENT || !of_row;
        pixels.ray_count[i] = much && pixels.angle[i] > CURVED && within ? OWN_RAYS : 1;
        if (!of_row || pixels.step[i] == 1) continue;
        const bool flat = pixels.angle[i] < FLAT_PLANE || pixels.step[i] > 2;
        if (much && flat) {
            const bool narrow = pixels.step[i] > 2 && is_narrow(c, i, pixels.step[i]);
            pixels.ray_count[i] = narrow ? NARROW_RAYS : SHARED_RAYS;
        } else if (much || pixels.step[i] > 2) {
            pixels.ray_count[i] = OWN_RAYS;
        }
        if (neighbours_do(c, pixels, above, i) ||
            (pixels.step[i] > 2 && one_beside_does(c, pixels, above, i))) {
            pixels.ray_count[i] = 0;
        }
    }
}

// One of the rays of a pixel's lobe.
vec3 ray_of_pixel(const Shading& s, const Chunk& c, const TracedPixels& pixels, int32_t i,
                  int32_t number) {
    const float scale = s.table == nullptr ? 1.0f : 0.5f * static_cast<float>(s.width);
    const int32_t column = static_cast<int32_t>(std::floor(c.at_x[i] * scale + 0.5f));
    const int32_t row = static_cast<int32_t>(std::floor(c.at_y[i] * scale + 0.5f));
    // Those who share have other rays each.
    const int32_t begin =
        pixels.step[i] > 1 ? column / pixels.step[i] + 2 * (row >> 1) : 5 * column + 7 * row;
    const float rough = c.roughness[i] * c.roughness[i], least = 0.25f * pixels.angle[i];
    const vec3 own = vector_at(c.normal, i), bend = vector_at(c.bend, i);
    const int32_t facet = begin + number * (LOBE / pixels.ray_count[i]);
    if (4.0f * dot(bend, bend) > FLAT * FLAT) {
        // One of the normals within the pixel.
        const int32_t turned = 5 * column + 3 * row + number * (LOBE / pixels.ray_count[i]);
        const int32_t part = turned & (LOBE - 1);
        const float place = (static_cast<float>(part) + 0.5f) / LOBE - 0.5f;
        const vec3 ray = lobe_ray(c, i, unit(own + bend * place), facet, 0, rough, PART);
        return dot(ray, own) < 0.02f ? vector_at(pixels.rays, i) : ray;
    }
    // Other rays in each row that looks.
    const int32_t turn = pixels.step[i] > 2 ? row >> 1 : 0;
    const vec3 ray = lobe_ray(c, i, own, facet, turn, rough > least ? rough : least, PART);
    // Below the surface there is nothing to be seen.
    return dot(ray, own) < 0.02f ? vector_at(pixels.rays, i) : ray;
}

// By how much what a ray meets counts, not the pictures.
float hit_share(float roughness, float distance) {
    return 1.0f - smoothstep(SMOOTH, ROUGH, roughness) * smoothstep(NEAR_M, FAR_M, distance);
}

// Follows one ray of each pixel that has so many, and adds what they meet.
void trace_rays(const Shading& s, const Chunk& c, int32_t number, TracedPixels& pixels) {
    Chunk hits;
    int32_t from[CHUNK];
    float weights[CHUNK];
    begin_hits(hits);
    int32_t count = 0;
    for (int32_t i = 0; i < c.count; i++) {
        if (number >= pixels.ray_count[i]) continue;
        const vec3 begin = vector_at(c.point, i);
        const vec3 ray = ray_of_pixel(s, c, pixels, i, number);
        const SceneHit met = closest_hit(*s.light->traced, begin, ray, ENDLESS);
        // All of a narrow lobe counts nearly alike.
        const float weight =
            c.roughness[i] < SMOOTH ? dot(vector_at(c.normal, i), ray) : lobe_weight(c, i, ray);
        const float hit = is_drawn(met) ? weight * hit_share(c.roughness[i], met.hit.t) : 0.0f;
        pixels.row.weight[i] += weight;
        vec3 sum = vector_at(pixels.row.sum, i) + vector_at(c.mirrored, i) * (weight - hit);
        if (pixels.meets_faces[i]) {
            sum = sum + radiance_of_faces(*s.light, begin, ray, met.hit.t) * weight;
        }
        put(pixels.row.sum, i, sum);
        if (!(hit > 0.0f)) continue;
        weights[count] = hit;
        const vec3 along = vector_at(c.ray, i);
        const float distance = c.depth[i] * std::sqrt(dot(along, along));
        const float rough = 0.5f * c.roughness[i] * c.roughness[i];
        set_hit(s.light, met, begin, ray, distance, max(pixels.angle[i], rough), hits, count);
        from[count++] = i;
    }
    if (count == 0) return;
    shade_hits(s, hits, count);
    for (int32_t k = 0; k < count; k++) {
        const vec3 sum = vector_at(pixels.row.sum, from[k]);
        vec3 light = vector_at(hits.light, k);
        if (pixels.angle[from[k]] > FLAT) {
            const float usual = luminance(vector_at(c.mirrored, from[k]));
            const float most = max(MOST_TIMES * usual, LIGHT_GREY / s.light->exposure);
            light = clamp(light, 0.0f, most);
        }
        put(pixels.row.sum, from[k], sum + light * weights[k]);
    }
}

// What pixels around a place met.
struct Met {
    vec3 sum = {0.0f, 0.0f, 0.0f};
    float weight = 0.0f;

    void add(const TracedRow& row, int32_t i, float share) {
        sum = sum + vector_at(row.sum, i) * share;
        weight += row.weight[i] * share;
    }
};

// A row with what the rows of the chunks beside it met, where they have looked of late.
struct WideRow {
    const TracedRow &row, *beside;  // `beside` stands between those of its neighbours, or is null

    // The row of a pixel, whose number becomes that within it; null if nothing is known of it.
    const TracedRow* at(int32_t y, int32_t& pixel) const {
        if (pixel >= 0 && pixel < CHUNK) return &row;
        if (beside == nullptr) return nullptr;
        const TracedRow* other = pixel < 0 ? beside - 1 : beside + 1;
        pixel += pixel < 0 ? CHUNK : -CHUNK;
        return other->y >= y - 2 ? other : nullptr;
    }
};

// Adds what the pixels around a place in a row met, the nearer the more.
void add_around(const Chunk& c, int32_t i, int32_t step, int32_t reach, float share,
                const WideRow& row, Met& met) {
    const int32_t left = i - i % step;
    for (int32_t place = left - step; place <= left + 2 * step; place += step) {
        const int32_t away = place < i ? i - place : place - i;
        if (away >= reach) continue;
        int32_t other = place;
        const TracedRow* of = row.at(c.y, other);
        if (of == nullptr || !shares(c, i, *of, other)) continue;
        met.add(*of, other, share * static_cast<float>(reach - away));
    }
}

// What the pixels around one of a row met, or one that lies anywhere by itself. `beside` is as in
// `WideRow`, null for the latter; `last` is the nearest row above that has rays, if it is near.
Met met_around(const Chunk& c, const TracedPixels& pixels, const TracedRow* beside,
               const TracedRow* last, int32_t i) {
    Met met;
    const int32_t step = pixels.step[i];
    if (beside == nullptr) {
        if (shares(c, i, pixels.row, i)) met.add(pixels.row, i, 1.0f);
        return met;
    }
    if (step > 2) {
        // A row with rays knows already what those above it met.
        const TracedRow* row = (c.y & 1) != 0 ? last : &pixels.row;
        // Where nothing is known of the chunk beside, those on one side alone would tell.
        const int32_t reach = last == nullptr ? step + 1 : 2 * step;
        if (row != nullptr) add_around(c, i, step, reach, 1.0f, {*row, beside}, met);
        if (met.weight > 0.0f) return met;
        for (int32_t other = i - BESIDE; other <= i + BESIDE; other++) {
            if (shares(c, i, pixels.row, other)) met.add(pixels.row, other, 1.0f);
            if (last != nullptr && shares(c, i, *last, other)) met.add(*last, other, 1.0f);
        }
        return met;
    }
    const float rough = c.roughness[i] * c.roughness[i];
    const bool soft = rough > pixels.angle[i] || pixels.angle[i] > CURVED;
    const int32_t reach = step > 1 ? 2 * step : soft ? 2 : 1;
    add_around(c, i, step, reach, 1.0f, {pixels.row, nullptr}, met);
    if (i % step != 0) {
        add_around(c, i, 1, 1, static_cast<float>(reach), {pixels.row, nullptr}, met);
    }
    if (reach > 1 && last != nullptr) {
        add_around(c, i, step, reach, last->y == c.y - 1 ? 1.0f : 0.5f, {*last, nullptr}, met);
    }
    return met;
}

// The pixel of the row above whose rays go on in one of a row, or -1: the one above it or, where
// something narrow slants, the nearest beside that. Of those, each so many look.
int32_t one_above(const Chunk& c, const TracedRow& last, int32_t i, int32_t step) {
    for (int32_t away = 0; away <= step; away++) {
        if (shares(c, i, last, i - away)) return i - away;
        if (shares(c, i, last, i + away)) return i + away;
    }
    return -1;
}

// Adds to what few pixels met what those above them did, less and less of it from row to row.
void add_rows_above(const Chunk& c, const TracedRow& last, TracedPixels& pixels) {
    for (int32_t i = 0; i < c.count; i++) {
        const bool few = pixels.step[i] > 2 || pixels.angle[i] > BENT;
        if (pixels.ray_count[i] == 0 || !few) continue;
        const int32_t above = one_above(c, last, i, pixels.step[i]);
        if (above < 0) continue;
        const vec3 sum = vector_at(pixels.row.sum, i);
        const vec3 apart = vector_at(pixels.row.point, i) - vector_at(last.point, above);
        const float away = std::sqrt(dot(apart, apart)) * (1.0f / KEPT_M);
        const float kept = min(KEPT_SHARE, 1.0f / (1.0f + away + 0.5f * away * away));
        put(pixels.row.sum, i, sum + vector_at(last.sum, above) * kept);
        pixels.row.weight[i] += kept * last.weight[above];
    }
}

}  // namespace

void trace_reflections(const Shading& s, Chunk& c, TracedRow* before) {
    TracedPixels pixels;
    if (!choose_pixels(c, before != nullptr, pixels)) return;
    const bool follows = before != nullptr && (before->y == c.y - 1 || before->y == c.y - 2);
    const TracedRow* last = follows ? before : nullptr;
    count_rays(c, before != nullptr, last, pixels);
    const int32_t most = *std::max_element(pixels.ray_count, pixels.ray_count + c.count);
    for (int32_t number = 0; number < most; number++) trace_rays(s, c, number, pixels);
    const bool looks = before != nullptr && (c.y & 1) == 0;
    if (looks && last != nullptr) add_rows_above(c, *last, pixels);
    for (int32_t i = 0; i < c.count; i++) {
        if (!(pixels.share[i] > 0.0f)) continue;
        const Met met = met_around(c, pixels, before, last, i);
        if (!(met.weight > 0.0f)) continue;
        const vec3 mean = met.sum * (1.0f / met.weight);
        put(c.mirrored, i, mix(vector_at(c.mirrored, i), mean, pixels.share[i]));
        if (pixels.meets_faces[i]) {
            put(c.faces, i, vector_at(c.faces, i) * (1.0f - pixels.share[i]));
        }
    }
    if (!looks) return;
    *before = pixels.row;
    before->y = c.y;
}

namespace {

// What some of eight rays from glass met.
struct GlassHits {
    uint32_t met = 0;  // bits of those that met anything
    vec3 light[8];
};

void look_from_glass(const Shading& s, Vec3x8 point, Vec3x8 ray, f8 distance, uint32_t lanes,
                     GlassHits& found) {
    Chunk hits;
    begin_hits(hits);
    int32_t of[8], count = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const int32_t k = __builtin_ctz(lanes);
        const vec3 begin(point.x[k], point.y[k], point.z[k]);
        const vec3 along(ray.x[k], ray.y[k], ray.z[k]);
        const SceneHit met = closest_hit(*s.light->traced, begin, along, ENDLESS);
        if (!is_drawn(met)) continue;
        set_hit(s.light, met, begin, along, distance[k], USUAL_ANGLE, hits, count);
        of[count++] = k;
    }
    if (count == 0) return;
    shade_hits(s, hits, count);
    for (int32_t j = 0; j < count; j++) {
        found.met |= 1u << of[j];
        found.light[of[j]] = vector_at(hits.light, j);
    }
}

// Whether what lies between two rays may be neither one's nor between theirs.
bool differ(const GlassHits& found, int32_t first, int32_t last) {
    const uint32_t both = 1u << first | 1u << last;
    if ((found.met & both) != both) return (found.met & both) != 0;
    const float a = luminance(found.light[first]), b = luminance(found.light[last]);
    return std::fabs(a - b) > EVEN_SHARE * max(a, b);
}

}  // namespace

Vec3x8 trace_glass(const Shading& s, Vec3x8 point, Vec3x8 ray, f8 distance, i8 wanted,
                   Vec3x8 mirrored) {
    const uint32_t lanes = lane_bits(wanted);
    if (lanes == 0) return mirrored;
    const int32_t first = __builtin_ctz(lanes), last = 31 - __builtin_clz(lanes);
    const uint32_t ends = 1u << first | 1u << last;
    GlassHits found;
    look_from_glass(s, point, ray, distance, ends, found);
    const bool edge = differ(found, first, last);
    if (edge) look_from_glass(s, point, ray, distance, lanes & ~ends, found);
    if (found.met == 0) return mirrored;
    const float part = 1.0f / static_cast<float>(std::max(last - first, 1));
    for (int32_t k = first; k <= last; k++) {
        vec3 light = found.light[k];
        if ((found.met >> k & 1u) == 0) {
            if (edge) continue;
            light =
                mix(found.light[first], found.light[last], part * static_cast<float>(k - first));
        }
        mirrored.x[k] = light.x;
        mirrored.y[k] = light.y;
        mirrored.z[k] = light.z;
    }
    return mirrored;
}

}  // namespace sailenv
