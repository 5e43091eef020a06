// Rows of PNG files from their filters (PNG specification, 9): the way back from png_data.cpp.
#include <algorithm>
#include <cstring>
#include <new>
#include <vector>

#include "../abi.h"

namespace {

// Eight rows at once, each a pixel behind the one above it: row k is at pixel x - k. Four are one
// vector of four bytes each, from their pixels' first ones on; the last of the four belongs to the
// next pixel and counts nothing.
typedef uint8_t Bytes16 __attribute__((vector_size(16)));
typedef uint32_t Pixels __attribute__((vector_size(16)));
constexpr int WAVE = 8, RGB = 3;

// Of left and up the one that is nearest to left + up - corner, or the corner (PNG specification,
// 9.4). Not by these distances, which bytes cannot hold, but by which side the corner is on: with
// it between the two, 2 (high - corner) <= corner - low says that it is nearer to high.
template <typename T>
inline T paeth(T left, T up, T corner) {
    const T high = left > up ? left : up, low = left < up ? left : up;
    const T over = (high > corner ? high : corner) - corner;
    const T under = corner - (low < corner ? low : corner);
    const T more = over > under ? over : under;
    const T near = over <= more - over ? low : corner;
    return under <= more - under ? high : near;
}

inline uint32_t four_bytes(const uint8_t* data) {
    uint32_t bytes;
    memcpy(&bytes, data, 4);
    return bytes;
}

// `filtered` and `rows` are those of the first of the rows, `above` is the row before it.
void unfilter_wave(const uint8_t* filtered, const uint8_t* above, int64_t width, uint8_t* rows) {
    const int64_t pixels = width / RGB;
    struct {
        Pixels left = {}, up = {};

        void step(Pixels own, uint32_t over) {
            const Pixels corner = up;
            up = Pixels{over, left[0], left[1], left[2]};
            left = (Pixels)((Bytes16)own +
                            paeth<Bytes16>((Bytes16)left, (Bytes16)up, (Bytes16)corner));
        }
    } high, low;
    // Where some rows have not begun or have ended. What is 0 before a row keeps left and corner 0.
    const auto edge = [&](int64_t x) {
        uint32_t own[WAVE + 1] = {};
        if (x < pixels) memcpy(&own[WAVE], above + RGB * x, RGB);
        for (int k = 0; k < WAVE; k++) {
            if (x - k < 0 || x - k >= pixels) continue;
            memcpy(&own[k], filtered + k * (width + 1) + RGB * (x - k), RGB);
        }
        low.step(Pixels{own[4], own[5], own[6], own[7]}, high.left[3]);
        high.step(Pixels{own[0], own[1], own[2], own[3]}, own[WAVE]);
        for (int k = 0; k < WAVE; k++) {
            if (x - k < 0 || x - k >= pixels) continue;
            const uint32_t pixel = k < 4 ? high.left[k] : low.left[k - 4];
            memcpy(rows + k * width + RGB * (x - k), &pixel, RGB);
        }
    };
    int64_t x = 0;
    for (; x < WAVE - 1; x++) edge(x);
    const int64_t from = width + 1 - RGB, to = width - RGB;
    // The fourth byte that is written is the next pixel's, which comes after it.
    for (; x < pixels - 1; x++) {
        const uint8_t* own = filtered + RGB * x;
        low.step(Pixels{four_bytes(own + 4 * from), four_bytes(own + 5 * from),
                        four_bytes(own + 6 * from), four_bytes(own + 7 * from)},
                 high.left[3]);
        high.step(Pixels{four_bytes(own), four_bytes(own + from), four_bytes(own + 2 * from),
                         four_bytes(own + 3 * from)},
                  four_bytes(above + RGB * x));
        uint8_t* row = rows + RGB * x;
        for (int k = 0; k < 4; k++) {
            const uint32_t one = high.left[k], other = low.left[k];
            memcpy(row + k * to, &one, 4);
            memcpy(row + (k + 4) * to, &other, 4);
        }
    }
    for (; x < pixels + WAVE - 1; x++) edge(x);
}

// One row by its filter (PNG specification, 9.2); false if there is no such filter.
bool unfilter_row(const uint8_t* filtered, const uint8_t* above, int64_t width, int64_t step,
                  uint8_t* row) {
    const int filter = filtered[0];
    const uint8_t* own = filtered + 1;
    const int64_t edge = std::min(step, width);
    if (filter > 4) return false;
    if (filter == 0) memcpy(row, own, static_cast<size_t>(width));
    if (filter == 2) {
        for (int64_t x = 0; x < width; x++) row[x] = static_cast<uint8_t>(own[x] + above[x]);
    }
    if (filter == 0 || filter == 2) return true;
    for (int64_t x = 0; x < edge; x++) {
        const int up = filter == 1 ? 0 : filter == 3 ? above[x] / 2 : above[x];
        row[x] = static_cast<uint8_t>(own[x] + up);
    }
    for (int64_t x = edge; x < width; x++) {
        const int left = row[x - step], up = above[x], corner = above[x - step];
        const int near = filter == 1   ? left
                         : filter == 3 ? (left + up) / 2
                                       : paeth<int>(left, up, corner);
        row[x] = static_cast<uint8_t>(own[x] + near);
    }
    return true;
}

bool unfilter(const uint8_t* filtered, int64_t height, int64_t width, int64_t step, uint8_t* rows,
              const uint8_t* nothing) {
    const auto is_wave = [&](int64_t y) {
        if (step != RGB || width < RGB * 2 * WAVE || height - y < WAVE) return false;
        for (int k = 0; k < WAVE; k++) {
            if (filtered[(y + k) * (width + 1)] != 4) return false;
        }
        return true;
    };
    for (int64_t y = 0; y < height;) {
        const uint8_t* own = filtered + y * (width + 1);
        const uint8_t* above = y == 0 ? nothing : rows + (y - 1) * width;
        if (is_wave(y)) {
            unfilter_wave(own + 1, above, width, rows + y * width);
            y += WAVE;
            continue;
        }
        if (!unfilter_row(own, above, width, step, rows + y * width)) return false;
        y++;
    }
    return true;
}

}  // namespace

// The rows of a PNG file: `filtered` (height, 1 + width) begin with their filters each, `rows`
// (height, width) takes bytes as the file has them, `step` of them a pixel. `read` tells 1, or 0
// where there is no such filter; `rows` are undefined then.
SAILENV_KERNEL(png_rows)
(const uint8_t* filtered, int64_t height, int64_t width, int64_t step, uint8_t* rows,
 int64_t* read) {
    constexpr int64_t LARGEST = int64_t{1} << 32;
    if (height < 1 || width < 1 || height > LARGEST / width || step < 1 || step > 8) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    try {
        const std::vector<uint8_t> nothing(static_cast<size_t>(width));
        *read = unfilter(filtered, height, width, step, rows, nothing.data()) ? 1 : 0;
        return sailenv::STATUS_OK;
    } catch (const std::bad_alloc&) {
        return sailenv::STATUS_OUT_OF_MEMORY;
    }
}
