#include "tools/about.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/version.h>

#include <thread>
#include <vector>

#include "base/heap.h"
#include "base/number_text.h"
#include "isowave/measure.h"
#include "isowave/version.h"
#include "lod/memory.h"

namespace isowave::tools {
namespace {

struct Feature {
    std::string_view name;
    bool has;
};

std::string listOf(const std::vector<Feature>& features) {
    std::string text;
    for (const Feature& feature : features)
        if (feature.has) text += (text.empty() ? "" : ", ") + std::string(feature.name);
    return text.empty() ? "none that is known" : text;
}

std::string simdOfProcessor() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    return listOf({{"SSE2", __builtin_cpu_supports("sse2") != 0},
                   {"SSE4.2", __builtin_cpu_supports("sse4.2") != 0},
                   {"AVX", __builtin_cpu_supports("avx") != 0},
                   {"AVX2", __builtin_cpu_supports("avx2") != 0},
                   {"FMA", __builtin_cpu_supports("fma") != 0},
                   {"AVX-512F", __builtin_cpu_supports("avx512f") != 0}});
#elif defined(__aarch64__)
    return "NEON";
#else
    return "none that is known";
#endif
}

// What every source may use, by the compiler's options.
std::string simdOfBuild() {
    std::vector<Feature> features;
#ifdef __SSE2__
    features.push_back({"SSE2", true});
#endif
#ifdef __AVX2__
    features.push_back({"AVX2", true});
#endif
#ifdef __AVX512F__
    features.push_back({"AVX-512F", true});
#endif
#ifdef __ARM_NEON
    features.push_back({"NEON", true});
#endif
    return listOf(features);
}

}  // namespace

std::string verboseVersion() {
    std::string text = "isowave " ISOWAVE_VERSION "\n";
    const auto line = [&](std::string_view key, const std::string& value) {
        text += fmt::format("{:<10} {}\n", key, value);
    };
    line("libraries", fmt::format("{}, oneTBB {} (as loaded)", ISOWAVE_LIBRARIES, TBB_runtime_version()));
    line("compiler", ISOWAVE_COMPILER);
    line("threads",
         fmt::format("{} of {} processors",
                     tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                     std::thread::hardware_concurrency()));
    line("SIMD", fmt::format("{}; built for {}", simdOfProcessor(), simdOfBuild()));
    line("allocator", heapName());
    line("memory", fmt::format("--max-memory is {} unless given", bytesText(lod::memoryLimit({}))));
    line("licence",
         canMeasureDistances() ? "GPL-3 as a whole (simplify/ is built in); sources MPL-2.0" : "MPL-2.0");
    return text;
}

}  // namespace isowave::tools
