// What writing and reading the streams of PNG files share (RFC 1950 and 1951).
#pragma once

#include <algorithm>
#include <cstdint>

// First length of each code from 257 on, and how many bits tell the rest (RFC 1951, 3.2.5).
constexpr int RUN_FIRST[29] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                               31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr int RUN_BITS[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                              2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};

// The order in which a block tells the lengths of the codes of its lengths (3.2.7).
constexpr int LENGTH_ORDER[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};

// Adler-32 (RFC 1950, 8.2). Each of 64 lanes adds up its bytes and these sums, for as long as both
// fit into 16 bits.
static inline uint32_t adler_of(const uint8_t* data, int64_t size) {
    constexpr uint32_t MODULUS = 65521;
    constexpr int64_t LANES = 64, ROUNDS = 21;
    uint32_t a = 1, b = 0;
    int64_t first = 0;
    while (size - first >= LANES) {
        const int64_t rounds = std::min(ROUNDS, (size - first) / LANES);
        uint16_t sums[LANES] = {}, before[LANES] = {};
        for (int64_t round = 0; round < rounds; round++) {
            const uint8_t* own = data + first + round * LANES;
            for (int64_t lane = 0; lane < LANES; lane++) {
                before[lane] = static_cast<uint16_t>(before[lane] + sums[lane]);
                sums[lane] = static_cast<uint16_t>(sums[lane] + own[lane]);
            }
        }
        uint32_t sum = 0, weighted = 0;
        for (int64_t lane = 0; lane < LANES; lane++) {
            sum += sums[lane];
            weighted += static_cast<uint32_t>(LANES) * before[lane] +
                        static_cast<uint32_t>(LANES - lane) * sums[lane];
        }
        b = (b + a * static_cast<uint32_t>(rounds * LANES) + weighted) % MODULUS;
        a = (a + sum) % MODULUS;
        first += rounds * LANES;
    }
    for (; first < size; first++) {
        a = (a + data[first]) % MODULUS;
        b = (b + a) % MODULUS;
    }
    return b << 16 | a;
}
