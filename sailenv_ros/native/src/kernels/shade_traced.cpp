// Shading: what polished surfaces mirror of what stands around them, by rays.
//
// What a ray meets is lit like what the camera sees, and mirrors the pictures of the room. Rough
// surfaces, and such as bend more from pixel to pixel than rays can stand for, mirror these
// pictures themselves.
#include "rays.h"
#include "shade_chunk.h"
#include "texture.h"
#include "traced_types.h"

namespace sailenv {
namespace {

constexpr float BEGIN_M = 5e-4f;  // a point lies that far from its surface, at most

// From where on a surface mirrors pictures of the room, more and more, and alone.
constexpr float SMOOTH = 0.22f, ROUGH = 0.36f;
// The same of the angle between the mirrored rays of neighbouring pixels [rad].
constexpr float FLAT = 0.05f, BENT = 0.15f;
// Share that is mirrored of all light that is sent back, where light is even: from where on rays
// are worth it, and several are.
constexpr float LEAST_SHARE = 0.25f, WHOLE_SHARE = 0.4f, LARGE_SHARE = 0.6f;
// Of samples at edges, which lie anywhere: angle between the mirrored rays of pixels [rad].
constexpr float USUAL_ANGLE = 0.004f;

// Of a rough surface some pixels of every second row look along rays of the lobe, the fewer the
// wider it is; those around share what these meet. Where much is mirrored sharply, each pixel has
// its own.
constexpr int32_t LOBE = 16, ROUGH_RAYS = 4, OWN_RAYS = 2;
// Roughness squared over the angle between pixels' rays, from where on every second pixel, every
// fourth and every eighth looks.
constexpr float SECOND = 1.0f, FOURTH = 18.0f, EIGHTH = 50.0f;
// Angle between pixels' rays from where on pixels beside are looked at, so that nothing is missed.
constexpr float CURVED = 0.03f, FLAT_PLANE = 0.01f;
constexpr float ALIKE = 0.97f;  // cosine between normals of those who share

// Slopes of the microfacets that rays meet, over roughness squared: the 85 % of GGX's lobe that are
// least steep, at points of the R2 sequence (Roberts 2018, "The unreasonable effectiveness of
// quasirandom sequences").
constexpr float SLOPE_X[LOBE] = {-1.21133f, 0.55872f,  -0.13554f, -0.02382f, 0.81008f,  -0.78981f,
                                 0.56292f,  -0.17275f, 0.99556f,  -0.29785f, -0.06746f, 0.12027f,
                                 -1.25322f, 0.95723f,  -0.58808f, 0.19721f};
constexpr float SLOPE_Y[LOBE] = {-0.56852f, 0.67262f,  -0.52139f, 0.12766f,  -1.12682f, 0.44042f,
                                 -0.03939f, -0.06680f, 1.04116f,  -0.88632f, 0.58596f,  -0.19466f,
                                 0.81845f,  -0.13461f, -0.18134f, 0.17932f};

// What of a chunk is looked at by rays.
struct Looks {
    alignas(32) float share[CHUNK];  // of what rays meet in what is mirrored; 0 for none
    alignas(32) float mirrored[CHUNK];
    float angle[CHUNK];   // to the ray of the pixel beside
    int32_t step[CHUNK];  // each so many pixels look; 1 for all
    int32_t rays_of[CHUNK];
    Vectors rays;
    TracedRow met;
};

struct Met {
    Hit hit;
    const TracedInstance* instance = nullptr;
};

Met first_met(const TracedScene& scene, const Ray& r) {
    Met met;
    if (scene.count == 0) return met;
    walk_tree<true>(scene.nodes, box_ray(r.o, r.d, 0.0f), 0.0f, met.hit.t,
                    [&](int32_t leaf, float) {
                        const TracedInstance& one = scene.instances[scene.order[leaf]];
                        const float before = met.hit.t;
                        meet_instance(one.placed, r, met.hit);
                        if (met.hit.t < before) met.instance = &one;
                        return met.hit.t;
                    });
    return met;
}

// Whether it is drawn. Backs are not: where one is met, the ray is inside of something.
bool is_drawn(const Met& met) {
    return met.instance != nullptr && met.hit.front &&
           met.instance->part_of[met.instance->placed.shape->order[met.hit.triangle]] >= 0;
}

// Whether two surfaces are one and turned alike, so that what the rays of one met counts for both.
bool is_alike(int32_t id, const Vectors& normals, int32_t k, int32_t other_id,
              const Vectors& others, int32_t other) {
    return id == other_id && normals.x[k] * others.x[other] + normals.y[k] * others.y[other] +
                                     normals.z[k] * others.z[other] >
                                 ALIKE;
}

// Whether a pixel is of another face than its neighbour, which is as flat as the pixel beyond that.
bool is_beside_face(const Chunk& c, int32_t i, int32_t other) {
    const int32_t beyond = 2 * other - i;
    return !is_alike(c.id[i], c.normal, i, c.id[other], c.normal, other) && beyond >= 0 &&
           beyond < c.count && !c.empty[beyond] &&
           is_alike(c.id[beyond], c.normal, beyond, c.id[other], c.normal, other);
}

// The angle to the mirrored ray of a neighbour that is of the same face or bends with it.
float angle_beside(const Chunk& c, const Vectors& rays, int32_t i) {
    float least = 1e30f;
    for (int32_t other = i - 1; other <= i + 1; other += 2) {
        if (other < 0 || other >= c.count || c.empty[other] || c.id[other] != c.id[i]) continue;
        if (is_beside_face(c, i, other)) continue;
        const float x = rays.x[other] - rays.x[i], y = rays.y[other] - rays.y[i],
                    z = rays.z[other] - rays.z[i];
        const float square = x * x + y * y + z * z;
        least = square < least ? square : least;
    }
    return least < 1e30f ? std::sqrt(least) : USUAL_ANGLE;
}

// What a triangle's corners know of a place on it, and what its part is made of.
void set_met(const Met& met, vec3 from, vec3 ray, float way, float angle, Chunk& c, int32_t i) {
    const TracedInstance& one = *met.instance;
    const RayShape& shape = *one.placed.shape;
    const int32_t triangle = shape.order[met.hit.triangle];
    const Part& part = one.parts[one.part_of[triangle]];
    const uint32_t* vertex = one.vertices + 3 * static_cast<int64_t>(triangle);
    const float* corner[3];
    for (int k = 0; k < 3; k++) corner[k] = part.vertices + 8 * static_cast<int64_t>(vertex[k]);
    const float weight[3] = {1.0f - met.hit.second - met.hit.third, met.hit.second, met.hit.third};
    float known[8];
    for (int k = 0; k < 7; k++) {
        known[k] = weight[0] * corner[0][k] + weight[1] * corner[1][k] + weight[2] * corner[2][k];
    }
    const float* m = one.placed.body_from_world;
    const float own[3] = {known[0] * one.inverse_scale[0], known[1] * one.inverse_scale[1],
                          known[2] * one.inverse_scale[2]};
    vec3 normal(own[0] * m[0] + own[1] * m[4] + own[2] * m[8],
                own[0] * m[1] + own[1] * m[5] + own[2] * m[9],
                own[0] * m[2] + own[1] * m[6] + own[2] * m[10]);
    const float length = std::sqrt(dot(normal, normal));
    normal =
        normal * ((dot(normal, ray) > 0.0f ? -1.0f : 1.0f) / (length > 1e-20f ? length : 1.0f));
    c.normal.x[i] = normal.x;
    c.normal.y[i] = normal.y;
    c.normal.z[i] = normal.z;
    c.u[i] = known[3];
    c.v[i] = known[4];
    const bool charted = part.has_chart && one.at_baked_pose;
    c.light_u[i] = charted ? known[5] * part.chart[2] + part.chart[0] : 0.0f;
    c.light_v[i] = charted ? known[6] * part.chart[3] + part.chart[1] : 0.0f;
    c.base.x[i] = part.colour[0];
    c.base.y[i] = part.colour[1];
    c.base.z[i] = part.colour[2];
    c.roughness[i] = part.roughness;
    c.metallic[i] = part.metallic;
    c.emission[i] = part.emission;
    c.id[i] = part.id;
    c.empty[i] = 0;
    c.ray.x[i] = ray.x;
    c.ray.y[i] = ray.y;
    c.ray.z[i] = ray.z;
    c.point.x[i] = from.x + ray.x * met.hit.t;
    c.point.y[i] = from.y + ray.y * met.hit.t;
    c.point.z[i] = from.z + ray.z * met.hit.t;
    c.colour_texels[i] = WHITE_TEXELS;
    c.colour_log2[i] = NO_MAP;
    c.ux[i] = c.vx[i] = c.uy[i] = c.vy[i] = 0.0f;
    if (part.colour_map == nullptr) return;
    c.coloured = true;
    c.colour_texels[i] = part.colour_map->texels;
    c.colour_log2[i] = static_cast<float>(part.colour_map->log2_size);
    // A pixel covers a square of the surface.
    const float* block = static_cast<const float*>(shape.triangles) +
                         9 * WIDTH * int64_t{met.hit.triangle / WIDTH} + met.hit.triangle % WIDTH;
    const vec3 a(block[3 * WIDTH], block[4 * WIDTH], block[5 * WIDTH]);
    const vec3 b(block[6 * WIDTH], block[7 * WIDTH], block[8 * WIDTH]);
    const vec3 across = cross(a, b);
    const float du = corner[1][3] - corner[0][3], dv = corner[1][4] - corner[0][4];
    const float eu = corner[2][3] - corner[0][3], ev = corner[2][4] - corner[0][4];
    const float area = std::sqrt(dot(across, across)), texture_area = std::fabs(du * ev - dv * eu);
    const float side = angle * (way + met.hit.t) * std::sqrt(texture_area / (area + 1e-20f));
    c.ux[i] = c.vy[i] = side;
}

void set_nothing(Chunk& c, int32_t i) {
    c.empty[i] = -1;
    c.id[i] = 0;
    c.colour_texels[i] = WHITE_TEXELS;
    c.colour_log2[i] = NO_MAP;
    c.base.x[i] = c.base.y[i] = c.base.z[i] = 0.0f;
    c.roughness[i] = 1.0f;
    c.metallic[i] = c.emission[i] = 0.0f;
    c.normal.x[i] = c.normal.y[i] = 0.0f;
    c.normal.z[i] = 1.0f;
    c.ray.x[i] = c.ray.y[i] = 0.0f;
    c.ray.z[i] = -1.0f;
    c.point.x[i] = c.point.y[i] = c.point.z[i] = 0.0f;
    c.u[i] = c.v[i] = c.light_u[i] = c.light_v[i] = 0.0f;
    c.ux[i] = c.vx[i] = c.uy[i] = c.vy[i] = 0.0f;
}

void begin_met(Chunk& c) {
    c.hit = c.parallel = true;
    c.missed = c.coloured = c.detailed = false;
}

// The light that the first `count` places that were met send back along the rays.
void light_met(const Shading& s, Chunk& c, int32_t count) {
    c.count = count;
    c.padded = (count + 7) & ~7;
    for (int32_t k = count; k < c.padded; k++) set_nothing(c, k);
    if (c.coloured) colour_for_picture(c);
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 root = c.base.at(i);
        c.base.set(i, root * root);
        store(c.roughness + i, clamp8(load(c.roughness + i), LEAST_ROUGHNESS, 1.0f));
        store(c.metallic + i, clamp8(load(c.metallic + i), 0.0f, 1.0f));
    }
    light_from_bake(s, c);
    mirror_surroundings(s, c);
    reflect_to_eye(s, c);
}

// Each so many pixels look.
int32_t step_of(float roughness, float angle, bool much) {
    const float angles = roughness * roughness / angle;
    if (angles > EIGHTH) return 8;
    if (angles > FOURTH) return 4;
    return angles > SECOND || !much ? 2 : 1;
}

// Finds the pixels that are worth rays.
bool choose(const Chunk& c, Looks& looks) {
    bool some = false;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 roughness = load(c.roughness + i);
        const i8 smooth = (roughness < ROUGH) & ~load(c.empty + i);
        store(looks.share + i, splat(0.0f));
        if (!any(smooth)) continue;
        const Vec3x8 ray = c.ray.at(i);
        const f8 cosine = abs8(dot(c.normal.at(i), ray) * inverse_length(ray)) + 1e-4f;
        const Mirroring term = mirroring(roughness, cosine);
        const Vec3x8 f0 = reflectance_head_on(c.base.at(i), load(c.metallic + i));
        const f8 sharp = luminance(f0 * term.x + term.y);
        const f8 diffuse = luminance(c.base.at(i)) * (1.0f - load(c.metallic + i));
        const f8 mirrored = sharp / (sharp + diffuse);
        const f8 share = smoothstep(LEAST_SHARE, WHOLE_SHARE, mirrored) *
                         (1.0f - smoothstep(SMOOTH, ROUGH, roughness));
        // Rays of a relief lead everywhere: too few would be alike.
        const i8 uneven =
            c.detailed ? (load(c.relief + i) > 0.0f) & (mirrored < LARGE_SHARE) : i8{};
        const i8 chosen = smooth & ~uneven;
        store(looks.share + i, chosen ? share : splat(0.0f));
        store(looks.mirrored + i, mirrored);
        looks.rays.set(i, mirrored_ray(c, i));
        some |= any(chosen & (share > 0.0f));
    }
    if (!some) return false;
    some = false;
    for (int32_t i = 0; i < c.count; i++) {
        looks.met.weight[i] = 0.0f;
        looks.rays_of[i] = 0;
        looks.met.sum.x[i] = looks.met.sum.y[i] = looks.met.sum.z[i] = 0.0f;
        looks.met.normal.x[i] = c.normal.x[i];
        looks.met.normal.y[i] = c.normal.y[i];
        looks.met.normal.z[i] = c.normal.z[i];
        looks.met.id[i] = c.id[i];
        if (!(looks.share[i] > 0.0f)) continue;
        const float angle = looks.angle[i] = angle_beside(c, looks.rays, i);
        const float bend = clamp((angle - FLAT) * (1.0f / (BENT - FLAT)), 0.0f, 1.0f);
        looks.share[i] *= 1.0f - bend * bend * (3.0f - 2.0f * bend);
        looks.step[i] = step_of(c.roughness[i], angle, looks.mirrored[i] >= LARGE_SHARE);
        some |= looks.share[i] > 0.0f;
    }
    return some;
}

