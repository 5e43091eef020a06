// Views that are attributes of surfaces, written as they are: a view is one function and one entry.
#include <cstring>

#include "shade.h"
#include "shade_chunk.h"

namespace sailenv {
namespace {

// Unit normals in the optical frame.
void write_normals(const Shading& s, Chunk& c, float* out) {
    Vectors seen;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 normal = s.camera_from_world * c.normal.at(i);
        const i8 there = ~load(c.empty + i);
        seen.set(i, {bit_cast_float(bits(normal.x) & there), bit_cast_float(bits(normal.y) & there),
                     bit_cast_float(bits(normal.z) & there)});
    }
    for (int32_t i = 0; i < c.count; i++) {
        out[3 * i] = seen.x[i];
        out[3 * i + 1] = seen.y[i];
        out[3 * i + 2] = seen.z[i];
    }
}

// Linear base colours. What glows is shaded in the glow's colour, so its own is looked up.
void write_albedo(const Shading& s, Chunk& c, float* out) {
    alignas(32) float shaded[3][CHUNK];
    float* const channels[3] = {c.base.x, c.base.y, c.base.z};
    for (int k = 0; k < 3; k++) {
        memcpy(shaded[k], channels[k], sizeof(shaded[k]));
        for (int32_t i = 0; i < c.padded; i += 8) store(channels[k] + i, splat(1.0f));
    }
    if (c.coloured) colour_of_pixels(c);
    const uint32_t* visible = s.visible + c.y * s.stride + c.x;
    for (int32_t i = 0; i < c.count; i++) {
        const uint32_t tag = visible[i];
        const float* base =
            tag == NOTHING ? nullptr : s.parts->parts[s.set->triangles[tag].part].base;
        for (int k = 0; k < 3; k++) {
            const float root = base == nullptr ? 0.0f : base[k] * channels[k][i];
            out[3 * i + k] = root * root;
        }
    }
    for (int k = 0; k < 3; k++) memcpy(channels[k], shaded[k], sizeof(shaded[k]));
}

// Texture coordinates.
void write_uv(const Shading&, Chunk& c, float* out) {
    for (int32_t i = 0; i < c.count; i++) {
        out[2 * i] = c.empty[i] ? 0.0f : c.u[i];
        out[2 * i + 1] = c.empty[i] ? 0.0f : c.v[i];
    }
}

// Metalness and roughness, as light takes them. Detail maps bend normals too: they are kept.
void write_metallic_roughness(const Shading& s, Chunk& c, float* out) {
    const Vectors normal = c.normal;
    alignas(32) float roughness[CHUNK], metallic[CHUNK];
    memcpy(roughness, c.roughness, sizeof(roughness));
    memcpy(metallic, c.metallic, sizeof(metallic));
    if (c.detailed) apply_detail_maps(s, c);
    for (int32_t i = 0; i < c.padded; i += 8) {
        store(c.metallic + i, clamp8(load(c.metallic + i), 0.0f, 1.0f));
        store(c.roughness + i, clamp8(load(c.roughness + i), LEAST_ROUGHNESS, 1.0f));
    }
    for (int32_t i = 0; i < c.count; i++) {
        out[2 * i] = c.empty[i] ? 0.0f : c.metallic[i];
        out[2 * i + 1] = c.empty[i] ? 0.0f : c.roughness[i];
    }
    c.normal = normal;
    memcpy(c.roughness, roughness, sizeof(roughness));
    memcpy(c.metallic, metallic, sizeof(metallic));
}

struct Attribute {
    int64_t channels;
    void (*write)(const Shading& s, Chunk& c, float* out);
};

// In the order of the views of source "geometry" in types/views.py.
constexpr Attribute ATTRIBUTES[] = {
    {3, write_normals}, {3, write_albedo}, {2, write_uv}, {2, write_metallic_roughness}};
constexpr int64_t COUNT = sizeof(ATTRIBUTES) / sizeof(ATTRIBUTES[0]);
static_assert(COUNT <= MOST_ATTRIBUTES);

}  // namespace

bool wants_attributes(const Outputs& outputs) {
    for (const float* wanted : outputs.attributes) {
        if (wanted != nullptr) return true;
    }
    return false;
}

void write_attributes(const Shading& s, Chunk& c) {
    for (int64_t k = 0; k < COUNT; k++) {
        float* out = s.outputs->attributes[k];
        if (out == nullptr) continue;
        const Attribute& attribute = ATTRIBUTES[k];
        attribute.write(s, c, out + attribute.channels * (c.y * s.width + c.x));
    }
}

}  // namespace sailenv
