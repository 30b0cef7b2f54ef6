// What ITK's readers hide, looked up in the headers themselves before ITK sees the file.
//
// NrrdIO, MetaIO and the NIfTI library fill what is missing with zeros, take absolute values, allocate
// whatever a header asks for, or print to the terminal. Here each header is read just far enough to know how
// many bytes of voxels it promises and whether the file holds them. What is not understood here is left to
// ITK.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "base/error.h"
#include "volume/image_source.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// ------------------------------------------------------------------------------------------------ text and
// numbers

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

// The whole numbers of a line; throws InputError when there is anything else in it.
std::vector<std::int64_t> wholeNumbers(const std::string& file, const std::string& key,
                                       const std::string& text) {
    std::vector<std::int64_t> result;
    std::istringstream stream(text);
    for (std::int64_t value; stream >> value;) result.push_back(value);
    if (!stream.eof())
        throw InputError(file, fmt::format("'{}' says '{}'; expected whole numbers", key, oneLine(text)));
    return result;
}

// Numbers as strtod takes them (nan and inf too); anything else ends the list.
std::vector<double> numbers(const std::string& text) {
    std::vector<double> result;
    const char* at = text.c_str();
    for (char* end = nullptr;; at = end) {
        const double value = std::strtod(at, &end);
        if (end == at) return result;
        result.push_back(value);
    }
}