// Whether what the rays of a pixel of a row met counts for another one, too.
bool shares(const Chunk& c, int32_t i, const TracedRow& row, int32_t other) {
    return other >= 0 && other < c.count && row.weight[other] > 0.0f &&
           is_alike(c.id[i], c.normal, i, row.id[other], row.normal, other);
}

// Whether pixels that look anyway do for one: those of `above`, the row before it, or, where that
// is null, of its own row.
bool does_without(const Chunk& c, const Looks& looks, const TracedRow* above, int32_t i) {
    const int32_t step = looks.step[i], left = i - i % step;
    if (above == nullptr && left == i) return false;
    for (int32_t other = left; other <= left + step && other < c.count; other += step) {
        if (above != nullptr) {
            if (shares(c, i, *above, other)) return true;
        } else if (looks.share[other] > 0.0f && other % looks.step[other] == 0 &&
                   is_alike(c.id[i], c.normal, i, c.id[other], c.normal, other)) {
            return true;
        }
    }
    return false;
}

// Says how many rays each pixel has; `before` is a row above, or null for pixels that lie anywhere.
void count_rays(const Chunk& c, const TracedRow* before, Looks& looks) {
    for (int32_t i = 0; i < c.count; i++) {
        if (!(looks.share[i] > 0.0f)) continue;
        const bool much = looks.mirrored[i] >= LARGE_SHARE;
        looks.rays_of[i] = much && looks.angle[i] > CURVED ? OWN_RAYS : 1;
        if (before == nullptr || looks.step[i] == 1) continue;
        const bool flat = looks.angle[i] < FLAT_PLANE || looks.step[i] > 2;
        looks.rays_of[i] =
            much ? (flat ? ROUGH_RAYS : OWN_RAYS) : (looks.step[i] > 2 ? OWN_RAYS : 1);
        const TracedRow* above = (c.y & 1) != 0 && before->y == c.y - 1 ? before : nullptr;
        if (does_without(c, looks, above, i)) looks.rays_of[i] = 0;
    }
}

