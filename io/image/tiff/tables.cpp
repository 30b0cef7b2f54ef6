// TIFF files before libtiff sees them: whether all that their tables point to lies in the file.
#include "io/image/tiff/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>
#include <vector>

#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void throwCut(const fs::path& path, std::int64_t needed, std::int64_t length) {
    throw InputError(
        path.string(),
        fmt::format("its tables point to byte {} but the file holds {}; it is truncated", needed, length));
}

// Numbers at places of a file, none beyond its end.
class Bytes {
  public:
    explicit Bytes(const fs::path& path)
        : path_(path),
          file_(path, std::ios::binary),
          length_(static_cast<std::int64_t>(fs::file_size(path))) {}

    bool bigEndian = false;

    std::uint64_t number(std::uint64_t at, unsigned bytes) {
        require(at, bytes);
        unsigned char raw[8] = {};
        file_.seekg(static_cast<std::streamoff>(at));
        file_.read(reinterpret_cast<char*>(raw), static_cast<std::streamsize>(bytes));
        std::uint64_t value = 0;
        for (unsigned i = 0; i < bytes; ++i) value = value << 8 | raw[bigEndian ? i : bytes - 1 - i];
        return value;
    }
    // Throws InputError unless `count` bytes from `at` on are there.
    void require(std::uint64_t at, std::uint64_t count) const {
        const auto length = static_cast<std::uint64_t>(length_);
        if (at > length || count > length - at)
            throwCut(path_, static_cast<std::int64_t>(std::min<std::uint64_t>(at + count, INT64_MAX)),
                     length_);
    }
    std::int64_t length() const { return length_; }

  private:
    fs::path path_;
    std::ifstream file_;
    std::int64_t length_;
};

// TIFF 6.0, section 2, and BigTIFF, which widens counts and offsets to 8 bytes.
struct TiffLayout {
    unsigned word;        // bytes of an offset and of a value that lies in its entry
    unsigned countBytes;  // of the number of entries of a directory
    unsigned entryBytes() const { return 4 + 2 * word; }
};

struct TiffArray {
    std::uint64_t count = 0, at = 0;
    unsigned bytesEach = 0;
};

unsigned tiffTypeBytes(std::uint64_t type) {
    static constexpr unsigned kBytes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    return type < std::size(kBytes) ? kBytes[type] : 0;
}

// One entry of a directory: tag, type, count, and the values or where they are.
TiffArray entryAt(Bytes& file, const TiffLayout& layout, std::uint64_t at) {
    TiffArray array;
    array.bytesEach = tiffTypeBytes(file.number(at + 2, 2));
    array.count = file.number(at + 4, layout.word);
    array.at = at + 4 + layout.word;
    if (array.bytesEach == 0) return array;  // a type of the future: readers skip it
    if (array.count > static_cast<std::uint64_t>(file.length())) file.require(array.count, 0);
    if (array.count * array.bytesEach > layout.word) array.at = file.number(array.at, layout.word);
    file.require(array.at, array.count * array.bytesEach);
    return array;
}

void checkStrips(Bytes& file, const TiffArray& offsets, const TiffArray& counts) {
    for (std::uint64_t i = 0; i < std::min(offsets.count, counts.count); ++i)
        file.require(file.number(offsets.at + i * offsets.bytesEach, offsets.bytesEach),
                     file.number(counts.at + i * counts.bytesEach, counts.bytesEach));
}

// Returns where the next directory is, 0 after the last.
std::uint64_t checkDirectory(Bytes& file, const TiffLayout& layout, std::uint64_t at) {
    const std::uint64_t entries = file.number(at, layout.countBytes);
    file.require(at, layout.countBytes + entries * layout.entryBytes() + layout.word);
    TiffArray offsets, counts;
    for (std::uint64_t i = 0; i < entries; ++i) {
        const std::uint64_t entry = at + layout.countBytes + i * layout.entryBytes();
        const std::uint64_t tag = file.number(entry, 2);
        const TiffArray array = entryAt(file, layout, entry);
        if (tag == 273 || tag == 324) offsets = array;  // of strips, of tiles
        if (tag == 279 || tag == 325) counts = array;
    }
    if (offsets.bytesEach > 0 && counts.bytesEach > 0) checkStrips(file, offsets, counts);
    return file.number(at + layout.countBytes + entries * layout.entryBytes(), layout.word);
}

}  // namespace

void checkTiff(const fs::path& path) {
    Bytes file(path);
    file.bigEndian = file.number(0, 1) == 'M';
    const std::uint64_t magic = file.number(2, 2);
    if (file.number(0, 1) != file.number(1, 1) || (magic != 42 && magic != 43))
        throw InputError(path.string(), "is not a TIFF file: it begins with neither 'II*' nor 'MM*'");
    const TiffLayout layout = magic == 42 ? TiffLayout{4, 2} : TiffLayout{8, 8};
    std::set<std::uint64_t> seen;
    for (std::uint64_t at = file.number(magic == 42 ? 4 : 8, layout.word); at != 0;) {
        if (!seen.insert(at).second)
            throw InputError(path.string(), "its directories point to each other in a circle; it is damaged");
        at = checkDirectory(file, layout, at);
    }
    if (seen.empty()) throw InputError(path.string(), "holds no image: its first directory is missing");
}

}  // namespace isowave::imageio
