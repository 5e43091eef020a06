// Shading: what surfaces mirror of what stands around them, by the samples of a picture.
//
// What a lobe meets changes slowly from pixel to pixel: pixels take over what the points around
// them tell. Of most surfaces these tell by how much pictures of the room are wrong; of rough ones
// that mirror much, all that is mirrored.
#include "shade_sampled.h"

#include "area_faces.h"
#include "mirror_samples.h"
#include "traced_hits.h"

namespace sailenv {
namespace {

constexpr int32_t SQUARE = MirrorSamples::SQUARE, FACES = MirrorSamples::FACES;
// Share that is mirrored of all light that is sent back: from where on rays are worth it, and count
// alone.
constexpr float LEAST_SHARE = 0.45f, WHOLE_SHARE = 0.6f;
// What is seen by a cosine of more than STEEP mirrors less than LEAST_SHARE if it sends back more
// than BRIGHT otherwise.
constexpr float BRIGHT = 0.12f, STEEP = 0.45f;
// Pixels take over what samples mirror that lie nearer [pixels], but for those with normals turned
// by more than this cosine, and those that lie off the pixel's plane by more than this share of its
// depth. At ENOUGH_WEIGHT half of what is mirrored is by samples, the rest by pictures of the room.
constexpr float REACH = 12.0f, TURNED = 0.9f, OFF_PLANE = 0.02f, ENOUGH_WEIGHT = 2.0f;

// Adds what a sample mirrors to pixels around it.
void add_sample(const MirrorSample& sample, const Chunk& c, int32_t i, i8 wanted, f8 x, f8 y,
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

// Weighted sums over the samples around eight pixels: corrections of pictures of the room, and what
// they know of area lights.
struct Interpolated {
    Vec3x8 correction = splat(vec3(0.0f, 0.0f, 0.0f));
    Vec3x8 faces = splat(vec3(0.0f, 0.0f, 0.0f)), around = splat(vec3(0.0f, 0.0f, 0.0f));
    f8 faces_share = splat(0.0f), faces_met = splat(0.0f), weight = splat(0.0f);

    // Of a sample in whose square's middle `near` would be highest.
    void add(const MirrorSample& sample, const Chunk& c, int32_t i, i8 wanted, f8 near) {
        const i8 own = wanted & (load(c.id + i) == sample.id);
        if (!any(own)) return;
        const f8 cosine = dot(c.normal.at(i), sample.normal);
        const f8 turned = clamp8((cosine - TURNED) * (1.0f / (1.0f - TURNED)), 0.0f, 1.0f);
        const f8 counts = own ? near * turned : splat(0.0f);
        correction = correction + counts * sample.correction;
        faces = faces + counts * sample.faces;
        around = around + counts * sample.around;
        faces_share = faces_share + counts * sample.faces_share;
        faces_met = faces_met + counts * sample.faces_met;
        weight = weight + counts;
    }
};

// Calls found(square, column, row, pixels) for the squares of samples around each of some pixels.
template <class Found>
LANES_INLINE void around_pixels(const MirrorSamples& samples, i8 x, i8 y, i8 wanted,
                                const Found& found) {
    const i8 column = x / SQUARE, row = y / SQUARE;
    // Pixels of a row are in one square.
    for (i8 left = wanted; any(left);) {
        const int k = __builtin_ctz(lane_bits(left));
        const i8 here = left & (column == column[k]) & (row == row[k]);
        left = left & ~here;
        for (int32_t n = 0; n < 9; n++) {
            const int32_t beside = column[k] + n % 3 - 1, below = row[k] + n / 3 - 1;
            const MirrorSample* square = samples.square(beside, below);
            if (square != nullptr && (square[0].id | square[1].id) != 0) {
                found(square, beside, below, here);
            }
        }
    }
}

Interpolated interpolate(const MirrorSamples& samples, const Chunk& c, int32_t i, i8 x, i8 y,
                         i8 wanted) {
    constexpr float SIDE = SQUARE, MIDDLE = 0.5f * (SQUARE - 1);
    Interpolated r;
    around_pixels(samples, x, y, wanted,
                  [&](const MirrorSample* square, int32_t column, int32_t row, i8 here) {
                      const f8 across = abs8(to_float(x - SQUARE * column) - MIDDLE);
                      const f8 down = abs8(to_float(y - SQUARE * row) - MIDDLE);
                      const i8 near = here & (across < SIDE) & (down < SIDE);
                      if (!any(near)) return;
                      const f8 counts = (SIDE - across) * (SIDE - down);
                      for (int32_t face = 0; face < FACES; face++) {
                          if (square[face].id != 0) r.add(square[face], c, i, near, counts);
                      }
                  });
    return r;
}

}  // namespace

// By how much eight surfaces mirror enough for rays to be worth it.
f8 share_of_room(const Chunk& c, int32_t i) {
    const f8 roughness = load(c.roughness + i);
    const i8 rough = (roughness >= ROUGH) & (roughness < ROUGHEST) & ~load(c.empty + i);
    if (!any(rough)) return splat(0.0f);
    const Vec3x8 ray = c.ray.at(i);
    const f8 diffuse = luminance(c.base.at(i)) * (1.0f - load(c.metallic + i));
    const f8 along = dot(c.normal.at(i), ray);
    const i8 steep = along * along > dot(ray, ray) * (STEEP * STEEP);
    if (!any(rough & ~(steep & (diffuse > BRIGHT)))) return splat(0.0f);
    const f8 mirrored = mirrored_part(c, i);
    const f8 share = smoothstep(LEAST_SHARE, WHOLE_SHARE, mirrored);
    const f8 told = share * (1.0f - smoothstep(ROUGHER, ROUGHEST, roughness));
    return rough & ~leads_everywhere(c, i, mirrored) ? told : splat(0.0f);
}

void correct_mirrored(const Shading& s, const int32_t* x, const int32_t* y, Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 roughness = load(c.roughness + i);
        const i8 wanted = (roughness < ROUGHEST) & ~load(c.empty + i);
        Vec3x8 faces = splat(vec3(0.0f, 0.0f, 0.0f));
        if (any(wanted)) {
            const Interpolated t = interpolate(*s.samples, c, i, load(x + i), load(y + i), wanted);
            const f8 scale = 1.0f / max8(t.weight, splat(1e-20f));
            // Where normals turn, mirrored rays turn twice as far.
            const Vec3x8 bend = c.bend.at(i);
            const f8 turned = sqrt8(dot(bend, bend));
            const f8 told = 1.0f - smoothstep(ROUGHER, ROUGHEST, roughness);
            const f8 part = told * (1.0f - smoothstep(FLAT, BENT, 2.0f * turned)) * t.weight /
                            (t.weight + ENOUGH_WEIGHT);
            const Vec3x8 corrected =
                c.mirrored.at(i) + part * (t.correction * scale + c.darkened.at(i));
            const f8 seen = t.weight > 0.0f ? t.faces_share * scale : load(c.open + i);
            // Where rough surfaces mirror the light around, that of faces counts by their lobes.
            const f8 rough = share_mirrored_around(roughness);
            const f8 even = rough * (1.0f - share_of_room(c, i));
            const f8 apart = even * told * seen;
            c.mirrored.set(i, max(corrected - t.around * (scale * apart), 0.0f));
            const f8 kept = (1.0f - even) * seen + apart;
            const i8 smooth = roughness < ROUGH, sampled = t.weight > 0.0f;
            faces = where(wanted & sampled, t.faces * (scale * kept), faces);
            // Highlights of what is smooth have edges; where it is curved, they may lie between
            // samples.
            const i8 curved = s.table != nullptr ? splat(-1) : turned > 0.0f;
            const i8 own = wanted & ((smooth & (curved | (t.faces_met > 0.0f))) | ~sampled);
            if (any(own)) {
                const Vec3x8 ray = c.ray.at(i);
                // Normals within a pixel are turned by up to half of that either way.
                const f8 within = sqrt8(roughness * roughness + 0.5f * turned);
                const Vec3x8 all = mirrored_faces(
                    *s.light, c.point.at(i), ray * inverse_length(ray), c.normal.at(i), within);
                faces = where(own, all * ((1.0f - rough) * seen), faces);
            }
        }
        c.faces.set(i, faces);
    }
}

void mirror_rough(const Shading& s, const int32_t* x, const int32_t* y, Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 share = share_of_room(c, i);
        const i8 wanted = share > 0.0f;
        if (!any(wanted)) continue;
        const i8 px = load(x + i), py = load(y + i);
        const f8 at_x = to_float(px), at_y = to_float(py);
        Vec3x8 sum = splat(vec3(0.0f, 0.0f, 0.0f));
        f8 weight = splat(0.0f);
        around_pixels(*s.samples, px, py, wanted,
                      [&](const MirrorSample* square, int32_t, int32_t, i8 here) {
                          for (int32_t face = 0; face < FACES; face++) {
                              if (square[face].id == 0 || !square[face].of_room) continue;
                              add_sample(square[face], c, i, here, at_x, at_y, sum, weight);
                          }
                      });
        const f8 scale = 1.0f / max8(weight, splat(1e-20f));
        const f8 part = share * weight / (weight + ENOUGH_WEIGHT);
        const Vec3x8 seen = c.mirrored.at(i);
        c.mirrored.set(i, seen + part * (sum * scale - seen));
    }
}

}  // namespace sailenv
