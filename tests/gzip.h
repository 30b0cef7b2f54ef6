// Deflated bytes, for files that tests make.
#pragma once

#include <zlib.h>

#include <string>
#include <utility>

namespace isowave::test {

inline std::string deflated(std::string text, int windowBits) {
    z_stream z{};
    deflateInit2(&z, 9, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&z, text.size()), '\0');
    z.next_in = reinterpret_cast<Bytef*>(text.data());
    z.avail_in = static_cast<uInt>(text.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    deflate(&z, Z_FINISH);
    out.resize(z.total_out);
    deflateEnd(&z);
    return out;
}
inline std::string gzipped(std::string text) { return deflated(std::move(text), 15 + 16); }

}  // namespace isowave::test
