// A .vdb file as OpenVDB 10 writes it, and what this file relies on (little-endian):
//
//   at 0   int64    magic " BDV"
//   at 8   uint32   file version; uint32, uint32 library version
//   at 20  char     1: grids can be found by their offsets
//   at 21  36 chars UUID as text, random in OpenVDB's own files
//   at 57  the file's metadata, the number of grids, the grids
//
// Files written here carry three marks of their own. The metadatum isowave:parts says of the bytes before the
// first grid and of each grid, descriptor included, where they end and what their hash is (of the former with
// those of the UUID and of this text taken as zeros): what is read is found whole before it is parsed,
// without reading the rest. The UUID is of version 8 ("vendor specific", RFC 9562) and its other 122 bits are
// a hash of that text. The metadatum isowave:file_bytes is the length of the file. The hashes find damage
// before OpenVDB parses anything, which matters: io::bloscFromStream() reads as many bytes as a damaged file
// tells it to into a buffer of another size. The length tells truncation from other damage.
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <new>
#include <sstream>

#include "base/atomic_file.h"
#include "base/file_bytes.h"
#include "isowave/error.h"
#include "volume/content_hash.h"
#include "volume/foreign/vdb_errors.h"
#include "volume/grid_bytes.h"

namespace isowave {
namespace {

static_assert(std::endian::native == std::endian::little,
              "VDB files are written in the machine's byte order");

constexpr std::streamoff kUuidAt = 21, kUuidLength = 36, kHeaderBytes = kUuidAt + kUuidLength;
constexpr const char* kFileBytes = "isowave:file_bytes";
constexpr const char* kParts = "isowave:parts";

// ---- reading

// What the first bytes of a file say.
struct Preamble {
    std::int64_t length = 0;  // of the file on disk
    std::string uuid;
    std::optional<std::int64_t> writtenLength;  // isowave:file_bytes
    std::int64_t partsAt = 0, partsLength = 0;  // where the text of isowave:parts lies; 0 without it

    // A file that another program wrote again from what it read here keeps our metadata under a UUID of its
    // own: it is that program's file, unless its length is still the one that we wrote.
    bool ours() const {
        return (uuid.size() == kUuidLength && uuid[14] == '8') || (writtenLength && *writtenLength == length);
    }
};

// Where the value of metadatum `name` of type `type` begins in `text`, a MetaMap as written; npos if it is
// not there.
// An entry is: uint32 length, name, uint32 length, type name, uint32 length of the value, value.
std::size_t valueAt(const std::string& text, const char* name, const char* type) {
    const std::size_t at = text.find(name);
    if (at == std::string::npos) return at;
    const std::size_t value = at + std::strlen(name) + 4 + std::strlen(type) + 4;
    return value <= text.size() ? value : std::string::npos;
}
std::size_t fileBytesAt(const std::string& text) {
    const std::size_t at = valueAt(text, kFileBytes, "int64");
    return at != std::string::npos && at + 8 <= text.size() ? at : std::string::npos;
}

Preamble readPreamble(const std::string& name, const FileBytes& file) {
    Preamble result;
    result.length = file.size();
    if (result.length == 0) throw InputError(name, "is empty; expected a .vdb file");

    std::string start(1 << 14, '\0');
    start.resize(file.read(0, start.data(), start.size()));
    const std::int64_t magic = openvdb::OPENVDB_MAGIC;
    if (start.compare(0, 8, std::string(reinterpret_cast<const char*>(&magic), 8), 0,
                      std::min<std::size_t>(8, start.size())) != 0)
        throw InputError(name,
                         "is not a .vdb file: it does not begin with OpenVDB's magic number; isowave analyse "
                         "makes a pyramid of an image or a mesh");
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
    if (const std::size_t at = valueAt(start, kParts, "string"); at != std::string::npos) {
        std::uint32_t length;
        std::memcpy(&length, start.data() + at - 4, 4);
        if (static_cast<std::int64_t>(at) + length <= result.length) {
            result.partsAt = static_cast<std::int64_t>(at);
            result.partsLength = length;
        }
    }
    return result;
}

// A stretch of a file with the hash that its bytes should have.
struct Part {
    std::int64_t begin = 0, end = 0;
    std::string hash;
};

// Short reads are failures of the stream's kind.
void readAll(const FileBytes& file, std::int64_t at, char* to, std::size_t count) {
    if (file.read(at, to, count) != count) throw std::ios_base::failure("short read");
}

std::string hashOf(const FileBytes& file, const Part& part, const std::vector<Part>& zeros = {}) {
    ContentHash hash;
    std::vector<char> block(1 << 16);
    for (std::int64_t at = part.begin; at < part.end;) {
        const auto count = std::min<std::int64_t>(static_cast<std::int64_t>(block.size()), part.end - at);
        readAll(file, at, block.data(), static_cast<std::size_t>(count));
        for (const Part& z : zeros)
            for (std::int64_t i = std::max(at, z.begin); i < std::min(at + count, z.end); ++i)
                block[i - at] = 0;
        hash.add(block.data(), static_cast<std::size_t>(count));
        at += count;
    }
    return hash.hex();
}

// The parts of a file: what lies before the first grid, then each grid. As text, isowave:parts, 16
// hexadecimal digits of where a part ends and 32 of its hash, part by part.
class PartTable {
  public:
    static constexpr std::size_t kEndLength = 16, kEntryLength = kEndLength + ContentHash::kHexLength;

