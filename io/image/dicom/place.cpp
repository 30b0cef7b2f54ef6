#include "io/image/dicom/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "isowave/error.h"

namespace isowave::imageio {
namespace {

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void sortAlong(DicomStack& stack, const Vec3& normal) {
    std::stable_sort(stack.begin(), stack.end(), [&](const DicomFrame& a, const DicomFrame& b) {
        return dot(*a.position, normal) < dot(*b.position, normal);
    });
}

// ---- several frames at one place

// Below this two frames lie at one place: 1 % of the usual gap between places.
double samePlace(const DicomStack& stack, const Vec3& normal) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < stack.size(); ++i)
        gaps.push_back(dot(*stack[i].position - *stack[i - 1].position, normal));
    const double most = *std::max_element(gaps.begin(), gaps.end());
    std::erase_if(gaps, [&](double gap) { return gap <= 1e-3 * most; });
    return gaps.empty() ? 0 : 0.01 * medianOf(std::move(gaps));
}

bool earlier(const DicomFrame& a, const DicomFrame& b) {
    return std::lexicographical_compare(
        a.moments.begin(), a.moments.end(), b.moments.begin(), b.moments.end(),
        [](const DicomMoment& x, const DicomMoment& y) { return x.value < y.value; });
}

// Frames at one place, in order of time; places in order along the normal.
std::vector<DicomStack> placesOf(DicomStack stack, const Vec3& normal) {
    const double same = stack.size() > 1 ? samePlace(stack, normal) : 0;
    std::vector<DicomStack> places;
    for (DicomFrame& frame : stack) {
        if (!places.empty() && dot(*frame.position - *places.back()[0].position, normal) <= same)
            places.back().push_back(std::move(frame));
        else
            places.push_back({std::move(frame)});
    }
    for (DicomStack& place : places) std::stable_sort(place.begin(), place.end(), earlier);
    return places;
}

// "EchoTime 4.6, 9.2": the first that differs between all frames of a place.
std::string differenceText(const DicomStack& place) {
    for (std::size_t m = 0; m + 1 < place[0].moments.size(); ++m) {
        std::set<double> values;
        std::string text;
        for (const DicomFrame& frame : place) {
            if (m >= frame.moments.size() ||
                std::string_view(frame.moments[m].name) != place[0].moments[m].name)
                break;
            values.insert(frame.moments[m].value);
            if (values.size() <= 6) text += (text.empty() ? " " : ", ") + frame.moments[m].text;
        }
        if (values.size() != place.size()) continue;
        return fmt::format(" ({}{}{})", place[0].moments[m].name, text, place.size() > 6 ? ", ..." : "");
    }
    return "";
}

// The same object twice, under two names.
void dropCopies(DicomStack& place, std::vector<std::string>& remarks) {
    for (std::size_t i = 1; i < place.size(); ++i) {
        const DicomFrame &a = place[i - 1], &b = place[i];
        if (a.object->instanceUid.empty() || a.object->instanceUid != b.object->instanceUid ||
            a.index != b.index)
            continue;
        remarks.push_back(fmt::format("{} is a copy of {} and left out", b.name(), a.name()));
        place.erase(place.begin() + static_cast<std::ptrdiff_t>(i--));
    }
}

void checkSideBySide(const std::string& folder, const DicomStack& place) {
    for (const DicomFrame& frame : place) {
        const double apart = length(*frame.position - *place[0].position);
        const double pixel = place[0].spacing ? (*place[0].spacing)[0] : 1;
        if (apart > 0.5 * pixel)
            throw InputError(folder,
                             fmt::format("slices {} and {} lie side by side in one plane, {:.4g} mm apart; "
                                         "put the slices of one stack into a folder of their own",
                                         place[0].name(), frame.name(), apart));
    }
}

