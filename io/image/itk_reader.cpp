// One reader is made by name; ITK's factories, which are global and load plugins, are not used. TIFF (tiff/) and slices
// that are PNG are read by io/picture.
#include "io/image/itk_reader.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <cstdarg>
#include <cstring>
#include <functional>

#include "base/read_file.h"
#include "io/image/check.h"
#include "io/image/kind.h"
#include "io/image/metaimage.h"
#include "io/image/nifti.h"
#include "io/image/nrrd.h"
#include "io/image/tiff/stack.h"
#include "io/picture/png.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// ~64 MB of the file at a time, where a format can be read in slabs.
constexpr std::int64_t kSlabBytes = std::int64_t(64) << 20;

// "itk::ERROR: NrrdImageIO(0x55..): Read: ..." without the class, whose address differs from run to run.
std::string whatItkSaid(const itk::ExceptionObject& e) {
    std::string text = oneLine(e.GetDescription());
    if (const auto at = text.find("): "); text.starts_with("itk::ERROR") && at != std::string::npos)
        text = text.substr(at + 3);
    return text;
}

// Runs f; whatever ITK or what lies below it throws becomes one InputError line.
template <class F>
void reading(const fs::path& path, F&& f) {
    try {
        f();
    } catch (const InputError&) {
        throw;
    } catch (const itk::ExceptionObject& e) {
        throw InputError(path.string(),
                         "cannot be read (" + whatItkSaid(e) + "); is it truncated or damaged?");
    } catch (const std::exception& e) {
        throw InputError(path.string(), "cannot be read: " + oneLine(e.what()));
    }
}

ValueType typeOf(const fs::path& path, const itk::ImageIOBase& io) {
    using T = itk::IOComponentEnum;
    switch (io.GetComponentType()) {
        case T::CHAR:
            return ValueType::int8;
        case T::UCHAR:
            return ValueType::uint8;
        case T::SHORT:
            return ValueType::int16;
        case T::USHORT:
            return ValueType::uint16;
        case T::INT:
            return ValueType::int32;
        case T::UINT:
            return ValueType::uint32;
        case T::LONG:
            return sizeof(long) == 8 ? ValueType::int64 : ValueType::int32;
        case T::ULONG:
            return sizeof(long) == 8 ? ValueType::uint64 : ValueType::uint32;
        case T::LONGLONG:
            return ValueType::int64;
        case T::ULONGLONG:
            return ValueType::uint64;
        case T::FLOAT:
            return ValueType::float32;
        case T::DOUBLE:
            return ValueType::float64;
        default:
            throw InputError(path.string(),
                             fmt::format("holds voxels of type {}; expected integers or floating-point "
                                         "numbers",
                                         io.GetComponentTypeAsString(io.GetComponentType())));
    }
}

[[noreturn]] void throwNotScalar(const fs::path& path, const std::string& kind, unsigned numbers) {
    throw InputError(path.string(),
                     fmt::format("holds {} voxels of {} numbers; expected one number a voxel; convert it "
                                 "to grey",
                                 kind, numbers));
}

void requireScalar(const fs::path& path, const itk::ImageIOBase& io) {
    if (io.GetNumberOfComponents() == 1 && io.GetPixelType() == itk::IOPixelEnum::SCALAR) return;
    std::string kind = io.GetPixelTypeAsString(io.GetPixelType());
    if (kind == "rgb" || kind == "rgba") kind = kind == "rgb" ? "RGB" : "RGBA";
    throwNotScalar(path, kind, io.GetNumberOfComponents());
}

// Sets what the reader says of axis a; a 2D reader says nothing of z.
void takeAxis(const itk::ImageIOBase& io, unsigned a, Header& header) {
    header.size[a] = static_cast<std::int64_t>(io.GetDimensions(a));
    header.spacing[a] = io.GetSpacing(a);
    header.origin[static_cast<int>(a)] = io.GetOrigin(a);
    const std::vector<double> direction = io.GetDirection(a);
    for (unsigned i = 0; i < 3; ++i)
        header.axis[a][static_cast<int>(i)] = i < direction.size() ? direction[i] : (i == a ? 1.0 : 0.0);
}

// invariant on return: header describes three axes; further ones had size 1.
void takeHeader(const fs::path& path, const itk::ImageIOBase& io, Header& header) {
    requireScalar(path, io);
    header.type = typeOf(path, io);
    header.size = {1, 1, 1};
    const unsigned dimensions = io.GetNumberOfDimensions();
    for (unsigned a = 0; a < std::min(3u, dimensions); ++a) takeAxis(io, a, header);
    for (unsigned a = 3; a < dimensions; ++a)
        if (io.GetDimensions(a) != 1)
            throw InputError(path.string(),
                             fmt::format("is a series of {} volumes; expected one; extract one of them",
                                         io.GetDimensions(a)));
}

