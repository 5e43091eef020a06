// No distortion: straight lines stay straight.
#pragma once

#include "perspective.h"

namespace sailenv {

struct Pinhole : Perspective<false> {
    static constexpr ModelText TEXT = {"pinhole", "", "0", "", "central", ""};
};

}  // namespace sailenv
