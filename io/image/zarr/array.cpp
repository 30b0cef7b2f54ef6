#include "io/image/zarr/array.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "base/file_bytes.h"
#include "base/peak_memory.h"
#include "io/image/check.h"
#include "io/image/zarr/json_file.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// Keys of .zarray, each with a line that says what is wrong with it.
class ArrayKeys {
  public:
    explicit ArrayKeys(const fs::path& file) : name_(file.string()), keys_(readJsonObject(file)) {}

    const json& at(const char* key) const {
        static const json nothing;
        const auto found = keys_.find(key);
        return found == keys_.end() ? nothing : *found;
    }
    [[noreturn]] void refuse(const char* key, const std::string& expected) const {
        throw InputError(name_,
                         fmt::format("its {} is {}; expected {}", key, oneLine(at(key).dump()), expected));
    }
    std::vector<std::int64_t> sizes(const char* key) const {
        constexpr std::int64_t kMost = std::int64_t{1} << 40;
        std::vector<std::int64_t> all;
        const json& found = at(key);
        if (!found.is_array() || found.empty()) refuse(key, "a list of whole numbers");
        for (const json& n : found) {
            if (!n.is_number_integer() || n < 1 || n > kMost)
                refuse(key, "a list of whole numbers from 1 on");
            all.push_back(n.get<std::int64_t>());
        }
        return all;
    }

  private:
    std::string name_;
    json keys_;
};

// "<u2": byte order, kind, bytes.
void takeType(const ArrayKeys& keys, ZarrArray& array) {
    static const std::map<std::string, ValueType> types = {
        {"b1", ValueType::uint8},   {"u1", ValueType::uint8},  {"i1", ValueType::int8},
        {"u2", ValueType::uint16},  {"i2", ValueType::int16},  {"u4", ValueType::uint32},
        {"i4", ValueType::int32},   {"u8", ValueType::uint64}, {"i8", ValueType::int64},
        {"f4", ValueType::float32}, {"f8", ValueType::float64}};
    const json& dtype = keys.at("dtype");
    const std::string text = dtype.is_string() ? dtype.get<std::string>() : "";
    const auto found = text.size() == 3 ? types.find(text.substr(1)) : types.end();
    if (found == types.end() || std::string("<>|").find(text[0]) == std::string::npos)
        keys.refuse("dtype",
                    "a whole number of 1 to 8 bytes, bool, f4 or f8; convert it: array.astype('float32')");
    array.type = found->second;
    array.bigEndian = text[0] == '>';
}

void takeCodec(const ArrayKeys& keys, ZarrArray& array) {
    static const std::map<std::string, ZarrCodec> codecs = {{"zlib", ZarrCodec::zlib},
                                                            {"gzip", ZarrCodec::zlib},
                                                            {"blosc", ZarrCodec::blosc},
                                                            {"zstd", ZarrCodec::zstd},
                                                            {"lz4", ZarrCodec::lz4}};
    const json& compressor = keys.at("compressor");
    if (!compressor.is_null()) {
        const auto id = compressor.is_object() && compressor.contains("id") ? compressor["id"] : json();
        const auto found = id.is_string() ? codecs.find(id.get<std::string>()) : codecs.end();
        if (found == codecs.end()) keys.refuse("compressor", "blosc, zstd, lz4, zlib, gzip or null");
        array.codec = found->second;
    }
    const json& filters = keys.at("filters");
    if (!filters.is_null() && !(filters.is_array() && filters.empty()))
        keys.refuse("filters", "none; save the array again without them: zarr.save('out.zarr', array[:])");
}

