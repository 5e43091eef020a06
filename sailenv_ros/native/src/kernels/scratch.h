// Memory for the length of one call, without exceptions: null where there is none.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>

namespace sailenv {

struct Free {
    void operator()(void* memory) const { std::free(memory); }
};
template <class T>
using Memory = std::unique_ptr<T[], Free>;

template <class T>
Memory<T> allocate(int64_t count) {
    return Memory<T>(static_cast<T*>(std::malloc(sizeof(T) * static_cast<size_t>(count))));
}

}  // namespace sailenv
