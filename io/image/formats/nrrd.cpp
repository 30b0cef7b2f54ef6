// Field names are those of https://teem.sourceforge.net/nrrd/format.html, lower case, without blanks.
#include "io/image/formats/nrrd.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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

struct NrrdText {
    std::map<std::string, std::string> field;  // "datafile", "spacedirections"
    std::map<std::string, std::string> note;   // "key:=value"
    std::vector<std::string> dataFiles;        // of "data file: LIST"
    std::int64_t end = 0;                      // first byte after the header
    bool complete = false;                     // the blank line that ends the header was there

    std::string get(const std::string& key) const {
        const auto found = field.find(key);
        return found == field.end() ? std::string() : found->second;
    }
    bool has(const std::string& key) const { return field.contains(key); }
};

void takeLine(const std::string& line, NrrdText& text) {
    const std::size_t colon = line.find(':');
    if (line[0] == '#' || colon == std::string::npos) return;
    if (line.compare(colon, 2, ":=") == 0) {
        text.note[trimmed(line.substr(0, colon))] = trimmed(line.substr(colon + 2));
        return;
    }
    std::string name = toLower(line.substr(0, colon));
    std::erase(name, ' ');
    static const std::map<std::string, std::string> aliases = {{"centers", "centerings"}};
    if (const auto found = aliases.find(name); found != aliases.end()) name = found->second;
    text.field[name] = trimmed(line.substr(colon + 1));
}

bool isList(const NrrdText& text) { return toLower(text.get("datafile")).starts_with("list"); }

// Lines "name: value", then an empty line (or the end of a detached header). "key:=value" and '#' lines are
// notes.
NrrdText nrrdText(const fs::path& path) {
    NrrdText result;
    const std::string text = headerFileText(path);
    if (text.compare(0, 4, "NRRD") != 0)
        throw InputError(path.string(), "is not an NRRD file: it does not begin with 'NRRD'");
    std::size_t at = text.find('\n');
    while (at != std::string::npos && at + 1 < text.size()) {
        const bool list = isList(result);
        const std::size_t next = text.find('\n', ++at);
        if (next == std::string::npos && !list) break;  // a line that was cut off says nothing
        const std::string line = trimmed(text.substr(at, next == std::string::npos ? next : next - at));
        at = next;
        if (line.empty()) {
            result.complete = true;
            break;
        }
        if (list)
            result.dataFiles.push_back(line);
        else
            takeLine(line, result);
    }
    if (!result.complete && text.size() >= kLongestHeader)
        throw InputError(path.string(),
                         fmt::format("its header goes on beyond {} bytes; expected a blank line that ends it",
                                     kLongestHeader));
    result.end = static_cast<std::int64_t>(at == std::string::npos ? text.size() : at + 1);
    return result;
}

// Where the voxels begin after `lines` lines and `bytes` bytes are skipped from `start`.
std::int64_t skipped(const fs::path& path, std::int64_t start, std::int64_t lines, std::int64_t bytes) {
    std::ifstream file(path, std::ios::binary);
    file.seekg(start);
    for (std::string line; lines > 0 && std::getline(file, line); --lines)
        start += static_cast<std::int64_t>(line.size()) + 1;
    return start + bytes;
}

std::int64_t numberOr(const std::string& file, const NrrdText& text, const std::string& key,
                      std::int64_t otherwise) {
    if (!text.has(key)) return otherwise;
    const auto values = wholeNumbers(file, key, text.get(key));
    return values.empty() ? otherwise : values[0];
}