// What the bytes of a PNG say of its one slice.
void takePngHeader(const fs::path& path, const Picture& picture, Header& header) {
    if (picture.channels != 1)
        throwNotScalar(path,
                       picture.channels == 3   ? "RGB"
                       : picture.channels == 4 ? "RGBA"
                                               : "scalar",
                       static_cast<unsigned>(picture.channels));
    header.type = picture.type;
    header.size = {picture.width, picture.height, 1};
    if (picture.pixelSize) header.spacing = {(*picture.pixelSize)[0], (*picture.pixelSize)[1], 1};
}

std::string bytesOf(const fs::path& path) { return readFile(path, "a slice"); }

[[noreturn]] void throwFlat(const fs::path& path, std::int64_t x, std::int64_t y, const std::string& remedy) {
    throw InputError(path.string(),
                     fmt::format("is a 2D image ({} x {}); expected a volume{}", x, y, remedy));
}

// What is wrong is said once, in an exception. ITK itself can be told so; the libtiff that it brings along
// prints a line for every private tag, and its switch, renamed by ITK, is in no header.
void silence() {
    itk::Object::SetGlobalWarningDisplay(false);
    using Handler = void (*)(const char*, const char*, std::va_list);
    using Setter = Handler (*)(Handler);
    for (const char* name : {"itk_TIFFSetWarningHandler", "itk_TIFFSetErrorHandler"})
        if (void* symbol = ::dlsym(RTLD_DEFAULT, name)) reinterpret_cast<Setter>(symbol)(nullptr);
}

itk::ImageIOBase::Pointer readerFor(const fs::path& path) {
    static const bool silent = (silence(), true);
    (void)silent;
    const FileKind kind = kindOf(path);
    itk::ImageIOBase::Pointer io;
    if (kind == FileKind::meta)
        io = itk::MetaImageIO::New();
    else if (kind == FileKind::nifti)
        io = itk::NiftiImageIO::New();
    else
        io = itk::NrrdImageIO::New();
    io->SetFileName(path.string());
    return io;
}

// Reads the region of slices z0 <= z < z1, or the whole of a 2D file, as it is stored.
void readRegion(itk::ImageIOBase& io, std::int64_t z0, std::int64_t z1, void* buffer) {
    const unsigned dimensions = io.GetNumberOfDimensions();
    itk::ImageIORegion region(dimensions);
    for (unsigned a = 0; a < dimensions; ++a) {
        region.SetIndex(a, a == 2 ? z0 : 0);
        region.SetSize(a, a == 2 ? static_cast<itk::SizeValueType>(z1 - z0) : io.GetDimensions(a));
    }
    io.SetIORegion(region);
    io.Read(buffer);
}

class FileSource : public VoxelSource {
  public:
    FileSource(fs::path path, itk::ImageIOBase::Pointer io) : path_(std::move(path)), io_(std::move(io)) {
        native = true;
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        reading(path_, [&] { readRegion(*io_, z0, z1, out); });
    }

  private:
    fs::path path_;
    itk::ImageIOBase::Pointer io_;
};

HeaderFacts factsOf(const fs::path& path, const itk::ImageIOBase& io) {
    if (dynamic_cast<const itk::NrrdImageIO*>(&io)) return checkNrrd(path);
    if (dynamic_cast<const itk::MetaImageIO*>(&io)) return checkMetaImage(path);
    if (dynamic_cast<const itk::NiftiImageIO*>(&io)) return checkNifti(path);
    return {};
}

std::string formatOf(const itk::ImageIOBase& io) {
    if (dynamic_cast<const itk::NrrdImageIO*>(&io)) return "NRRD";
    if (dynamic_cast<const itk::MetaImageIO*>(&io)) return "MetaImage";
    return "NIfTI";
}

// PNG and most TIFF slices say at most how large a pixel is; a voxel is taken to be as high as it is wide.
void assumeHeight(Header& header) {
    header.hasZSpacing = false;
    header.spacing[2] = header.spacing[0];
}

// Whether the voxels can be had without ITK: it neither rescales nor rearranges them.
bool isPlain(const HeaderFacts& facts, const Header& header) {
    std::int64_t voxels = 1;
    for (const std::int64_t n : facts.size) voxels *= n;
    return facts.plain && facts.storedType == header.type && voxels == header.sliceVoxels() * header.size[2];
}

SourcePtr openTiffVolume(const fs::path& path, const ImageReadOptions& options) {
    SourcePtr stack = openTiffStack(path, options);
    if (stack->header.size[2] == 1)
        throwFlat(path, stack->header.size[0], stack->header.size[1], "; give the folder of its slices");
    return stack;
}

}  // namespace

