#include "tests/fuzz/section_files.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/section_file.h"
#include "curves2d/file/pyramid_file.h"
#include "curves2d/fit.h"
#include "isowave/curves.h"
#include "isowave/subdivision.h"
#include "subdivision/curves/curve_details.h"
#include "subdivision/lattice/relief_details.h"

namespace isowave::fuzz {
namespace {

constexpr std::string_view kPlain = "plain";
constexpr std::size_t kMagicAndVersion = 12, kSectionHead = 16;  // u32 kind, u64 length, u32 CRC-32

std::uint64_t numberAt(std::string_view bytes, std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + at, size);  // little endian, as is what fuzzers run on
    return value;
}

std::string section(std::string_view kind, const std::string& content) {
    ByteWriter length, crc;
    length.u64(content.size());
    const std::string covered = std::string(kind) + length.str() + content;
    crc.u32(static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(covered.data()), covered.size())));
    return std::string(kind) + length.str() + crc.str() + content;
}

// Lengths beyond the end become what is left; what is too short for a section stays as it is.
std::string mended(std::string_view bytes) {
    const bool plain = bytes.starts_with(kPlain);
    if (plain) bytes.remove_prefix(kPlain.size());
    if (bytes.size() < kMagicAndVersion) return std::string(bytes);
    std::string result(bytes.substr(0, kMagicAndVersion));
    bytes.remove_prefix(kMagicAndVersion);
    for (bool first = true; bytes.size() >= kSectionHead; first = false) {
        const std::uint64_t length =
            std::min<std::uint64_t>(numberAt(bytes, 4, 8), bytes.size() - kSectionHead);
        const std::string content(bytes.substr(kSectionHead, length));
        result += section(bytes.substr(0, 4), plain && !first ? deflated(content) : content);
        bytes.remove_prefix(kSectionHead + length);
    }
    return result.append(bytes);
}

void requireFinite(const std::vector<double>& values) {
    require(std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }),
            "a number that is not finite");
}

// Work on what was read may be refused, without a name.
template <class Work>
void attempt(const Work& work) {
    try {
        work();
    } catch (const InputError& e) {
        requireOneLine(e.what());
    }
}

// ---- curve-pyramid

void climb(const curves2d::Input& input) {
    constexpr std::int64_t kFewPoints = 20'000, kVeryFew = 2'000;
    const std::int64_t points = input.fitted->field.controlPointCount();
    if (points > kFewPoints) return;
    for (const auto hold : {curves2d::Hold::none, curves2d::Hold::local}) {
        if (hold == curves2d::Hold::local && points > kVeryFew) return;
        attempt([&] {
            curves2d::makeLadder(input, {.hold = hold}, [](const curves2d::LadderStep& step) {
                for (const auto& ring : step.curves().rings)
                    for (const auto& p : ring.points)
                        require(std::isfinite(p.x + p.y), "a point that is not finite");
            });
        });
    }
}

Answer readPyramid(std::string_view given) {
    const std::string bytes = mended(given);
    return answerOf("curves.iwc", [&] {
        const curves2d::Input input = curves2d::readPyramid(bytes, "curves.iwc");
        const std::string again = curves2d::pyramidBytes(input);
        require(curves2d::pyramidBytes(curves2d::readPyramid(again, "again")) == again,
                "a pyramid changes when it is written and read again");
        climb(input);
    });
}

// ---- curve-details

void rebuildAll(const subdivision::CurveSet& set) {
    constexpr std::size_t kFewNumbers = 100'000;
    std::size_t numbers = 0;
    for (const auto& curve : set.curves) {
        numbers += curve.coarse.coordinates.size();
        for (const auto& details : curve.details) numbers += details.coordinates.size();
    }
    if (numbers > kFewNumbers) return;
    using subdivision::Frames, subdivision::Positions, subdivision::CurveRebuildOptions;
    std::vector<subdivision::Polyline> moved;
    for (const auto& curve : set.curves) moved.push_back(curve.coarse);
    for (const CurveRebuildOptions& options : {CurveRebuildOptions{},
                                               {.depth = 1},
                                               {.keep = 3},
                                               {.positions = Positions::limit},
                                               {.moved = moved, .frames = Frames::local}})
        attempt([&] {
            for (const auto& curve : subdivision::rebuild(set, options).curves)
                require(curve.size() * static_cast<std::size_t>(curve.dimension) == curve.coordinates.size(),
                        "a point with too few coordinates");
        });
}

Answer readCurves(std::string_view given) {
    const std::string bytes = mended(given);
    return answerOf("curves.details", [&] {
        const subdivision::CurveSet set = subdivision::readCurveDetails(bytes, "curves.details");
        for (const auto& curve : set.curves) {
            requireFinite(curve.coarse.coordinates);
            for (const auto& details : curve.details) requireFinite(details.coordinates);
        }
        const std::string again = subdivision::curveDetailsBytes(set);
        require(subdivision::curveDetailsBytes(subdivision::readCurveDetails(again, "again")) == again,
                "curves change when they are written and read again");
        rebuildAll(set);
    });
}

// ---- relief-details

Answer readRelief(std::string_view given) {
    const std::string bytes = mended(given);
    return answerOf("relief.details", [&] {
        const auto parts = subdivision::readReliefDetails(bytes, "relief.details");
        requireFinite(parts.levels.coarse.values);
        for (const auto& details : parts.levels.details) requireFinite(details);
        const std::string again = subdivision::reliefDetailsBytes(parts);
        require(subdivision::reliefDetailsBytes(subdivision::readReliefDetails(again, "again")) == again,
                "heights change when they are written and read again");
        const auto relief = subdivision::ReliefDetails::read(bytes, "relief.details");
        const subdivision::Grid coarse = relief.coarseHeights();
        using subdivision::Positions, subdivision::ReliefRebuildOptions;
        constexpr std::size_t kFewSamples = 4096;
        if (coarse.values.size() > kFewSamples) return;
        for (const ReliefRebuildOptions& options : {ReliefRebuildOptions{},
                                                    {.depth = 1},
                                                    {.keep = 3},
                                                    {.positions = Positions::limit},
                                                    {.edited = coarse}})
            attempt([&] {
                const subdivision::Grid heights = relief.rebuild(options).heights;
                require(heights.rows * heights.columns * heights.channels == heights.values.size(),
                        "heights are missing");
            });
    });
}

}  // namespace

std::vector<Target> sectionFileTargets() {
    return {{"curve-pyramid", readPyramid}, {"curve-details", readCurves}, {"relief-details", readRelief}};
}

}  // namespace isowave::fuzz
