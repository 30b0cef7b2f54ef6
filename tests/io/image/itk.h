// Images written and read by ITK itself, for the tests of isowave/image.h.
#pragma once

#include <itkBMPImageIO.h>
#include <itkExtractImageFilter.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkImageRegionIterator.h>
#include <itkImageRegionIteratorWithIndex.h>
#include <itkJPEGImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <type_traits>

namespace isowave::test {

inline itk::ImageIOBase::Pointer itkReaderFor(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    if (name.ends_with(".mha") || name.ends_with(".mhd")) return itk::MetaImageIO::New();
    if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return itk::NiftiImageIO::New();
    if (name.ends_with(".tif")) return itk::TIFFImageIO::New();
    if (name.ends_with(".bmp")) return itk::BMPImageIO::New();
    if (name.ends_with(".jpg")) return itk::JPEGImageIO::New();
    if (name.ends_with(".png")) return itk::PNGImageIO::New();
    return itk::NrrdImageIO::New();
}

template <class Image>
void writeItk(const Image* image, const std::filesystem::path& path, bool compress = false) {
    const auto io = itkReaderFor(path);
    auto writer = itk::ImageFileWriter<Image>::New();
    writer->SetImageIO(io);
    writer->SetInput(image);
    writer->SetUseCompression(compress);
    writer->SetFileName(path.string());
    writer->Update();
}

template <class Image>
typename Image::Pointer readItk(const std::filesystem::path& path) {
    auto reader = itk::ImageFileReader<Image>::New();
    reader->SetImageIO(itkReaderFor(path));
    reader->SetFileName(path.string());
    reader->Update();
    return reader->GetOutput();
}

// -125..125 (0..250 without a sign), not symmetric in x, y, z.
template <class T>
T patternAt(long x, long y, long z) {
    return static_cast<T>((x * 7 + y * 31 + z * 101) % 251 - (std::is_signed_v<T> ? 125 : 0));
}

template <class T, unsigned D = 3>
typename itk::Image<T, D>::Pointer patternImage(const std::array<unsigned, D>& size) {
    using Image = itk::Image<T, D>;
    auto image = Image::New();
    typename Image::SizeType itkSize;
    for (unsigned a = 0; a < D; ++a) itkSize[a] = size[a];
    image->SetRegions(typename Image::RegionType(itkSize));
    image->Allocate();
    for (itk::ImageRegionIteratorWithIndex<Image> i(image, image->GetLargestPossibleRegion()); !i.IsAtEnd();
         ++i)
        i.Set(patternAt<T>(i.GetIndex()[0], i.GetIndex()[1], D > 2 ? i.GetIndex()[D - 1] : 0));
    return image;
}

}  // namespace isowave::test