std::string headerFileText(const fs::path& path) {
    // Headers are a few kB; a detached or local header never nears this.
    constexpr std::streamsize kLongestHeader = 1 << 20;
    std::string text(kLongestHeader, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(text.data(), kLongestHeader);
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

// ---------------------------------------------------------------------------------------------- bytes that
// are held

// How far a zlib or gzip stream (or several gzip ones after another) inflates; finished: its end mark and
// checksum were there and right.
struct Inflated {
    std::int64_t bytes = 0;
    bool finished = false;
};

class InflateStream {
  public:
    InflateStream() { inflateInit2(&z_, 15 + 32); }  // 32: zlib or gzip, whichever the first bytes say
    ~InflateStream() { inflateEnd(&z_); }
    InflateStream(const InflateStream&) = delete;
    InflateStream& operator=(const InflateStream&) = delete;

    Inflated measure(std::ifstream& file) {
        std::vector<char> in(1 << 16), out(1 << 18);
        Inflated result;
        while (file.read(in.data(), static_cast<std::streamsize>(in.size())) || file.gcount() > 0) {
            z_.next_in = reinterpret_cast<Bytef*>(in.data());
            z_.avail_in = static_cast<uInt>(file.gcount());
            while (z_.avail_in > 0) {
                if (result.finished && inflateReset(&z_) != Z_OK) return result;
                z_.next_out = reinterpret_cast<Bytef*>(out.data());
                z_.avail_out = static_cast<uInt>(out.size());
                const int status = inflate(&z_, Z_NO_FLUSH);
                result.bytes += static_cast<std::int64_t>(out.size() - z_.avail_out);
                if (status == Z_STREAM_END) {
                    result.finished = true;
                } else if (result.finished) {
                    return result;  // bytes after the end that are no further stream: padding
                } else if (status != Z_OK) {
                    return result;
                }
                if (status == Z_OK && z_.avail_out > 0 && z_.avail_in == 0) break;
            }
        }
        return result;
    }

  private:
    z_stream z_{};
};

// The last 4 bytes of a gzip stream are its length modulo 2^32. If they say what is needed, the file is whole
// but for a chance of 2^-32, and a large file need not be inflated twice.
bool gzipEndsAt(const fs::path& path, std::int64_t bytes) {
    const auto length = static_cast<std::streamoff>(fs::file_size(path));
    if (length < 18) return false;
    std::ifstream file(path, std::ios::binary);
    file.seekg(length - 4);
    unsigned char end[4] = {};
    file.read(reinterpret_cast<char*>(end), 4);
    const std::uint32_t says = end[0] | end[1] << 8 | end[2] << 16 | static_cast<std::uint32_t>(end[3]) << 24;
    return says == static_cast<std::uint32_t>(bytes);
}

[[noreturn]] void throwTruncated(const fs::path& path, const std::string& promise, std::int64_t needed,
                                 std::int64_t held) {
    throw InputError(
        path.string(),
        fmt::format("{} ({}) but the file holds {}; it is truncated or its header is wrong", promise,
                    bytesText(static_cast<double>(needed)),
                    needed == held ? "no end of its compressed data" : bytesText(static_cast<double>(held))));
}

// The data begins at byte `start` of the file and is needed in full. promise: "'sizes' says 512 x 512 x 300".
void checkPlain(const fs::path& path, std::int64_t start, std::int64_t needed, const std::string& promise) {
    const std::int64_t held = static_cast<std::int64_t>(fs::file_size(path)) - start;
    if (held < needed) throwTruncated(path, promise, needed, std::max<std::int64_t>(held, 0));
}

void checkDeflated(const fs::path& path, std::int64_t start, std::int64_t needed,
                   const std::string& promise) {
    if (gzipEndsAt(path, needed)) return;
    std::ifstream file(path, std::ios::binary);
    file.seekg(start);
    const Inflated inflated = InflateStream().measure(file);
    if (inflated.bytes < needed || !inflated.finished)
        throwTruncated(path, promise, needed, std::min(inflated.bytes, needed));
}

void requireFile(const fs::path& header, const fs::path& data) {
    std::error_code error;
    if (!fs::is_regular_file(data, error))
        throw InputError(header.string(),
                         fmt::format("its voxels should be in {}, which is missing; put it beside the "
                                     "header",
                                     data.string()));
}

std::string sizesText(const std::vector<std::int64_t>& size) {
    std::string text;
    for (const std::int64_t n : size) text += (text.empty() ? "" : " x ") + std::to_string(n);
    return text;
}

// The first three spacings, when one of them is not a positive number. nan where the file says nothing.
std::optional<std::array<double, 3>> badAmong(const std::vector<double>& spacing, bool nanIsUnknown) {
    std::array<double, 3> first{1, 1, 1};
    bool bad = false;
    for (std::size_t a = 0; a < std::min<std::size_t>(3, spacing.size()); ++a) {
        first[a] = spacing[a];
        if (nanIsUnknown && std::isnan(spacing[a])) continue;
        bad = bad || !(spacing[a] > 0) || !std::isfinite(spacing[a]);
    }
    return bad ? std::optional(first) : std::nullopt;
}

// -----------------------------------------------------------------------------------------------------------
// NRRD

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
        std::string name = lower(line.substr(0, colon));
        std::erase(name, ' ');
        result.field[name] = trimmed(line.substr(colon + 1));
        list = name == "datafile" && lower(result.field[name]).starts_with("list");
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

void checkNrrdData(const fs::path& path, const NrrdText& text, std::int64_t needed,
                   const std::string& promise) {
    const std::string name = path.string();
    const auto get = [&](const std::string& key) {
        const auto found = text.field.find(key);
        return found == text.field.end() ? std::string() : found->second;
    };
    const std::string data = get("datafile"), encoding = lower(get("encoding"));
    for (const std::string& file : text.dataFiles) requireFile(path, path.parent_path() / file);
    // "pattern%03d.raw 1 9 1" and lists: several files, whose lengths NrrdIO checks one by one.
    if (!text.dataFiles.empty() || data.find('%') != std::string::npos) return;
    const fs::path file = data.empty() ? path : path.parent_path() / data;
    if (!data.empty()) requireFile(path, file);
    if (data.empty() && !text.complete) throw InputError(name, "its header has no end; it is truncated");

    const std::int64_t lineSkip = numberOr(name, text, "lineskip", 0),
                       byteSkip = numberOr(name, text, "byteskip", 0);
    const std::int64_t start = data.empty() ? text.end : 0;
    if (encoding == "raw") {
        checkPlain(file, byteSkip < 0 ? 0 : skipped(file, start, lineSkip, byteSkip), needed, promise);
    } else if (encoding == "gzip" || encoding == "gz") {  // lines are skipped before inflating, bytes after
        checkDeflated(file, skipped(file, start, lineSkip, 0), needed + std::max<std::int64_t>(byteSkip, 0),
                      promise);
    }
}

}  // namespace

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
    facts.storedType = valueTypeOf(std::string(need("type")));
    if (!facts.storedType) {  // the long names: "signed short int", "unsigned long long"
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
        const auto found = others.find(lower(need("type")));
        if (found == others.end())
            throw InputError(name, fmt::format("'type' says '{}'; expected an integer or floating-point type",
                                               oneLine(need("type"))));
        facts.storedType = found->second;
    }
    if (text.field.contains("spacings"))
        facts.badSpacing = badAmong(numbers(text.field.at("spacings")), true);
    if (text.field.contains("spacedirections")) checkSpaceDirections(name, text.field.at("spacedirections"));
    need("encoding");
    const std::int64_t needed =
        byteCount(name, facts.size, static_cast<std::int64_t>(sizeOf(*facts.storedType)));
    checkNrrdData(path, text, needed, fmt::format("'sizes' says {}", sizesText(facts.size)));
    return facts;
}

