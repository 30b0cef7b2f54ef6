#include "io/image/formats/metaimage.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "base/text.h"
#include "io/image/check.h"
#include "io/image/header.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

std::optional<ValueType> metaType(const std::string& name) {
    static const std::map<std::string, ValueType> types = {
        {"MET_CHAR", ValueType::int8},         {"MET_UCHAR", ValueType::uint8},
        {"MET_SHORT", ValueType::int16},       {"MET_USHORT", ValueType::uint16},
        {"MET_INT", ValueType::int32},         {"MET_UINT", ValueType::uint32},
        {"MET_LONG", ValueType::int32},        {"MET_ULONG", ValueType::uint32},
        {"MET_LONG_LONG", ValueType::int64},   {"MET_FLOAT", ValueType::float32},
        {"MET_ULONG_LONG", ValueType::uint64}, {"MET_DOUBLE", ValueType::float64}};
    const auto found = types.find(name);
    return found == types.end() ? std::nullopt : std::optional(found->second);
}

struct MetaText {
    std::map<std::string, std::string> field;
    std::int64_t end = 0;  // first byte after the header

    std::string get(const std::string& key) const {
        const auto found = field.find(key);
        return found == field.end() ? std::string() : found->second;
    }
    bool yes(const std::string& key) const { return toLower(get(key)).starts_with('t') || get(key) == "1"; }
};

bool countedByNDims(const std::string& key) {
    static const std::set<std::string> keys = {
        "DimSize", "ElementSpacing", "ElementSize", "Offset",          "Position",
        "Origin",  "Rotation",       "Orientation", "TransformMatrix", "CenterOfRotation"};
    return keys.contains(key);
}

// Lines "name = value" (or "name: value"); ElementDataFile is the last, and NDims comes before what it
// counts.
MetaText metaText(const fs::path& path) {
    MetaText result;
    const std::string text = headerFileText(path);
    int number = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t next = text.find('\n', at);
        const std::string line = text.substr(at, next == std::string::npos ? next : next - at);
        at = next == std::string::npos ? text.size() : next + 1;
        ++number;
        const std::size_t equals = line.find_first_of("=:");
        if (equals == std::string::npos && trimmed(line).empty()) continue;
        if (equals == std::string::npos || trimmed(line.substr(0, equals)).empty() ||
            line.find('\0') != std::string::npos)
            throw InputError(path.string(),
                             fmt::format("line {} of its header is '{}'; expected 'name = value'", number,
                                         oneLine(line).substr(0, 60)));
        const std::string key = trimmed(line.substr(0, equals));
        if (countedByNDims(key) && !result.field.contains("NDims"))
            throw InputError(path.string(), fmt::format("its header has no 'NDims' before '{}'", key));
        const std::string value = trimmed(line.substr(equals + 1));
        if (const auto [earlier, first] = result.field.emplace(key, value);
            !first && earlier->second != value)
            throw InputError(path.string(), fmt::format("'{}' says '{}' and then '{}'; expected it once", key,
                                                        oneLine(earlier->second), oneLine(value)));
        if (key != "ElementDataFile") continue;
        result.end = static_cast<std::int64_t>(at);
        return result;
    }
    throw InputError(path.string(),
                     "its header has no 'ElementDataFile'; it is truncated or not a MetaImage");
}

// The numbers of a field, or nothing when a word of it is none. Neither 0x10 nor 1e is one.
std::vector<double> plainNumbers(const std::string& text) {
    std::vector<double> result;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        double value = 0;
        const char *begin = word.data() + (word[0] == '+'), *end = word.data() + word.size();
        if (const auto parsed = std::from_chars(begin, end, value);
            parsed.ptr != end || parsed.ec != std::errc())
            return {};
        result.push_back(value);
    }
    return result;
}

// Fields of n or n x n numbers.
void checkMetaNumbers(const std::string& file, const MetaText& text, std::size_t n) {
    for (const auto& [key, value] : text.field) {
        const bool matrix = key == "TransformMatrix" || key == "Rotation" || key == "Orientation";
        const bool vector = key == "Offset" || key == "Position" || key == "Origin" ||
                            key == "CenterOfRotation" || key == "ElementSpacing" || key == "ElementSize";
        if (!matrix && !vector) continue;
        const std::vector<double> found = plainNumbers(value);
        const bool finite =
            std::all_of(found.begin(), found.end(), [](double v) { return std::isfinite(v); });
        if (found.size() != (matrix ? n * n : n) || !finite)
            throw InputError(file, fmt::format("'{}' says '{}'; expected {} finite numbers", key,
                                               oneLine(value), matrix ? n * n : n));
    }
}

