// Bloom and sensor noise; see render/picture/sensor.py, and tests/support/reference_kernels.py for
// the sums.
#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "pixel_pairs.h"
#include "scratch.h"

namespace {

constexpr int64_t LEVELS = 5;  // halvings of the picture: each doubles how far light is spread
constexpr int64_t TILE_ROWS = 8;
constexpr int64_t REACH = 5;  // of the blur, in samples of its level
// A normal distribution of 1.2 samples, from the middle outwards.
constexpr float WEIGHTS[REACH + 1] = {0.33244f, 0.23493f, 0.0829f, 0.01461f, 0.00128f, 0.00006f};
constexpr float GREATEST = 6e4f;  // half precision ends at 65504

// One size of the picture: red, green, blue and an unused number of each sample.
struct Level {
    int64_t height, width;
    f4* samples;
};

LANES_INLINE int64_t within(int64_t at, int64_t size) {
    return at < 0 ? 0 : at < size ? at : size - 1;
}

LANES_INLINE f4 load_four(const uint16_t* halves) {
    typedef uint16_t u4_any __attribute__((vector_size(8), aligned(2), may_alias));
    typedef int32_t i4 __attribute__((vector_size(16)));
    const i4 bits_of =
        __builtin_convertvector(*reinterpret_cast<const u4_any*>(halves), i4) & 0x7fff;
    const i4 shifted = bits_of << 13;
    f4 small;
    memcpy(&small, &shifted, sizeof small);
    return small * 0x1p112f;
}

// Means of two by two samples.
template <class Source>
void halve(int64_t threads, int64_t height, int64_t width, const Source& source,
           const Level& target) {
    sailenv::parallel_for(threads, target.height, TILE_ROWS,
                          [&](int64_t first, int64_t last, int64_t) {
                              for (int64_t v = first; v < last; v++) {
                                  const int64_t below = within(2 * v + 1, height);
                                  f4* out = target.samples + v * target.width;
                                  for (int64_t u = 0; u < target.width; u++) {
                                      const int64_t right = within(2 * u + 1, width);
                                      out[u] = ((source(2 * v, 2 * u) + source(2 * v, right)) +
                                                (source(below, 2 * u) + source(below, right))) *
                                               0.25f;
                                  }
                              }
                          });
}

// Blurs along the rows and then along the columns; beyond a border it goes on.
void blur(int64_t threads, const Level& level, f4* between) {
    const int64_t height = level.height, width = level.width;
    const auto weighted = [](const f4* line, int64_t at, int64_t size, int64_t step) {
        f4 sum = WEIGHTS[0] * line[at * step];
        for (int64_t k = 1; k <= REACH; k++) {
            sum = sum + WEIGHTS[k] *
                            (line[within(at - k, size) * step] + line[within(at + k, size) * step]);
        }
        return sum;
    };
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            const f4* line = level.samples + v * width;
            for (int64_t u = 0; u < width; u++) {
                between[v * width + u] = weighted(line, u, width, 1);
            }
        }
    });
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            for (int64_t u = 0; u < width; u++) {
                level.samples[v * width + u] = weighted(between + u, v, height, width);
            }
        }
    });
}

// A sample of a picture of twice the size, bilinear.
LANES_INLINE f4 doubled(const Level& level, int64_t v, int64_t u) {
    const int64_t row = v / 2, column = u / 2;
    const int64_t other_row = within(row + (v & 1 ? 1 : -1), level.height);
    const int64_t other = within(column + (u & 1 ? 1 : -1), level.width);
    const f4 *near = level.samples + row * level.width,
             *far = level.samples + other_row * level.width;
    const f4 here = 0.75f * near[column] + 0.25f * far[column];
    const f4 beside = 0.75f * near[other] + 0.25f * far[other];
    return 0.75f * here + 0.25f * beside;
}

