// NIfTI-1 headers (nifti1.h) before the NIfTI library sees them.
#include "io/image/nifti.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// The 348 bytes of a NIfTI-1 header (nifti1.h), in the file's byte order.
class NiftiBytes {
  public:
    explicit NiftiBytes(const fs::path& path) {
        // gzread() reads plain files as they are.
        gzFile file = gzopen(path.c_str(), "rb");
        const int got = file ? gzread(file, bytes_, sizeof bytes_) : -1;
        if (file) gzclose(file);
        if (got < static_cast<int>(sizeof bytes_))
            throw InputError(path.string(),
                             "is shorter than a NIfTI header; it is truncated or no NIfTI file");
        swap_ = at<std::int32_t>(0) != 348;
        if (at<std::int32_t>(0) == 540 || std::memcmp(bytes_ + 4, "n+2", 4) == 0)
            throw InputError(path.string(), "is NIfTI-2; expected NIfTI-1; convert it");
        if (at<std::int32_t>(0) != 348)
            throw InputError(path.string(), "is not a NIfTI file: its header does not begin with 348");
        if (std::memcmp(bytes_ + 344, "n+1", 4) != 0)
            throw InputError(path.string(),
                             "is not a single-file NIfTI image: expected 'n+1' at byte 344 of its header");
    }
    bool bigEndian() const { return swap_ != (std::endian::native == std::endian::big); }
    template <class T>
    T at(std::size_t offset) const {
        char value[sizeof(T)];
        std::memcpy(value, bytes_ + offset, sizeof(T));
        if (swap_) std::reverse(value, value + sizeof(T));
        T result;
        std::memcpy(&result, value, sizeof(T));
        return result;
    }

  private:
    char bytes_[348] = {};
    bool swap_ = false;
};

std::optional<ValueType> niftiType(int code) {
    static const std::map<int, ValueType> types = {{2, ValueType::uint8},    {4, ValueType::int16},
                                                   {8, ValueType::int32},    {16, ValueType::float32},
                                                   {64, ValueType::float64}, {256, ValueType::int8},
                                                   {512, ValueType::uint16}, {768, ValueType::uint32},
                                                   {1024, ValueType::int64}, {1280, ValueType::uint64}};
    const auto found = types.find(code);
    return found == types.end() ? std::nullopt : std::optional(found->second);
}

bool isGzip(const fs::path& path) {
    unsigned char magic[2] = {};
    std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(magic), 2);
    return magic[0] == 0x1F && magic[1] == 0x8B;
}

// ITK takes a sform whose axes are at right angles only. (A qform, always a rotation, would stand in.)
void checkNiftiAngles(const std::string& file, const std::array<Vec3, 3>& axis) {
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3;
        const double cosine = dot(axis[a], axis[b]) / (length(axis[a]) * length(axis[b]));
        if (std::abs(cosine) > 0.01)
            throw InputError(
                file,
                fmt::format("its sform puts {:.1f} degrees between the {} and the {} axis; expected right "
                            "angles; resample it",
                            std::acos(cosine) * 180 / std::acos(-1.0), "xyz"[a], "xyz"[b]));
    }
}

