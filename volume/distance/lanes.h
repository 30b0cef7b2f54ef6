// Several floats or 32-bit integers side by side, in as many of the machine's registers as that takes. What is written
// with them gives the same in every lane, whatever their number.
//
// REQUIRES of who includes this: -ffp-contract=off, -fno-math-errno (a square root is one instruction) and -Wno-psabi
// (all is inlined: nothing is passed in registers that a processor may lack).
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/vectors.h"

namespace isowave {

template <int N>
struct Lanes {
    typedef float Floats __attribute__((vector_size(4 * N)));
    typedef std::int32_t Ints __attribute__((vector_size(4 * N)));

    ISOWAVE_INLINE static Floats all(float value) { return Floats{} + value; }
    ISOWAVE_INLINE static Ints all(std::int32_t value) { return Ints{} + value; }
    ISOWAVE_INLINE static Floats load(const float* from) {
        Floats v;
        __builtin_memcpy(&v, from, sizeof v);
        return v;
    }
    ISOWAVE_INLINE static Ints load(const std::int32_t* from) {
        Ints v;
        __builtin_memcpy(&v, from, sizeof v);
        return v;
    }
    ISOWAVE_INLINE static void store(float* to, Floats v) { __builtin_memcpy(to, &v, sizeof v); }
    ISOWAVE_INLINE static void store(std::int32_t* to, Ints v) { __builtin_memcpy(to, &v, sizeof v); }
};

// Lane by lane. NaN in neither.
template <class Vector>
ISOWAVE_INLINE Vector least(Vector a, Vector b) {
    return a < b ? a : b;
}
template <class Vector>
ISOWAVE_INLINE Vector most(Vector a, Vector b) {
    return a > b ? a : b;
}
template <class Floats>
ISOWAVE_INLINE Floats squareRoot(Floats v) {
    for (std::size_t k = 0; k < sizeof v / sizeof v[0]; ++k) v[k] = __builtin_sqrtf(v[k]);
    return v;
}

}  // namespace isowave
