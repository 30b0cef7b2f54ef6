#include "io/image/dicom/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "io/image/dicom/pixels.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

bool isWhole(double v) { return v == std::floor(v); }

void takeTypes(const DicomStack& frames, Header& header) {
    const DicomFrame& first = frames[0];
    bool rescaled = false, whole = true, same = true;
    for (const DicomFrame& frame : frames) {
        rescaled =
            rescaled || frame.slope != 1 || frame.intercept != 0 || frame.object->type != first.object->type;
        whole = whole && isIntegral(frame.object->type) && isWhole(frame.slope) && isWhole(frame.intercept);
        same = same && frame.slope == first.slope && frame.intercept == first.intercept;
    }
    header.type = rescaled ? ValueType::float32 : first.object->type;
    header.storedType = first.object->type;
    header.integral = whole;
    if (!same) return;
    header.slope = first.slope;
    header.intercept = first.intercept;
}

// Pixels that say nothing of their size: said as a missing z spacing is.
void takeSpacing(const DicomFrame& first, const ImageReadOptions& options, Header& header) {
    const auto spacing = first.spacing.value_or(std::array<double, 2>{1, 1});
    header.spacing = {spacing[0], spacing[1], 1};
    if (!first.spacing && !options.spacing)
        header.warnings.push_back(fmt::format(
            "no PixelSpacing in {}; pixels of 1 x 1 mm are assumed; give the spacing", header.format));
    if (first.spacing && first.spacingFrom != "PixelSpacing" && !options.spacing)
        header.warnings.push_back(
            fmt::format("no PixelSpacing in {}; {}, {:.4g} x {:.4g} mm, is taken, which may be "
                        "that at the detector; check it",
                        header.format, first.spacingFrom, spacing[0], spacing[1]));
    if (!first.spacing && options.spacing) header.hasZSpacing = false;  // nothing is replaced
}

void takeRemarks(const DicomStack& frames, Header& header) {
    const DicomObject* last = nullptr;
    for (const DicomFrame& frame : frames) {
        if (frame.object.get() == last) continue;
        last = frame.object.get();
        for (const std::string& remark : last->remarks)
            if (std::find(header.warnings.begin(), header.warnings.end(), remark) == header.warnings.end())
                header.warnings.push_back(remark);
    }
}

}  // namespace

Header headerOf(const PlacedStack& placed, const ImageReadOptions& options) {
    const DicomFrame& first = placed.frames[0];
    Header header;
    header.format = first.object->frames > 1 ? "DICOM frames" : "DICOM series";
    header.size = {first.object->columns, first.object->rows, placed.slices};
    takeTypes(placed.frames, header);
    takeSpacing(first, options, header);
    header.axis = {*first.row, *first.column, placed.along};
    header.origin = *first.position;
    header.spacing[2] = placed.step;
    if (placed.step == 0 || first.stepAssumed) {
        header.hasZSpacing = false;
        header.spacing[2] = header.spacing[0];
    }
    takeRemarks(placed.frames, header);
    if (!placed.saysSides) header.space = Space::unspecified;
    const double lean = dot(header.axis[0], header.axis[1]);
    if (std::abs(lean) > 1e-3)
        header.warnings.push_back(
            fmt::format("rows and columns stand at {:.1f} degrees; the voxels are kept so",
                        std::acos(lean) * 180 / M_PI));
    header.warnings.insert(header.warnings.end(), placed.remarks.begin(), placed.remarks.end());
    return header;
}

// ---- a frame a slice, or between them

namespace {

class FramesSource : public VoxelSource {
  public:
    explicit FramesSource(PlacedStack placed) : placed_(std::move(placed)) {}

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        std::int64_t inexact = 0;
        for (std::int64_t z = z0; z < z1; ++z, out += header.sliceVoxels())
            inexact += placed_.even ? pixels_.read(placed_.frames[static_cast<std::size_t>(z)], out)
                                    : between(z, out);
        return inexact;
    }

