// Three threads that call the pool at once, also from within a tile; run by test_hostile_input.py.
#include "threads.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

namespace {

constexpr int ROUNDS = 2000;

void expect(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "%s\n", what);
    std::exit(1);
}

void call(int number) {
    std::vector<int64_t> visits(97);
    std::vector<int64_t> expected(97);
    for (int round = 0; round < ROUNDS; round++) {
        const int64_t threads = 2 + round % 3;
        const int64_t rows = 1 + (round * 7 + number) % 97;
        sailenv::parallel_for(threads, rows, 1 + round % 3,
                              [&](int64_t first, int64_t last, int64_t slot) {
                                  expect(0 <= slot && slot < threads, "a slot of nobody");
                                  for (int64_t row = first; row < last; row++) visits[row]++;
                              });
        for (int64_t row = 0; row < rows; row++) expected[row]++;
        if (round % 16 == 0) {
            sailenv::parallel_for(3, 4, 1, [&](int64_t, int64_t, int64_t) {
                std::atomic<int64_t> sum{0};
                sailenv::parallel_for(2, 8, 1, [&](int64_t first, int64_t last, int64_t) {
                    sum += last - first;
                });
                expect(sum == 8, "a row was left out within a tile");
            });
        }
    }
    expect(visits == expected, "a row was not visited exactly once");
}

}  // namespace

int main() {
    std::thread first(call, 1);
    std::thread second(call, 2);
    call(3);
    first.join();
    second.join();
}
