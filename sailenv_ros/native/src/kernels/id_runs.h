// Runs of pixels that see one instance.
#pragma once

#include <cstdint>

namespace sailenv {

// The first pixel behind `at` of another instance, or `end`.
inline int64_t same_until(const uint16_t* ids, int64_t at, int64_t end) {
    const uint16_t id = ids[at];
    constexpr int64_t STEP = 16;
    for (at++; at + STEP <= end; at += STEP) {
        bool same = true;
        for (int64_t k = 0; k < STEP; k++) same &= ids[at + k] == id;
        if (!same) break;
    }
    while (at < end && ids[at] == id) at++;
    return at;
}

}  // namespace sailenv