// ---- where voxels lie

// The first of these fields that is there; they are synonyms.
std::vector<double> firstOf(const MetaText& text, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
        if (text.field.contains(key)) return plainNumbers(text.get(key));
    return {};
}

double unitOf(const MetaText& text, Header& header) {
    const std::string unit = text.get("DistanceUnits");
    if (unit.empty() || unit == "?" || toLower(unit) == "none") return 1;
    const auto millimetres = millimetresIn(unit);
    if (!millimetres)
        header.warnings.push_back(
            fmt::format("'DistanceUnits' says '{}', which is no length; mm is assumed", oneLine(unit)));
    remarkUnit(header, unit, millimetres.value_or(1));
    return millimetres.value_or(1);
}

// Of n axes; the first three count.
void placeMeta(const MetaText& text, std::size_t n, Header& header) {
    const double unit = unitOf(text, header);
    std::vector<double> matrix = firstOf(text, {"TransformMatrix", "Rotation", "Orientation"}),
                        offset = firstOf(text, {"Offset", "Position", "Origin"}),
                        spacing = firstOf(text, {"ElementSpacing", "ElementSize"});
    std::array<Vec3, 3> step{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    Vec3 origin;
    header.spacing = {unit, unit, unit};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t row = 0; row < 3 && !matrix.empty(); ++row)
            step[a][static_cast<int>(row)] = matrix[a * n + row];
    for (std::size_t a = 0; a < 3 && !offset.empty(); ++a) origin[static_cast<int>(a)] = unit * offset[a];
    for (std::size_t a = 0; a < 3 && !spacing.empty(); ++a) header.spacing[a] = unit * spacing[a];
    header.hasZSpacing = !spacing.empty();
    header.axis = step;
    header.origin = origin;
}

// What the format calls intensity is slope * value + offset.
void remarkIntensity(const MetaText& text, Header& header) {
    const auto differs = [&](const char* key, double usual) {
        const std::vector<double> found = plainNumbers(text.get(key));
        return found.size() == 1 && found[0] != usual;
    };
    if (differs("ElementToIntensityFunctionSlope", 1) || differs("ElementToIntensityFunctionOffset", 0))
        header.warnings.push_back(
            "'ElementToIntensityFunctionSlope' and 'Offset' are not applied; values are as stored");
}

// ---- voxels

bool isLocal(const MetaText& text) { return toLower(text.get("ElementDataFile")) == "local"; }

std::vector<std::string> listedNames(const fs::path& path, const MetaText& text) {
    std::vector<std::string> names;
    std::istringstream lines(headerFileText(path).substr(static_cast<std::size_t>(text.end)));
    for (std::string line; std::getline(lines, line);)
        if (const std::string name = trimmed(line); !name.empty()) names.push_back(name);
    return names;
}

std::vector<std::string> voxelFiles(const fs::path& path, const MetaText& text) {
    const std::string data = text.get("ElementDataFile");
    if (isLocal(text)) return {};
    if (data.starts_with("LIST")) return listedNames(path, text);
    if (data.find('%') == std::string::npos) return {data};
    const auto size = wholeNumbers(path.string(), "DimSize", text.get("DimSize"));
    return numberedNames(path.string(), data, size.empty() ? std::nullopt : std::optional(size.back()));
}

// HeaderSize -1: the voxels are what the file ends with.
VoxelPiece pieceOf(const fs::path& file, const std::string& name, const MetaText& text, std::int64_t start,
                   std::int64_t each) {
    const auto headerSize = wholeNumbers(name, "HeaderSize", text.get("HeaderSize"));
    const std::int64_t skip = headerSize.empty() ? 0 : headerSize[0];
    if (skip >= 0) return {file, start + skip, 0};
    const auto held = static_cast<std::int64_t>(fs::file_size(file));
    return {file, std::max<std::int64_t>(0, held - each), 0};
}

void checkCompressedSize(const fs::path& path, const MetaText& text, const VoxelPiece& piece) {
    const auto stated = wholeNumbers(path.string(), "CompressedDataSize", text.get("CompressedDataSize"));
    if (!stated.empty())
        checkPlain(piece.file, piece.start, stated[0],
                   fmt::format("'CompressedDataSize' says {}", stated[0]));
}

