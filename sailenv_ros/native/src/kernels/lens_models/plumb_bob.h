// Radial and tangential distortion, as OpenCV and ROS have it.
#pragma once

#include "perspective.h"

namespace sailenv {

struct PlumbBob : Perspective<false> {
    static constexpr ModelText TEXT = {
        "plumb_bob", "k1 k2 p1 p2 k3", "4 5", "p2", "central", "a radius that grows from the axis"};
};

}  // namespace sailenv