// ------------------------------------------------------------------------------------------------------
// MetaImage

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
    bool yes(const std::string& key) const { return lower(get(key)).starts_with('t') || get(key) == "1"; }
};

// Lines "name = value"; ElementDataFile is the last.
MetaText metaText(const fs::path& path) {
    MetaText result;
    const std::string text = headerFileText(path);
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t next = text.find('\n', at);
        const bool cut = next == std::string::npos;
        const std::string line = text.substr(at, cut ? next : next - at);
        at = cut ? text.size() : next + 1;
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos) continue;
        const std::string key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
        result.field[key] = value;
        if (key == "ElementDataFile") {
            result.end = static_cast<std::int64_t>(at);
            if (cut && value == "LOCAL") break;  // no newline: no data either, found by its length
            return result;
        }
    }
    if (!result.field.contains("ElementDataFile"))
        throw InputError(path.string(),
                         "its header has no 'ElementDataFile'; it is truncated or not a MetaImage");
    return result;
}

void checkMetaData(const fs::path& path, const MetaText& text, std::int64_t needed,
                   const std::string& promise) {
    const std::string data = text.get("ElementDataFile"), name = path.string();
    const bool local = lower(data) == "local";
    if (data.starts_with("LIST") || data.find('%') != std::string::npos)
        return;  // many files: MetaIO opens each
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
    }
}

}  // namespace

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
    const std::int64_t needed = byteCount(name, all, static_cast<std::int64_t>(sizeOf(*facts.storedType)));
    facts.onePiece = text.yes("CompressedData") || !text.get("ElementDataFile").ends_with("LOCAL");
    checkMetaData(path, text, needed, fmt::format("'DimSize' says {}", sizesText(facts.size)));
    return facts;
}

// ----------------------------------------------------------------------------------------------------------
// NIfTI

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

    const auto offset = header.at<float>(108);  // vox_offset
    if (!(offset >= 0 && offset < 1e9f))
        throw InputError(name, fmt::format("its header says that voxels begin at byte {}", offset));
    const std::int64_t needed =
        byteCount(name, facts.size, static_cast<std::int64_t>(sizeOf(*facts.storedType))) +
        std::max<std::int64_t>(352, static_cast<std::int64_t>(offset));
    const std::string promise = fmt::format("its header says {}", sizesText(facts.size));
    if (isGzip(path))
        checkDeflated(path, 0, needed, promise);
    else
        checkPlain(path, 0, needed, promise);
    return facts;
}

}  // namespace isowave::imageio