// One frame of each place. REQUIRES: places is not empty.
DicomStack oneOfEach(const std::string& folder, std::vector<DicomStack> places,
                     const ImageReadOptions& options, std::vector<std::string>& remarks) {
    for (DicomStack& place : places) dropCopies(place, remarks);
    const DicomStack* most = &places[0];
    for (const DicomStack& place : places) most = place.size() > most->size() ? &place : most;
    checkSideBySide(folder, *most);
    const auto count = static_cast<std::int64_t>(most->size());
    if (places.size() == 1 && count > 1)
        throw InputError(
            folder, fmt::format("its {} frames, {} and {} among them, lie at one place{}; times or echoes "
                                "of one slice are no volume",
                                count, (*most)[0].name(), (*most)[1].name(), differenceText(*most)));
    if (count > 1 && !options.time)
        throw InputError(
            folder,
            fmt::format("slices {} and {} lie at the same place; it holds {} volumes, times or echoes{}; "
                        "choose one (--time 1 to {})",
                        (*most)[0].name(), (*most)[1].name(), count, differenceText(*most), count));
    const std::int64_t time = options.time.value_or(1);
    if (time < 1 || time > count)
        throw InputError(folder, fmt::format("has no time {}; it holds {}", time, count));
    DicomStack chosen;
    for (DicomStack& place : places) {
        if (static_cast<std::int64_t>(place.size()) < time)
            throw InputError(
                folder, fmt::format("has {} slices where {} lies but {} where {} lies; slices of time {} "
                                    "are missing",
                                    count, (*most)[0].name(), place.size(), place[0].name(), time));
        chosen.push_back(std::move(place[static_cast<std::size_t>(time - 1)]));
    }
    return chosen;
}

// ---- frames that say nothing of their places

std::optional<double> instanceOf(const DicomFrame& frame) { return frame.instance; }
std::optional<double> locationOf(const DicomFrame& frame) { return frame.location; }

// Sorts by a number that all frames have and no two share. Returns false where there is none.
bool sortBy(DicomStack& stack, std::optional<double> (*number)(const DicomFrame&)) {
    std::set<double> values;
    for (const DicomFrame& frame : stack)
        if (!number(frame) || !values.insert(*number(frame)).second) return false;
    std::stable_sort(stack.begin(), stack.end(),
                     [&](const DicomFrame& a, const DicomFrame& b) { return *number(a) < *number(b); });
    return true;
}

// The distances from the first that SliceLocation says, when it runs one way.
std::vector<double> saidHeights(const DicomStack& stack) {
    std::vector<double> heights;
    for (const DicomFrame& frame : stack) {
        if (!frame.location) return {};
        heights.push_back(std::abs(*frame.location - *stack[0].location));
        if (heights.size() > 1 && heights.back() <= heights[heights.size() - 2]) return {};
    }
    return heights;
}

// Their distance is all that frames without places say. One slice alone: its thickness, for some scanners write the gap
// where the distance belongs.
double heightOf(const DicomFrame& frame, bool alone) {
    const double between = std::abs(frame.between);
    const double first = alone ? frame.thickness : between, second = alone ? between : frame.thickness;
    return first > 0 ? first : second;
}

// Puts frames without places in order and on the z axis.
void stackBlindly(const std::string& folder, DicomStack& stack, PlacedStack& placed) {
    const bool oneFile = stack[0].object->frames > 1;
    const bool numbered = sortBy(stack, instanceOf);
    if (!numbered && stack.size() > 1 && !sortBy(stack, locationOf))
        throw InputError(
            folder,
            "its slices say neither where they lie (ImagePositionPatient, ImageOrientationPatient) nor "
            "their order (InstanceNumber, SliceLocation); their order is not known");
    std::vector<double> heights = saidHeights(stack);
    const double step = heightOf(stack[0], stack.size() == 1);
    if (heights.empty())
        for (std::size_t i = 0; i < stack.size(); ++i)
            heights.push_back(static_cast<double>(i) * (step > 0 ? step : 1));
    else if (stack.size() > 1)
        placed.step = heights[1];
    if (placed.step == 0) placed.step = step;
    for (DicomFrame& frame : stack) {
        if (frame.row) continue;
        frame.row = Vec3{1, 0, 0};
        frame.column = Vec3{0, 1, 0};
        placed.saysSides = false;
    }
    const Vec3 normal = stack[0].normal();
    for (std::size_t i = 0; i < stack.size(); ++i) {
        DicomFrame& frame = stack[i];
        frame.position = normal * heights[i];
        if (placed.step == 0) frame.stepAssumed = true;
    }
    const char* by = numbered ? "InstanceNumber" : "SliceLocation";
    if (stack.size() == 1)
        placed.remarks.push_back("the slice says nothing of its place; it is put at the origin");
    else if (oneFile)
        placed.remarks.push_back(
            "the file says nothing of its place; its frames are stacked in their order from the origin on");
    else
        placed.remarks.push_back(
            fmt::format("the slices say nothing of their places; they are stacked by {}, so that the solid "
                        "may be mirrored",
                        by));
}