ValueType nrrdType(const std::string& file, const std::string& text) {
    if (const auto type = valueTypeOf(text)) return *type;
    // The long names: "signed short int", "unsigned long long".
    static const std::map<std::string, ValueType> others = {{"signed short int", ValueType::int16},
                                                            {"short int", ValueType::int16},
                                                            {"unsigned short int", ValueType::uint16},
                                                            {"longlong", ValueType::int64},
                                                            {"long long", ValueType::int64},
                                                            {"long long int", ValueType::int64},
                                                            {"signed long long", ValueType::int64},
                                                            {"signed long long int", ValueType::int64},
                                                            {"unsigned long long", ValueType::uint64},
                                                            {"unsigned long long int", ValueType::uint64},
                                                            {"ulonglong", ValueType::uint64},
                                                            {"int8_t", ValueType::int8},
                                                            {"uint8_t", ValueType::uint8},
                                                            {"int16_t", ValueType::int16},
                                                            {"uint16_t", ValueType::uint16},
                                                            {"int32_t", ValueType::int32},
                                                            {"uint32_t", ValueType::uint32},
                                                            {"int64_t", ValueType::int64},
                                                            {"uint64_t", ValueType::uint64}};
    const auto found = others.find(toLower(text));
    if (found == others.end())
        throw InputError(
            file, fmt::format("'type' says '{}'; expected an integer or floating-point type", oneLine(text)));
    return found->second;
}

// ---- fields of one entry an axis

std::vector<std::string> words(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> result;
    for (std::string word; stream >> word;) result.push_back(word);
    return result;
}

// "mm" "um" "": what stands between quotation marks, or words.
std::vector<std::string> quoted(const std::string& text) {
    if (text.find('"') == std::string::npos) return words(text);
    std::vector<std::string> result;
    for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 1)) {
        const std::size_t end = std::min(text.find('"', at + 1), text.size());
        result.push_back(trimmed(text.substr(at + 1, end - at - 1)));
        at = end;
        if (at >= text.size()) break;
    }
    return result;
}

// The numbers of "(a, b, c)", without the parentheses.
std::vector<double> vectorOf(std::string inside) {
    std::replace(inside.begin(), inside.end(), ',', ' ');
    return numbers(inside);
}

// 'space directions': one vector "(a,b,c)", or "none", an axis; empty for none.
std::vector<std::vector<double>> directionsOf(const std::string& file, const std::string& text,
                                              std::size_t axes) {
    std::vector<std::vector<double>> result;
    for (std::size_t at = text.find_first_not_of(" \t"); at != std::string::npos;
         at = text.find_first_not_of(" \t", at)) {
        const bool vector = text[at] == '(';
        const std::size_t end = vector ? text.find(')', at) : text.find_first_of(" \t(", at);
        std::vector<double> found;
        if (vector && end != std::string::npos) found = vectorOf(text.substr(at + 1, end - at - 1));
        const bool unknown = std::all_of(found.begin(), found.end(), [](double v) { return std::isnan(v); });
        if (vector && (end == std::string::npos || found.empty()))
            throw InputError(
                file,
                fmt::format("'space directions' says '{}'; expected vectors (a,b,c) or none", oneLine(text)));
        result.push_back(unknown ? std::vector<double>() : found);
        at = vector ? end + 1 : end;
        if (at == std::string::npos) break;
    }
    if (result.size() != axes)
        throw InputError(file,
                         fmt::format("'space directions' has {} entries for {} axes", result.size(), axes));
    return result;
}

void checkDirection(const std::string& file, const std::string& text, const std::vector<double>& vector) {
    const bool zero = std::all_of(vector.begin(), vector.end(), [](double v) { return v == 0; });
    const bool infinite =
        std::any_of(vector.begin(), vector.end(), [](double v) { return !std::isfinite(v); });
    if (zero || infinite)
        throw InputError(file,
                         fmt::format("'space directions' says {}, {}; expected vectors of "
                                     "positive length",
                                     oneLine(text), zero ? "a spacing of zero" : "which are not all finite"));
}

// ---- spaces

// What the first three coordinates of a space times sign are in LPS.
struct NrrdSpace {
    Vec3 sign{1, 1, 1};
    std::size_t dimension = 3;
    std::string remark;  // where it names no side of the body
};

