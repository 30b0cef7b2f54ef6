#include "subdivision/lattice/picture_files.h"

#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkTIFFImageIO.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/atomic_file.h"
#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

// ITK's messages are several lines with source positions: keep the last.
std::string lastLine(const itk::ExceptionObject& error) {
    std::string text = error.GetDescription();
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text.substr(text.find_last_of('\n') + 1);
}

// libpng by itself: ITK's reader lets an exception fly through libpng's C frames when a file is truncated,
// which ends the program. 16-bit files keep their 16 bits; colours become luminance; nothing is done to
// gamma.
Grid readPng(const std::filesystem::path& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    const auto fail = [&]() -> InputError {
        const std::string message = image.message;
        png_image_free(&image);
        return {path.string(), "cannot be read as a picture: " + message};
    };
    if (!png_image_begin_read_from_file(&image, path.c_str())) throw fail();
    Grid grid{image.height, image.width, 1, {}};
    const bool deep = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
    image.format = deep ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
    // Where the picture is transparent it is taken as black.
    const png_color black{0, 0, 0};
    if (!png_image_finish_read(&image, &black, bytes.data(), 0, nullptr)) throw fail();
    grid.values.reserve(grid.rows * grid.columns);
    for (std::size_t k = 0; k < grid.rows * grid.columns; ++k) {
        if (deep) {
            std::uint16_t value;
            std::memcpy(&value, bytes.data() + 2 * k, 2);
            grid.values.push_back(value);
        } else {
            grid.values.push_back(bytes[k]);
        }
    }
    return grid;
}

Grid readTiff(const std::filesystem::path& path) {
    using Image = itk::Image<double, 2>;
    const auto reader = itk::ImageFileReader<Image>::New();
    reader->SetImageIO(itk::TIFFImageIO::New());
    reader->SetFileName(path.string());
    try {
        reader->Update();
    } catch (const itk::ExceptionObject& error) {
        throw InputError(path.string(), "cannot be read as a picture: " + lastLine(error));
    }
    const auto size = reader->GetOutput()->GetLargestPossibleRegion().GetSize();
    Grid grid{size[1], size[0], 1, {}};
    const double* const from = reader->GetOutput()->GetBufferPointer();
    grid.values.assign(from, from + grid.rows * grid.columns);
    return grid;
}

}  // namespace

Grid readPictureOrGrid(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    if (extension != ".png" && extension != ".tif" && extension != ".tiff") return readGrid(path);
    if (!std::filesystem::exists(path))
        throw InputError(path.string(), "cannot be opened; is the name right?");
    const Grid grid = extension == ".png" ? readPng(path) : readTiff(path);
    if (grid.rows < 2 || grid.columns < 2)
        throw InputError(path.string(), "has fewer than 2 rows or columns");
    for (std::size_t k = 0; k < grid.values.size(); ++k) {
        if (std::isfinite(grid.values[k])) continue;
        throw InputError(path.string(), "the sample at row " + std::to_string(k / grid.columns) +
                                            ", column " + std::to_string(k % grid.columns) +
                                            " is not finite; fill such gaps before");
    }
    return grid;
}

std::string pngBytes(const Grid& grid, double black, double white) {
    const double scale = white != black ? 255 / (white - black) : 0;  // black may be the larger: a negative
    std::vector<std::uint8_t> grey(grid.rows * grid.columns);
    for (std::size_t k = 0; k < grey.size(); ++k) {
        const double value = grid.values[k * grid.channels];
        const double level = std::isfinite(value) ? std::clamp((value - black) * scale, 0.0, 255.0) : 255.0;
        grey[k] = static_cast<std::uint8_t>(std::lround(level));
    }
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(grid.columns);
    image.height = static_cast<png_uint_32>(grid.rows);
    image.format = PNG_FORMAT_GRAY;
    png_alloc_size_t size = 0;
    std::string file;
    bool done = png_image_write_get_memory_size(image, size, 0, grey.data(), 0, nullptr);
    if (done) {
        file.resize(size);
        done = png_image_write_to_memory(&image, file.data(), &size, 0, grey.data(), 0, nullptr);
    }
    const std::string message = image.message;
    png_image_free(&image);
    if (!done) throw OperationError("picture", "cannot be made a PNG: " + message);
    file.resize(size);
    return file;
}

void writePng(const std::filesystem::path& path, const Grid& grid, double black, double white) {
    const std::string bytes = pngBytes(grid, black, white);
    AtomicFile place(path);
    place.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    place.commit();
}

}  // namespace isowave::subdivision