  private:
    // Frame i <= t < frame i + 1: value (1 - w) a + w b, w = (t - t[i]) / (t[i+1] - t[i]).
    std::int64_t between(std::int64_t z, float* out) {
        const std::vector<double>& t = placed_.heights;
        const double height = std::clamp(static_cast<double>(z) * placed_.step, t.front(), t.back());
        const auto above = std::upper_bound(t.begin() + 1, t.end() - 1, height);
        const auto i = static_cast<std::size_t>(above - t.begin()) - 1;
        const double w = std::clamp((height - t[i]) / (t[i + 1] - t[i]), 0.0, 1.0);
        const std::vector<float>&a = frame(i), &b = frame(i + 1);
        for (std::size_t v = 0; v < a.size(); ++v)
            out[v] = static_cast<float>((1 - w) * static_cast<double>(a[v]) + w * static_cast<double>(b[v]));
        return 0;
    }

    // The last two that were wanted are kept.
    const std::vector<float>& frame(std::size_t i) {
        Kept& kept = kept_[i % 2];
        if (kept.frame == i) return kept.values;
        kept.values.resize(static_cast<std::size_t>(header.sliceVoxels()));
        pixels_.read(placed_.frames[i], kept.values.data());
        kept.frame = i;
        return kept.values;
    }

    struct Kept {
        std::size_t frame = SIZE_MAX;
        std::vector<float> values;
    };
    PlacedStack placed_;
    DicomPixels pixels_;
    std::array<Kept, 2> kept_;
};

}  // namespace

SourcePtr framesSource(PlacedStack placed, Header header) {
    if (!placed.even) {
        header.type = ValueType::float32;
        header.integral = false;
    }
    auto source = std::make_unique<FramesSource>(std::move(placed));
    source->header = std::move(header);
    return source;
}

// ---- segmentations

namespace {

std::vector<int> segmentsOf(const DicomStack& stack) {
    std::set<int> numbers;
    for (const DicomFrame& frame : stack) numbers.insert(frame.segment);
    return {numbers.begin(), numbers.end()};
}

std::string listOf(const DicomStack& stack) {
    std::string text;
    for (const std::string& segment : stack[0].object->segments) text += (text.empty() ? "" : ", ") + segment;
    return text.empty() ? fmt::format("{} segments", segmentsOf(stack).size()) : text;
}

DicomStack ofSegment(const std::string& folder, const DicomStack& stack, std::int64_t which) {
    const std::vector<int> numbers = segmentsOf(stack);
    if (which < 1 || which > static_cast<std::int64_t>(numbers.size()))
        throw InputError(folder, fmt::format("has no segment {}; it holds {}", which, listOf(stack)));
    DicomStack chosen;
    for (const DicomFrame& frame : stack)
        if (frame.segment == numbers[static_cast<std::size_t>(which - 1)]) chosen.push_back(frame);
    return chosen;
}

// The slice of each frame on a lattice along the normal. Frames stand only where their segment is not empty, so that
// gaps are whole numbers of steps.
struct Lattice {
    double step = 0;
    std::int64_t slices = 1;
    std::vector<std::int64_t> slice;  // of each frame
    double worst = 0;                 // farthest from its place, mm
};

Lattice latticeOf(const std::vector<double>& heights, double step) {
    Lattice lattice;
    lattice.step = step;
    for (const double h : heights) {
        const double at = std::round(h / step);
        lattice.slice.push_back(static_cast<std::int64_t>(at));
        lattice.worst = std::max(lattice.worst, std::abs(h - at * step));
        lattice.slices = std::max(lattice.slices, lattice.slice.back() + 1);
    }
    return lattice;
}

double leastGap(std::vector<double> heights) {
    std::sort(heights.begin(), heights.end());
    double least = 0;
    for (std::size_t i = 1; i < heights.size(); ++i) {
        const double gap = heights[i] - heights[i - 1];
        if (gap > 1e-3 * heights.back() / static_cast<double>(heights.size()) && (least == 0 || gap < least))
            least = gap;
    }
    return least;
}

Lattice placeSegments(const std::string& folder, const DicomStack& stack, const Vec3& normal) {
    constexpr double kMostSlices = 100'000;
    std::vector<double> heights;
    for (const DicomFrame& frame : stack)
        heights.push_back(dot(*frame.position - *stack[0].position, normal));
    const double whole = *std::max_element(heights.begin(), heights.end());
    for (const double step : {std::abs(stack[0].between), leastGap(heights), stack[0].thickness}) {
        if (!(step > 0) || whole / step > kMostSlices) continue;
        Lattice lattice = latticeOf(heights, step);
        if (lattice.worst <= placeTolerance(stack, step)) return lattice;
    }
    if (whole == 0) return latticeOf(heights, 1);
    throw InputError(
        folder, fmt::format("its {} frames, {:.4g} mm from the first to the last, do not lie in even steps; "
                            "expected whole multiples of SpacingBetweenSlices ({:.4g} mm) or of the least "
                            "distance ({:.4g} mm)",
                            stack.size(), whole, stack[0].between, leastGap(heights)));
}

class SegmentsSource : public VoxelSource {
  public:
    SegmentsSource(DicomStack frames, const Lattice& lattice) : frames_(std::move(frames)) {
        for (std::size_t i = 0; i < frames_.size(); ++i) at_[lattice.slice[i]].push_back(i);
    }

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        for (std::int64_t z = z0; z < z1; ++z, out += header.sliceVoxels()) {
            std::fill(out, out + header.sliceVoxels(), 0.f);
            if (const auto here = at_.find(z); here != at_.end())
                for (const std::size_t i : here->second) add(frames_[i], out);
        }
        return 0;
    }