// "right-anterior-superior", "RAS", "left-posterior-superior-time", "RAST", in any combination of sides.
std::optional<NrrdSpace> anatomicalSpace(std::string name) {
    NrrdSpace space;
    if (name.ends_with("-time") || name.size() == 4) space.dimension = 4;
    if (name.ends_with("-time")) name.resize(name.size() - 5);
    if (name.size() == 4 && name.back() == 't') name.pop_back();
    static const std::pair<const char*, const char*> sides[3] = {
        {"left", "right"}, {"posterior", "anterior"}, {"superior", "inferior"}};
    std::replace(name.begin(), name.end(), '-', ' ');
    std::vector<std::string> parts = words(name);
    if (parts.size() == 1 && name.size() == 3)
        parts = {name.substr(0, 1), name.substr(1, 1), name.substr(2, 1)};
    if (parts.size() != 3) return std::nullopt;
    for (int a = 0; a < 3; ++a) {
        const std::string& part = parts[static_cast<std::size_t>(a)];
        const auto is = [&](const std::string& side) { return part == side || part == side.substr(0, 1); };
        if (!is(sides[a].first) && !is(sides[a].second)) return std::nullopt;
        space.sign[a] = is(sides[a].first) ? 1 : -1;
    }
    return space;
}

NrrdSpace spaceOf(const std::string& file, const NrrdText& text) {
    const std::string name = toLower(text.get("space"));
    if (const auto space = anatomicalSpace(name)) return *space;
    NrrdSpace space;
    static const std::set<std::string> others = {"scanner-xyz",          "scanner-xyz-time",
                                                 "3d-right-handed",      "3d-left-handed",
                                                 "3d-right-handed-time", "3d-left-handed-time"};
    if (!name.empty() && !others.contains(name))
        throw InputError(file,
                         fmt::format("'space' says '{}'; expected left-posterior-superior, RAS or another "
                                     "space of the NRRD format",
                                     oneLine(text.get("space"))));
    if (name.ends_with("-time")) space.dimension = 4;
    if (name.empty()) {
        space.dimension = static_cast<std::size_t>(
            std::clamp<std::int64_t>(numberOr(file, text, "spacedimension", 3), 1, 16));
        space.remark =
            "names no space; its coordinates are kept as they are, and do not say where left and right are";
    } else {
        space.remark =
            fmt::format("its space '{}' names no side of the body; its coordinates are kept as they are",
                        text.get("space"));
    }
    return space;
}

// ---- which axes are x, y, z

struct NrrdAxes {
    std::vector<std::int64_t> size;
    std::vector<std::string> kind;               // lower case; "" where none is stated
    std::vector<std::vector<double>> direction;  // empty: none, or no directions at all
    std::size_t first = 0;                       // of the three axes beside each other that are x, y, z
};

// Kinds of axes along which nothing lies in space.
bool isRange(const std::string& kind) {
    static const std::set<std::string> others = {
        "list", "time", "point", "vector", "covariant-vector", "normal", "scalar", "complex", "quaternion"};
    return others.contains(kind) || kind.ends_with("-vector") || kind.ends_with("-color") ||
           kind.ends_with("-gradient") || kind.ends_with("-normal") ||
           kind.find("matrix") != std::string::npos;
}

bool isSpatial(const NrrdAxes& axes, std::size_t a, bool directions) {
    if (isRange(axes.kind[a])) return false;
    if (!directions) return true;
    const auto& d = axes.direction[a];
    if (d.empty()) return false;
    // An axis of a space with time that runs along time alone.
    return d.size() < 4 || std::any_of(d.begin(), d.begin() + 3, [](double v) { return v != 0; });
}

