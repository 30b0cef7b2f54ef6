// The sections of a packed solid's file (base/section_file.h).
#pragma once

#include "base/section_file.h"

namespace isowave::compress {

inline constexpr std::uint32_t kPackedFormatVersion = 1;
inline constexpr SectionFormat kPackedFormat{"ISOWAVEZ", kPackedFormatVersion, "packed solid",
                                             "isowave pack INPUT -o OUT.iwz", "pack it again"};

enum SectionKind : std::uint32_t { head = 1, nodes = 2, signs = 3, values = 4 };

// A head: its length, u32, and a zlib stream.
std::string deflatedHead(std::string_view bytes);
std::string inflatedHead(std::string_view bytes);  // throws std::runtime_error; at most 16 MB

}  // namespace isowave::compress