    std::vector<Part> parts;
    std::int64_t textAt = 0, textLength = 0;

    std::string text() const {
        std::string result;
        for (const Part& part : parts) result += fmt::format("{:016x}{}", part.end, part.hash);
        return result;
    }
    // The hash of the first part, with the UUID and the table's own text taken as zeros.
    std::string hashOfHead(const FileBytes& file) const {
        return hashOf(file, parts.front(),
                      {{kUuidAt, kUuidAt + kUuidLength, {}}, {textAt, textAt + textLength, {}}});
    }
    // The UUID of a file: the hash of this text.
    static std::string uuidOf(const std::string& text) {
        ContentHash hash;
        hash.add(text.data(), text.size());
        return hash.uuid();
    }
    // The table of a file, found to be true of itself and of the first part; nothing where it is not.
    static std::optional<PartTable> read(const FileBytes& file, const Preamble& preamble) {
        PartTable table;
        table.textAt = preamble.partsAt;
        table.textLength = preamble.partsLength;
        std::string text(static_cast<std::size_t>(table.textLength), '\0');
        readAll(file, table.textAt, text.data(), text.size());
        if (text.empty() || text.size() % kEntryLength != 0 || uuidOf(text) != preamble.uuid) return {};
        std::int64_t begin = 0;
        for (std::size_t at = 0; at < text.size(); at += kEntryLength) {
            std::int64_t end = -1;
            std::from_chars(text.data() + at, text.data() + at + kEndLength, end, 16);
            if (end < begin || end > preamble.length) return {};
            table.parts.push_back({begin, end, text.substr(at + kEndLength, ContentHash::kHexLength)});
            begin = end;
        }
        if (begin != preamble.length || table.hashOfHead(file) != table.parts.front().hash) return {};
        return table;
    }
};

InputError damaged(const std::filesystem::path& path) {
    return InputError(
        path.string(),
        "is damaged: its content does not match the hash in its header; copy or write it again");
}

// The table of a file of ours, which is as long as it was written.
PartTable tableOf(const std::filesystem::path& path, const FileBytes& file, const Preamble& preamble) {
    if (preamble.writtenLength && *preamble.writtenLength > preamble.length)
        throw InputError(path.string(), fmt::format("was written with {} bytes but holds {}; it is truncated",
                                                    *preamble.writtenLength, preamble.length));
    auto table = PartTable::read(file, preamble);
    if (!table) throw damaged(path);
    return *std::move(table);
}

void removeOwnMarks(openvdb::MetaMap& metadata) {
    metadata.removeMeta(kFileBytes);
    metadata.removeMeta(kParts);
}

FileBytes openVdb(const std::filesystem::path& path) {
    initializeVdb();
    return FileBytes(path, "a .vdb file");
}

}  // namespace

// ---- reading in parts

namespace {

// Reads single grids.
class GridReader : public openvdb::io::Archive {
  public:
    // Reads the file's metadata.
    openvdb::MetaMap readMetadata(std::istream& file) {
        start(file);
        openvdb::MetaMap metadata;
        metadata.readMeta(file);
        return metadata;
    }
    openvdb::GridBase::Ptr readGrid(std::istream& file, std::int64_t at) {
        start(file);
        file.seekg(at);
        openvdb::io::GridDescriptor descriptor;
        descriptor.read(file);
        auto grid = openvdb::GridBase::createGrid(descriptor.gridType());
        grid->setSaveFloatAsHalf(descriptor.saveFloatAsHalf());
        Archive::readGrid(grid, descriptor, file);
        return grid;
    }

