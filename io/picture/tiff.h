// TIFF and BigTIFF, by libtiff.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/picture/picture.h"

namespace isowave {

bool isTiff(std::string_view bytes);

// The first page; `pages` counts those that are neither thumbnails nor masks. Integers of 8 to 64 bits and floats of 32
// and 64 stay as they are, halves become float32, 1, 2 and 4 bits are spread over 0 .. 255, palettes become colours of 16
// bits, and where 0 is white the values are turned over. One channel beyond grey or colours is opacity; colours that were
// multiplied with it are divided. Whatever else libtiff can show (YCbCr, CMYK, Lab) becomes colours of 8 bits.
// `name` stands in messages; libtiff prints nothing. Throws InputError: truncated, damaged, of a kind that is not read.
Picture readTiff(std::string_view bytes, const std::string& name);

// What the tags of a page say; numbers of kinds are libtiff's (tiff.h).
struct TiffPage {
    std::int64_t width = 0, height = 0;
    int bits = 0, samples = 1, photometric = 0;
    std::int64_t depth = 1;           // slices in it, by a tag of SGI that libtiff knows
    std::optional<ValueType> type;    // of the samples as a Picture has them; none where none fits
    bool isThumbnail = false;         // or a mask
    std::array<double, 2> perUnit{};  // pixels along x and y in a unit; 0: not said
    int unit = 0;                     // 1 none, 2 inch, 3 cm
    std::string description;          // of the first page only
    std::uint64_t directory = 0;      // where its tags lie
    std::uint64_t firstByte = 0;      // where its samples begin if they are not compressed, else 0
};

// All pages of a file that stays where it is. Not for several threads at once.
class TiffFile {
  public:
    // Up to `count` bytes from `at` on; at + count <= the file's size.
    using ReadAt = std::function<std::size_t(std::uint64_t at, char* to, std::size_t count)>;
    enum class Samples {
        shown,  // as readTiff() has them
        stored  // as tifffile has them: 1, 2, 4 bits, places in a palette and values where 0 is white stand as they are
    };

    // Reads the tags of all pages. Throws InputError as readTiff() does.
    TiffFile(ReadAt readAt, std::uint64_t size, const std::string& name);
    ~TiffFile();
    TiffFile(TiffFile&&) noexcept;
    TiffFile& operator=(TiffFile&&) noexcept;

    const std::vector<TiffPage>& pages() const;
    // Rows from the top as the page's orientation says. Throws InputError.
    Picture picture(std::size_t page, Samples samples);

  private:
    class Reader;
    std::unique_ptr<Reader> reader_;
};

}  // namespace isowave
