// A .vdb file as OpenVDB 10 writes it, and what this file relies on (little-endian):
//
//   at 0   int64    magic " BDV"
//   at 8   uint32   file version; uint32, uint32 library version
//   at 20  char     1: grids can be found by their offsets
//   at 21  36 chars UUID as text, random in OpenVDB's own files
//   at 57  the file's metadata, the number of grids, the grids
//
// Files written here carry two marks of their own. The UUID is of version 8 ("vendor specific", RFC 9562) and
// its other 122 bits are a hash of all other bytes; the metadatum isowave:file_bytes is the length of the
// file. The first finds damage before OpenVDB parses anything, which matters: io::bloscFromStream() reads as
// many bytes as a damaged file tells it to into a buffer of another size. The second tells truncation from
// other damage.
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <new>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"

namespace isowave {
namespace {

static_assert(std::endian::native == std::endian::little,
              "VDB files are written in the machine's byte order");

constexpr std::streamoff kUuidAt = 21, kUuidLength = 36, kHeaderBytes = kUuidAt + kUuidLength;
constexpr const char* kFileBytes = "isowave:file_bytes";

// ---------------------------------------------------------------------------------------------- the content
// hash

// Two 64-bit lanes, each h <- mix((h ^ word) * p) with p odd. For a fixed word that is a bijection of h, and
// for a fixed h one of the word; so any change within one aligned 8-byte word changes both lanes for certain,
// and other changes escape with probability 2^-122. Not cryptographic: it finds damage, not malice.
class ContentHash {
  public:
    void add(const char* bytes, std::size_t count) {  // REQUIRES: all calls but the last: count % 8 == 0
        for (; count >= 8; bytes += 8, count -= 8) {
            std::uint64_t word;
            std::memcpy(&word, bytes, 8);
            step(word);
        }
        if (count > 0) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes, count);
            step(word);
            step(count);
        }
    }
    // As a UUID of version 8: xxxxxxxx-xxxx-8xxx-yxxx-xxxxxxxxxxxx, y in 8..b.
    std::string uuid() const {
        const std::uint64_t a = (lane_[0] & ~0xF000ULL) | 0x8000ULL;
        const std::uint64_t b = (lane_[1] & ~(3ULL << 62)) | (2ULL << 62);
        return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", a >> 32, (a >> 16) & 0xFFFF, a & 0xFFFF,
                           b >> 48, b & 0xFFFFFFFFFFFFULL);
    }

  private:
    void step(std::uint64_t word) {
        for (int i = 0; i < 2; ++i) {
            lane_[i] = (lane_[i] ^ word) * kPrime[i];
            lane_[i] ^= lane_[i] >> 29;
        }
    }
    // The odd multipliers of xxHash64 (its PRIME64_1 and _2): any odd number keeps the claim above.
    static constexpr std::uint64_t kPrime[2] = {0x9E3779B185EBCA87ULL, 0xC2B2AE3D27D4EB4FULL};
    std::uint64_t lane_[2] = {1, 2};
};

// The UUID that belongs to a file: the hash of its bytes with those of the UUID taken as zeros.
std::string uuidOfContent(std::istream& file) {
    ContentHash hash;
    std::vector<char> block(1 << 16);
    bool first = true;
    file.clear();
    file.seekg(0);
    while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
        const auto count = static_cast<std::size_t>(file.gcount());
        if (first && count >= kHeaderBytes) std::fill_n(block.begin() + kUuidAt, kUuidLength, '\0');
        first = false;
        hash.add(block.data(), count);
    }
    return hash.uuid();
}

// -------------------------------------------------------------------------------------------------------
// reading

// One line whatever a library's message holds.
std::string oneLine(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
    if (text.size() > 200) text = text.substr(0, 200) + "...";
    return text;
}

// What the first bytes of a file say.
struct Preamble {
    std::int64_t length = 0;  // of the file on disk
    std::string uuid;
    std::optional<std::int64_t> writtenLength;  // isowave:file_bytes