// One of the rays of a pixel's lobe.
vec3 ray_of_lobe(const Shading& s, const Chunk& c, const Looks& looks, int32_t i, int32_t number) {
    const float scale = s.table == nullptr ? 1.0f : 0.5f * static_cast<float>(s.width);
    const int32_t column = static_cast<int32_t>(std::floor(c.at_x[i] * scale + 0.5f));
    const int32_t row = static_cast<int32_t>(std::floor(c.at_y[i] * scale + 0.5f));
    // Those who share have other rays each.
    const int32_t begin =
        looks.step[i] > 1 ? column / looks.step[i] + 3 * (row >> 1) : 5 * column + 7 * row;
    const int32_t k = (begin + number * (LOBE / looks.rays_of[i])) & (LOBE - 1);
    const float rough = c.roughness[i] * c.roughness[i], least = 0.25f * looks.angle[i];
    const float wide = rough > least ? rough : least;
    const vec3 n(c.normal.x[i], c.normal.y[i], c.normal.z[i]);
    // Two axes across the normal (Duff et al. 2017, "Building an orthonormal basis, revisited").
    const float sign = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    const vec3 first(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    const vec3 second(b, sign + n.y * n.y * a, -n.y);
    vec3 facet = n + first * (wide * SLOPE_X[k]) + second * (wide * SLOPE_Y[k]);
    facet = facet * (1.0f / std::sqrt(dot(facet, facet)));
    vec3 along(c.ray.x[i], c.ray.y[i], c.ray.z[i]);
    along = along * (1.0f / std::sqrt(dot(along, along)));
    const vec3 ray = along - facet * (2.0f * dot(along, facet));
    // Below the surface there is nothing to be seen.
    if (dot(ray, n) < 0.02f) return vec3(looks.rays.x[i], looks.rays.y[i], looks.rays.z[i]);
    return ray;
}

// Follows one ray of each pixel that has so many, and adds what they meet.
void look(const Shading& s, const Chunk& c, int32_t number, Looks& looks) {
    Chunk there;
    int32_t from[CHUNK];
    float weights[CHUNK];
    begin_met(there);
    int32_t count = 0;
    for (int32_t i = 0; i < c.count; i++) {
        if (number >= looks.rays_of[i]) continue;
        const vec3 begin(c.point.x[i], c.point.y[i], c.point.z[i]);
        const vec3 ray = ray_of_lobe(s, c, looks, i, number);
        const float o[3] = {begin.x, begin.y, begin.z}, d[3] = {ray.x, ray.y, ray.z};
        const Met met = first_met(*s.light->traced, ray_of(o, d, BEGIN_M));
        const float weight = dot(ray, vec3(c.normal.x[i], c.normal.y[i], c.normal.z[i]));
        looks.met.weight[i] += weight;
        weights[count] = weight;
        if (!is_drawn(met)) {
            looks.met.sum.x[i] += c.mirrored.x[i] * weight;
            looks.met.sum.y[i] += c.mirrored.y[i] * weight;
            looks.met.sum.z[i] += c.mirrored.z[i] * weight;
            continue;
        }
        const vec3 along(c.ray.x[i], c.ray.y[i], c.ray.z[i]);
        const float way = c.depth[i] * std::sqrt(dot(along, along));
        const float rough = 0.5f * c.roughness[i] * c.roughness[i];
        set_met(met, begin, ray, way, max(looks.angle[i], rough), there, count);
        from[count++] = i;
    }
    if (count == 0) return;
    light_met(s, there, count);
    for (int32_t k = 0; k < count; k++) {
        looks.met.sum.x[from[k]] += there.light.x[k] * weights[k];
        looks.met.sum.y[from[k]] += there.light.y[k] * weights[k];
        looks.met.sum.z[from[k]] += there.light.z[k] * weights[k];
    }
}

// Adds what the pixels around a place in a row met, the nearer the more.
void add_around(const Chunk& c, int32_t i, int32_t step, int32_t reach, float share,
                const TracedRow& row, vec3& sum, float& weight) {
    const int32_t left = i - i % step;
    for (int32_t other = left - step; other <= left + 2 * step; other += step) {
        const int32_t away = other < i ? i - other : other - i;
        if (away >= reach || !shares(c, i, row, other)) continue;
        const float part = share * static_cast<float>(reach - away);
        sum = sum + vec3(row.sum.x[other], row.sum.y[other], row.sum.z[other]) * part;
        weight += row.weight[other] * part;
    }
}

}  // namespace