// ---- the line

struct Line {
    Vec3 along;  // unit vector
    double step = 0;
    std::vector<double> heights;  // of each frame from the first
    std::size_t farthest = 0;     // the frame that lies farthest beside the line
    double beside = 0;            // so far, mm
    double uneven = 0;            // the farthest that a height is from i step
};

// REQUIRES: at least two frames, sorted, not all at one place.
Line lineThrough(const DicomStack& stack) {
    Line line;
    const Vec3 whole = *stack.back().position - *stack.front().position;
    line.along = whole / length(whole);
    line.step = length(whole) / static_cast<double>(stack.size() - 1);
    for (std::size_t i = 0; i < stack.size(); ++i) {
        const Vec3 from = *stack[i].position - *stack[0].position;
        const double height = dot(from, line.along), beside = length(from - line.along * height);
        line.heights.push_back(height);
        line.uneven = std::max(line.uneven, std::abs(height - static_cast<double>(i) * line.step));
        if (beside > line.beside) {
            line.beside = beside;
            line.farthest = i;
        }
    }
    return line;
}

void checkBeside(const std::string& folder, const DicomStack& stack, const Line& line) {
    if (line.beside <= placeTolerance(stack, line.step)) return;
    throw InputError(
        folder,
        fmt::format("slice {} lies {:.4g} mm beside the line from {} to {}; expected slices on one "
                    "line; put those of one stack into a folder of their own",
                    stack[line.farthest].name(), line.beside, stack.front().name(), stack.back().name()));
}

struct Gap {
    std::size_t from = 0;  // between frames from and from + 1
    double mm = 0;
};

Gap gapAt(const Line& line, std::size_t i) { return {i, line.heights[i + 1] - line.heights[i]}; }

std::string textOf(const DicomStack& stack, const Gap& gap) {
    return fmt::format("{} and {} are {:.4g} mm apart", stack[gap.from].name(), stack[gap.from + 1].name(),
                       gap.mm);
}

[[noreturn]] void throwUneven(const std::string& folder, const DicomStack& stack, const Line& line) {
    Gap least = gapAt(line, 0), most = least;
    std::vector<double> gaps;
    for (std::size_t i = 0; i + 1 < stack.size(); ++i) {
        const Gap gap = gapAt(line, i);
        gaps.push_back(gap.mm);
        if (gap.mm < (1 - 1e-6) * least.mm) least = gap;  // the first of equal ones
        if (gap.mm > (1 + 1e-6) * most.mm) most = gap;
    }
    const double usual = medianOf(gaps), ratio = most.mm / usual;
    const auto large = std::count_if(gaps.begin(), gaps.end(), [&](double g) { return g > 1.5 * usual; });
    const bool missing =
        ratio > 1.5 && std::abs(ratio - std::round(ratio)) < 0.02 * ratio && 10 * large <= std::ssize(gaps);
    throw InputError(folder, fmt::format("slices {}, {}; {}; --resample-slices interpolates between them",
                                         textOf(stack, most), textOf(stack, least),
                                         missing ? "slices are missing" : "expected even steps within 1 %"));
}

