#include "volume/foreign/foreign_vdb.h"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/forked_child.h"
#include "volume/foreign/vdb_errors.h"

namespace isowave {
namespace {

// ---- in the child

VdbContent parse(std::istream& file) {
    file.seekg(0);
    openvdb::io::Stream stream(file, /*delayLoad=*/false);
    return {*stream.getGrids(), stream.getMetadata()};
}

// OpenVDB takes the places of a root's children as they stand in the file, and finds nothing again where one is no
// multiple of a child's width.
template <class Tree>
void requireAligned(const Tree& tree) {
    constexpr auto kInside = static_cast<openvdb::Int32>(Tree::RootNodeType::ChildNodeType::DIM - 1);
    const auto require = [](const openvdb::Coord& at) {
        if ((at.x() & kInside) || (at.y() & kInside) || (at.z() & kInside))
            throw std::runtime_error(fmt::format("a node lies at ({}, {}, {}), which is no multiple of {}",
                                                 at.x(), at.y(), at.z(), kInside + 1));
    };
    for (auto child = tree.root().cbeginChildOn(); child; ++child) require(child.getCoord());
    for (auto tile = tree.root().cbeginValueAll(); tile; ++tile) require(tile.getCoord());
}

// Of the kinds that anybody here looks into.
void requireAligned(const openvdb::GridPtrVec& grids) {
    for (const auto& grid : grids) {
        if (const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
            requireAligned(floats->tree());
        if (const auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid))
            requireAligned(doubles->tree());
    }
}

// Statistics would be taken by several threads, which a fork does not have.
void writePlain(std::ostream& to, const VdbContent& content) {
    openvdb::io::Stream stream(to);
    stream.setCompression(openvdb::io::COMPRESS_NONE);
    stream.setGridStatsMetadataEnabled(false);
    stream.write(content.grids, *content.metadata);
}

// ---- memory that a child shares with its parent

class SharedMemory {
  public:
    SharedMemory() : descriptor_(::memfd_create("isowave", MFD_CLOEXEC)) {
        if (descriptor_ < 0)
            throw OperationError(fmt::format("no shared memory can be had: {}", ::strerror(errno)));
    }
    ~SharedMemory() { ::close(descriptor_); }
    SharedMemory(const SharedMemory&) = delete;
    SharedMemory& operator=(const SharedMemory&) = delete;

    // A file's name for it, in this process and its children.
    std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

  private:
    int descriptor_;
};

// A tree takes more than its file: leaves that compress well, and 260 kB for an internal node of few children.
ChildLimits limitsFor(std::int64_t fileBytes) {
    return {.memoryBytes = (std::int64_t(512) << 20) + 16 * fileBytes,
            .seconds = static_cast<int>(20 + fileBytes / 10'000'000)};
}

// ---- a file's tables, entry by entry, without OpenVDB

// Numbers and texts one after another; nothing after the first that the file does not hold.
class Entries {
  public:
    Entries(const FileBytes& file, std::int64_t at) : file_(file), at_(at) {}

    template <class T = std::uint32_t>
    std::optional<T> number() {
        T value = 0;
        if (file_.read(at_, reinterpret_cast<char*>(&value), sizeof value) != sizeof value) return {};
        at_ += sizeof value;
        return value;
    }
    std::optional<std::string> text() {
        const auto length = number();
        if (!length || *length > file_.size() - at_) return {};
        std::string value(*length, '\0');
        if (file_.read(at_, value.data(), value.size()) != value.size()) return {};
        at_ += *length;
        return value;
    }
    std::int64_t at() const { return at_; }
    void moveTo(std::int64_t at) { at_ = at; }

  private:
    const FileBytes& file_;
    std::int64_t at_;
};

constexpr std::int64_t kVersionAt = 8, kOffsetsAt = 20, kMetadataAt = 57;  // vdb_file.cpp has the header

bool hasHeaderOfToday(const FileBytes& file) {
    std::int64_t magic = 0;
    char bytes[sizeof magic];
    if (file.read(0, bytes, sizeof bytes) != sizeof bytes) return false;
    std::memcpy(&magic, bytes, sizeof magic);
    const auto version = Entries(file, kVersionAt).number();
    return magic == openvdb::OPENVDB_MAGIC && version &&
           *version >= openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION &&
           *version <= openvdb::OPENVDB_FILE_VERSION;
}

// Files of OpenVDB's io::File say where each grid ends, so truncation is known before anything is parsed. Those of io::Stream
// do not; there the short read itself tells.
void checkGridEnds(const std::string& name, const FileBytes& file) {
    char hasOffsets = 0;
    if (!hasHeaderOfToday(file) || file.read(kOffsetsAt, &hasOffsets, 1) != 1 || !hasOffsets) return;
    const auto need = [&]<class T>(const std::optional<T>& value) {
        if (!value) throw std::ios_base::failure("short read");
        return *value;
    };
    Entries entries(file, kMetadataAt);
    for (auto left = need(entries.number()); left > 0; --left)
        for (int text = 0; text < 3; ++text) need(entries.text());  // name, type, value
    for (auto left = need(entries.number()); left > 0; --left) {
        const std::string grid = need(entries.text());
        need(entries.text());                  // type
        need(entries.text());                  // the grid whose tree it shares
        need(entries.number<std::int64_t>());  // where the grid begins, and where its values do
        need(entries.number<std::int64_t>());
        const auto end = need(entries.number<std::int64_t>());
        if (end > file.size())
            throw InputError(name,
                             fmt::format("grid '{}' ends at byte {} but the file holds {}; it is truncated",
                                         oneLine(grid), end, file.size()));
        if (end < entries.at())
            throw InputError(
                name, fmt::format("grid '{}' ends before it begins; the file is damaged", oneLine(grid)));
        entries.moveTo(end);
    }
}

}  // namespace

VdbContent readForeignVdb(const std::string& name, const FileBytes& file) {
    vdbGuarded(name, file.size(), [&] { checkGridEnds(name, file); });
    const SharedMemory shared;
    const auto work = [&] {
        return vdbGuarded(name, file.size(), [&] {
            FileStream stream(file);
            std::ofstream to(shared.path(), std::ios::binary);
            to.exceptions(std::ios::failbit | std::ios::badbit);
            const VdbContent content = parse(stream);
            requireAligned(content.grids);
            writePlain(to, content);
            return std::string();
        });
    };
    const ChildAnswer answer = runInChild(work, limitsFor(file.size()));
    if (!answer.failure.empty())
        throw InputError(name, fmt::format("is damaged, or unlike any .vdb that could be read: OpenVDB {}; "
                                           "write it again",
                                           answer.failure));
    const FileBytes grids(shared.path(), "grids");
    FileStream stream(grids);
    return vdbGuarded(name, file.size(), [&] { return parse(stream); });
}

std::optional<std::string> vdbStringMetadatum(const FileBytes& file, const std::string& name) {
    if (!hasHeaderOfToday(file)) return {};
    Entries entries(file, kMetadataAt);
    for (std::uint32_t left = entries.number().value_or(0); left > 0; --left) {
        const auto key = entries.text(), type = entries.text(), value = entries.text();
        if (!key || !type || !value) return {};
        if (*key == name) return *type == "string" ? value : std::nullopt;
    }
    return {};
}

}  // namespace isowave