SourcePtr openVolumeFile(const fs::path& path, const ImageReadOptions& options) {
    if (kindOf(path) == FileKind::png) {
        Header flat;
        takePngHeader(path, readPngHeader(bytesOf(path), path.string()), flat);
        throwFlat(path, flat.size[0], flat.size[1], "; give the folder of its slices");
    }
    if (kindOf(path) == FileKind::tiff) return openTiffVolume(path, options);
    const itk::ImageIOBase::Pointer io = readerFor(path);
    auto source = std::make_unique<FileSource>(path, io);
    Header& header = source->header;
    const HeaderFacts facts = factsOf(path, *io);
    if (facts.badSpacing && !options.spacing) {
        header.spacing = *facts.badSpacing;
        settleGeometry(path.string(), header, options);  // throws
    }
    reading(path, [&] { io->ReadImageInformation(); });
    header.format = formatOf(*io);
    const std::size_t dimensions = facts.size.empty() ? io->GetNumberOfDimensions() : facts.size.size();
    takeHeader(path, *io, header);
    if (std::min<std::size_t>(dimensions, io->GetNumberOfDimensions()) < 3 && dimensions < 3)
        throwFlat(path, header.size[0], header.size[1], "");
    header.storedType = facts.storedType;
    header.integral = facts.integral;
    header.slope = facts.slope;
    header.intercept = facts.intercept;
    if (isPlain(facts, header)) return openPlain(*facts.plain, header);
    source->slicesPerRead = header.size[2];
    if (!facts.onePiece && io->CanStreamRead())
        source->slicesPerRead = std::clamp<std::int64_t>(
            kSlabBytes / (header.sliceVoxels() * static_cast<std::int64_t>(sizeOf(header.type))), 1,
            header.size[2]);
    return source;
}

// ---- a folder of slices

namespace {

// A file that is one slice, or a TIFF of several pages.
struct Slice {
    std::string format;
    Header header;
    std::function<void(void*)> read;  // its voxels
};

Slice openPngSlice(const fs::path& path) {
    Slice slice{"PNG", {}, {}};
    const auto bytes = std::make_shared<const std::string>(bytesOf(path));
    takePngHeader(path, readPngHeader(*bytes, path.string()), slice.header);
    slice.read = [bytes, path](void* out) {
        const Picture picture = readPng(*bytes, path.string());
        std::memcpy(out, picture.samples.data(), picture.samples.size());
    };
    return slice;
}

Slice openTiffSlice(const fs::path& path, const ImageReadOptions& options) {
    const std::shared_ptr<VoxelSource> stack = openTiffStack(path, options);
    return {"TIFF", stack->header, [stack](void* out) { stack->readNative(0, 1, out); }};
}

Slice openSlice(const fs::path& path, const ImageReadOptions& options) {
    if (fs::file_size(path) == 0) throw InputError(path.string(), "is empty; expected a slice");
    if (kindOf(path) == FileKind::png) return openPngSlice(path);
    return openTiffSlice(path, options);
}

class SlicesSource : public VoxelSource {
  public:
    SlicesSource(std::vector<fs::path> slices, const ImageReadOptions& options)
        : slices_(std::move(slices)), options_(options) {
        native = true;
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        auto* bytes = static_cast<char*>(out);
        for (std::int64_t z = z0; z < z1; ++z) {
            const fs::path& path = slices_[static_cast<std::size_t>(z)];
            reading(path, [&] {
                const Slice slice = openSlice(path, options_);
                requireLikeFirst(path, slice.header);
                slice.read(bytes);
            });
            bytes += static_cast<std::size_t>(header.sliceVoxels()) * sizeOf(header.type);
        }
    }

  private:
    void requireLikeFirst(const fs::path& path, const Header& slice) const {
        if (slice.size[0] != header.size[0] || slice.size[1] != header.size[1] || slice.size[2] != 1)
            throw InputError(path.string(), fmt::format("is a slice of {} but the first, {}, is {} x {} x 1",
                                                        sizeText(slice.size), slices_[0].filename().string(),
                                                        header.size[0], header.size[1]));
        if (slice.type != header.type)
            throw InputError(path.string(), fmt::format("is a slice of {} voxels but the first, {}, holds {}",
                                                        nameOf(slice.type), slices_[0].filename().string(),
                                                        nameOf(header.type)));
    }

    std::vector<fs::path> slices_;
    ImageReadOptions options_;
};

}  // namespace

SourcePtr openSliceFiles(const fs::path& folder, const std::vector<fs::path>& slices,
                         const ImageReadOptions& options) {
    const Slice first = openSlice(slices.front(), options);
    if (first.header.size[2] > 1) {  // pages
        if (slices.size() == 1) return openVolumeFile(slices.front(), options);
        throw InputError(folder.string(),
                         fmt::format("holds {} TIFF files of several pages; expected slices; give one "
                                     "of the files",
                                     slices.size()));
    }
    auto source = std::make_unique<SlicesSource>(slices, options);
    source->header = first.header;
    source->header.format = first.format + " slices";
    source->header.size[2] = static_cast<std::int64_t>(slices.size());
    if (first.format == "PNG" || !first.header.hasZSpacing) assumeHeight(source->header);
    return source;
}

}  // namespace isowave::imageio
