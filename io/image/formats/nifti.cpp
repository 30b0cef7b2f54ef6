// Offsets and names are those of nifti1.h and nifti2.h (nifti.nimh.nih.gov).
#include "io/image/formats/nifti.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>

#include "base/text.h"
#include "io/image/check.h"
#include "io/image/header.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr std::int32_t kLength1 = 348, kLength2 = 540;

// The first bytes of a file, inflated if need be.
class NiftiBytes {
  public:
    explicit NiftiBytes(const fs::path& path) {
        const std::string start = firstBytes(path, kLength2);
        std::copy(start.begin(), start.end(), bytes_.begin());
        held_ = static_cast<int>(start.size());
        const auto length = at<std::int32_t>(0);
        swap_ = length != kLength1 && length != kLength2;
    }
    int held() const { return held_; }
    std::int32_t length() const { return at<std::int32_t>(0); }
    bool bigEndian() const { return swap_ != (std::endian::native == std::endian::big); }
    std::string text(std::size_t offset, std::size_t count) const { return {bytes_.data() + offset, count}; }
    template <class T>
    T at(std::size_t offset) const {
        std::array<char, sizeof(T)> value;
        std::copy_n(bytes_.data() + offset, sizeof(T), value.data());
        if (swap_) std::reverse(value.begin(), value.end());
        return std::bit_cast<T>(value);
    }

  private:
    std::array<char, kLength2> bytes_{};
    int held_ = 0;
    bool swap_ = false;
};

// The fields that count, of either version.
struct NiftiFields {
    bool bigEndian = false, pair = false;
    bool analyze = false;            // Analyze 7.5, which knows neither forms nor units
    std::int64_t firstVoxel = 0;     // vox_offset, at least behind the header
    std::vector<std::int64_t> size;  // dim[1] .. dim[dim[0]]
    int type = 0;                    // datatype
    int unit = 0;                    // xyzt_units & 7
    int intent = 0;
    double slope = 0, intercept = 0;
    int qformCode = 0, sformCode = 0;
    std::array<double, 4> pixdim{};
    std::array<double, 6> quaternion{};  // quatern_b, c, d, qoffset_x, y, z
    std::array<std::array<double, 4>, 3> srow{};
};

// Whole numbers of one type and real ones of another lie at other places in the two versions.
template <class Size, class Real, class Code>
struct NiftiPlaces {
    std::size_t dim, datatype, pixdim, offset, slope, qformCode, sformCode, quaternion, srow, unit, intent;

    NiftiFields read(const NiftiBytes& bytes) const {
        NiftiFields f;
        const auto real = [&](std::size_t place, std::size_t i) {
            return static_cast<double>(bytes.at<Real>(place + i * sizeof(Real)));
        };
        f.bigEndian = bytes.bigEndian();
        const auto dimensions = static_cast<std::int64_t>(bytes.at<Size>(dim));
        for (std::int64_t a = 1; a <= std::clamp<std::int64_t>(dimensions, 0, 7); ++a)
            f.size.push_back(
                static_cast<std::int64_t>(bytes.at<Size>(dim + static_cast<std::size_t>(a) * sizeof(Size))));
        f.type = bytes.at<std::int16_t>(datatype);
        f.slope = real(slope, 0);
        f.intercept = real(slope, 1);
        f.qformCode = bytes.at<Code>(qformCode);
        f.sformCode = bytes.at<Code>(sformCode);
        for (std::size_t i = 0; i < 4; ++i) f.pixdim[i] = real(pixdim, i);
        for (std::size_t i = 0; i < 6; ++i) f.quaternion[i] = real(quaternion, i);
        for (std::size_t i = 0; i < 12; ++i) f.srow[i / 4][i % 4] = real(srow, i);
        return f;
    }
};

