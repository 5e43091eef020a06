// The laws of lenses for Python; see native/lens_models.py.
#include <cstdio>
#include <limits>

#include "../threads.h"
#include "lens_models/table.h"
#include "record.h"

#define LENS_PLACES_FIELDS(FIELD)                                               \
    FIELD(int64_t, model)                                                       \
    FIELD(const double*, coefficients) /* (MOST_COEFFICIENTS,) */               \
    FIELD(double, limit)               /* largest angle from the axis [rad] */  \
    FIELD(const double*, places)       /* (N, 2), in the normalised plane */    \
    FIELD(double*, rays)               /* (N, 3): unit vectors, nan for none */ \
    FIELD(int64_t, count)

SAILENV_RECORD(LensPlaces, unproject_places, LENS_PLACES_FIELDS)

#define LENS_POINTS_FIELDS(FIELD)                                     \
    FIELD(int64_t, model)                                             \
    FIELD(const double*, coefficients)                                \
    FIELD(double, limit)                                              \
    FIELD(const double*, points) /* (N, 3), in the optical frame */   \
    FIELD(double*, places)       /* (N, 2); nan where it sees none */ \
    FIELD(int64_t, count)

SAILENV_RECORD(LensPoints, project_points, LENS_POINTS_FIELDS)

namespace {

constexpr int64_t TILE = 1024;
constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();

}  // namespace

// The words of a model, one line each; `size` is that of the text in bytes, with a 0 at its end.
SAILENV_KERNEL(lens_model_text)(int64_t model, char* text, int64_t size) {
    using namespace sailenv;
    bool fits = false;
    const bool known = LensModels::choose(model, [&](auto m) {
        const ModelText t = m.TEXT;
        const int length =
            std::snprintf(text, static_cast<size_t>(size), "%s\n%s\n%s\n%s\n%s\n%s", t.name,
                          t.coefficients, t.counts, t.odd, t.rays, t.accepted);
        fits = length >= 0 && length < size;
    });
    return known && fits ? STATUS_OK : STATUS_INVALID_ARGUMENT;
}

// (3,): the largest angle from the axis, that straight up and down, and 1 where the law folds.
SAILENV_KERNEL(lens_reach)(int64_t model, const double* coefficients, double* reach) {
    using namespace sailenv;
    const bool known = LensModels::choose(model, [&](auto m) {
        const Reach found = m.reach(coefficients);
        reach[0] = found.angle;
        reach[1] = found.vertical;
        reach[2] = found.folds ? 1.0 : 0.0;
    });
    return known ? STATUS_OK : STATUS_INVALID_ARGUMENT;
}

SAILENV_KERNEL(unproject_places)(int64_t threads, const LensPlaces* given) {
    using namespace sailenv;
    const LensPlaces& in = *given;
    if (in.count < 0) return STATUS_INVALID_ARGUMENT;
    const LensLaw law = lens_law(in.model, in.coefficients, in.limit);
    const bool known = LensModels::choose(law.model, [&](auto m) {
        parallel_for(threads, in.count, TILE, [&](int64_t first, int64_t last, int64_t) {
            for (int64_t i = first; i < last; i++) {
                double* ray = in.rays + 3 * i;
                if (!m.unproject(law, in.places + 2 * i, ray)) {
                    ray[0] = ray[1] = ray[2] = NOT_A_NUMBER;
                }
            }
        });
    });
    return known ? STATUS_OK : STATUS_INVALID_ARGUMENT;
}

SAILENV_KERNEL(project_points)(int64_t threads, const LensPoints* given) {
    using namespace sailenv;
    const LensPoints& in = *given;
    if (in.count < 0) return STATUS_INVALID_ARGUMENT;
    const LensLaw law = lens_law(in.model, in.coefficients, in.limit);
    const bool known = LensModels::choose(law.model, [&](auto m) {
        parallel_for(threads, in.count, TILE, [&](int64_t first, int64_t last, int64_t) {
            for (int64_t i = first; i < last; i++) {
                double* place = in.places + 2 * i;
                if (!m.project(law, in.points + 3 * i, place)) {
                    place[0] = place[1] = NOT_A_NUMBER;
                }
            }
        });
    });
    return known ? STATUS_OK : STATUS_INVALID_ARGUMENT;
}