    // A file that another program wrote again from what it read here keeps our metadata under a UUID of its own:
    // it is that program's file, unless its length is still the one that we wrote.
    bool ours() const {
        return (uuid.size() == kUuidLength && uuid[14] == '8') || (writtenLength && *writtenLength == length);
    }
};

// Where the 8 bytes of isowave:file_bytes lie in `text`, a MetaMap as written; npos if it is not there.
// An entry is: uint32 length, name, uint32 length, type name ("int64"), uint32 length of the value, value.
std::size_t fileBytesAt(const std::string& text) {
    const std::size_t name = text.find(kFileBytes);
    if (name == std::string::npos) return name;
    const std::size_t value = name + std::strlen(kFileBytes) + 4 + std::strlen("int64") + 4;
    return value + 8 <= text.size() ? value : std::string::npos;
}

Preamble readPreamble(const std::filesystem::path& path, std::ifstream& file) {
    const std::string name = path.string();
    Preamble result;
    result.length = static_cast<std::int64_t>(std::filesystem::file_size(path));
    if (result.length == 0) throw InputError(name, "is empty; expected a .vdb file");

    std::string start(1 << 14, '\0');
    file.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(file.gcount()));
    const std::int64_t magic = openvdb::OPENVDB_MAGIC;
    if (start.compare(0, 8, std::string(reinterpret_cast<const char*>(&magic), 8), 0,
                      std::min<std::size_t>(8, start.size())) != 0)
        throw InputError(name, "is not a .vdb file: it does not begin with OpenVDB's magic number");
    if (result.length < kHeaderBytes + 8)
        throw InputError(name, fmt::format("holds {} bytes, fewer than a .vdb file's header; it is truncated",
                                           result.length));
    std::uint32_t version;
    std::memcpy(&version, start.data() + 8, 4);
    if (version > openvdb::OPENVDB_FILE_VERSION)
        throw InputError(
            name, fmt::format("has .vdb file version {}, and this program reads up to {}; it is damaged or "
                              "was written by a newer OpenVDB",
                              version, static_cast<unsigned>(openvdb::OPENVDB_FILE_VERSION)));
    result.uuid = start.substr(kUuidAt, kUuidLength);
    if (const std::size_t at = fileBytesAt(start); at != std::string::npos) {
        std::int64_t length;
        std::memcpy(&length, start.data() + at, 8);
        result.writtenLength = length;
    }
    return result;
}

// Our own files: whole, to the byte, or refused.
void checkOwnFile(const std::filesystem::path& path, std::ifstream& file, const Preamble& preamble) {
    if (preamble.writtenLength && *preamble.writtenLength > preamble.length)
        throw InputError(path.string(), fmt::format("was written with {} bytes but holds {}; it is truncated",
                                                    *preamble.writtenLength, preamble.length));
    if (uuidOfContent(file) != preamble.uuid)
        throw InputError(
            path.string(),
            "is damaged: its content does not match the hash in its header; copy or write it again");
}

// Files of others: OpenVDB's File writes where each grid ends, so that truncation is known before a tree is
// built. That is more than politeness: a tree whose reading breaks off leaks its unfinished nodes.
// io::Stream's files lack the ends; there the short read itself is what tells.
class GridEnds : public openvdb::io::Archive {
  public:
    // REQUIRES: exceptions on for short reads.
    void check(const std::string& name, std::istream& file, std::int64_t length) {
        file.seekg(0);
        readHeader(file);
        setFormatVersion(file);
        setLibraryVersion(file);
        if (!inputHasGridOffsets()) return;
        openvdb::MetaMap().readMeta(file);
        for (std::int32_t count = readGridCount(file); count > 0; --count) {
            openvdb::io::GridDescriptor grid;
            grid.read(file);
            if (grid.getEndPos() > length)
                throw InputError(
                    name, fmt::format("grid '{}' ends at byte {} but the file holds {}; it is truncated",
                                      oneLine(grid.gridName()), grid.getEndPos(), length));
            if (grid.getEndPos() < file.tellg())
                throw InputError(name, fmt::format("grid '{}' ends before it begins; the file is damaged",
                                                   oneLine(grid.gridName())));
            grid.seekToEnd(file);
        }
    }
};