void trace_reflections(const Shading& s, Chunk& c, TracedRow* before) {
    Looks looks;
    if (!choose(c, looks)) return;
    count_rays(c, before, looks);
    for (int32_t number = 0; number < ROUGH_RAYS; number++) look(s, c, number, looks);
    const bool follows = before != nullptr && (before->y == c.y - 1 || before->y == c.y - 2);
    for (int32_t i = 0; i < c.count; i++) {
        if (!(looks.share[i] > 0.0f)) continue;
        const int32_t step = looks.step[i];
        const bool soft =
            c.roughness[i] * c.roughness[i] > looks.angle[i] || looks.angle[i] > CURVED;
        const int32_t reach = before == nullptr ? 1 : step > 1 ? 2 * step : soft ? 2 : 1;
        vec3 sum(0.0f, 0.0f, 0.0f);
        float weight = 0.0f;
        add_around(c, i, step, reach, 1.0f, looks.met, sum, weight);
        if (i % step != 0)
            add_around(c, i, 1, 1, static_cast<float>(reach), looks.met, sum, weight);
        if (reach > 1 && follows) {
            add_around(c, i, step, reach, before->y == c.y - 1 ? 1.0f : 0.5f, *before, sum, weight);
        }
        if (!(weight > 0.0f)) continue;
        sum = sum * (1.0f / weight);
        const float share = looks.share[i];
        c.mirrored.x[i] += (sum.x - c.mirrored.x[i]) * share;
        c.mirrored.y[i] += (sum.y - c.mirrored.y[i]) * share;
        c.mirrored.z[i] += (sum.z - c.mirrored.z[i]) * share;
    }
    if (before == nullptr || (c.y & 1) != 0) return;
    *before = looks.met;
    before->y = c.y;
}