// Even steps as small as the smallest gap.
void resample(PlacedStack& placed, const Line& line) {
    double least = line.heights[1];
    for (std::size_t i = 0; i + 1 < line.heights.size(); ++i) least = std::min(least, gapAt(line, i).mm);
    const double whole = line.heights.back();
    const double most = 16.0 * static_cast<double>(line.heights.size());
    const double steps = std::min(std::max(1.0, std::round(whole / least)), most);
    placed.even = false;
    placed.step = whole / steps;
    placed.slices = static_cast<std::int64_t>(steps) + 1;
    placed.remarks.push_back(
        fmt::format("{} slices in uneven steps are interpolated to {} in steps of {:.4g} mm",
                    line.heights.size(), placed.slices, placed.step));
}

bool isMultiple(double x, double of) {
    // Four-digit offsets are written with seven digits or so, which leaves 1e-5 mm.
    return std::abs(x / of - std::round(x / of)) < 0.01;
}

// The largest of 1, 0.1 and 0.01 mm of which all differences of positions are whole multiples; 0 for none.
double roundingOf(const DicomStack& stack) {
    for (const double grid : {1.0, 0.1, 0.01}) {
        const auto fits = [&](const DicomFrame& frame) {
            const Vec3 d = *frame.position - *stack[0].position;
            return isMultiple(d.x, grid) && isMultiple(d.y, grid) && isMultiple(d.z, grid);
        };
        if (std::all_of(stack.begin(), stack.end(), fits)) return grid;
    }
    return 0;
}

void remarkTilt(const DicomStack& stack, const Line& line, std::vector<std::string>& remarks) {
    const Vec3 normal = stack[0].normal();
    // Positions are rounded, often to 0.1 mm; a lean below half a pixel over the whole stack is not worth a word.
    const double lean = length(line.along - normal * dot(line.along, normal)) * line.heights.back();
    const double tilt = std::acos(std::clamp(dot(line.along, normal), -1.0, 1.0)) * 180 / M_PI;
    if (lean > 0.5 * (stack[0].spacing ? (*stack[0].spacing)[0] : 1))
        remarks.push_back(
            fmt::format("the gantry is tilted by {:.2f} degrees; the voxels are kept so", tilt));
}

}  // namespace

double placeTolerance(const DicomStack& stack, double step) {
    // The position and both ends of the line are rounded by half of it.
    return std::max(0.01 * step, std::min(roundingOf(stack), 0.1 * step));
}

bool liesEvenly(DicomStack stack) {
    const Vec3 normal = stack[0].normal();
    sortAlong(stack, normal);
    if (stack.size() < 2) return true;
    if (!(dot(*stack.back().position - *stack.front().position, normal) > 0)) return false;
    const Line line = lineThrough(stack);
    return std::max(line.beside, line.uneven) <= placeTolerance(stack, line.step);
}

PlacedStack placeStack(const std::string& folder, DicomStack stack, const ImageReadOptions& options) {
    PlacedStack placed;
    if (!stack[0].placed()) stackBlindly(folder, stack, placed);
    const Vec3 normal = stack[0].normal();
    sortAlong(stack, normal);
    placed.frames = oneOfEach(folder, placesOf(std::move(stack), normal), options, placed.remarks);
    placed.slices = static_cast<std::int64_t>(placed.frames.size());
    placed.along = normal;
    if (placed.frames.size() == 1) {
        placed.heights = {0};
        placed.step = heightOf(placed.frames[0], true);
        return placed;
    }
    const Line line = lineThrough(placed.frames);
    checkBeside(folder, placed.frames, line);
    placed.along = line.along;
    placed.heights = line.heights;
    placed.step = line.step;
    const double tolerance = placeTolerance(placed.frames, line.step);
    if (line.uneven > tolerance) {
        if (!options.resampleSlices) throwUneven(folder, placed.frames, line);
        resample(placed, line);
    } else if (std::max(line.uneven, line.beside) > 0.01 * line.step) {
        placed.remarks.push_back(
            fmt::format("the places of the slices are rounded to {:g} mm or so; even steps of {:.4g} mm "
                        "are taken",
                        roundingOf(placed.frames), line.step));
    }
    remarkTilt(placed.frames, line, placed.remarks);
    return placed;
}

}  // namespace isowave::imageio