VdbContent parse(std::ifstream& file) {
    file.seekg(0);
    openvdb::io::Stream stream(file, /*delayLoad=*/false);
    VdbContent content{*stream.getGrids(), stream.getMetadata()};
    content.metadata->removeMeta(kFileBytes);
    return content;
}

}  // namespace

VdbContent readVdb(const std::filesystem::path& path) {
    initializeVdb();
    const std::string name = path.string();
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw InputError(name, "no such file");
    if (!std::filesystem::is_regular_file(path, error))
        throw InputError(name, "is not a file; expected a .vdb file");
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(name, "cannot be opened; check its permissions");

    const Preamble preamble = readPreamble(path, file);
    if (preamble.ours()) checkOwnFile(path, file, preamble);
    try {
        // OpenVDB does not look at what read() says; with exceptions on, no short read goes unseen.
        file.clear();
        file.exceptions(std::ios::failbit | std::ios::badbit);
        if (!preamble.ours()) GridEnds().check(name, file, preamble.length);
        return parse(file);
    } catch (const std::ios_base::failure&) {
        throw InputError(
            name, fmt::format("ends too early, after {} bytes; it is truncated or damaged", preamble.length));
    } catch (const std::bad_alloc&) {
        throw InputError(name,
                         "asks for more memory than there is; it is damaged or too large for this machine");
    } catch (const std::exception& e) {
        throw InputError(name, "is damaged or of an unknown kind: " + oneLine(e.what()));
    }
}

// -------------------------------------------------------------------------------------------------------
// writing

namespace {

// openvdb::io::File opens its file itself and looks at the stream at the end, if at all. This one writes to
// ours.
class StreamArchive : public openvdb::io::Archive {
  public:
    StreamArchive() {
        setCompression(openvdb::io::COMPRESS_ACTIVE_MASK |
                       (hasBloscCompression()  ? openvdb::io::COMPRESS_BLOSC
                        : hasZLibCompression() ? openvdb::io::COMPRESS_ZIP
                                               : openvdb::io::COMPRESS_NONE));
    }
    void writeTo(std::ostream& stream, const openvdb::GridCPtrVec& grids,
                 const openvdb::MetaMap& metadata) const {
        write(stream, grids, /*seekable=*/true, metadata);
    }
};

// pass 1: the content; pass 2: its length; pass 3: the hash of both in place of the random UUID.
void writeContent(AtomicFile& file, const openvdb::GridCPtrVec& grids, openvdb::MetaMap metadata) {
    std::ostream& stream = file.stream();
    metadata.insertMeta(kFileBytes, openvdb::Int64Metadata(0));
    StreamArchive().writeTo(stream, grids, metadata);

    stream.seekp(0, std::ios::end);
    const std::int64_t length = stream.tellp();
    std::ostringstream metadataText;
    metadata.writeMeta(metadataText);
    stream.seekp(kHeaderBytes + static_cast<std::streamoff>(fileBytesAt(metadataText.str())));
    stream.write(reinterpret_cast<const char*>(&length), 8);
    stream.flush();

    std::ifstream written(file.temporary(), std::ios::binary);
    const std::string uuid = uuidOfContent(written);
    stream.seekp(kUuidAt);
    stream.write(uuid.data(), kUuidLength);
}

}  // namespace

void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata) {
    initializeVdb();
    AtomicFile file(path);
    try {
        writeContent(file, grids, metadata);
    } catch (const std::ios_base::failure&) {
        throw OperationError(path.string(), "writing failed; is the disk full? Nothing was left behind");
    }
    file.commit();
}