Vec3x8 trace_glass(const Shading& s, Vec3x8 point, Vec3x8 ray, f8 way, i8 wanted, Vec3x8 mirrored) {
    Chunk there;
    begin_met(there);
    int32_t groups[2], count = 0;
    for (int32_t group = 0; group < 8; group += 4) {
        int32_t k = group;
        while (k < group + 4 && !wanted[k]) k++;
        if (k == group + 4) continue;
        const vec3 begin(point.x[k], point.y[k], point.z[k]);
        const vec3 along(ray.x[k], ray.y[k], ray.z[k]);
        const float o[3] = {begin.x, begin.y, begin.z}, d[3] = {along.x, along.y, along.z};
        const Met met = first_met(*s.light->traced, ray_of(o, d, BEGIN_M));
        if (!is_drawn(met)) continue;
        set_met(met, begin, along, way[k], USUAL_ANGLE, there, count);
        groups[count++] = group;
    }
    if (count == 0) return mirrored;
    light_met(s, there, count);
    for (int32_t j = 0; j < count; j++) {
        for (int32_t k = groups[j]; k < groups[j] + 4; k++) {
            mirrored.x[k] = there.light.x[j];
            mirrored.y[k] = there.light.y[j];
            mirrored.z[k] = there.light.z[j];
        }
    }
    return mirrored;
}

}  // namespace sailenv