constexpr NiftiPlaces<std::int16_t, float, std::int16_t> kNifti1{.dim = 40,
                                                                 .datatype = 70,
                                                                 .pixdim = 76,
                                                                 .offset = 108,
                                                                 .slope = 112,
                                                                 .qformCode = 252,
                                                                 .sformCode = 254,
                                                                 .quaternion = 256,
                                                                 .srow = 280,
                                                                 .unit = 123,
                                                                 .intent = 68};
constexpr NiftiPlaces<std::int64_t, double, std::int32_t> kNifti2{.dim = 16,
                                                                  .datatype = 12,
                                                                  .pixdim = 104,
                                                                  .offset = 168,
                                                                  .slope = 176,
                                                                  .qformCode = 344,
                                                                  .sformCode = 348,
                                                                  .quaternion = 352,
                                                                  .srow = 400,
                                                                  .unit = 500,
                                                                  .intent = 504};

enum class Version { first, second, analyze };

// Named .hdr or .img, compressed or not.
bool isNamedAsPair(const fs::path& path) {
    const fs::path plain = toLower(path.extension().string()) == ".gz" ? path.stem() : path.filename();
    const std::string extension = toLower(plain.extension().string());
    return extension == ".hdr" || extension == ".img";
}

// pair: voxels are in an .img.
Version checkMagic(const std::string& name, const NiftiBytes& bytes, bool& pair) {
    const std::int32_t length = bytes.length();
    if (bytes.held() < (length == kLength2 ? kLength2 : kLength1))
        throw InputError(name, "is shorter than a NIfTI header; it is truncated or no NIfTI file");
    if (length != kLength1 && length != kLength2)
        throw InputError(name, "is not a NIfTI file: its header begins with neither 348 nor 540");
    const bool second = length == kLength2;
    const std::string magic = second ? bytes.text(4, 4) : bytes.text(344, 4);
    const std::string single(second ? "n+2\0" : "n+1\0", 4), two(second ? "ni2\0" : "ni1\0", 4);
    pair = magic == two;
    if (magic == single || pair) return second ? Version::second : Version::first;
    pair = !second && isNamedAsPair(name);
    if (pair) return Version::analyze;
    throw InputError(name, fmt::format("is not a NIfTI image: expected '{}' or '{}' at byte {} of its header",
                                       single.c_str(), two.c_str(), second ? 4 : 344));
}

NiftiFields fieldsOf(const fs::path& path) {
    const std::string name = path.string();
    const NiftiBytes bytes(path);
    bool pair = false;
    const Version version = checkMagic(name, bytes, pair);
    const bool second = version == Version::second;
    NiftiFields f = second ? kNifti2.read(bytes) : kNifti1.read(bytes);
    f.pair = pair;
    f.analyze = version == Version::analyze;
    const auto dimensions =
        second ? bytes.at<std::int64_t>(kNifti2.dim) : bytes.at<std::int16_t>(kNifti1.dim);
    if (dimensions < 1 || dimensions > 7)
        throw InputError(name, fmt::format("its header says {} dimensions; expected 3", dimensions));
    f.unit = (second ? bytes.at<std::int32_t>(kNifti2.unit) : bytes.at<std::uint8_t>(kNifti1.unit)) & 7;
    f.intent = second ? bytes.at<std::int32_t>(kNifti2.intent) : bytes.at<std::int16_t>(kNifti1.intent);
    if (f.analyze) f.unit = f.intent = f.qformCode = f.sformCode = 0, f.intercept = 0;
    const double offset = second ? static_cast<double>(bytes.at<std::int64_t>(kNifti2.offset))
                                 : static_cast<double>(bytes.at<float>(kNifti1.offset));
    if (!(offset >= 0 && offset < 1e9))
        throw InputError(
            name,
            fmt::format("its header says that voxels begin at byte {:g}; expected 0 to 1e9, usually {}; mend "
                        "its vox_offset",
                        offset, pair ? 0 : (second ? kLength2 : kLength1) + 4));
    // Four bytes behind the header say whether extensions follow.
    const std::int64_t least = pair ? 0 : (second ? kLength2 : kLength1) + 4;
    f.firstVoxel = std::max(least, static_cast<std::int64_t>(offset));
    return f;
}