Encoding encodingOf(const MetaText& text) {
    if (text.yes("CompressedData")) return Encoding::deflated;
    return !text.field.contains("BinaryData") || text.yes("BinaryData") ? Encoding::raw : Encoding::text;
}

void takeVoxels(const fs::path& path, const MetaText& text, std::int64_t needed, VoxelLayout& voxels) {
    const std::string name = path.string();
    voxels.encoding = encodingOf(text);
    voxels.bigEndian = text.yes("BinaryDataByteOrderMSB") || text.yes("ElementByteOrderMSB");
    const std::vector<std::string> files = voxelFiles(path, text);
    if (isLocal(text) && isGzip(path)) {
        putBehindHeader(voxels, path, text.end, !text.field.contains("HeaderSize"));
        return;
    }
    if (isLocal(text)) {
        voxels.pieces = {pieceOf(path, name, text, text.end, needed)};
    } else if (files.empty() || files[0].empty()) {
        throw InputError(name, "'ElementDataFile' names no file; it is truncated");
    }
    const auto count = std::max<std::int64_t>(1, static_cast<std::int64_t>(files.size()));
    if (needed % count != 0)
        throw InputError(name, fmt::format("'ElementDataFile' names {} files, among which {} bytes of voxels "
                                           "cannot be shared out; expected one a slice",
                                           count, needed));
    for (const std::string& file : files) {
        const fs::path data = path.parent_path() / file;
        requireFile(path, data);
        voxels.pieces.push_back(pieceOf(data, name, text, 0, needed / count));
    }
    if (voxels.encoding == Encoding::deflated && voxels.pieces.size() == 1)
        checkCompressedSize(path, text, voxels.pieces[0]);
}

// DimSize, as many numbers as NDims says, at least three.
std::vector<std::int64_t> sizeOfMeta(const fs::path& path, const MetaText& text) {
    const std::string name = path.string();
    const auto size = wholeNumbers(name, "DimSize", text.get("DimSize"));
    const auto dimensions = wholeNumbers(name, "NDims", text.get("NDims"));
    if (dimensions.size() != 1 || static_cast<std::int64_t>(size.size()) != dimensions[0])
        throw InputError(
            name, fmt::format("'NDims' says '{}' but 'DimSize' has {} numbers; it is truncated or not a "
                              "MetaImage",
                              oneLine(text.get("NDims")), size.size()));
    byteCount(name, size, 1);
    if (size.empty()) throw InputError(name, "'NDims' says 0; expected 3");
    if (size.size() < 3) throwFlat(path, size[0], size.size() > 1 ? size[1] : 1, "");
    return size;
}

ValueType typeOf(const std::string& name, const MetaText& text) {
    const auto type = metaType(text.get("ElementType"));
    if (!type)
        throw InputError(name,
                         fmt::format("'ElementType' says '{}'; expected a scalar type such as MET_SHORT",
                                     oneLine(text.get("ElementType"))));
    return *type;
}

}  // namespace

std::vector<std::string> metaVoxelFiles(const fs::path& path) { return voxelFiles(path, metaText(path)); }

StoredVolume readMetaHeader(const fs::path& path) {
    const std::string name = path.string();
    const MetaText text = metaText(path);
    StoredVolume volume;
    Header& header = volume.header;
    const std::vector<std::int64_t> size = sizeOfMeta(path, text);
    header.format = "MetaImage";
    header.size = {size[0], size[1], size[2]};
    header.type = typeOf(name, text);
    const auto channels = wholeNumbers(name, "ElementNumberOfChannels", text.get("ElementNumberOfChannels"));
    if (!channels.empty() && channels[0] != 1)
        throwNotScalar(path, channels[0] == 3 ? "RGB" : channels[0] == 4 ? "RGBA" : "vector", channels[0]);
    remarkIntensity(text, header);
    checkMetaNumbers(name, text, size.size());
    placeMeta(text, size.size(), header);
    for (std::size_t a = 3; a < size.size(); ++a) volume.voxels.outer *= size[a];
    const std::int64_t needed = byteCount(name, size, static_cast<std::int64_t>(sizeOf(header.type)));
    takeVoxels(path, text, needed, volume.voxels);
    volume.promise = fmt::format("'DimSize' says {}", sizesText(size));
    return volume;
}

}  // namespace isowave::imageio
