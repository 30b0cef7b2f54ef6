#include "wavelets/step_order.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace isowave {
namespace {

constexpr double kRounding = 1e-6;  // of a ratio of edges that were measured along oblique axes
constexpr int kAllAxes = 3;
constexpr int kNoLevel = 1 << 30;  // a step that no solid has; sums of it and a few steps stay numbers

double ratioOf(const std::array<double, 3>& voxel) {
    const auto [least, most] = std::minmax_element(voxel.begin(), voxel.end());
    return *most / *least;
}

// The axes of the `count` shortest edges, ascending.
std::string shortestAxes(const std::array<double, 3>& voxel, std::size_t count) {
    std::string axes = "xyz";
    std::stable_sort(axes.begin(), axes.end(), [&](char a, char b) {
        return voxel[static_cast<std::size_t>(a - 'x')] < voxel[static_cast<std::size_t>(b - 'x')];
    });
    axes.resize(count);
    std::sort(axes.begin(), axes.end());
    return axes;
}

std::array<double, 3> halvedOn(std::array<double, 3> voxel, const std::string& axes) {
    for (const char axis : axes) voxel[static_cast<std::size_t>(axis - 'x')] *= 2;
    return voxel;
}

int stepsOf(const std::vector<std::string>& levels) {
    return std::accumulate(levels.begin(), levels.end(), 0, [](int sum, const std::string& axes) {
        return sum + static_cast<int>(axes.size());
    });
}

}  // namespace

StepOrder StepOrder::forVoxels(const std::array<double, 3>& spacing, double factor) {
    StepOrder order;
    std::array<double, 3> voxel = spacing;
    while (ratioOf(voxel) >= factor * (1 - kRounding) && order.first.size() < wavelets::kMostHalvings) {
        const std::string one = shortestAxes(voxel, 1), two = shortestAxes(voxel, 2);
        const double ofOne = ratioOf(halvedOn(voxel, one)), ofTwo = ratioOf(halvedOn(voxel, two));
        const std::string& axes = ofTwo < ofOne * (1 - kRounding) ? two : one;
        if (std::min(ofOne, ofTwo) >= ratioOf(voxel) * (1 - kRounding)) break;
        voxel = halvedOn(voxel, axes);
        order.first.push_back(axes);
    }
    return order;
}

int StepOrder::axisAfter(int step) const {
    assert(step >= 0);
    for (const std::string& axes : first) {
        const auto count = static_cast<int>(axes.size());
        if (step < count) return axes[static_cast<std::size_t>(step)] - 'x';
        step -= count;
    }
    return step % kAllAxes;
}

int StepOrder::stepOf(int level) const {
    assert(level >= 0);
    const int early = std::min(level, static_cast<int>(first.size()));
    const std::int64_t later = std::int64_t(kAllAxes) * (level - early);
    return static_cast<int>(
        std::min<std::int64_t>(stepsOf({first.begin(), first.begin() + early}) + later, kNoLevel));
}

int StepOrder::levelUpTo(int step) const {
    int level = 0;
    for (const std::string& axes : first) {
        if (step < static_cast<int>(axes.size())) return level;
        step -= static_cast<int>(axes.size());
        ++level;
    }
    return level + step / kAllAxes;
}

std::optional<int> StepOrder::levelOf(int step) const {
    const int level = levelUpTo(step);
    return stepOf(level) == step ? std::optional(level) : std::nullopt;
}

std::array<int, 3> StepOrder::halvings(int step) const {
    std::array<int, 3> times{};
    int s = 0;
    const int early = std::min(step, stepsOf(first));
    for (; s < early; ++s) ++times[static_cast<std::size_t>(axisAfter(s))];
    for (int& n : times) n += (step - early) / kAllAxes;
    for (s += (step - early) / kAllAxes * kAllAxes; s < step; ++s)
        ++times[static_cast<std::size_t>(axisAfter(s))];
    return times;
}

int StepOrder::levelOfVoxel(double longest) const {
    assert(longest >= 1);
    const double most = std::min(longest, std::numeric_limits<double>::max());  // 2^1024 is infinite
    const auto fits = [&](int level) {
        const std::array<int, 3> times = halvings(stepOf(level));
        return std::ldexp(1.0, *std::max_element(times.begin(), times.end())) <= most;
    };
    int level = 0;
    while (fits(level + 1)) ++level;
    return level;
}

namespace wavelets {

std::string textOf(const StepOrder& order) {
    std::string text;
    for (const std::string& axes : order.first) text += (text.empty() ? "" : " ") + axes;
    return text;
}

std::optional<StepOrder> orderOf(std::string_view text) {
    StepOrder order;
    std::string axes;
    for (const char c : std::string(text) + ' ') {
        if (c >= 'x' && c <= 'z' && axes.find(c) == std::string::npos)
            axes += c;
        else if (c == ' ' && !axes.empty())
            order.first.push_back(std::exchange(axes, {}));
        else if (!text.empty())
            return std::nullopt;
    }
    if (order.first.size() > kMostHalvings) return std::nullopt;
    return order;
}

}  // namespace wavelets
}  // namespace isowave
