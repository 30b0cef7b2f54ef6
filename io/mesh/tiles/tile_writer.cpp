#include "io/mesh/tiles/tile_writer.h"

#include <cerrno>
#include <cstring>

#include "isowave/error.h"

namespace isowave {

TileFile::TileFile(std::filesystem::path path) : path_(std::move(path)), stream_(path_, std::ios::binary) {
    if (!stream_) fail();
}

void TileFile::fail() const {
    throw OperationError(path_.string(),
                         std::string("writing failed (") + std::strerror(errno) + "); is the disk full?");
}

void TileFile::append(std::string_view bytes) {
    if (!stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
}

void TileFile::close() {
    stream_.close();
    if (!stream_) fail();
}

void writeTileFile(const std::filesystem::path& path, std::string_view bytes) {
    TileFile file(path);
    file.append(bytes);
    file.close();
}

}  // namespace isowave