void chooseAxes(const fs::path& path, NrrdAxes& axes, bool directions) {
    std::vector<std::size_t> spatial;
    for (std::size_t a = 0; a < axes.size.size(); ++a)
        if (isSpatial(axes, a, directions)) spatial.push_back(a);
    if (spatial.size() < 3 && directions && axes.size.size() > 2 && spatial.size() < axes.size.size() - 1)
        throw InputError(path.string(),
                         fmt::format("'space directions' gives {} of its {} axes a direction; expected three",
                                     spatial.size(), axes.size.size()));
    if (spatial.size() < 3) {
        std::int64_t x = axes.size[0], y = axes.size.size() > 1 ? axes.size[1] : 1;
        if (!spatial.empty()) x = axes.size[spatial[0]], y = spatial.size() > 1 ? axes.size[spatial[1]] : 1;
        throwFlat(path, x, y, "");
    }
    if (spatial[2] != spatial[0] + 2)
        throw InputError(path.string(),
                         fmt::format("its axes {}, {}, {} lie in space, with another one between "
                                     "them; expected three beside each other",
                                     spatial[0], spatial[1], spatial[2]));
    axes.first = spatial[0];
    for (std::size_t a = 0; a < axes.size.size(); ++a) {
        const bool other = a < axes.first || a > axes.first + 2;
        const bool choosable = axes.kind[a] == "list" || axes.kind[a] == "time" || !isRange(axes.kind[a]);
        if (other && !choosable && axes.size[a] > 1)
            throwNotScalar(path, axes.kind[a].ends_with("-color") ? "RGB" : axes.kind[a], axes.size[a]);
    }
}

NrrdAxes axesOf(const fs::path& path, const NrrdText& text) {
    const std::string name = path.string();
    NrrdAxes axes;
    const std::int64_t dimension = numberOr(name, text, "dimension", 0);
    axes.size = wholeNumbers(name, "sizes", text.get("sizes"));
    if (static_cast<std::int64_t>(axes.size.size()) != dimension)
        throw InputError(
            name, fmt::format("'dimension' says {} but 'sizes' has {} numbers", dimension, axes.size.size()));
    if (dimension < 1) throw InputError(name, "'dimension' says 0; expected 3");
    axes.kind = words(toLower(text.get("kinds")));
    axes.kind.resize(axes.size.size());
    const bool directions = text.has("spacedirections");
    if (directions) axes.direction = directionsOf(name, text.get("spacedirections"), axes.size.size());
    byteCount(name, axes.size, 1);
    chooseAxes(path, axes, directions);
    return axes;
}

// ---- where voxels lie

// mm in a unit; 1 for what is no length, with a remark.
double unitOrRemark(const std::string& unit, const char* field, Header& header) {
    if (unit.empty() || unit == "none" || unit == "???") return 1;
    if (const auto millimetres = millimetresIn(unit)) return *millimetres;
    header.warnings.push_back(
        fmt::format("'{}' says '{}', which is no length; mm is assumed", field, oneLine(unit)));
    return 1;
}

// mm in the units of three coordinates or axes, from `first` on.
Vec3 unitsOf(const NrrdText& text, const std::string& key, const char* field, std::size_t first,
             Header& header) {
    Vec3 result{1, 1, 1};
    const std::vector<std::string> units = quoted(text.get(key));
    std::string last;
    for (std::size_t a = 0; a < 3 && first + a < units.size(); ++a) {
        const std::string& unit = units[first + a];
        if (a > 0 && unit == last) {
            result[static_cast<int>(a)] = result[static_cast<int>(a) - 1];
            continue;
        }
        result[static_cast<int>(a)] = unitOrRemark(unit, field, header);
        remarkUnit(header, unit, result[static_cast<int>(a)]);
        last = unit;
    }
    return result;
}

Vec3 spaceOrigin(const std::string& file, const NrrdText& text) {
    Vec3 origin;
    if (!text.has("spaceorigin")) return origin;
    std::string inside = text.get("spaceorigin");
    std::erase_if(inside, [](char c) { return c == '(' || c == ')'; });
    const std::vector<double> found = vectorOf(inside);
    if (found.size() < 3)
        throw InputError(file, fmt::format("'space origin' says '{}'; expected three numbers",
                                           oneLine(text.get("spaceorigin"))));
    for (int a = 0; a < 3; ++a) origin[a] = found[static_cast<std::size_t>(a)];
    return origin;
}