void takeFill(const ArrayKeys& keys, ZarrArray& array) {
    const json& fill = keys.at("fill_value");
    const std::string text = fill.is_string() ? fill.get<std::string>() : "";
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (fill.is_number())
        array.fill = fill.get<double>();
    else if (fill.is_boolean())
        array.fill = fill.get<bool>();
    else if (text == "NaN")
        array.fill = std::numeric_limits<double>::quiet_NaN();
    else if (text == "Infinity" || text == "-Infinity")
        array.fill = text[0] == '-' ? -kInfinity : kInfinity;
    else if (!fill.is_null())
        keys.refuse("fill_value", "a number or null");
    withType(array.type, [&](auto zero) {
        using T = decltype(zero);
        if constexpr (std::is_integral_v<T>) {
            const bool fits = array.fill >= static_cast<double>(std::numeric_limits<T>::min()) &&
                              array.fill < std::ldexp(1.0, std::numeric_limits<T>::digits);
            if (!fits)
                keys.refuse("fill_value", std::string("a number that ") + nameOf(array.type) + " holds");
        }
    });
    array.fillText = fill.is_null() ? "0" : oneLine(text.empty() ? fill.dump() : text);
}

// No codec makes more than a little of what it cannot pack.
std::string packedChunk(const ZarrArray& array, const fs::path& file) {
    const FileBytes bytes(file, "a chunk");
    const std::int64_t most = array.chunkBytes() + array.chunkBytes() / 8 + (1 << 16);
    if (bytes.size() > most)
        throw InputError(file.string(),
                         fmt::format("has {} bytes, and a chunk of this array {} when it is unpacked; "
                                     "it is of another array",
                                     bytes.size(), array.chunkBytes()));
    std::string packed(static_cast<std::size_t>(bytes.size()), '\0');
    packed.resize(bytes.read(0, packed.data(), packed.size()));
    return packed;
}

}  // namespace

std::int64_t ZarrArray::chunkVoxels() const {
    std::int64_t voxels = 1;
    for (const std::int64_t n : chunk) voxels *= n;
    return voxels;
}

fs::path ZarrArray::fileOf(const std::vector<std::int64_t>& numbers) const {
    return folder / fmt::format("{}", fmt::join(numbers, std::string(1, separator)));
}

std::vector<std::int64_t> ZarrArray::strides() const {
    std::vector<std::int64_t> all(axes());
    std::int64_t step = 1;
    for (std::size_t i = 0; i < axes(); ++i) {
        const std::size_t axis = firstFastest ? i : axes() - 1 - i;
        all[axis] = step;
        step *= chunk[axis];
    }
    return all;
}

ZarrArray readZarrArray(const fs::path& folder) {
    const ArrayKeys keys(folder / ".zarray");
    ZarrArray array;
    array.folder = folder;
    if (keys.at("zarr_format") != 2) keys.refuse("zarr_format", "2");
    array.shape = keys.sizes("shape");
    array.chunk = keys.sizes("chunks");
    if (array.chunk.size() != array.shape.size())
        keys.refuse("chunks", fmt::format("{} numbers, as its shape has", array.shape.size()));
    takeType(keys, array);
    takeCodec(keys, array);
    takeFill(keys, array);
    const json& order = keys.at("order");
    if (order != "C" && order != "F") keys.refuse("order", "\"C\" or \"F\"");
    array.firstFastest = order == "F";
    const json& separator = keys.at("dimension_separator");
    if (!separator.is_null() && separator != "." && separator != "/")
        keys.refuse("dimension_separator", "\".\" or \"/\"");
    array.separator = separator == "/" ? '/' : '.';
    const std::int64_t bytes =
        byteCount((folder / ".zarray").string(), array.chunk, static_cast<std::int64_t>(sizeOf(array.type)));
    if (2 * static_cast<double>(bytes) > usualMemoryLimit())  // packed and unpacked
        keys.refuse("chunks", "chunks that fit into memory");
    return array;
}

bool readZarrChunk(const ZarrArray& array, const std::vector<std::int64_t>& numbers, std::vector<char>& out) {
    const fs::path file = array.fileOf(numbers);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return false;
    out.resize(static_cast<std::size_t>(array.chunkBytes()));
    unpackChunk(array.codec, packedChunk(array, file), file.string(), out);
    const std::size_t each = sizeOf(array.type);
    if (each > 1 && array.bigEndian != (std::endian::native == std::endian::big))
        for (auto at = out.begin(); at != out.end(); at += static_cast<std::ptrdiff_t>(each))
            std::reverse(at, at + static_cast<std::ptrdiff_t>(each));
    return true;
}

}  // namespace isowave::imageio