ValueType typeOf(const std::string& name, int code) {
    static const std::map<int, ValueType> types = {{2, ValueType::uint8},    {4, ValueType::int16},
                                                   {8, ValueType::int32},    {16, ValueType::float32},
                                                   {64, ValueType::float64}, {256, ValueType::int8},
                                                   {512, ValueType::uint16}, {768, ValueType::uint32},
                                                   {1024, ValueType::int64}, {1280, ValueType::uint64}};
    static const std::map<int, const char*> others = {
        {1, "single bits"},        {32, "complex numbers"},   {128, "RGB colours"}, {1536, "128-bit numbers"},
        {1792, "complex numbers"}, {2048, "complex numbers"}, {2304, "RGB colours"}};
    if (const auto found = types.find(code); found != types.end()) return found->second;
    if (const auto found = others.find(code); found != others.end())
        throw InputError(
            name, fmt::format("holds {}; expected one number a voxel; save one component, or grey values",
                              found->second));
    throw InputError(
        name, fmt::format("its header says data type {}; expected an integer or floating-point type", code));
}

// ---- where voxels lie; RAS, in the file's unit

struct Affine {
    std::array<Vec3, 3> step;  // of one voxel along each axis
    Vec3 origin;
};

Affine sformOf(const NiftiFields& f) {
    Affine result;
    for (int row = 0; row < 3; ++row) {
        const auto& r = f.srow[static_cast<std::size_t>(row)];
        for (std::size_t a = 0; a < 3; ++a) result.step[a][row] = r[a];
        result.origin[row] = r[3];
    }
    return result;
}

// The rotation of the quaternion (a, b, c, d), whose a >= 0 is not stored since its length is 1; pixdim[0] < 0 turns the
// third axis round.
Affine qformOf(const std::string& name, const NiftiFields& f) {
    double b = f.quaternion[0], c = f.quaternion[1], d = f.quaternion[2];
    const double square = b * b + c * c + d * d;
    if (square > 1.01 * 1.01)
        throw InputError(
            name,
            fmt::format("its qform is no rotation: the quaternion has length {:.6g}; expected at most 1",
                        std::sqrt(square)));
    const double scale = square > 1 ? 1 / std::sqrt(square) : 1;
    b *= scale, c *= scale, d *= scale;
    const double a = std::sqrt(std::max(0.0, 1 - (b * b + c * c + d * d)));
    const double third = f.pixdim[0] < 0 ? -f.pixdim[3] : f.pixdim[3];
    Affine result;
    result.step = {
        Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)} * f.pixdim[1],
        Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)} * f.pixdim[2],
        Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c} * third};
    result.origin = {f.quaternion[3], f.quaternion[4], f.quaternion[5]};
    return result;
}

void requireFinite(const std::string& name, const char* what, const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        if (!std::isfinite(values[i]))
            throw InputError(name, fmt::format("its {} holds {}; expected a finite number", what, values[i]));
}

// The largest distance between the places that two maps give a corner of the image.
double farthestCorner(const Affine& s, const Affine& t, const Header& header) {
    double most = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 d = s.origin - t.origin;
        for (std::size_t a = 0; a < 3; ++a)
            if (corner >> a & 1) d += (s.step[a] - t.step[a]) * static_cast<double>(header.size[a] - 1);
        most = std::max(most, length(d));
    }
    return most;
}

