// Damaged copies of a small file, read one by one in child processes: every prefix, and copies with one byte changed.
//
//   Outcome seen = sweep(folder / "a.png", bytes, [](const fs::path& file) { readBitmap(file); });
//
// What each read must keep: it succeeds, or throws InputError with one line that begins with the name of a file and goes on
// behind it; nothing is printed, no signal comes, and it takes at most kMostSeconds and kMostBytes. A child reads many
// copies; where one breaks a rule the next child goes on behind it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace isowave::test {

inline constexpr unsigned kMostSeconds = 20;
inline constexpr long kMostBytes = 1L << 30;

using Read = std::function<void(const std::filesystem::path&)>;

struct Outcome {
    std::size_t prefixes = 0, prefixesRead = 0, flips = 0, flipsRead = 0;
    long mostBytes = 0;      // of the largest child, or child of a child
    double mostSeconds = 0;  // of one read
};

// One line: what was seen.
std::string textOf(const Outcome& outcome, const std::string& name);

// How many copies: so many prefixes at most, evenly spread, and so many with one byte changed, the same ones in each run.
struct Extent {
    std::size_t prefixes = 4000, flips = 10000;
};

// Puts each damaged copy of `bytes` at `file` and reads it: `file` again, or whatever of it `read` looks at. A copy that
// breaks a rule fails the test of Google Test that runs. quick: what is enough where reading takes long; with
// ISOWAVE_EVERY_CORRUPTION=1 in the environment it does not count.
// REQUIRES: this process has one thread (a fork has no others), which is what `read` starts with.
Outcome sweep(const std::filesystem::path& file, const std::string& bytes, const Read& read,
              Extent quick = {});

// What `make` leaves in files, by a process of its own: the threads that it starts are not here afterwards.
void inAChild(const std::function<void()>& make);

std::string contentOf(const std::filesystem::path& file);

}  // namespace isowave::test
