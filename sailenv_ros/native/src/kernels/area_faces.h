// What surfaces mirror of the faces of area lights: see area_faces.cpp.
#pragma once

#include "shade.h"

namespace sailenv {

struct RayLight;

// The lobes of eight surfaces where they meet the face of an area light. Of each axis of the face:
// places from -1 to 1 between its ends, and shares of the lobe that lie below one.
struct LobeOnFace {
    struct Axis {
        f8 middle, width;  // of the lobe: where the mirrored ray leads, and how far it spreads
        f8 below, share;   // below the face's lower end; between its ends
    } across, up;
    f8 share;  // of the lobe that meets the face

    // The place along an axis below which a part of what meets the face lies.
    static float place(const Axis& axis, int lane, float part);
};

// Of surfaces at `point`, whose normals are of unit length, as `along` is, which leads there from
// the eye.
LobeOnFace lobe_on_face(const RayLight& light, Vec3x8 point, Vec3x8 along, Vec3x8 normal,
                        f8 roughness);

// Radiance that surfaces mirror of all faces, as if nothing were in the way.
Vec3x8 mirrored_faces(const Light& light, Vec3x8 point, Vec3x8 along, Vec3x8 normal, f8 roughness);

// What eight surfaces have of the face of an area light of radiance 1.
struct FaceLight {
    f8 share;   // of the lobe that meets it
    f8 around;  // irradiance / pi; of surfaces that mirror the light around alone
};

// The same where the lobe may be as wide as the face or wider: then by points of the face.
// `head_on` is the luminance of the surface's reflectance head-on.
FaceLight light_of_face(const RayLight& light, const LobeOnFace& met, Vec3x8 point, Vec3x8 along,
                        Vec3x8 normal, f8 roughness, f8 head_on);

// The point of a face at a place from -1 to 1 along each axis.
vec3 place_on_face(const RayLight& light, float x, float y);

// Radiance of an area light's face.
vec3 face_radiance(const RayLight& light);

// Radiance of the faces that a ray passes before `end`.
vec3 radiance_of_faces(const Light& light, vec3 from, vec3 ray, float end);

}  // namespace sailenv
