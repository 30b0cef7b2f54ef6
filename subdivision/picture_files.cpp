#include "subdivision/picture_files.h"

#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace isowave::subdivision {

namespace {

itk::ImageIOBase::Pointer readerFor(const std::string& extension) {
    if (extension == ".png") return itk::PNGImageIO::New().GetPointer();
    return itk::TIFFImageIO::New().GetPointer();
}

// ITK's messages are several lines with source positions: keep the last.
std::string lastLine(const itk::ExceptionObject& error) {
    std::string text = error.GetDescription();
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text.substr(text.find_last_of('\n') + 1);
}

}  // namespace

Grid readPictureOrGrid(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    if (extension != ".png" && extension != ".tif" && extension != ".tiff") return readGrid(path);
    if (!std::filesystem::exists(path)) throw InputError(path.string(), "cannot be opened; is the name right?");
    using Image = itk::Image<double, 2>;
    const auto reader = itk::ImageFileReader<Image>::New();
    reader->SetImageIO(readerFor(extension));
    reader->SetFileName(path.string());
    try {
        reader->Update();
    } catch (const itk::ExceptionObject& error) {
        throw InputError(path.string(), "cannot be read as a picture: " + lastLine(error));
    }
    const auto size = reader->GetOutput()->GetLargestPossibleRegion().GetSize();
    Grid grid{size[1], size[0], 1, {}};
    if (grid.rows < 2 || grid.columns < 2) throw InputError(path.string(), "has fewer than 2 rows or columns");
    const double* const from = reader->GetOutput()->GetBufferPointer();
    grid.values.assign(from, from + grid.rows * grid.columns);
    for (std::size_t k = 0; k < grid.values.size(); ++k) {
        if (std::isfinite(grid.values[k])) continue;
        throw InputError(path.string(), "the sample at row " + std::to_string(k / grid.columns) + ", column " +
                                            std::to_string(k % grid.columns) + " is not finite; fill such gaps before");
    }
    return grid;
}

void writePng(const std::filesystem::path& path, const Grid& grid, double black, double white) {
    using Image = itk::Image<unsigned char, 2>;
    const auto image = Image::New();
    Image::SizeType size;
    size[0] = grid.columns;
    size[1] = grid.rows;
    image->SetRegions(Image::RegionType(size));
    image->Allocate();
    unsigned char* to = image->GetBufferPointer();
    const double scale = white > black ? 255 / (white - black) : 0;
    for (std::size_t k = 0; k < grid.rows * grid.columns; ++k) {
        const double value = grid.values[k * grid.channels];
        const double grey = std::isfinite(value) ? std::clamp((value - black) * scale, 0.0, 255.0) : 255.0;
        to[k] = static_cast<unsigned char>(std::lround(grey));
    }
    const auto writer = itk::ImageFileWriter<Image>::New();
    writer->SetImageIO(itk::PNGImageIO::New());
    writer->SetFileName(path.string());
    writer->SetInput(image);
    try {
        writer->Update();
    } catch (const itk::ExceptionObject& error) {
        throw OperationError(path.string(), "cannot be written: " + lastLine(error));
    }
}

}  // namespace isowave::subdivision
