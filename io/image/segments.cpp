#include "io/image/segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "io/image/check.h"
#include "io/image/dicom/data_set.h"
#include "io/image/dicom/tags.h"
#include "io/image/formats/nrrd.h"
#include "io/image/kind.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

// CIELab's white is D50, here as in the PCS of ICC profiles, which DICOM (PS3.3, C.10.7.1.1) refers to. Three whole numbers: L from 0
// to 100, a and b from -128 to 127, each over all of 16 bits. The matrix takes XYZ of that white to linear sRGB (Bradford).
std::optional<std::array<std::uint8_t, 3>> srgbOf(const std::vector<double>& lab) {
    if (lab.size() != 3) return {};
    const double L = lab[0] / 65535 * 100, a = lab[1] / 257 - 128, b = lab[2] / 257 - 128;
    const double fy = (L + 16) / 116;
    const auto back = [](double f) { return f > 6.0 / 29 ? f * f * f : (f - 4.0 / 29) * 108 / 841; };
    const double x = 0.96422 * back(fy + a / 500), y = back(fy), z = 0.82521 * back(fy - b / 200);
    const std::array<double, 3> linear{3.1338561 * x - 1.6168667 * y - 0.4906146 * z,
                                       -0.9787684 * x + 1.9161415 * y + 0.0334540 * z,
                                       0.0719453 * x - 0.2289914 * y + 1.4052427 * z};
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double c = std::clamp(linear[i], 0.0, 1.0);
        const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
        colour[i] = static_cast<std::uint8_t>(std::lround(255 * encoded));
    }
    return colour;
}

std::vector<ImageSegment> dicomSegments(const std::filesystem::path& path) {
    std::vector<ImageSegment> segments;
    const DicomFile file = readDicomFile(path);
    for (const DicomSet& segment : file.set.items(tag::kSegments))
        segments.push_back({segment.number(tag::kSegmentNumber, 0), oneLine(segment.text(tag::kSegmentLabel)),
                            srgbOf(segment.numbers(tag::kSegmentColour))});
    return segments;
}

}  // namespace

std::vector<ImageSegment> segmentsOf(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return {};
    try {
        const FileKind kind = kindOf(path);
        if (kind == FileKind::nrrd) return nrrdSegments(path);
        if (kind == FileKind::dicom) return dicomSegments(path);
    } catch (const InputError&) {
        return {};  // who reads the voxels says it
    }
    return {};
}

}  // namespace isowave::imageio
