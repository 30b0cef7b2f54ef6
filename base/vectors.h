// What the machine's vector instructions are, asked when the program runs: one binary serves every processor,
// and uses what it finds. Results never depend on it.
#pragma once

#include <cstdlib>
#include <string_view>

namespace isowave {

// Doubles in one register: SSE2 or whatever else the compiler takes for granted; AVX2; AVX-512.
enum class Vectors { two, four, eight };

// Functions compiled for the wider ones. Call them where widestVectors() says so.
#if defined(__x86_64__) && defined(__GNUC__)
#define ISOWAVE_FOUR __attribute__((target("avx2")))
#ifdef __clang__  // does not know the last word
#define ISOWAVE_EIGHT __attribute__((target("avx2,avx512f,avx512vl,avx512dq,avx512bw")))
#else
#define ISOWAVE_EIGHT \
    __attribute__((target("avx2,avx512f,avx512vl,avx512dq,avx512bw,prefer-vector-width=512")))
#endif
#else
#define ISOWAVE_FOUR
#define ISOWAVE_EIGHT
#endif

// ISOWAVE_VECTORS=2 or 4 in the environment forbids wider ones: tests/field/same_bits.py shows with it that results are the same.
inline Vectors widestVectors() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const Vectors widest = [] {
        const char* const most = std::getenv("ISOWAVE_VECTORS");
        const std::string_view allowed = most ? most : "";
        __builtin_cpu_init();
        if (!__builtin_cpu_supports("avx2") || allowed == "2") return Vectors::two;
        const bool eight = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
        return eight && allowed != "4" ? Vectors::eight : Vectors::four;
    }();
    return widest;
#else
    return Vectors::two;
#endif
}

#define ISOWAVE_INLINE [[gnu::always_inline]] inline

}  // namespace isowave
