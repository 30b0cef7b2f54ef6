// The program as libFuzzer runs it:  fuzz_files --target=stl CORPUS [libFuzzer's own options]
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/fuzz/target.h"

namespace {

constexpr const char* kOption = "--target=";

// Static, since libFuzzer calls plain functions.
isowave::fuzz::Target& chosen() {
    static isowave::fuzz::Target target;
    return target;
}

}  // namespace

// libFuzzer passes over options that begin with two dashes.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    for (int i = 1; i < *argc; ++i)
        if (std::strncmp((*argv)[i], kOption, std::strlen(kOption)) == 0)
            for (const auto& target : isowave::fuzz::targets())
                if (target.name == (*argv)[i] + std::strlen(kOption)) chosen() = target;
    if (chosen().run) return 0;
    std::fprintf(stderr, "give one of");
    for (const auto& target : isowave::fuzz::targets())
        std::fprintf(stderr, " %s%s", kOption, target.name.c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    chosen().run({reinterpret_cast<const char*>(data), size});
    return 0;
}