// A number of 64 bits for each pixel (SplitMix64: Steele, Lea and Flood 2014).
LANES_INLINE uint64_t random_bits(uint64_t seed, uint64_t number) {
    uint64_t z = seed + (number + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

struct Noise {
    const float* normal;  // (65536,); null for none
    uint64_t seed;
    float per_light, read;  // variance of light x: x per_light + read
};

// The light of two pixels side by side.
LANES_INLINE f8 with_noise(const Noise& noise, int64_t at, f8 light) {
    if (noise.normal == nullptr) return light;
    const uint64_t a = random_bits(noise.seed, static_cast<uint64_t>(at)),
                   b = random_bits(noise.seed, static_cast<uint64_t>(at + 1));
    const auto number = [&noise](uint64_t drawn, int place) {
        return noise.normal[drawn >> (16 * place) & 0xffff];
    };
    const f8 numbers = {number(a, 0), number(a, 1), number(a, 2), 0.0f,
                        number(b, 0), number(b, 1), number(b, 2), 0.0f};
    return light + sqrt8(light * noise.per_light + noise.read) * numbers;
}

// Pixels with the light that is spread to them.
f8 with_halos(const Level& level, float share, int64_t width, int64_t at, int64_t pixels,
              f8 light) {
    for (int64_t k = 0; k < pixels; k++) {
        const f4 halo = doubled(level, (at + k) / width, (at + k) % width) * (1.0f / LEVELS);
        for (int c = 0; c < 4; c++) light[4 * k + c] += share * (halo[c] - light[4 * k + c]);
    }
    return light;
}

}  // namespace

// `radiance` and `out` are (height, width, 4); `normal` (65536,) may be null: no noise.
SAILENV_KERNEL(gather_light)
(int64_t threads, int64_t height, int64_t width, const uint16_t* radiance, double bloom,
 double shot, double read, int64_t seed, const float* normal, uint16_t* out) {
    if (height < 0 || width < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    if (height == 0 || width == 0) return sailenv::STATUS_OK;
    const bool blooms = bloom > 0.0;
    Level levels[LEVELS];
    int64_t count = 0, rows = height, columns = width;
    for (Level& level : levels) {
        rows = (rows + 1) / 2;
        columns = (columns + 1) / 2;
        level = {rows, columns, nullptr};
        count += rows * columns;
    }
    const int64_t largest = levels[0].height * levels[0].width;
    const auto memory = sailenv::allocate<f4>(blooms ? count + largest : 1);
    if (!memory) return sailenv::STATUS_OUT_OF_MEMORY;
    if (blooms) {
        f4* next = memory.get() + largest;
        for (int64_t k = 0; k < LEVELS; k++) {
            Level& level = levels[k];
            level.samples = next;
            next += level.height * level.width;
            if (k == 0) {
                halve(
                    threads, height, width,
                    [&](int64_t v, int64_t u) { return load_four(radiance + 4 * (v * width + u)); },
                    level);
            } else {
                const Level& finer = levels[k - 1];
                halve(
                    threads, finer.height, finer.width,
                    [&](int64_t v, int64_t u) { return finer.samples[v * finer.width + u]; },
                    level);
            }
        }
        for (int64_t k = LEVELS - 1; k >= 0; k--) {
            const Level& level = levels[k];
            blur(threads, level, memory.get());
            if (k + 1 == LEVELS) continue;
            const Level& coarser = levels[k + 1];
            sailenv::parallel_for(threads, level.height, TILE_ROWS,
                                  [&](int64_t first, int64_t last, int64_t) {
                                      for (int64_t v = first; v < last; v++) {
                                          f4* line = level.samples + v * level.width;
                                          for (int64_t u = 0; u < level.width; u++) {
                                              line[u] = line[u] + doubled(coarser, v, u);
                                          }
                                      }
                                  });
        }
    }
    const Noise noise{normal, static_cast<uint64_t>(seed), static_cast<float>(shot),
                      static_cast<float>(read)};
    const float share = static_cast<float>(bloom);
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        const auto finish = [&levels, noise, share, blooms, width](int64_t at, int64_t pixels,
                                                                   const uint16_t* given) {
            f8 light = load_halves(given);
            if (blooms) light = with_halos(levels[0], share, width, at, pixels, light);
            return to_half(clamp8(with_noise(noise, at, light), 0.0f, GREATEST));
        };
        sailenv::finish_pairs(radiance, out, first * width, last * width, finish);
    });
    return sailenv::STATUS_OK;
}
