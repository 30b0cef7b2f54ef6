#include "compress/sections.h"

#include <stdexcept>

namespace isowave::compress {
namespace {

constexpr std::uint64_t kMostInflated = std::uint64_t{16} << 20;
constexpr const char* kRemedy = "the file is damaged; pack it again, or take another copy";

}  // namespace

std::string deflatedHead(std::string_view bytes) {
    ByteWriter writer;
    writer.u32(static_cast<std::uint32_t>(bytes.size()));
    return writer.str() + deflated(bytes);
}

std::string inflatedHead(std::string_view bytes) {
    ByteReader reader(bytes);
    const std::uint64_t size = reader.u32();
    if (size > kMostInflated) throw std::runtime_error(std::string("its head is too large; ") + kRemedy);
    try {
        return inflated(bytes.substr(4), size);
    } catch (const std::runtime_error&) {
        throw std::runtime_error(std::string("its head does not unpack; ") + kRemedy);
    }
}

}  // namespace isowave::compress
