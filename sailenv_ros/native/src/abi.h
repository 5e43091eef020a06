// The border to Python: plain C functions that ctypes calls.
//
// A kernel is an exported function that is compiled once for each instruction set. It takes plain
// numbers and pointers to dense arrays, whose sizes the caller has checked, writes its results into
// arrays of the caller, and returns a Status. It throws nothing and keeps nothing between calls.
// Where it takes more than a few, they come as one structure (kernels/record.h).
#pragma once

#include <cstdint>

// Counted up whenever a function's arguments change; library.py holds the same number.
#define SAILENV_ABI_VERSION 5

#define SAILENV_EXPORT extern "C" __attribute__((visibility("default")))

#define SAILENV_JOIN_(a, b, c) a##b##_##c
#define SAILENV_JOIN(a, b, c) SAILENV_JOIN_(a, b, c)

// Begins the definition of a kernel: SAILENV_KERNEL(annotate)(int64_t threads, ...) { ... }
// is exported as sailenv_annotate_avx2 and so forth.
#define SAILENV_KERNEL(name) SAILENV_EXPORT int32_t SAILENV_JOIN(sailenv_, name, SAILENV_ISA)

namespace sailenv {

enum Status : int32_t {
    STATUS_OK = 0,
    STATUS_INVALID_ARGUMENT = 1,
    STATUS_OUT_OF_MEMORY = 2,
};

}  // namespace sailenv
