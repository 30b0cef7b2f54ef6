// NRRD headers, as https://teem.sourceforge.net/nrrd/format.html has them, before NrrdIO sees them.
#include "io/image/nrrd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "base/text.h"
#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

struct NrrdText {
    std::map<std::string, std::string>
        field;                           // by lower-case name without blanks: "datafile", "spacedirections"
    std::vector<std::string> dataFiles;  // of "data file: LIST"
    std::int64_t end = 0;                // first byte after the header
    bool complete = false;               // the blank line that ends the header was there
};

// Lines "name: value", then an empty line (or the end of a detached header). "key:=value" and '#' lines are
// notes.
NrrdText nrrdText(const fs::path& path) {
    NrrdText result;
    const std::string text = headerFileText(path);
    if (text.compare(0, 4, "NRRD") != 0)
        throw InputError(path.string(), "is not an NRRD file: it does not begin with 'NRRD'");
    std::size_t at = text.find('\n');
    bool list = false;
    while (at != std::string::npos && at + 1 < text.size()) {
        const std::size_t next = text.find('\n', ++at);
        if (next == std::string::npos && !list) break;  // a line that was cut off says nothing
        const std::string line = trimmed(text.substr(at, next == std::string::npos ? next : next - at));
        at = next;
        if (line.empty()) {
            result.complete = true;
            break;
        }
        if (list) {
            result.dataFiles.push_back(line);
            continue;
        }
        const std::size_t colon = line.find(':');
        if (line[0] == '#' || colon == std::string::npos || line.compare(colon, 2, ":=") == 0) continue;
        std::string name = toLower(line.substr(0, colon));
        std::erase(name, ' ');
        result.field[name] = trimmed(line.substr(colon + 1));
        list = name == "datafile" && toLower(result.field[name]).starts_with("list");
    }
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
    const auto found = text.field.find(key);
    if (found == text.field.end()) return otherwise;
    const auto values = wholeNumbers(file, key, found->second);
    return values.empty() ? otherwise : values[0];
}

// 'space directions': one vector "(a,b,c)" or "none" an axis; a vector without length is spacing 0.
void checkSpaceDirections(const std::string& file, const std::string& text) {
    for (std::size_t at = text.find('('); at != std::string::npos; at = text.find('(', at + 1)) {
        std::string inside = text.substr(at + 1, text.find(')', at) - at - 1);
        std::replace(inside.begin(), inside.end(), ',', ' ');
        const std::vector<double> vector = numbers(inside);
        const bool someZero = std::all_of(vector.begin(), vector.end(), [](double v) { return v == 0; });
        const bool infinite =
            std::any_of(vector.begin(), vector.end(), [](double v) { return std::isinf(v); });
        if (someZero || infinite)
            throw InputError(file,
                             fmt::format("'space directions' says {}, a spacing of {}; expected vectors of "
                                         "positive length",
                                         oneLine(text), someZero ? "zero" : "infinity"));
    }
}

// Returns where the voxels are if they lie there as they are.
std::optional<PlainData> checkNrrdData(const fs::path& path, const NrrdText& text, std::int64_t needed,
                                       const std::string& promise) {
    const std::string name = path.string();
    const auto get = [&](const std::string& key) {
        const auto found = text.field.find(key);
        return found == text.field.end() ? std::string() : found->second;
    };
    const std::string data = get("datafile"), encoding = toLower(get("encoding"));
    if (encoding == "bzip2" || encoding == "bz2")  // NrrdIO as ITK has it lacks it
        throw InputError(name,
                         "'encoding' says " + encoding + "; expected raw, gzip, ascii or hex; convert it");
    for (const std::string& file : text.dataFiles) requireFile(path, path.parent_path() / file);
    // "pattern%03d.raw 1 9 1" and lists: several files, whose lengths NrrdIO checks one by one.
    if (!text.dataFiles.empty() || data.find('%') != std::string::npos) return std::nullopt;
    const fs::path file = data.empty() ? path : path.parent_path() / data;
    if (!data.empty()) requireFile(path, file);
    if (data.empty() && !text.complete) throw InputError(name, "its header has no end; it is truncated");

    const std::int64_t lineSkip = numberOr(name, text, "lineskip", 0),
                       byteSkip = numberOr(name, text, "byteskip", 0);
    const std::int64_t start = data.empty() ? text.end : 0;
    if (encoding == "raw") {
        const std::int64_t begin = byteSkip < 0 ? 0 : skipped(file, start, lineSkip, byteSkip);
        checkPlain(file, begin, needed, promise);
        // byte skip -1: the voxels are what the file ends with.
        const auto held = static_cast<std::int64_t>(fs::file_size(file));
        return PlainData{file, byteSkip < 0 ? held - needed : begin, toLower(get("endian")) == "big"};
    } else if (encoding == "gzip" || encoding == "gz") {  // lines are skipped before inflating, bytes after
        checkDeflated(file, skipped(file, start, lineSkip, 0), needed + std::max<std::int64_t>(byteSkip, 0),
                      promise);
    }
    return std::nullopt;
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

}  // namespace

std::vector<std::string> nrrdVoxelFiles(const fs::path& path) {
    const NrrdText text = nrrdText(path);
    const auto found = text.field.find("datafile");
    if (!text.dataFiles.empty() || found == text.field.end()) return text.dataFiles;
    return {found->second};
}

HeaderFacts checkNrrd(const fs::path& path) {
    const std::string name = path.string();
    const NrrdText text = nrrdText(path);
    const auto need = [&](const std::string& key) -> const std::string& {
        const auto found = text.field.find(key);
        if (found == text.field.end())
            throw InputError(
                name, fmt::format("its header has no '{}'; it is truncated or not an NRRD header", key));
        return found->second;
    };
    HeaderFacts facts;
    const std::int64_t dimension = numberOr(name, text, "dimension", 0);
    facts.size = wholeNumbers(name, "sizes", need("sizes"));
    if (static_cast<std::int64_t>(facts.size.size()) != dimension)
        throw InputError(name, fmt::format("'dimension' says {} but 'sizes' has {} numbers", dimension,
                                           facts.size.size()));
    facts.storedType = nrrdType(name, need("type"));
    if (text.field.contains("spacings"))
        facts.badSpacing = badAmong(numbers(text.field.at("spacings")), true);
    if (text.field.contains("spacedirections")) checkSpaceDirections(name, text.field.at("spacedirections"));
    need("encoding");
    const std::int64_t needed =
        byteCount(name, facts.size, static_cast<std::int64_t>(sizeOf(*facts.storedType)));
    facts.plain = checkNrrdData(path, text, needed, fmt::format("'sizes' says {}", sizesText(facts.size)));
    return facts;
}

}  // namespace isowave::imageio