// Two places for one image are worth a line when they differ by half a voxel.
void remarkOther(const Affine& sform, const NiftiFields& f, const std::string& name, double unit,
                 Header& header) {
    if (f.qformCode <= 0 || badAmong({f.pixdim.begin() + 1, f.pixdim.end()}, false)) return;
    for (const double v : f.quaternion)
        if (!std::isfinite(v)) return;
    if (std::hypot(f.quaternion[0], f.quaternion[1], f.quaternion[2]) > 1.01) return;
    const double most = farthestCorner(sform, qformOf(name, f), header);
    if (most > 0.5 * std::min({length(sform.step[0]), length(sform.step[1]), length(sform.step[2])}))
        header.warnings.push_back(
            fmt::format("its qform puts voxels up to {:.3g} mm from where its sform puts "
                        "them; the sform is used",
                        most * unit));
}

// Analyze 7.5: left, front, up ("transverse unflipped"), as nibabel takes it, too.
Affine analyzeAxes(const NiftiFields& f, Header& header) {
    header.warnings.push_back(
        "an Analyze 7.5 image says nothing certain of its orientation; its axes are taken to run to the "
        "left, to "
        "the front and up, and may be mirrored");
    return {{Vec3{-f.pixdim[1], 0, 0}, Vec3{0, f.pixdim[2], 0}, Vec3{0, 0, f.pixdim[3]}}, Vec3{}};
}

Affine affineOf(const std::string& name, const NiftiFields& f, double unit, Header& header) {
    if (f.sformCode > 0) {
        requireFinite(name, "sform", f.srow[0].data(), 4);
        requireFinite(name, "sform", f.srow[1].data(), 4);
        requireFinite(name, "sform", f.srow[2].data(), 4);
        const Affine sform = sformOf(f);
        remarkOther(sform, f, name, unit, header);
        return sform;
    }
    if (f.qformCode > 0) {
        requireFinite(name, "qform", f.quaternion.data(), f.quaternion.size());
        return qformOf(name, f);
    }
    header.space = Space::unspecified;
    if (f.analyze) return analyzeAxes(f, header);
    header.warnings.push_back(
        "says nothing of its orientation (sform_code and qform_code are 0); its axes are taken to run to the "
        "right, to the front and up, and may be mirrored");
    return {{Vec3{f.pixdim[1], 0, 0}, Vec3{0, f.pixdim[2], 0}, Vec3{0, 0, f.pixdim[3]}}, Vec3{}};
}

// RAS -> LPS; mm.
Vec3 worldOf(const Vec3& v, double unit) { return Vec3{-v.x, -v.y, v.z} * unit; }

// A pixdim that is 0, negative or no number leaves the axes their directions: a spacing that the user gives heals it.
void placeNifti(const std::string& name, NiftiFields f, Header& header) {
    const auto bad = badAmong({f.pixdim.begin() + 1, f.pixdim.end()}, false);
    if (bad && f.sformCode <= 0) std::fill(f.pixdim.begin() + 1, f.pixdim.end(), 1.0);
    static const std::map<int, std::pair<const char*, double>> units = {{1, {"m", 1e3}}, {3, {"um", 1e-3}}};
    const auto unit = units.find(f.unit);
    const double millimetres = unit == units.end() ? 1 : unit->second.second;
    if (unit != units.end()) remarkUnit(header, unit->second.first, millimetres);
    const Affine affine = affineOf(name, f, millimetres, header);
    place(header,
          {worldOf(affine.step[0], millimetres), worldOf(affine.step[1], millimetres),
           worldOf(affine.step[2], millimetres)},
          worldOf(affine.origin, millimetres));
    if (bad && f.sformCode <= 0) header.spacing = *bad;
}

// ---- values

bool isWhole(double value) { return value == std::floor(value); }

void takeScaling(const std::string& name, const NiftiFields& f, Header& header) {
    if (f.slope == 0 || !std::isfinite(f.slope)) return;
    if (!std::isfinite(f.intercept))
        throw InputError(name, fmt::format("its scl_slope is {:g} but its scl_inter is {}; expected a number",
                                           f.slope, f.intercept));
    header.slope = f.slope;
    header.intercept = f.intercept;
    if (isIntegral(header.type)) header.integral = isWhole(f.slope) && isWhole(f.intercept);
}

