// Clip distances as depths of single precision are compared with them.
#pragma once

#include <cmath>

namespace sailenv {

// The greatest number of single precision that is not above another one: of the far distance; the
// near one is the negative of this of the negative.
inline float rounded_down(double x) {
    const float r = static_cast<float>(x);
    return static_cast<double>(r) > x ? std::nextafterf(r, -__builtin_inff()) : r;
}

}  // namespace sailenv