// The same factor for each coordinate.
Vec3 product(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

void placeBySpace(const std::string& file, const NrrdText& text, const NrrdAxes& axes, Header& header) {
    const NrrdSpace space = spaceOf(file, text);
    const Vec3 factor = product(space.sign, unitsOf(text, "spaceunits", "space units", 0, header));
    if (!space.remark.empty()) {
        header.warnings.push_back(space.remark);
        header.space = Space::unspecified;
    }
    std::array<Vec3, 3> step;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::vector<double>& d = axes.direction[axes.first + a];
        if (d.size() != space.dimension || d.size() < 3)
            throw InputError(file,
                             fmt::format("'space directions' has vectors of {} numbers in a space of {}; "
                                         "expected 3",
                                         d.size(), space.dimension));
        checkDirection(file, text.get("spacedirections"), d);
        step[a] = product({d[0], d[1], d[2]}, factor);
    }
    place(header, step, product(spaceOrigin(file, text), factor));
}

// A field with one number an axis, nan where it is not known.
void requireNumberAnAxis(const std::string& file, const NrrdText& text, const std::string& key,
                         const char* field, std::size_t axes) {
    if (text.has(key) && numbers(text.get(key)).size() != axes)
        throw InputError(file, fmt::format("'{}' says '{}'; expected {} numbers, one an axis", field,
                                           oneLine(text.get(key)), axes));
}

// Number `axis` of a field with one number an axis; NaN where it does not say.
double ofAxis(const NrrdText& text, const std::string& key, std::size_t axis) {
    const std::vector<double> values = numbers(text.get(key));
    return axis < values.size() ? values[axis] : std::nan("");
}

// Without a space: 'spacings', or 'axis mins' and 'axis maxs', which give the places of samples or, of axes centred in
// cells (the default), of the cells' borders.
void placeByAxes(const std::string& file, const NrrdText& text, const NrrdAxes& axes, Header& header) {
    for (const auto& [key, field] :
         {std::pair{"spacings", "spacings"}, {"axismins", "axis mins"}, {"axismaxs", "axis maxs"}})
        requireNumberAnAxis(file, text, key, field, axes.size.size());
    const Vec3 unit = unitsOf(text, "units", "units", axes.first, header);
    const std::vector<std::string> centerings = words(toLower(text.get("centerings")));
    std::array<Vec3, 3> step{};
    Vec3 origin;
    std::vector<char> unspaced;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t axis = axes.first + a;
        const int i = static_cast<int>(a);
        const bool node = axis < centerings.size() && centerings[axis] == "node";
        const double low = ofAxis(text, "axismins", axis), high = ofAxis(text, "axismaxs", axis);
        const auto cells = static_cast<double>(header.size[a] - (node ? 1 : 0));
        double spacing = ofAxis(text, "spacings", axis);
        if (std::isnan(spacing)) spacing = cells > 0 ? (high - low) / cells : std::nan("");
        if (std::isnan(spacing)) {
            spacing = 1;
            unspaced.push_back("xyz"[a]);
        }
        step[a][i] = unit[i];
        if (std::isfinite(low)) origin[i] = unit[i] * (low + (node ? 0 : spacing / 2));
        header.spacing[a] = unit[i] * spacing;
    }
    header.hasZSpacing = unspaced.empty();
    header.unspaced = fmt::format("{}", fmt::join(unspaced, ", "));
    const std::array<double, 3> spacing = header.spacing;
    place(header, step, origin);
    header.spacing = spacing;  // refused, or healed by a given one, where it is not positive
    header.space = Space::unspecified;
    header.warnings.push_back("names no space; its axes are taken as x, y, z, and may be mirrored");
}

// ---- voxels

// "LIST", a pattern or a name; nothing: in the file itself.
std::vector<std::string> voxelFiles(const std::string& file, const NrrdText& text) {
    if (isList(text)) return text.dataFiles;
    const std::string data = text.get("datafile");
    if (data.empty()) return {};
    if (data.find('%') == std::string::npos) return {data};
    return numberedNames(file, data, std::nullopt);
}

