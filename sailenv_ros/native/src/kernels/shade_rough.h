// What rough surfaces of a picture mirror: samples, each of which many pixels share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "shade.h"

namespace sailenv {

// A point of a rough surface, and what rays of its lobe met: weighted sums of radiance.
struct RoughSample {
    int32_t id = 0;        // of the instance; 0 where there is no sample
    bool of_room = false;  // rays tell of the room, not of area lights alone
    Fragment seen;
    vec3 normal = {0.0f, 0.0f, 1.0f}, point = {0.0f, 0.0f, 0.0f};
    vec3 near = {0.0f, 0.0f, 0.0f}, far = {0.0f, 0.0f, 0.0f};  // what stands near; all else
    float weight = 0.0f, open = 0.0f;                          // of all; of what is not near
    vec3 mirrored = {0.0f, 0.0f, 0.0f};                        // radiance
};

// Samples of each square of pixels: of up to two faces.
struct RoughSamples {
    static constexpr int32_t FACES = 2;
    int32_t first_row = 0, rows = 0, columns = 0;  // of squares
    std::vector<RoughSample> samples;

    // The samples of a square; null beyond the rows and columns.
    const RoughSample* square(int32_t column, int32_t row) const {
        const int32_t y = row - first_row;
        if (column < 0 || column >= columns || y < 0 || y >= rows) return nullptr;
        return samples.data() + FACES * (int64_t{y} * columns + column);
    }
    RoughSample* square(int32_t column, int32_t row) {
        return const_cast<RoughSample*>(std::as_const(*this).square(column, row));
    }
};

// Takes the samples of some rows of a picture, of which it is known what pixels see.
void sample_rough(int64_t threads, const Shading& shading, int32_t first_row, int32_t end_row,
                  RoughSamples& samples);

}  // namespace sailenv
