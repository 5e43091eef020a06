// Numbers from their differences; see light/bake/array_coding.py, which writes them.
#include <cstring>

#include "../abi.h"

namespace {

// `planes` are the lowest bytes of all small numbers, then the next ones, and so forth. Small
// numbers 0, 1, 2, 3 stand for the steps 0, -1, 1, -2. Sums wrap around, as the steps did.
template <typename T>
void sum_steps(const uint8_t* planes, int64_t rows, int64_t length, int64_t channels, T* numbers) {
    const int64_t row_size = length * channels, size = rows * row_size;
    for (int64_t y = 0; y < rows; y++) {
        T* row = numbers + y * row_size;
        const uint8_t* own = planes + y * row_size;
        for (int64_t i = 0; i < row_size; i++) {
            T small = 0;
            for (size_t b = 0; b < sizeof(T); b++) {
                const T byte = own[static_cast<int64_t>(b) * size + i];
                small = static_cast<T>(small | static_cast<T>(byte << (8 * b)));
            }
            row[i] = static_cast<T>((small >> 1) ^ static_cast<T>(0 - (small & 1)));
        }
        if (channels == 3) {
            T sum[3] = {0, 0, 0};
            for (int64_t i = 0; i < row_size; i += 3) {
                const T green = row[i + 1];
                sum[0] = static_cast<T>(sum[0] + row[i] + green);
                sum[1] = static_cast<T>(sum[1] + green);
                sum[2] = static_cast<T>(sum[2] + row[i + 2] + green);
                memcpy(row + i, sum, sizeof sum);
            }
        } else {
            T sum = 0;
            for (int64_t i = 0; i < row_size; i++) row[i] = sum = static_cast<T>(sum + row[i]);
        }
        if (y == 0) continue;
        for (int64_t i = 0; i < row_size; i++) row[i] = static_cast<T>(row[i] + row[i - row_size]);
    }
}

}  // namespace

// The (rows, length, channels) numbers of so many bytes each, 1, 2, 4 or 8, from `planes` of as
// many bytes in all. There are three channels or one.
SAILENV_KERNEL(sum_steps)
(const uint8_t* planes, int64_t rows, int64_t length, int64_t channels, int64_t bytes,
 void* numbers) {
    using namespace sailenv;
    if (rows < 0 || length < 0 || (channels != 1 && channels != 3)) return STATUS_INVALID_ARGUMENT;
    switch (bytes) {
        case 1:
            sum_steps(planes, rows, length, channels, static_cast<uint8_t*>(numbers));
            break;
        case 2:
            sum_steps(planes, rows, length, channels, static_cast<uint16_t*>(numbers));
            break;
        case 4:
            sum_steps(planes, rows, length, channels, static_cast<uint32_t*>(numbers));
            break;
        case 8:
            sum_steps(planes, rows, length, channels, static_cast<uint64_t*>(numbers));
            break;
        default:
            return STATUS_INVALID_ARGUMENT;
    }
    return STATUS_OK;
}
