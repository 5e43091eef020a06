// All models of lenses, and how one is chosen: Python's names and numbers come from here
// (native/lens_models.py). A model's number is its place in the list.
#pragma once

#include "double_sphere.h"
#include "equidistant.h"
#include "equirectangular.h"
#include "mei.h"
#include "orthographic.h"
#include "pinhole.h"
#include "plumb_bob.h"
#include "rational_polynomial.h"

namespace sailenv {

template <class... Models>
struct ModelList {
    static constexpr int64_t SIZE = sizeof...(Models);

    // Calls body(Model{}) for the model of that number; false if there is none.
    template <class Body>
    static bool choose(int64_t number, const Body& body) {
        int64_t k = 0;
        return ((k++ == number ? (body(Models{}), true) : false) || ...);
    }
};

using LensModels = ModelList<Pinhole, PlumbBob, RationalPolynomial, Equidistant, DoubleSphere, Mei,
                             Equirectangular, Orthographic>;

// The law of a model with its coefficients, seen up to an angle from the axis [rad]. A model that
// there is not sees nothing.
inline LensLaw lens_law(int64_t model, const double* coefficients, double limit) {
    LensLaw law{model, limit, 0.0, {}};
    for (int64_t i = 0; i < MOST_COEFFICIENTS; i++) law.k[i] = coefficients[i];
    LensModels::choose(model, [&](auto m) { law.radius = m.radius(law); });
    return law;
}

}  // namespace sailenv
