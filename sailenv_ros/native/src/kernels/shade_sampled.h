// What samples of a picture tell pixels of what they mirror.
#pragma once

#include "shade_chunk.h"

namespace sailenv {

// Roughness up to where rays tell what is mirrored, and from where on nothing: there it is the
// light around.
constexpr float ROUGHER = 0.6f, ROUGHEST = 0.75f;

// By how much eight rough surfaces mirror enough for rays to tell all of it.
f8 share_of_room(const Chunk& c, int32_t i);

}  // namespace sailenv