  private:
    void start(std::istream& file) {
        file.seekg(0);
        readHeader(file);
        setFormatVersion(file);
        setLibraryVersion(file);
        openvdb::io::setDataCompression(file, compression());
    }
};

// The name of the grid whose descriptor begins at `part`. Its bytes were not checked: a length that is out of
// the question reads as no name.
std::string gridNameAt(const FileBytes& file, const Part& part) {
    std::uint32_t length = 0;
    readAll(file, part.begin, reinterpret_cast<char*>(&length), sizeof length);
    constexpr std::uint32_t kLongest = 1 << 12;
    if (length > kLongest || length > part.end - part.begin - std::int64_t(sizeof length)) return {};
    std::string name(length, '\0');
    readAll(file, part.begin + std::int64_t(sizeof length), name.data(), length);
    return openvdb::io::GridDescriptor::nameAsString(name);
}

// The grids of these parts, by several threads; null where the bytes do not match their hash.
openvdb::GridPtrVec readParts(const FileBytes& file, const std::vector<Part>& parts) {
    openvdb::GridPtrVec grids(parts.size());
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        if (hashOf(file, parts[i]) != parts[i].hash) return;
        FileStream stream(file);
        grids[i] = GridReader().readGrid(stream, parts[i].begin);
    });
    return grids;
}

VdbContent readOwn(const std::filesystem::path& path, const FileBytes& file, const Preamble& preamble) {
    const PartTable table = tableOf(path, file, preamble);
    FileStream stream(file);
    const auto metadata = std::make_shared<openvdb::MetaMap>(GridReader().readMetadata(stream));
    const auto grids = readParts(file, {table.parts.begin() + 1, table.parts.end()});
    if (std::find(grids.begin(), grids.end(), nullptr) != grids.end()) throw damaged(path);
    return {grids, metadata};
}

}  // namespace

VdbContent readVdb(const std::filesystem::path& path) {
    const FileBytes file = openVdb(path);
    const Preamble preamble = readPreamble(path.string(), file);
    return vdbGuarded(path.string(), file.size(), [&] {
        VdbContent content;
        if (preamble.ours()) {
            content = readOwn(path, file, preamble);
        } else {
            content = readForeignVdb(path.string(), file);
        }
        removeOwnMarks(*content.metadata);
        return content;
    });
}

struct VdbParts::State {
    explicit State(const std::filesystem::path& place) : path(place), file(openVdb(place)) {}

    std::filesystem::path path;
    FileBytes file;
    std::int64_t bytesRead = 0;
    openvdb::MetaMap metadata;
    std::vector<std::pair<std::string, Part>> grids;  // by name
    std::optional<VdbContent> whole;                  // of files that are not ours
};

VdbParts::VdbParts(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {
    State& s = *state_;
    const Preamble preamble = readPreamble(path.string(), s.file);
    if (!preamble.ours() || preamble.writtenLength != preamble.length) {
        s.whole = readVdb(path);
        s.bytesRead = preamble.length;
        return;
    }
    vdbGuarded(path.string(), preamble.length, [&] {
        const PartTable table = tableOf(path, s.file, preamble);
        FileStream stream(s.file);
        s.metadata = GridReader().readMetadata(stream);
        for (std::size_t i = 1; i < table.parts.size(); ++i)
            s.grids.emplace_back(gridNameAt(s.file, table.parts[i]), table.parts[i]);
        s.bytesRead = table.parts.front().end;
    });
    removeOwnMarks(s.metadata);
}

VdbParts::~VdbParts() = default;

const openvdb::MetaMap& VdbParts::metadata() const {
    return state_->whole ? *state_->whole->metadata : state_->metadata;
}

std::int64_t VdbParts::bytesRead() const { return state_->bytesRead; }

std::vector<openvdb::GridBase::Ptr> VdbParts::read(const std::vector<std::string>& gridNames) {
    State& s = *state_;
    std::vector<openvdb::GridBase::Ptr> result(gridNames.size());
    if (s.whole) {
        for (std::size_t i = 0; i < gridNames.size(); ++i)
            for (const auto& grid : s.whole->grids)
                if (!result[i] && grid->getName() == gridNames[i]) result[i] = grid;
        return result;
    }
    std::vector<Part> parts;
    std::vector<std::size_t> asked;  // of each part
    for (std::size_t i = 0; i < gridNames.size(); ++i) {
        const auto at = std::find_if(s.grids.begin(), s.grids.end(),
                                     [&](const auto& grid) { return grid.first == gridNames[i]; });
        if (at == s.grids.end()) continue;
        parts.push_back(at->second);
        asked.push_back(i);
        s.bytesRead += at->second.end - at->second.begin;
    }
    const auto grids = vdbGuarded(s.path.string(), s.file.size(), [&] { return readParts(s.file, parts); });
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (!grids[p])
            throw InputError(
                s.path.string(),
                fmt::format("is damaged: grid '{}' does not match its hash; copy or write it again",
                            oneLine(gridNames[asked[p]])));
        result[asked[p]] = grids[p];
    }
    return result;
}

