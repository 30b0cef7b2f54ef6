#include "io/image/formats/mrc.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "base/text.h"
#include "io/image/check.h"
#include "io/image/formats/stored_volume.h"
#include "io/image/half.h"
#include "io/image/header.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHeaderBytes = 1024;

// Words of four bytes, numbered from 1 as the format's description has them.
class MrcWords {
  public:
    MrcWords(const std::string& bytes, bool bigEndian) : bytes_(bytes), bigEndian_(bigEndian) {}
    bool bigEndian() const { return bigEndian_; }
    std::int32_t whole(std::size_t word) const { return at<std::int32_t>(word); }
    double real(std::size_t word) const { return at<float>(word); }
    Vec3 reals(std::size_t word) const { return {real(word), real(word + 1), real(word + 2)}; }
    std::array<std::int64_t, 3> wholes(std::size_t word) const {
        return {whole(word), whole(word + 1), whole(word + 2)};
    }

  private:
    template <class T>
    T at(std::size_t word) const {
        std::array<char, 4> value;
        std::copy_n(bytes_.data() + 4 * (word - 1), 4, value.data());
        if (bigEndian_ != (std::endian::native == std::endian::big)) std::reverse(value.begin(), value.end());
        return std::bit_cast<T>(value);
    }

    const std::string& bytes_;
    bool bigEndian_;
};

// Columns, rows and sections run along the cell's edges 1, 2, 3 in some order; 0, 0, 0 of old programs: in this one.
std::optional<std::array<std::size_t, 3>> axesOf(const MrcWords& words) {
    std::array<std::int64_t, 3> axes = words.wholes(17);
    if (axes == std::array<std::int64_t, 3>{}) axes = {1, 2, 3};
    std::array<std::int64_t, 3> sorted = axes;
    std::sort(sorted.begin(), sorted.end());
    if (sorted != std::array<std::int64_t, 3>{1, 2, 3}) return std::nullopt;
    return std::array{static_cast<std::size_t>(axes[0] - 1), static_cast<std::size_t>(axes[1] - 1),
                      static_cast<std::size_t>(axes[2] - 1)};
}

bool isSensible(const MrcWords& words) {
    const auto size = words.wholes(1);
    const std::int32_t mode = words.whole(4);
    return axesOf(words) && mode >= 0 && mode <= 101 && *std::min_element(size.begin(), size.end()) > 0;
}

// The machine stamp at byte 212: 0x44 of little-endian machines, 0x11 of big-endian ones; what makes sense where it is neither.
MrcWords wordsOf(const fs::path& path, const std::string& bytes) {
    const MrcWords little(bytes, false), big(bytes, true);
    if (bytes.size() >= kHeaderBytes) {
        const bool saysBig = bytes[212] == 0x11, saysLittle = bytes[212] == 0x44;
        for (const MrcWords& words : {saysBig ? big : little, saysBig || saysLittle ? little : big})
            if (isSensible(words)) return words;
    }
    std::string remedy;
    if (toLower(path.extension().string()) == ".rec")
        remedy = "; if it is one of a pair PAR/REC, convert it: dcm2niix";
    throw InputError(path.string(), "is not an MRC map: its first 1024 bytes are no header of one" + remedy);
}

// What IMOD writes at word 39: "IMOD"; then flags, of which the first says that mode 0 is signed.
constexpr std::int32_t kImodStamp = 1146047817;

ValueType typeOf(const std::string& name, const MrcWords& words) {
    const std::int32_t mode = words.whole(4);
    if (mode == 0 && words.whole(39) == kImodStamp && (words.whole(40) & 1) == 0) return ValueType::uint8;
    static const std::map<std::int32_t, ValueType> types = {{0, ValueType::int8},
                                                            {1, ValueType::int16},
                                                            {2, ValueType::float32},
                                                            {6, ValueType::uint16},
                                                            {12, ValueType::uint16}};
    static const std::map<std::int32_t, const char*> others = {{3, ", complex numbers"},
                                                               {4, ", complex numbers"},
                                                               {16, ", RGB colours"},
                                                               {101, ", numbers of 4 bits"}};
    if (const auto found = types.find(mode); found != types.end()) return found->second;
    const auto other = others.find(mode);
    throw InputError(name,
                     fmt::format("is of mode {}{}; modes 0, 1, 2, 6 and 12 are read: newstack -mode 2 in.mrc "
                                 "out.mrc",
                                 mode, other == others.end() ? "" : other->second));
}