void writeField(const std::filesystem::path& path, const BSplineField& field) {
    // A shallow copy: it shares the tree, and what is added to its metadata stays out of the caller's grid.
    const openvdb::FloatGrid::Ptr grid = field.controlPoints->copy();
    grid->setName("field");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->insertMeta("isowave:K", openvdb::DoubleMetadata(field.K));
    writeVdb(path, {grid});
}

// ----------------------------------------------------------------------------------------------------- level
// sets

namespace {

std::string describe(const openvdb::GridPtrVec& grids) {
    std::string text;
    for (const auto& grid : grids)
        text += fmt::format("{}'{}' ({}{})", text.empty() ? "" : ", ", oneLine(grid->getName()),
                            grid->valueType(),
                            grid->getGridClass() == openvdb::GRID_UNKNOWN
                                ? std::string()
                                : ", " + openvdb::GridBase::gridClassToString(grid->getGridClass()));
    return text;
}

// As float, whatever it was stored in; null when it is neither float nor double.
openvdb::FloatGrid::Ptr asFloat(const openvdb::GridBase::Ptr& grid) {
    if (auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return floats;
    if (auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid))
        return openvdb::FloatGrid::Ptr(new openvdb::FloatGrid(*doubles));
    return nullptr;
}

bool hasNegativeValue(const openvdb::FloatGrid& grid) {
    for (auto value = grid.cbeginValueAll(); value; ++value)
        if (*value < 0) return true;
    return false;
}

bool isLevelSet(const openvdb::FloatGrid& grid) {
    switch (grid.getGridClass()) {
        case openvdb::GRID_LEVEL_SET:
            return true;
        case openvdb::GRID_UNKNOWN:
            return grid.background() > 0 && hasNegativeValue(grid);
        default:
            return false;
    }
}

void checkFinite(const std::string& file, const openvdb::FloatGrid& grid) {
    for (auto value = grid.cbeginValueAll(); value; ++value)
        if (!std::isfinite(*value)) {
            const openvdb::Coord at = value.getCoord();
            throw InputError(
                file, fmt::format("grid '{}' holds {} at voxel ({}, {}, {}); a level set must be finite",
                                  oneLine(grid.getName()), *value, at.x(), at.y(), at.z()));
        }
}

openvdb::FloatGrid::Ptr pickNamed(const std::string& file, const openvdb::GridPtrVec& grids,
                                  const std::string& name) {
    openvdb::GridPtrVec named;
    for (const auto& grid : grids)
        if (grid->getName() == name) named.push_back(grid);
    if (named.empty())
        throw InputError(file, fmt::format("has no grid '{}'; it holds {}", name, describe(grids)));
    if (named.size() > 1) throw InputError(file, fmt::format("has {} grids '{}'", named.size(), name));
    if (auto grid = asFloat(named.front())) return grid;
    throw InputError(
        file, fmt::format("grid '{}' holds {}; expected float or double", name, named.front()->valueType()));
}

openvdb::FloatGrid::Ptr pickOnly(const std::string& file, const openvdb::GridPtrVec& grids) {
    openvdb::GridPtrVec found;
    openvdb::FloatGrid::Ptr result;
    for (const auto& grid : grids)
        if (const auto floats = asFloat(grid); floats && isLevelSet(*floats)) {
            found.push_back(grid);
            result = floats;
        }
    if (grids.empty()) throw InputError(file, "holds no grids; expected a level set");
    if (found.empty())
        throw InputError(file, fmt::format("holds no level set but {}; name the grid to use one all the same",
                                           describe(grids)));
    if (found.size() > 1)
        throw InputError(
            file, fmt::format("holds {} level sets: {}; name the one to use", found.size(), describe(found)));
    return result;
}

}  // namespace

openvdb::FloatGrid::Ptr readLevelSet(const std::filesystem::path& path,
                                     const std::optional<std::string>& gridName) {
    const VdbContent content = readVdb(path);
    const std::string file = path.string();
    const auto grid = gridName ? pickNamed(file, content.grids, *gridName) : pickOnly(file, content.grids);
    checkFinite(file, *grid);
    return grid;
}

}  // namespace isowave
