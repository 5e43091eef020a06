// A kernel that tests the border, the threads and the instruction sets, and nothing else.
#include "../abi.h"
#include "../threads.h"

// Writes into counts[row] how often each row was worked on (once, if all is well), and into
// slots[row] by which slot. Returns an error for negative sizes.
SAILENV_KERNEL(self_test)
(int64_t threads, int64_t rows, int64_t tile_rows, int32_t* counts, int32_t* slots) {
    if (threads < 1 || rows < 0 || tile_rows < 1) return sailenv::STATUS_INVALID_ARGUMENT;
    sailenv::parallel_for(threads, rows, tile_rows, [&](int64_t first, int64_t last, int64_t slot) {
        for (int64_t row = first; row < last; row++) {
            counts[row]++;
            slots[row] = static_cast<int32_t>(slot);
        }
    });
    return sailenv::STATUS_OK;
}