Encoding encodingOf(const std::string& file, const std::string& name) {
    static const std::map<std::string, Encoding> encodings = {
        {"raw", Encoding::raw},   {"gzip", Encoding::deflated}, {"gz", Encoding::deflated},
        {"text", Encoding::text}, {"txt", Encoding::text},      {"ascii", Encoding::text},
        {"hex", Encoding::hex}};
    const auto found = encodings.find(name);
    if (found == encodings.end())
        throw InputError(file, fmt::format("'encoding' says {}; expected raw, gzip, ascii or hex; convert it",
                                           oneLine(name)));
    return found->second;
}

bool isBigEndian(const std::string& file, const NrrdText& text, Encoding encoding, ValueType type) {
    const std::string endian = toLower(text.get("endian"));
    const bool matters = encoding != Encoding::text && sizeOf(type) > 1;
    if (matters && endian.empty())
        throw InputError(
            file, fmt::format("its header has no 'endian', which {} voxels need; expected little or big",
                              nameOf(type)));
    if (matters && endian != "little" && endian != "big")
        throw InputError(file, fmt::format("'endian' says '{}'; expected little or big", oneLine(endian)));
    return endian == "big";
}

constexpr std::int64_t kMostSkipped = std::int64_t(1) << 62;

// Lines are skipped before decoding, bytes after it. A byte skip of -1: raw voxels are what the file ends with.
VoxelPiece pieceOf(const fs::path& file, std::int64_t start, const NrrdText& text, Encoding encoding,
                   std::int64_t each) {
    const std::string name = file.string();
    const std::int64_t lines = numberOr(name, text, "lineskip", 0),
                       bytes = numberOr(name, text, "byteskip", 0);
    const auto held = static_cast<std::int64_t>(fs::file_size(file));
    if (lines < 0 || lines > held)
        throw InputError(name, fmt::format("'line skip' says {}; expected 0 to {}", lines, held));
    // Bytes are those behind decoding: a deflated file may have more than it takes.
    if (bytes < -1 || (bytes > held && encoding != Encoding::deflated) || bytes > kMostSkipped)
        throw InputError(name, fmt::format("'byte skip' says {}, of a file of {} bytes; expected -1 or more",
                                           bytes, held));
    if (encoding == Encoding::raw && bytes < 0) {
        return {file, std::max<std::int64_t>(0, held - each), 0};
    }
    const std::int64_t begin = skipped(file, start, lines, 0);
    return encoding == Encoding::deflated ? VoxelPiece{file, begin, std::max<std::int64_t>(0, bytes)}
                                          : VoxelPiece{file, begin + std::max<std::int64_t>(0, bytes), 0};
}

void takeVoxels(const fs::path& path, const NrrdText& text, std::int64_t needed, ValueType type,
                VoxelLayout& voxels) {
    const std::string name = path.string();
    voxels.encoding = encodingOf(name, toLower(text.get("encoding")));
    voxels.bigEndian = isBigEndian(name, text, voxels.encoding, type);
    const std::vector<std::string> files = voxelFiles(name, text);
    if (files.empty() && (text.has("datafile") || !text.complete))
        throw InputError(name, text.has("datafile") ? "'data file' names no file; it is truncated"
                                                    : "its header has no end; it is truncated");
    const auto count = std::max<std::int64_t>(1, static_cast<std::int64_t>(files.size()));
    if (needed / static_cast<std::int64_t>(sizeOf(type)) % count != 0)
        throw InputError(name,
                         fmt::format("'data file' names {} files, among which {} bytes of voxels cannot be "
                                     "shared out; expected one a slice",
                                     count, needed));
    for (const std::string& file : files) {
        requireFile(path, path.parent_path() / file);
        voxels.pieces.push_back(pieceOf(path.parent_path() / file, 0, text, voxels.encoding, needed / count));
    }
    if (!files.empty()) return;
    if (isGzip(path))
        putBehindHeader(voxels, path, text.end, !text.has("lineskip") && !text.has("byteskip"));
    else
        voxels.pieces = {pieceOf(path, text.end, text, voxels.encoding, needed)};
}

// ---- segmentations of 3D Slicer

