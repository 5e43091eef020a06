// OpenCV's rational radial distortion, with tangential distortion and a thin prism.
#pragma once

#include "perspective.h"

namespace sailenv {

struct RationalPolynomial : Perspective<true> {
    static constexpr ModelText TEXT = {"rational_polynomial",
                                       "k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4",
                                       "8 12",
                                       "p2 s1 s2",
                                       "central",
                                       "a radius that grows from the axis"};
};

}  // namespace sailenv