  private:
    void add(const DicomFrame& frame, float* out) {
        values_.resize(static_cast<std::size_t>(header.sliceVoxels()));
        pixels_.read(frame, values_.data());
        const bool bits = frame.object->allocated == 1;
        for (std::size_t v = 0; v < values_.size(); ++v) {
            if (values_[v] == 0 || values_[v] == frame.object->background) continue;
            const float value = bits ? static_cast<float>(frame.segment) : values_[v];
            if (out[v] != 0) throwOverlap(frame, out[v]);
            out[v] = value;
        }
    }

    [[noreturn]] void throwOverlap(const DicomFrame& frame, float other) const {
        throw InputError(
            frame.object->file.path.string(),
            fmt::format("its segments {} and {} overlap ({}); choose one: --stack 1 for the first", other,
                        frame.segment, listOf(frames_)));
    }

    DicomStack frames_;
    std::map<std::int64_t, std::vector<std::size_t>> at_;  // frames of each slice
    DicomPixels pixels_;
    std::vector<float> values_;
};

}  // namespace

SourcePtr segmentsSource(const std::string& folder, DicomStack stack, const ImageReadOptions& options) {
    const bool bits = stack[0].object->allocated == 1;
    const std::size_t segments = segmentsOf(stack).size();
    if (options.stack && stack[0].object->isLabelMap)
        throw InputError(folder,
                         fmt::format("is one map of all segments ({}); choose one by its number: --label N",
                                     listOf(stack)));
    if (options.stack) stack = ofSegment(folder, stack, *options.stack);
    if (!options.stack && !bits && segments > 1)
        throw InputError(folder,
                         fmt::format("holds shares of {} segments ({}); choose one: --stack 1 for the first",
                                     segments, listOf(stack)));
    const Vec3 normal = stack[0].normal();
    std::stable_sort(stack.begin(), stack.end(), [&](const DicomFrame& a, const DicomFrame& b) {
        return dot(*a.position, normal) < dot(*b.position, normal);
    });
    const Lattice lattice = placeSegments(folder, stack, normal);
    PlacedStack placed;
    placed.frames = stack;
    placed.step = stack.size() > 1 || stack[0].between != 0 ? lattice.step : 0;
    placed.slices = lattice.slices;
    placed.along = normal;
    Header header = headerOf(placed, options);
    header.format = "DICOM segmentation";
    header.type = !bits ? header.type : ValueType::uint16;
    header.storedType = bits ? ValueType::uint16 : *header.storedType;
    auto source = std::make_unique<SegmentsSource>(std::move(stack), lattice);
    source->header = std::move(header);
    return source;
}

}  // namespace isowave::imageio