// "Segment3_Name", or what else there is of segment 3; empty where it is not.
std::string segmentNote(const NrrdText& text, int segment, const char* key) {
    const auto at = text.note.find(fmt::format("Segment{}_{}", segment, key));
    return at == text.note.end() ? std::string() : at->second;
}

bool hasSegment(const NrrdText& text, int segment) {
    return text.note.contains(fmt::format("Segment{}_Name", segment));
}

// "0.5 0.25 1"; nothing where it is no colour.
std::optional<std::array<std::uint8_t, 3>> colourOf(const std::string& text) {
    std::istringstream in(text);
    std::array<std::uint8_t, 3> colour{};
    for (std::uint8_t& c : colour) {
        double share = -1;
        if (!(in >> share) || !(share >= 0 && share <= 1)) return std::nullopt;
        c = static_cast<std::uint8_t>(std::lround(255 * share));
    }
    return colour;
}

// Of each segment its label and, counted from 1, its layer:
// "volume 1: liver = 1, tumour = 2; volume 2: vessel = 1".
std::string segmentsText(const NrrdText& text, bool layers) {
    std::map<std::int64_t, std::vector<std::string>> found;
    for (int i = 0; hasSegment(text, i); ++i)
        found[layers ? std::atoll(segmentNote(text, i, "Layer").c_str()) : 0].push_back(
            segmentNote(text, i, "Name") + " = " + segmentNote(text, i, "LabelValue"));
    std::string result;
    for (const auto& [layer, names] : found)
        result += fmt::format("{}{}{}", result.empty() ? "" : "; ",
                              layers ? fmt::format("volume {}: ", layer + 1) : std::string(),
                              fmt::join(names, ", "));
    return oneLine(result);
}

}  // namespace

std::vector<std::string> nrrdVoxelFiles(const fs::path& path) {
    return voxelFiles(path.string(), nrrdText(path));
}

std::vector<ImageSegment> nrrdSegments(const fs::path& path) {
    const NrrdText text = nrrdText(path);
    std::vector<ImageSegment> segments;
    for (int i = 0; hasSegment(text, i); ++i)
        segments.push_back({std::atof(segmentNote(text, i, "LabelValue").c_str()),
                            oneLine(segmentNote(text, i, "Name")), colourOf(segmentNote(text, i, "Color")),
                            std::atoi(segmentNote(text, i, "Layer").c_str())});
    return segments;
}

StoredVolume readNrrdHeader(const fs::path& path) {
    const std::string name = path.string();
    const NrrdText text = nrrdText(path);
    for (const char* key : {"sizes", "type", "encoding"})
        if (!text.has(key))
            throw InputError(
                name, fmt::format("its header has no '{}'; it is truncated or not an NRRD header", key));
    const NrrdAxes axes = axesOf(path, text);
    StoredVolume volume;
    Header& header = volume.header;
    header.format = "NRRD";
    header.type = nrrdType(name, text.get("type"));
    for (std::size_t a = 0; a < 3; ++a) header.size[a] = axes.size[axes.first + a];
    for (std::size_t a = 0; a < axes.size.size(); ++a) {
        if (a < axes.first) volume.voxels.inner *= axes.size[a];
        if (a > axes.first + 2) volume.voxels.outer *= axes.size[a];
    }
    if (axes.direction.empty())
        placeByAxes(name, text, axes, header);
    else
        placeBySpace(name, text, axes, header);
    const std::int64_t needed = byteCount(name, axes.size, static_cast<std::int64_t>(sizeOf(header.type)));
    takeVoxels(path, text, needed, header.type, volume.voxels);
    volume.promise = fmt::format("'sizes' says {}", sizesText(axes.size));
    const bool layers = volume.voxels.inner * volume.voxels.outer > 1;
    volume.volumesText = segmentsText(text, layers);
    if (!layers && !volume.volumesText.empty())
        header.warnings.push_back("its segments are " + volume.volumesText + "; --label chooses one");
    return volume;
}

}  // namespace isowave::imageio