// ---- writing

namespace {

// openvdb::io::File opens its file itself and looks at the stream at the end, if at all. This one writes to
// ours.
class StreamArchive : public openvdb::io::Archive {
  public:
    StreamArchive() {
        // Neither Blosc nor zip: on coefficients they gain nothing. The pyramid of 19.6 million control
        // points is 137.3 MB with Blosc (8 bytes more a leaf), 135.4 with zip, 136.4 with neither, and
        // OpenVDB writes it in 1.1, 7.9 and 0.6 s.
        setCompression(openvdb::io::COMPRESS_ACTIVE_MASK);
        setInstancingEnabled(false);  // each part can be read alone
    }
    void writeTo(std::ostream& stream, const openvdb::GridCPtrVec& grids,
                 const openvdb::MetaMap& metadata) const {
        openvdb::GridCPtrVec parallel;
        for (const auto& grid : grids) parallel.push_back(writtenInParallel(grid));
        write(stream, parallel, /*seekable=*/true, metadata);
    }
};

// Where the parts of a file that was just written lie.
class WrittenParts : public openvdb::io::Archive {
  public:
    std::vector<Part> read(std::istream& file) {
        file.seekg(0);
        readHeader(file);
        setFormatVersion(file);
        setLibraryVersion(file);
        openvdb::MetaMap().readMeta(file);
        const std::int32_t count = readGridCount(file);
        std::vector<Part> parts{{0, file.tellg(), {}}};
        for (std::int32_t i = 0; i < count; ++i) {
            openvdb::io::GridDescriptor grid;
            grid.read(file);
            grid.seekToEnd(file);
            parts.push_back({parts.back().end, grid.getEndPos(), {}});
        }
        return parts;
    }
};

// pass 1: the content; pass 2: its length; pass 3: the hashes of its parts and their hash in place of the
// random UUID.
void writeContent(AtomicFile& file, const openvdb::GridCPtrVec& grids, openvdb::MetaMap metadata) {
    std::ostream& stream = file.stream();
    metadata.insertMeta(kFileBytes, openvdb::Int64Metadata(0));
    PartTable table;
    table.textLength = static_cast<std::int64_t>((1 + grids.size()) * PartTable::kEntryLength);
    metadata.insertMeta(kParts, openvdb::StringMetadata(std::string(std::size_t(table.textLength), '0')));
    StreamArchive().writeTo(stream, grids, metadata);

    stream.seekp(0, std::ios::end);
    const std::int64_t length = stream.tellp();
    std::ostringstream text;
    metadata.writeMeta(text);
    stream.seekp(kHeaderBytes + static_cast<std::streamoff>(fileBytesAt(text.str())));
    stream.write(reinterpret_cast<const char*>(&length), 8);
    stream.flush();

    const FileBytes written(file.temporary(), "a .vdb file");
    FileStream ends(written);
    table.textAt = kHeaderBytes + static_cast<std::int64_t>(valueAt(text.str(), kParts, "string"));
    table.parts = WrittenParts().read(ends);
    table.parts.front().hash = table.hashOfHead(written);
    tbb::parallel_for(std::size_t{1}, table.parts.size(),
                      [&](std::size_t i) { table.parts[i].hash = hashOf(written, table.parts[i]); });

    const std::string parts = table.text(), uuid = PartTable::uuidOf(parts);
    stream.seekp(table.textAt);
    stream.write(parts.data(), static_cast<std::streamsize>(parts.size()));
    stream.seekp(kUuidAt);
    stream.write(uuid.data(), kUuidLength);
}

void writeWhole(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
                const openvdb::MetaMap& metadata, bool wait) {
    initializeVdb();
    AtomicFile file(path);
    try {
        writeContent(file, grids, metadata);
    } catch (const std::ios_base::failure&) {
        throw OperationError(path.string(), "writing failed; is the disk full? Nothing was left behind");
    }
    file.commit(wait);
}

}  // namespace

void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata) {
    writeWhole(path, grids, metadata, true);
}

void writeVdbForNow(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
                    const openvdb::MetaMap& metadata) {
    writeWhole(path, grids, metadata, false);
}

void writeField(const std::filesystem::path& path, const BSplineField& field) {
    // A shallow copy: it shares the tree, and what is added to its metadata stays out of the caller's grid.
    const openvdb::FloatGrid::Ptr grid = field.controlPoints->copy();
    grid->setName("field");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->insertMeta("isowave:K", openvdb::DoubleMetadata(field.K));
    writeVdb(path, {grid});
}

// ---- level sets

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
        throw InputError(file,
                         fmt::format("holds no level set, only {}; name the grid to use one all the same",
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
