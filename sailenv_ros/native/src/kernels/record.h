// A kernel's arguments as one structure, which Python fills by name.
//
//     #define MOTION_FIELDS(FIELD) FIELD(int64_t, width) FIELD(const float*, depth)
//     SAILENV_RECORD(Motion, motion, MOTION_FIELDS)
//
// defines the structure `Motion`, and exports sailenv_motion_layout_<instruction set>, by which the
// loader compares name, kind, offset and size of each field with Python's (native/records.py).
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "../abi.h"

namespace sailenv {

// One field; the last one of a list has no name, and the size of the whole.
struct FieldLayout {
    const char* name;
    int64_t kind;  // 'p' a pointer, 'i' an integer, 'f' a floating-point number
    int64_t offset, size;
};

template <class T>
constexpr int64_t kind_of() {
    static_assert(std::is_pointer<T>::value || std::is_arithmetic<T>::value, "a plain field");
    return std::is_pointer<T>::value ? 'p' : std::is_integral<T>::value ? 'i' : 'f';
}

}  // namespace sailenv

#define SAILENV_DECLARE_FIELD_(type, name) type name;
#define SAILENV_TELL_FIELD_(type, name) \
    {#name, sailenv::kind_of<type>(), static_cast<int64_t>(offsetof(Self, name)), sizeof(type)},

#define SAILENV_RECORD(Record, kernel, FIELDS)                                         \
    namespace {                                                                        \
    struct Record {                                                                    \
        FIELDS(SAILENV_DECLARE_FIELD_)                                                 \
    };                                                                                 \
    }                                                                                  \
    SAILENV_EXPORT const sailenv::FieldLayout* SAILENV_JOIN(sailenv_, kernel##_layout, \
                                                            SAILENV_ISA)() {           \
        using Self = Record;                                                           \
        static const sailenv::FieldLayout fields[] = {                                 \
            FIELDS(SAILENV_TELL_FIELD_){nullptr, 0, 0, sizeof(Self)}};                 \
        return fields;                                                                 \
    }
