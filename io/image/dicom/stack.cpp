#include "io/image/dicom/stack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/image/check.h"
#include "io/image/dicom/place.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

bool sameDirection(const std::optional<Vec3>& a, const std::optional<Vec3>& b) {
    return a.has_value() == b.has_value() && (!a || length(*a - *b) < 1e-3);
}

bool sameSpacing(const DicomFrame& a, const DicomFrame& b) {
    if (a.spacing.has_value() != b.spacing.has_value()) return false;
    if (!a.spacing) return true;
    for (int i = 0; i < 2; ++i)
        if (!(std::abs((*a.spacing)[i] - (*b.spacing)[i]) <= 2e-4 * std::abs((*b.spacing)[i]))) return false;
    return true;
}

// All but the series.
bool sameShape(const DicomFrame& a, const DicomFrame& b) {
    return a.object->rows == b.object->rows && a.object->columns == b.object->columns &&
           a.placed() == b.placed() && a.stackId == b.stackId && sameDirection(a.row, b.row) &&
           sameDirection(a.column, b.column) && sameSpacing(a, b);
}

bool belongs(const DicomStack& stack, const DicomFrame& frame) {
    return stack[0].object->seriesUid == frame.object->seriesUid && sameShape(stack[0], frame);
}

// ---- series of one slice each

bool joinable(const DicomStack& a, const DicomStack& b) {
    return a[0].object->studyUid == b[0].object->studyUid &&
           a[0].object->frameOfReference == b[0].object->frameOfReference && sameShape(a[0], b[0]);
}

std::vector<DicomStack> joinSingles(std::vector<DicomStack> stacks, std::vector<std::string>& remarks) {
    std::vector<DicomStack> result;
    for (std::size_t i = 0; i < stacks.size(); ++i) {
        if (stacks[i].empty()) continue;
        std::vector<std::size_t> group;
        if (stacks[i].size() == 1 && stacks[i][0].placed())
            for (std::size_t j = i; j < stacks.size(); ++j)
                if (stacks[j].size() == 1 && joinable(stacks[i], stacks[j])) group.push_back(j);
        DicomStack joined;
        for (const std::size_t j : group) joined.push_back(stacks[j][0]);
        if (joined.size() < 3 || !liesEvenly(joined)) {
            result.push_back(std::move(stacks[i]));
            continue;
        }
        remarks.push_back(fmt::format(
            "{} series of one slice each are joined, for they lie in even steps on a line", joined.size()));
        for (const std::size_t j : group) stacks[j].clear();
        result.push_back(std::move(joined));
    }
    return result;
}

// ---- lists

std::string orientationText(const DicomFrame& frame) {
    if (!frame.placed()) return "no position";
    const Vec3 n = frame.normal();
    constexpr double kAlong = 0.999;  // 2.6 degrees
    if (std::abs(n.z) > kAlong) return "axial";
    if (std::abs(n.y) > kAlong) return "coronal";
    if (std::abs(n.x) > kAlong) return "sagittal";
    return fmt::format("normal ({:.3g}, {:.3g}, {:.3g})", n.x, n.y, n.z);
}

std::string spacingText(const DicomFrame& frame) {
    return frame.spacing ? fmt::format("{:.4g} x {:.4g} mm", (*frame.spacing)[0], (*frame.spacing)[1])
                         : "no spacing";
}

std::string describe(const DicomStack& stack) {
    const DicomFrame& first = stack.front();
    const DicomObject& o = *first.object;
    return fmt::format("{} '{}' ({} of {} x {}, {}, {}, {} ...)",
                       o.seriesUid.empty() ? "(no UID)" : oneLine(o.seriesUid), o.description,
                       stack.size() == 1 ? "1 slice" : fmt::format("{} slices", stack.size()), o.columns,
                       o.rows, spacingText(first), orientationText(first), first.name());
}

std::string describe(const std::vector<DicomStack>& stacks) {
    constexpr std::size_t kMost = 12;
    std::string text;
    for (std::size_t i = 0; i < std::min(stacks.size(), kMost); ++i)
        text += fmt::format("{}{}: {}", i == 0 ? "" : "; ", i + 1, describe(stacks[i]));
    if (stacks.size() > kMost) text += fmt::format("; and {} more", stacks.size() - kMost);
    return text;
}

bool matches(const DicomStack& stack, const std::string& series) {
    return stack[0].object->seriesUid.find(series) != std::string::npos ||
           stack[0].object->description.find(series) != std::string::npos;
}

std::vector<DicomStack> ofSeries(const std::string& folder, std::vector<DicomStack> stacks,
                                 const std::string& series) {
    std::vector<DicomStack> matching;
    for (const DicomStack& stack : stacks)
        if (matches(stack, series)) matching.push_back(stack);
    if (matching.empty())
        throw InputError(
            folder, fmt::format("no series matches '{}'; it holds {}", oneLine(series), describe(stacks)));
    return matching;
}

[[noreturn]] void throwSeveral(const std::string& folder, const std::vector<DicomStack>& stacks) {
    const bool oneSeries = std::all_of(stacks.begin(), stacks.end(), [&](const DicomStack& s) {
        return s[0].object->seriesUid == stacks[0][0].object->seriesUid;
    });
    throw InputError(folder,
                     fmt::format("holds {} {}: {}; {}", stacks.size(),
                                 oneSeries ? "stacks of different size, spacing or orientation in one series"
                                           : "series or stacks",
                                 describe(stacks),
                                 oneSeries ? "choose one (--stack N)"
                                           : "choose one by its UID or a part of it (--series), or by its "
                                             "number (--stack N)"));
}

}  // namespace

std::vector<DicomStack> stacksOf(std::vector<DicomFrame> frames) {
    std::vector<DicomStack> stacks;
    for (DicomFrame& frame : frames) {
        const auto stack = std::find_if(stacks.begin(), stacks.end(),
                                        [&](const DicomStack& s) { return belongs(s, frame); });
        if (stack == stacks.end())
            stacks.push_back({std::move(frame)});
        else
            stack->push_back(std::move(frame));
    }
    return stacks;
}

DicomStack pickStack(const std::string& folder, std::vector<DicomStack> stacks,
                     const ImageReadOptions& options, std::vector<std::string>& remarks) {
    if (stacks.empty()) throw InputError(folder, "its DICOM files hold no images");
    if (options.series) stacks = ofSeries(folder, std::move(stacks), *options.series);
    std::vector<std::string> joined;
    stacks = joinSingles(std::move(stacks), joined);
    if (!options.stack && stacks.size() > 1) throwSeveral(folder, stacks);
    const std::int64_t chosen = options.stack.value_or(1);
    if (chosen < 1 || chosen > static_cast<std::int64_t>(stacks.size()))
        throw InputError(folder, fmt::format("has no stack {}; it holds {}", chosen, describe(stacks)));
    DicomStack stack = std::move(stacks[static_cast<std::size_t>(chosen - 1)]);
    if (stack.size() > 1 && stack.front().object->seriesUid != stack.back().object->seriesUid)
        remarks.insert(remarks.end(), joined.begin(), joined.end());
    return stack;
}

}  // namespace isowave::imageio
