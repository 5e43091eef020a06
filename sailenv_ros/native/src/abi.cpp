// What the library says about itself, and which instruction set suits the processor.
#include "abi.h"

#ifndef SAILENV_SOURCE_HASH
#error "compile.py defines SAILENV_SOURCE_HASH"
#endif

// compile.py looks for this text in the file.
static const char SOURCES[] = "sailenv-native-sources:" SAILENV_SOURCE_HASH;

SAILENV_EXPORT int32_t sailenv_abi_version() { return SAILENV_ABI_VERSION; }

SAILENV_EXPORT const char* sailenv_sources() { return SOURCES; }

// 0: portable, 1: AVX2 (x86-64-v3), 2: AVX-512 (x86-64-v4).
SAILENV_EXPORT int32_t sailenv_instruction_set_level() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (!(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
          __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma") &&
          __builtin_cpu_supports("popcnt"))) {
        return 0;
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
        return 2;
    }
    return 1;
#else
    return 0;
#endif
}
