// MetaImage headers before MetaIO sees them: it prints what it dislikes and leaves unread voxels as they
// were.
#include "io/image/metaimage.h"

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

bool manyFiles(const std::string& elementDataFile) {
    return elementDataFile.starts_with("LIST") || elementDataFile.find('%') != std::string::npos;
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

// The numbers of a field, or nothing when a word of it is none. MetaIO knows neither 0x10 nor 1e, and prints
// what it thinks of them.
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

// Fields of n or n x n numbers, which MetaIO reads as far as they are numbers.
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

// Voxels as text: MetaIO leaves those that are missing as they were in memory.
void checkMetaAscii(const fs::path& file, std::int64_t start, std::int64_t needed,
                    const std::string& promise) {
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(start);
    std::int64_t found = 0;
    for (double value; found < needed && stream >> value;) ++found;
    if (found < needed)
        throw InputError(file.string(),
                         fmt::format("{} ({} numbers) but the file holds {} as text; it is truncated or "
                                     "'BinaryData' is wrong",
                                     promise, needed, found));
}

// Returns where the voxels are if they lie there as they are.
std::optional<PlainData> checkMetaData(const fs::path& path, const MetaText& text, std::int64_t count,
                                       std::int64_t bytesEach, const std::string& promise) {
    const std::int64_t needed = count * bytesEach;
    const std::string data = text.get("ElementDataFile"), name = path.string();
    const bool local = toLower(data) == "local";
    if (data.starts_with("LIST") || data.find('%') != std::string::npos)
        return std::nullopt;  // many files: MetaIO opens each
    const fs::path file = local ? path : path.parent_path() / data;
    if (!local) requireFile(path, file);

    const auto headerSize = wholeNumbers(name, "HeaderSize", text.get("HeaderSize"));
    const std::int64_t skip = headerSize.empty() ? 0 : headerSize[0];
    const std::int64_t start = skip < 0 ? 0 : (local ? text.end : 0) + skip;
    if (text.yes("CompressedData")) {
        const auto stated = wholeNumbers(name, "CompressedDataSize", text.get("CompressedDataSize"));
        if (!stated.empty())
            checkPlain(file, start, stated[0], fmt::format("'CompressedDataSize' says {}", stated[0]));
        checkDeflated(file, start, needed, promise);
    } else if (!text.field.contains("BinaryData") || text.yes("BinaryData")) {
        checkPlain(file, start, needed, promise);
        // HeaderSize -1: the voxels are what the file ends with.
        const bool big = text.yes("BinaryDataByteOrderMSB") || text.yes("ElementByteOrderMSB");
        const auto held = static_cast<std::int64_t>(fs::file_size(file));
        return PlainData{file, skip < 0 ? held - needed : start, big};
    } else {
        checkMetaAscii(file, start, count, promise);
    }
    return std::nullopt;
}

}  // namespace

std::vector<std::string> metaVoxelFiles(const fs::path& path) {
    const MetaText text = metaText(path);
    const std::string data = text.get("ElementDataFile");
    if (toLower(data) == "local") return {};
    if (!data.starts_with("LIST")) return {data};
    std::vector<std::string> names;
    std::istringstream lines(headerFileText(path).substr(static_cast<std::size_t>(text.end)));
    for (std::string line; std::getline(lines, line);) names.push_back(trimmed(line));
    return names;
}

HeaderFacts checkMetaImage(const fs::path& path) {
    const std::string name = path.string();
    const MetaText text = metaText(path);
    HeaderFacts facts;
    facts.size = wholeNumbers(name, "DimSize", text.get("DimSize"));
    const auto dimensions = wholeNumbers(name, "NDims", text.get("NDims"));
    if (dimensions.size() != 1 || static_cast<std::int64_t>(facts.size.size()) != dimensions[0])
        throw InputError(
            name, fmt::format("'NDims' says '{}' but 'DimSize' has {} numbers; it is truncated or not a "
                              "MetaImage",
                              oneLine(text.get("NDims")), facts.size.size()));
    facts.storedType = metaType(text.get("ElementType"));
    if (!facts.storedType)
        throw InputError(name,
                         fmt::format("'ElementType' says '{}'; expected a scalar type such as MET_SHORT",
                                     oneLine(text.get("ElementType"))));
    const std::string spacing =
        text.field.contains("ElementSpacing") ? text.get("ElementSpacing") : text.get("ElementSize");
    facts.badSpacing = badAmong(numbers(spacing), false);
    const auto channels = wholeNumbers(name, "ElementNumberOfChannels", text.get("ElementNumberOfChannels"));
    std::vector<std::int64_t> all = facts.size;
    if (!channels.empty()) all.push_back(channels[0]);
    const auto bytesEach = static_cast<std::int64_t>(sizeOf(*facts.storedType));
    const std::int64_t count = byteCount(name, all, bytesEach) / bytesEach;
    checkMetaNumbers(name, text, facts.size.size());
    facts.onePiece = text.yes("CompressedData") || manyFiles(text.get("ElementDataFile"));
    facts.plain =
        checkMetaData(path, text, count, bytesEach, fmt::format("'DimSize' says {}", sizesText(facts.size)));
    return facts;
}

}  // namespace isowave::imageio
