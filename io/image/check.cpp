#include "io/image/check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "isowave/error.h"

namespace isowave::imageio {

std::string sizeText(const std::array<std::int64_t, 3>& size) {
    return fmt::format("{} x {} x {}", size[0], size[1], size[2]);
}

std::string bytesText(double bytes) {
    static constexpr const char* kUnits[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
    int unit = 0;
    for (; bytes >= 10000 && unit < 6; ++unit) bytes /= 1000;
    return fmt::format("{:.0f} {}", bytes, kUnits[unit]);
}

std::int64_t byteCount(const std::string& file, const std::vector<std::int64_t>& size,
                       std::int64_t bytesEach) {
    constexpr std::int64_t kMost = std::int64_t(1) << 62;
    std::string sizes;
    for (const std::int64_t n : size) sizes += (sizes.empty() ? "" : " x ") + std::to_string(n);
    std::int64_t product = bytesEach;
    for (const std::int64_t n : size) {
        if (n < 1)
            throw InputError(file, fmt::format("its size is {}; expected at least 1 on each axis", sizes));
        if (product > kMost / n)
            throw InputError(
                file,
                fmt::format("its size is {}, more than can be addressed; its header is damaged", sizes));
        product *= n;
    }
    return product;
}

namespace {

double machineMemory() {
    return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

void checkMemory(const std::string& file, const VoxelSource& source, const ImageReadOptions& options,
                 std::size_t keptBytes, std::size_t besideBytes) {
    const Header& header = source.header;
    const auto kept = static_cast<double>(byteCount(file, {header.size[0], header.size[1], header.size[2]},
                                                    static_cast<std::int64_t>(keptBytes)));
    const double beside = static_cast<double>(header.sliceVoxels()) *
                          static_cast<double>(source.slicesPerRead) * static_cast<double>(besideBytes);
    const double limit = options.memoryLimit > 0 ? static_cast<double>(options.memoryLimit) : machineMemory();
    if (kept + beside > limit)
        throw InputError(file,
                         fmt::format("its {} voxels take {} to read, more than the limit of {}; crop or "
                                     "downsample it",
                                     sizeText(header.size), bytesText(kept + beside), bytesText(limit)));
}

namespace {

std::string spacingText(const std::array<double, 3>& s) {
    return fmt::format("{:.6g} x {:.6g} x {:.6g}", s[0], s[1], s[2]);
}

// Lengths whose squares and products are numbers still, whatever the unit.
constexpr double kLeastSpacing = 1e-12, kMostSpacing = 1e12;

bool positive(const std::array<double, 3>& spacing) {
    for (const double s : spacing)
        if (!(s >= kLeastSpacing && s <= kMostSpacing)) return false;
    return true;
}

// > 0.1 % on some axis: more than the rounding of a number typed from a header.
bool differ(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(a[i] - b[i]) <= 1e-3 * std::abs(b[i]))) return true;
    return false;
}

void settleSpacing(const std::string& file, Header& header, const ImageReadOptions& options) {
    if (options.spacing) {
        if (!positive(*options.spacing))
            throw InputError(file, "the given spacing " + spacingText(*options.spacing) +
                                       " must be positive on each axis");
        if (header.hasZSpacing && differ(*options.spacing, header.spacing))
            header.warnings.push_back(fmt::format("the given spacing {} replaces the file's {}",
                                                  spacingText(*options.spacing),
                                                  spacingText(header.spacing)));
        header.spacing = *options.spacing;
    } else if (!positive(header.spacing)) {
        const auto& axis = header.axis;
        const bool hasAxes = dot(cross(axis[0], axis[1]), axis[2]) != 0;
        throw InputError(
            file, fmt::format("its spacing is {}; expected positive numbers, 1e-12 to 1e12; {}",
                              spacingText(header.spacing),
                              hasAxes ? "give the right one as spacing"
                                      : "its axes have no directions either: mend its header (NIfTI: the "
                                        "sform, or sform_code 0)"));
    } else if (!header.hasZSpacing) {
        header.warnings.push_back(fmt::format("no {} spacing in {}; {} {} is assumed; give the spacing",
                                              header.unspaced, header.format, spacingText(header.spacing),
                                              header.unit));
    }
}

}  // namespace

void settleGeometry(const std::string& file, Header& header, const ImageReadOptions& options) {
    settleSpacing(file, header, options);
    // det of the unit axes: the volume of the cell that they span, 1 for orthogonal ones. Below 1e-6 they lie
    // in a plane, or one has no length.
    const auto& axis = header.axis;
    const double volume = dot(cross(axis[0], axis[1]), axis[2]);
    const double lengths = length(axis[0]) * length(axis[1]) * length(axis[2]);
    if (!(std::abs(volume) > 1e-6 * lengths) || !std::isfinite(lengths)) {
        std::string text;
        for (int a = 0; a < 3; ++a)
            text += fmt::format("{}({:.6g}, {:.6g}, {:.6g})", a == 0 ? "" : " ", axis[a][0], axis[a][1],
                                axis[a][2]);
        throw InputError(
            file, fmt::format(
                      "its axes point along {}, a direction matrix that cannot be inverted; "
                      "expected three independent axes; mend its header (NIfTI: the sform, or sform_code 0)",
                      text));
    }
    for (int a = 0; a < 3; ++a)
        if (!std::isfinite(header.origin[a]))
            throw InputError(file, fmt::format("its origin ({}, {}, {}) is not finite", header.origin[0],
                                               header.origin[1], header.origin[2]));
}

void NotFinite::countIn(const float* values, std::int64_t n, std::int64_t from) {
    // The exponent's bits are all set in NaNs and infinities alone; whole pieces without one go by fast.
    constexpr std::uint32_t kExponent = 0x7f800000;
    const auto bad = [](float v) { return (std::bit_cast<std::uint32_t>(v) & kExponent) == kExponent; };
    std::int64_t here = 0;
    for (std::int64_t i = 0; i < n; ++i) here += bad(values[i]);
    if (here == 0) return;
    const std::int64_t at = std::find_if(values, values + n, bad) - values;
    add({here, from + at, values[at]});
}

void NotFinite::add(const NotFinite& other) {
    if (other.count == 0) return;
    if (count == 0 || other.first < first) {
        first = other.first;
        value = other.value;
    }
    count += other.count;
}

void checkFinite(const std::string& file, const std::array<std::int64_t, 3>& size, const NotFinite& found) {
    if (found.count == 0) return;
    const std::int64_t x = found.first % size[0], y = found.first / size[0] % size[1],
                       z = found.first / (size[0] * size[1]);
    throw InputError(
        file, fmt::format("voxel ({}, {}, {}) is {}, the first of {} that are {}; {}replace them by "
                          "a number outside the object",
                          x, y, z, found.value, found.count,
                          std::isnan(found.value) ? "not finite" : "not finite, or beyond float32's 3.4e38",
                          std::isnan(found.value) ? "say with --nan what NaN is taken as, or " : ""));
}

std::string roundedText(std::int64_t inexact, const Image& image) {
    return fmt::format("{} of {} {} voxels are too large for float32 and were rounded", inexact,
                       image.voxelCount(), image.componentType);
}

std::string oneLine(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ' || c == 127) c = ' ';
    text.erase(0, text.find_first_not_of(' '));
    if (text.size() > 200) text = text.substr(0, 200) + "...";
    return text;
}

}  // namespace isowave::imageio