// "a.nii.gz" -> ".gz" kept: the other file of the pair is compressed alike.
fs::path withExtension(const fs::path& path, const std::string& extension) {
    const bool gzip = toLower(path.extension().string()) == ".gz";
    fs::path stem = gzip ? path.parent_path() / path.stem() : path;
    const bool capitals = stem.extension().string().find_first_of("HI") != std::string::npos;
    std::string other = extension;
    if (capitals)
        std::transform(other.begin(), other.end(), other.begin(),
                       [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    stem.replace_extension(other);
    return gzip ? fs::path(stem.string() + path.extension().string()) : stem;
}

// The file of the voxels: of a pair it is the .img, plain or not.
fs::path voxelFileOf(const fs::path& path, bool pair) {
    if (!pair) return path;
    const fs::path image = withExtension(path, ".img");
    std::error_code error;
    for (const fs::path& other : {fs::path(image.string() + ".gz"), image.parent_path() / image.stem()})
        if (!fs::exists(image, error) && fs::exists(other, error) && other != path) return other;
    return image;
}

std::int64_t volumesBehind(const std::string& name, const std::vector<std::int64_t>& size) {
    return byteCount(name, std::vector<std::int64_t>(size.begin() + 3, size.end()), 1);
}

}  // namespace

bool beginsAsNifti(const fs::path& path) {
    const NiftiBytes bytes(path);
    const bool isDicom = bytes.text(128, 4) == "DICM";  // the 128 bytes before may be anything, 348 too
    return bytes.held() >= kLength1 && (bytes.length() == kLength1 || bytes.length() == kLength2) && !isDicom;
}

fs::path niftiHeaderOf(const fs::path& path) {
    const fs::path plain = toLower(path.extension().string()) == ".gz" ? path.stem() : path.filename();
    if (toLower(plain.extension().string()) != ".img") return path;
    const fs::path header = withExtension(path, ".hdr");
    std::error_code error;
    return fs::is_regular_file(header, error) && beginsAsNifti(header) ? header : path;
}

std::vector<std::string> niftiVoxelFiles(const fs::path& path) {
    const fs::path header = niftiHeaderOf(path);
    const fs::path voxels = voxelFileOf(header, fieldsOf(header).pair);
    std::vector<std::string> files;
    for (const fs::path& file : {header, voxels})
        if (file != path) files.push_back(file.filename().string());
    return files;
}

StoredVolume readNiftiHeader(const fs::path& given) {
    const fs::path path = niftiHeaderOf(given);
    const std::string name = path.string();
    const NiftiFields f = fieldsOf(path);
    if (f.intent >= 3000 && f.intent < 3100)
        throw InputError(name, "is a CIFTI file: values on surfaces, not a volume; expected a volume");
    StoredVolume volume;
    Header& header = volume.header;
    header.format = f.analyze ? "Analyze 7.5" : "NIfTI";
    header.type = typeOf(name, f.type);
    byteCount(name, f.size, static_cast<std::int64_t>(sizeOf(header.type)));
    if (f.size.size() < 3) throwFlat(path, f.size[0], f.size.size() > 1 ? f.size[1] : 1, "");
    header.size = {f.size[0], f.size[1], f.size[2]};
    placeNifti(name, f, header);
    takeScaling(name, f, header);

    VoxelLayout& voxels = volume.voxels;
    voxels.bigEndian = f.bigEndian;
    voxels.outer = volumesBehind(name, f.size);
    const fs::path file = voxelFileOf(path, f.pair);
    if (file != path) requireFile(path, file);
    putBehindHeader(voxels, file, f.firstVoxel);
    volume.promise = fmt::format("its header says {}", sizesText(f.size));
    return volume;
}

}  // namespace isowave::imageio
