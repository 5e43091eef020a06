// Shading: the light of what rays meet.
#include "traced_hits.h"

#include "texture.h"

namespace sailenv {
namespace {

void set_empty(Chunk& c, int32_t i) {
    c.empty[i] = -1;
    c.id[i] = 0;
    c.colour_texels[i] = WHITE_TEXELS;
    c.colour_log2[i] = NO_MAP;
    put(c.base, i, {0.0f, 0.0f, 0.0f});
    c.roughness[i] = 1.0f;
    c.metallic[i] = c.emission[i] = 0.0f;
    put(c.normal, i, {0.0f, 0.0f, 1.0f});
    put(c.ray, i, {0.0f, 0.0f, -1.0f});
    put(c.point, i, {0.0f, 0.0f, 0.0f});
    c.u[i] = c.v[i] = c.light_u[i] = c.light_v[i] = 0.0f;
    c.ux[i] = c.vx[i] = c.uy[i] = c.vy[i] = 0.0f;
}

}  // namespace

SceneHit closest_hit(const TracedScene& scene, vec3 from, vec3 ray, float reach) {
    const float o[3] = {from.x, from.y, from.z}, d[3] = {ray.x, ray.y, ray.z};
    const Ray r = ray_of(o, d, BEGIN_M);
    SceneHit met;
    met.hit.t = reach;
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

// What a triangle's corners know of the place, and what its part is made of.
void set_hit(const Light* light, const SceneHit& met, vec3 from, vec3 ray, float distance,
             float angle, Chunk& c, int32_t i) {
    const TracedInstance& one = *met.instance;
    const RayShape& shape = *one.placed.shape;
    const int32_t triangle = shape.order[met.hit.triangle];
    const Part& part = one.parts[one.part_of[triangle]];
    const uint32_t* vertex = one.vertices + 3 * static_cast<int64_t>(triangle);
    const float* factors = factors_of(light, part, false);
    f8 corner[3];
    for (int k = 0; k < 3; k++) corner[k] = vertex_of(part, factors, vertex[k]);
    const float weight[3] = {1.0f - met.hit.second - met.hit.third, met.hit.second, met.hit.third};
    const f8 known = corner[0] * weight[0] + corner[1] * weight[1] + corner[2] * weight[2];
    const float* m = one.placed.body_from_world;
    const float own[3] = {known[0] * one.inverse_scale[0], known[1] * one.inverse_scale[1],
                          known[2] * one.inverse_scale[2]};
    const vec3 turned(own[0] * m[0] + own[1] * m[4] + own[2] * m[8],
                      own[0] * m[1] + own[1] * m[5] + own[2] * m[9],
                      own[0] * m[2] + own[1] * m[6] + own[2] * m[10]);
    const float length = std::sqrt(dot(turned, turned));
    const float towards_eye = dot(turned, ray) > 0.0f ? -1.0f : 1.0f;
    const vec3 normal = turned * (towards_eye / (length > 1e-20f ? length : 1.0f));
    put(c.normal, i, normal);
    c.u[i] = known[3];
    c.v[i] = known[4];
    const bool charted = part.has_chart && one.at_baked_pose;
    // What has no chart has a factor and the share that it hides of itself there.
    const float free = part.has_chart ? 0.0f : 1.0f;
    c.light_u[i] = charted              ? known[5] * part.chart[2] + part.chart[0]
                   : towards_eye > 0.0f ? free * known[5]
                                        : 0.0f;
    c.light_v[i] = charted ? known[6] * part.chart[3] + part.chart[1] : free * known[6];
    put(c.base, i, {part.colour[0], part.colour[1], part.colour[2]});
    c.roughness[i] = part.roughness;
    c.metallic[i] = part.metallic;
    c.emission[i] = part.emission;
    c.id[i] = part.id;
    c.empty[i] = 0;
    put(c.ray, i, ray);
    put(c.point, i, from + ray * met.hit.t);
    c.colour_texels[i] = WHITE_TEXELS;
    c.colour_log2[i] = NO_MAP;
    c.ux[i] = c.vx[i] = c.uy[i] = c.vy[i] = 0.0f;
    if (part.colour_map == nullptr) return;
    c.coloured = true;
    c.colour_texels[i] = part.colour_map->texels;
    c.colour_log2[i] = static_cast<float>(part.colour_map->log2_size);
    // A pixel covers a square of the surface.
    const vec3 across = triangle_normal(shape, met.hit.triangle);
    const float du = corner[1][3] - corner[0][3], dv = corner[1][4] - corner[0][4];
    const float eu = corner[2][3] - corner[0][3], ev = corner[2][4] - corner[0][4];
    const float area = std::sqrt(dot(across, across)), texture_area = std::fabs(du * ev - dv * eu);
    const float side = angle * (distance + met.hit.t) * std::sqrt(texture_area / (area + 1e-20f));
    c.ux[i] = c.vy[i] = side;
}

void begin_hits(Chunk& c) {
    c.hit = c.parallel = true;
    c.missed = c.coloured = c.detailed = false;
}

void shade_hits(const Shading& s, Chunk& c, int32_t count) {
    c.count = count;
    c.padded = (count + 7) & ~7;
    for (int32_t k = count; k < c.padded; k++) set_empty(c, k);
    if (c.coloured) colour_for_picture(c);
    for (int32_t i = 0; i < c.padded; i += 8) finish_material(c, i);
    light_from_bake(s, c);
    mirror_surroundings(s, c);
    reflect_to_eye(s, c);
}

}  // namespace sailenv