// The NIfTI library inverts what the header says of orientation, and vnl aborts the program over an inf in
// it.
void checkNiftiOrientation(const std::string& file, const NiftiBytes& header) {
    const auto number = [&](std::size_t offset) { return static_cast<double>(header.at<float>(offset)); };
    for (std::size_t offset = 76; offset < 92;
         offset += 4)  // pixdim[0] .. pixdim[3]; these are checked as spacing
        if (std::isinf(number(offset))) throw InputError(file, "its pixdim holds an infinity");
    for (std::size_t offset = 256; offset < 328; offset += 4)  // quatern_b .. srow_z
        if (!std::isfinite(number(offset)))
            throw InputError(
                file, fmt::format("byte {} of its header, a part of qform or sform, is {}; expected a finite "
                                  "number",
                                  offset, number(offset)));
    // Voxels of a nanometre to a kilometre, in millimetres; beyond, single precision runs out.
    const auto sane = [](double length) { return length > 1e-6 && length < 1e6; };
    for (std::size_t a = 1; a <= 3; ++a)
        if (const double d = number(76 + 4 * a); d > 0 && !sane(d))
            throw InputError(
                file, fmt::format("its spacing {} is beyond what is sensible; expected 1e-6 to 1e6 mm", d));
    for (const std::size_t offset : {268, 272, 276, 292, 308, 324})  // qoffset_x .. z, last of srow_x .. z
        if (std::abs(number(offset)) > 1e9)
            throw InputError(file,
                             fmt::format("its origin {} is beyond what is sensible; expected below 1e9 mm",
                                         number(offset)));
    const double quaternion =
        std::hypot(number(256), number(260), number(264));  // the first part is not stored
    if (header.at<std::int16_t>(252) > 0 && quaternion > 1.01)
        throw InputError(
            file,
            fmt::format("its qform is no rotation: the quaternion has length {:.6g}; expected at most 1",
                        quaternion));
    if (header.at<std::int16_t>(254) <= 0) return;  // sform_code
    std::array<Vec3, 3> axis;
    for (int a = 0; a < 3; ++a)
        for (int row = 0; row < 3; ++row)
            axis[a][row] = number(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(a));
    const double volume = std::abs(dot(cross(axis[0], axis[1]), axis[2]));
    const double lengths = length(axis[0]) * length(axis[1]) * length(axis[2]);
    const bool sizes = std::all_of(axis.begin(), axis.end(), [&](const Vec3& v) { return sane(length(v)); });
    if (!(volume > 1e-6 * lengths) || !sizes)
        throw InputError(
            file,
            fmt::format("its sform takes the axes to ({:.6g}, {:.6g}, {:.6g}) ({:.6g}, {:.6g}, {:.6g}) "
                        "({:.6g}, {:.6g}, {:.6g}), which cannot be inverted; expected three independent "
                        "axes",
                        axis[0][0], axis[0][1], axis[0][2], axis[1][0], axis[1][1], axis[1][2], axis[2][0],
                        axis[2][1], axis[2][2]));
    if (header.at<std::int16_t>(252) <= 0) checkNiftiAngles(file, axis);
}

bool isWhole(float value) { return std::isfinite(value) && value == std::floor(value); }

}  // namespace

HeaderFacts checkNifti(const fs::path& path) {
    const std::string name = path.string();
    const NiftiBytes header(path);
    HeaderFacts facts;
    const int dimension = header.at<std::int16_t>(40);  // dim[0]
    if (dimension < 1 || dimension > 7)
        throw InputError(name, fmt::format("its header says {} dimensions; expected 3", dimension));
    std::vector<double> spacing;
    for (int a = 1; a <= dimension; ++a) {
        facts.size.push_back(header.at<std::int16_t>(40 + 2 * static_cast<std::size_t>(a)));    // dim[a]
        if (a <= 3) spacing.push_back(header.at<float>(76 + 4 * static_cast<std::size_t>(a)));  // pixdim[a]
    }
    facts.badSpacing = badAmong(spacing, false);
    checkNiftiOrientation(name, header);
    const int code = header.at<std::int16_t>(70);  // datatype
    if (code == 128 || code == 2304) throw InputError(name, "holds RGB colours; expected one number a voxel");
    if (code == 32 || code == 1792)
        throw InputError(name, "holds complex numbers; expected one number a voxel");
    facts.storedType = niftiType(code);
    if (!facts.storedType)
        throw InputError(
            name,
            fmt::format("its header says data type {}; expected an integer or floating-point type", code));
    const auto slope = header.at<float>(112), intercept = header.at<float>(116);  // scl_slope, scl_inter
    if (isIntegral(*facts.storedType) && slope != 0) facts.integral = isWhole(slope) && isWhole(intercept);
    if (std::isfinite(slope) && slope != 0) facts.slope = slope;
    if (std::isfinite(intercept)) facts.intercept = intercept;

    const auto offset = header.at<float>(108);  // vox_offset
    if (!(offset >= 0 && offset < 1e9f))
        throw InputError(name, fmt::format("its header says that voxels begin at byte {}", offset));
    const std::int64_t start = std::max<std::int64_t>(352, static_cast<std::int64_t>(offset));
    const std::int64_t needed =
        start + byteCount(name, facts.size, static_cast<std::int64_t>(sizeOf(*facts.storedType)));
    const std::string promise = fmt::format("its header says {}", sizesText(facts.size));
    if (isGzip(path)) {
        checkDeflated(path, 0, needed, promise);
    } else {
        checkPlain(path, 0, needed, promise);
        facts.plain = PlainData{path, start, header.bigEndian()};
    }
    return facts;
}

}  // namespace isowave::imageio