// The edges of the cell, of length 1, as crystallography puts them: a along x, b in the plane of x and y.
std::array<Vec3, 3> edgesOf(const std::string& name, const MrcWords& words) {
    Vec3 angle = words.reals(14);
    if (angle == Vec3{} || angle == Vec3{90, 90, 90}) return {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    angle *= std::numbers::pi / 180;
    const Vec3 cosine{std::cos(angle.x), std::cos(angle.y), std::cos(angle.z)};
    const double sine = std::sin(angle.z), y = (cosine.x - cosine.y * cosine.z) / sine;
    const double square = 1 - cosine.y * cosine.y - y * y;
    if (!(square > 1e-9) || !(sine > 1e-9))
        throw InputError(
            name, fmt::format("its cell's angles are {}, {} and {}; expected those of a cell with a volume",
                              words.real(14), words.real(15), words.real(16)));
    return {Vec3{1, 0, 0}, Vec3{cosine.z, sine, 0}, Vec3{cosine.y, y, std::sqrt(square)}};
}

// Angstrom along the cell's edges; nothing where the header does not say.
std::optional<Vec3> voxelOf(const MrcWords& words) {
    const auto samples = words.wholes(8);
    Vec3 voxel = words.reals(11);
    for (int a = 0; a < 3; ++a) {
        voxel[a] /= static_cast<double>(samples[static_cast<std::size_t>(a)]);
        if (!(voxel[a] > 0) || !std::isfinite(voxel[a])) return std::nullopt;
    }
    return voxel;
}

void placeMrc(const std::string& name, const MrcWords& words, Header& header) {
    const std::array<std::size_t, 3> along = *axesOf(words);
    const std::array<Vec3, 3> edge = edgesOf(name, words);
    const Vec3 voxel = voxelOf(words).value_or(Vec3{1, 1, 1});
    header.hasZSpacing = voxelOf(words).has_value();
    Vec3 origin = words.reals(50);
    const bool placed = std::isfinite(dot(origin, origin)) && origin != Vec3{};
    if (!placed) origin = {};
    std::array<Vec3, 3> step;
    for (std::size_t a = 0; a < 3; ++a) {
        step[a] = edge[along[a]] * voxel[static_cast<int>(along[a])];
        if (!placed) origin += step[a] * static_cast<double>(words.whole(5 + a));
    }
    place(header, step, origin);
    header.space = Space::unspecified;
    header.unit = "angstrom";
    header.warnings.push_back(
        "an MRC map's lengths are in angstrom, and so are all coordinates; its axes have no sides of a body");
}

// From 401 on sections are those of several volumes, mz each.
std::int64_t volumesOf(const MrcWords& words) {
    const std::int64_t sections = words.whole(3), each = words.whole(10), group = words.whole(23);
    return group >= 401 && group <= 630 && each > 0 && sections % each == 0 ? sections / each : 1;
}

}  // namespace

bool beginsAsMrc(const std::string& start) {
    if (start.size() < kHeaderBytes || start.compare(208, 3, "MAP") != 0) return false;
    return isSensible({start, false}) || isSensible({start, true});
}

SourcePtr openMrc(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string(), bytes = firstBytes(path, kHeaderBytes);
    const MrcWords words = wordsOf(path, bytes);
    StoredVolume volume;
    Header& header = volume.header;
    header.format = "MRC";
    header.type = typeOf(name, words);
    header.size = words.wholes(1);
    volume.voxels.outer = volumesOf(words);
    header.size[2] /= volume.voxels.outer;
    placeMrc(name, words, header);
    const std::int64_t extended = words.whole(24);
    if (extended < 0)
        throw InputError(name, fmt::format("its extended header has {} bytes; expected 0 or more", extended));
    volume.voxels.bigEndian = words.bigEndian();
    putBehindHeader(volume.voxels, path, static_cast<std::int64_t>(kHeaderBytes) + extended);
    volume.promise = "its header says " + sizeText(words.wholes(1));
    const bool half = words.whole(4) == 12;
    SourcePtr source = openStored(path, std::move(volume), options);
    return half ? halvesAsFloats(std::move(source)) : std::move(source);
}

}  // namespace isowave::imageio
