// What surfaces of a picture mirror: samples, each of which many pixels share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "shade.h"

namespace sailenv {

// A point of a surface, and what rays of its lobe met: weighted sums of radiance.
struct MirrorSample {
    int32_t id = 0;        // of the instance; 0 where there is no sample
    bool of_room = false;  // rough, and mirrors so much that rays tell all of it
    Fragment seen;
    vec3 normal = {0.0f, 0.0f, 1.0f}, point = {0.0f, 0.0f, 0.0f};
    // Of the room: what stands near; all else; weights of all, and of what is not near.
    vec3 near = {0.0f, 0.0f, 0.0f}, far = {0.0f, 0.0f, 0.0f};
    float weight = 0.0f, open = 0.0f;
    vec3 mirrored = {0.0f, 0.0f, 0.0f};  // radiance
    // What rays met less what pictures of the room have; its mean over samples around.
    vec3 difference = {0.0f, 0.0f, 0.0f};
    float difference_weight = 0.0f;
    vec3 correction = {0.0f, 0.0f, 0.0f};
    // Radiance of the faces of area lights that it mirrors if nothing is in the way, and irradiance
    // / pi by them; luminance of those it sees, and of all; the share that samples around see.
    vec3 faces = {0.0f, 0.0f, 0.0f}, around = {0.0f, 0.0f, 0.0f};
    float faces_seen = 0.0f, faces_met = 0.0f, faces_share = 1.0f;
};

// Samples of each square of pixels: of up to two faces.
struct MirrorSamples {
    static constexpr int32_t SQUARE = 8;  // pixels along a side
    static constexpr int32_t FACES = 2;
    int32_t first_row = 0, rows = 0, columns = 0;  // of squares
    std::vector<MirrorSample> samples;

    // The samples of a square; null beyond the rows and columns.
    const MirrorSample* square(int32_t column, int32_t row) const {
        const int32_t y = row - first_row;
        if (column < 0 || column >= columns || y < 0 || y >= rows) return nullptr;
        return samples.data() + FACES * (int64_t{y} * columns + column);
    }
    MirrorSample* square(int32_t column, int32_t row) {
        return const_cast<MirrorSample*>(std::as_const(*this).square(column, row));
    }
};

// Takes the samples of some rows of a picture, of which it is known what pixels see.
void sample_mirrored(int64_t threads, const Shading& shading, int32_t first_row, int32_t end_row,
                     MirrorSamples& samples);

}  // namespace sailenv
