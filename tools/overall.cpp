#include "tools/overall.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isowave::tools {
namespace {

struct StageShare {
    std::string_view stage;
    double begin, end;
};
// Where in a run of `isowave lod` a stage begins and ends, roughly: inputs differ, and what the bar needs is that it never goes
// back and never stands still for long.
constexpr StageShare kStages[] = {
    {"reading", 0.00, 0.05},   {"repairing", 0.05, 0.08},           {"finding the inside", 0.08, 0.12},
    {"distances", 0.08, 0.35}, {"measuring distances", 0.12, 0.35}, {"walls", 0.35, 0.40},
    {"fitting", 0.35, 0.45},   {"analysing", 0.45, 1.00},           {"synthesising", 0.10, 1.00},
};

constexpr double kLeastSeconds = 2, kLeastShare = 0.02;  // for a guess at what is left

std::string minutes(double seconds) {
    const auto whole = static_cast<long>(std::ceil(seconds));
    return whole < 3600 ? fmt::format("{}:{:02}", whole / 60, whole % 60)
                        : fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

// Per second, where it can be told.
std::optional<double> rateOf(const ProgressFacts& facts) {
    if (!facts.ofWhole || facts.seconds < kLeastSeconds || facts.share < kLeastShare) return std::nullopt;
    return facts.share / facts.seconds;
}

double percent(const ProgressFacts& facts) { return std::floor(100 * std::clamp(facts.share, 0.0, 1.0)); }

}  // namespace

void Overall::startPart(std::size_t index, std::size_t count) {
    index_ = index;
    count_ = count;
    ofPart_ = 0.0;
}

std::optional<double> Overall::at(std::string_view stage, double done) {
    const auto* found = std::find_if(std::begin(kStages), std::end(kStages),
                                     [&](const StageShare& s) { return s.stage == stage; });
    if (found != std::end(kStages)) {
        const double now = found->begin + (found->end - found->begin) * std::clamp(done, 0.0, 1.0);
        ofPart_ = std::max(ofPart_.value_or(0.0), now);
    }
    if (!ofPart_) return std::nullopt;
    return (static_cast<double>(index_) + *ofPart_) / static_cast<double>(count_);
}

std::string barText(const ProgressFacts& facts, std::size_t width) {
    constexpr std::size_t kCells = 20;
    const auto full = static_cast<std::size_t>(percent(facts) / 100 * kCells);
    std::string text = fmt::format("[{}{}] {:3.0f} %  {}", std::string(full, '#'),
                                   std::string(kCells - full, '-'), percent(facts), facts.stage);
    if (const auto rate = rateOf(facts))
        text += fmt::format("  {:.2g} %/s  {} left", 100 * *rate, minutes((1 - facts.share) / *rate));
    return text.substr(0, width);
}

std::string plainText(const ProgressFacts& facts) {
    std::string text = fmt::format("{:.0f} %, {}", percent(facts), facts.stage);
    if (const auto rate = rateOf(facts)) text += fmt::format(", {} left", minutes((1 - facts.share) / *rate));
    return text;
}

}  // namespace isowave::tools
