// DICOM through GDCM: a folder of slices, sorted by where they lie, or one file of several frames.
//
// The third axis of a series is the step from its first slice to its last, divided by their number less one.
// For an untilted scan that is the normal of the slices times their distance, as itk::ImageSeriesReader has
// it; for a tilted gantry it leans, and the voxels stay where the scanner saw them.
#include "io/image/dicom.h"

#include <fmt/format.h>
#include <gdcmDirectory.h>
#include <gdcmImageHelper.h>
#include <gdcmImageReader.h>
#include <gdcmScanner.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cmath>

#include "io/image/check.h"
#include "io/image/dicom_check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// GDCM talks to the terminal about every oddity, and ignores the rescaling of MR images unless told. Both are
// switches of the library, global there; ITK's own reader sets the second one too.
void prepareGdcm() {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    gdcm::ImageHelper::SetForceRescaleInterceptSlope(true);
}

// ---- pixels of a file

ValueType typeOf(const std::string& file, const gdcm::PixelFormat& format) {
    switch (format.GetScalarType()) {
        case gdcm::PixelFormat::INT8:
            return ValueType::int8;
        case gdcm::PixelFormat::UINT8:
            return ValueType::uint8;
        case gdcm::PixelFormat::INT12:
        case gdcm::PixelFormat::INT16:
            return ValueType::int16;
        case gdcm::PixelFormat::UINT12:
        case gdcm::PixelFormat::UINT16:
            return ValueType::uint16;
        case gdcm::PixelFormat::INT32:
            return ValueType::int32;
        case gdcm::PixelFormat::UINT32:
            return ValueType::uint32;
        case gdcm::PixelFormat::FLOAT32:
            return ValueType::float32;
        case gdcm::PixelFormat::FLOAT64:
            return ValueType::float64;
        default:
            throw InputError(file, fmt::format("holds pixels of type {}; expected 8 to 64 bits each",
                                               format.GetScalarTypeAsString()));
    }
}

struct DicomImage {
    gdcm::ImageReader reader;
    ValueType type = ValueType::int16;

    const gdcm::Image& image() const { return reader.GetImage(); }
    std::int64_t columns() const { return image().GetDimension(0); }
    std::int64_t rows() const { return image().GetDimension(1); }
    std::int64_t frames() const { return image().GetNumberOfDimensions() == 3 ? image().GetDimension(2) : 1; }
    bool rescaled() const { return image().GetSlope() != 1 || image().GetIntercept() != 0; }
    bool integral() const {
        const auto whole = [](double v) { return v == std::floor(v); };
        return isIntegral(type) && whole(image().GetSlope()) && whole(image().GetIntercept());
    }
};

// Throws InputError when GDCM cannot parse the file or its pixels are not single numbers.
// REQUIRES: the file went through stacksOf().
std::unique_ptr<DicomImage> openImage(const fs::path& path) {
    const std::string name = path.string();
    auto result = std::make_unique<DicomImage>();
    result->reader.SetFileName(name.c_str());
    bool good = false;
    try {
        good = result->reader.Read();
    } catch (const std::exception&) {
        good = false;
    }
    if (!good)
        throw InputError(
            name, "is not a DICOM image that can be read; it is truncated, damaged or holds no pixels");
    const gdcm::Image& image = result->image();
    using Colour = gdcm::PhotometricInterpretation;
    const Colour colour = image.GetPhotometricInterpretation();
    if (image.GetPixelFormat().GetSamplesPerPixel() != 1 || colour == Colour::PALETTE_COLOR)
        throw InputError(name,
                         fmt::format("holds colours ({}); expected one number a voxel", colour.GetString()));
    result->type = typeOf(name, image.GetPixelFormat());
    return result;
}

// All frames of a file as float, rescaled. Returns how many integers float32 could not hold.
std::int64_t readPixels(const fs::path& path, const DicomImage& dicom, float* out) {
    const std::string name = path.string();
    const gdcm::Image& image = dicom.image();
    const std::int64_t count = dicom.columns() * dicom.rows() * dicom.frames();
    const std::size_t needed = static_cast<std::size_t>(count) * sizeOf(dicom.type);
    std::vector<char> stored(std::max<std::size_t>(needed, image.GetBufferLength()));
    bool good = image.GetBufferLength() == needed;
    try {
        good = good && image.GetBuffer(stored.data());
    } catch (const std::exception&) {
        good = false;
    }
    if (!good)
        throw InputError(
            name, fmt::format("its pixels ({}) cannot be decoded; it is truncated, damaged or compressed in "
                              "a way that is not known",
                              image.GetTransferSyntax().GetString()));
    if (!dicom.rescaled()) return convert(dicom.type, stored.data(), count, false, out);
    // In double: slope * v + intercept of a 16-bit value is exact there where it is a whole number.
    std::vector<float> plain(static_cast<std::size_t>(count));
    const std::int64_t inexact = convert(dicom.type, stored.data(), count, false, plain.data());
    for (std::int64_t i = 0; i < count; ++i)
        out[i] =
            static_cast<float>(image.GetSlope() * static_cast<double>(plain[static_cast<std::size_t>(i)]) +
                               image.GetIntercept());
    return inexact;
}

// Everything but size[2], the third axis and the origin of a stack.
void takePlane(const DicomImage& dicom, Header& header) {
    header.size = {dicom.columns(), dicom.rows(), dicom.frames()};
    header.type = dicom.rescaled() ? ValueType::float32 : dicom.type;
    header.storedType = dicom.type;
    header.integral = dicom.integral();
    const double* cosines = dicom.image().GetDirectionCosines();
    const double* spacing = dicom.image().GetSpacing();
    const double* origin = dicom.image().GetOrigin();
    // Cosines are rounded to six digits or so; ITK makes them unit vectors again, and so do we.
    const auto unit = [](const Vec3& v) { return length(v) > 0 ? v / length(v) : v; };
    header.axis[0] = unit(Vec3{cosines[0], cosines[1], cosines[2]});
    header.axis[1] = unit(Vec3{cosines[3], cosines[4], cosines[5]});
    header.axis[2] = unit(cross(header.axis[0], header.axis[1]));
    header.spacing = {spacing[0], spacing[1], spacing[2]};
    header.origin = Vec3{origin[0], origin[1], origin[2]};
}

}  // namespace

// ---- a folder of slices

namespace {

struct Slice {
    fs::path path;
    std::string uid, description;
    std::string problem;  // why its pixels cannot be used; empty when they can
    std::int64_t rows = 0, columns = 0, frames = 1, instance = 0;
    std::optional<Vec3> position;       // ImagePositionPatient: the centre of the first pixel
    std::optional<Vec3> row, column;    // ImageOrientationPatient
    double thickness = 0, between = 0;  // SliceThickness; SpacingBetweenSlices; 0 where not said

    // Slices that say nothing of their places: their distance is all there is. One slice alone: its
    // thickness, for some scanners write the gap where the distance belongs.
    double height(bool alone) const {
        const double first = alone ? thickness : between, second = alone ? between : thickness;
        return first > 0 ? first : second;
    }

    bool placed() const { return position && row && column; }
    bool fits(const Slice& other) const {
        // 1e-3 of a radian: what scanners round their cosines to.
        const auto same = [](const std::optional<Vec3>& a, const std::optional<Vec3>& b) {
            return a.has_value() == b.has_value() && (!a || length(*a - *b) < 1e-3);
        };
        return uid == other.uid && rows == other.rows && columns == other.columns && frames == other.frames &&
               placed() == other.placed() && same(row, other.row) && same(column, other.column);
    }
};

using Stack = std::vector<Slice>;

const gdcm::Tag kSeries(0x0020, 0x000E), kDescription(0x0008, 0x103E), kInstance(0x0020, 0x0013),
    kPosition(0x0020, 0x0032), kOrientation(0x0020, 0x0037), kRows(0x0028, 0x0010), kColumns(0x0028, 0x0011),
    kFrames(0x0028, 0x0008), kThickness(0x0018, 0x0050), kBetween(0x0018, 0x0088), kSamples(0x0028, 0x0002),
    kAllocated(0x0028, 0x0100), kStored(0x0028, 0x0101), kHighBit(0x0028, 0x0102),
    kRepresentation(0x0028, 0x0103);

std::vector<double> numbersOf(const std::string& text) {  // "1.5\\-2\\3"
    std::vector<double> result;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find('\\', at), text.size());
        const std::string part = text.substr(at, end - at);
        char* stop = nullptr;
        const double value = std::strtod(part.c_str(), &stop);
        if (stop == part.c_str()) break;
        result.push_back(value);
        at = end + 1;
    }
    return result;
}

Slice sliceOf(const gdcm::Scanner& scanner, const fs::path& path) {
    const auto text = [&](const gdcm::Tag& tag) {
        const char* value = scanner.GetValue(path.c_str(), tag);
        std::string result = value ? value : "";
        while (!result.empty() && (result.back() == ' ' || result.back() == '\0')) result.pop_back();
        return result;
    };
    const auto number = [&](const gdcm::Tag& tag, double otherwise) {
        const auto values = numbersOf(text(tag));
        return values.empty() ? otherwise : values[0];
    };
    // The pixel format, where GDCM asserts rather than looks.
    const double samples = number(kSamples, 1), allocated = number(kAllocated, 16),
                 storedBits = number(kStored, allocated), highBit = number(kHighBit, storedBits - 1),
                 sign = number(kRepresentation, 0);
    Slice slice;
    if (samples != 1)
        slice.problem =
            fmt::format("holds colours ({} samples a pixel); expected one number a voxel", samples);
    else if ((allocated != 8 && allocated != 12 && allocated != 16 && allocated != 32 && allocated != 64) ||
             storedBits < 1 || storedBits > allocated || highBit < storedBits - 1 || highBit >= allocated ||
             (sign != 0 && sign != 1))
        slice.problem = fmt::format(
            "its pixels are said to have {} bits, of which {} are used up to bit {}; expected "
            "8, 12, 16, 32 or 64",
            allocated, storedBits, highBit);
    slice.path = path;
    slice.uid = text(kSeries);
    slice.description = oneLine(text(kDescription));
    slice.rows = static_cast<std::int64_t>(number(kRows, 0));
    slice.columns = static_cast<std::int64_t>(number(kColumns, 0));
    slice.frames = static_cast<std::int64_t>(number(kFrames, 1));
    slice.instance = static_cast<std::int64_t>(number(kInstance, 0));
    slice.thickness = number(kThickness, 0);
    slice.between = number(kBetween, 0);
    if (const auto p = numbersOf(text(kPosition)); p.size() == 3) slice.position = Vec3{p[0], p[1], p[2]};
    if (const auto o = numbersOf(text(kOrientation)); o.size() == 6) {
        slice.row = Vec3{o[0], o[1], o[2]};
        slice.column = Vec3{o[3], o[4], o[5]};
    }
    return slice;
}

// Slices of one series, size and orientation, in the order of the file names.
std::vector<Stack> stacksOf(const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
        if (fs::file_size(file) == 0) throw InputError(file.string(), "is empty; expected a DICOM slice");
        checkDicom(file);
    }
    gdcm::Scanner scanner;
    for (const gdcm::Tag& tag :
         {kSeries, kDescription, kInstance, kPosition, kOrientation, kRows, kColumns, kFrames, kThickness,
          kBetween, kSamples, kAllocated, kStored, kHighBit, kRepresentation})
        scanner.AddTag(tag);
    gdcm::Directory::FilenamesType names;
    for (const fs::path& file : files) names.push_back(file.string());
    scanner.Scan(names);

    std::vector<Stack> stacks;
    for (const fs::path& file : files) {
        if (!scanner.IsKey(file.c_str()))
            throw InputError(file.string(),
                             "is not a DICOM file that can be read; it is truncated or damaged");
        Slice slice = sliceOf(scanner, file);
        if (slice.rows == 0 || slice.columns == 0) continue;  // a report, a plan: no image
        const auto stack =
            std::find_if(stacks.begin(), stacks.end(), [&](const Stack& s) { return s[0].fits(slice); });
        if (stack == stacks.end())
            stacks.push_back({std::move(slice)});
        else
            stack->push_back(std::move(slice));
    }
    return stacks;
}

void requireGrey(const Stack& stack) {
    for (const Slice& slice : stack)
        if (!slice.problem.empty()) throw InputError(slice.path.string(), slice.problem);
}

std::string describe(const Stack& stack) {
    const Slice& first = stack.front();
    return fmt::format("{} '{}' ({} of {} x {}{})", first.uid.empty() ? "(no UID)" : first.uid,
                       first.description,
                       stack.size() == 1 ? "1 slice" : fmt::format("{} slices", stack.size()), first.columns,
                       first.rows, first.frames > 1 ? fmt::format(" x {}", first.frames) : std::string());
}

std::string describe(const std::vector<Stack>& stacks) {
    constexpr std::size_t kMost = 12;
    std::string text;
    for (std::size_t i = 0; i < std::min(stacks.size(), kMost); ++i)
        text += (i == 0 ? "" : "; ") + describe(stacks[i]);
    if (stacks.size() > kMost) text += fmt::format("; and {} more", stacks.size() - kMost);
    return text;
}

Stack pick(const std::string& folder, std::vector<Stack> stacks, const std::optional<std::string>& series) {
    if (stacks.empty()) throw InputError(folder, "its DICOM files hold no images");
    if (series) {
        std::vector<Stack> matching;
        for (const Stack& stack : stacks)
            if (stack[0].uid.find(*series) != std::string::npos ||
                stack[0].description.find(*series) != std::string::npos)
                matching.push_back(stack);
        if (matching.empty())
            throw InputError(folder, fmt::format("no series matches '{}'; it holds {}", oneLine(*series),
                                                 describe(stacks)));
        stacks = std::move(matching);
    }
    if (stacks.size() == 1) return std::move(stacks[0]);
    const bool oneSeries = std::all_of(stacks.begin(), stacks.end(),
                                       [&](const Stack& s) { return s[0].uid == stacks[0][0].uid; });
    throw InputError(
        folder, fmt::format("holds {} {}: {}; {}", stacks.size(),
                            oneSeries ? "stacks of different size or orientation in one series" : "series",
                            describe(stacks),
                            oneSeries ? "put the slices of one into a folder of their own"
                                      : "give one by its UID or a part of it (--series)"));
}

// ---- where the slices lie

// gaps[i]: from slice i to the next. Throws InputError for two slices at one place and for a gap.
void checkGaps(const std::string& folder, const Stack& stack, const std::vector<double>& gaps,
               Header& header) {
    std::vector<double> sorted = gaps;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                     sorted.end());
    const double usual = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        const auto names = [&] {
            return stack[i].path.filename().string() + " and " + stack[i + 1].path.filename().string();
        };
        if (gaps[i] <= 1e-3 * std::max(usual, 1e-3))
            throw InputError(
                folder,
                fmt::format("slices {} lie at the same place; the series holds several time points or "
                            "echoes; put one of them into a folder of its own",
                            names()));
        if (gaps[i] > 1.5 * usual)
            throw InputError(
                folder, fmt::format("slices {} are {:.4g} mm apart, the others {:.4g}; slices are missing",
                                    names(), gaps[i], usual));
    }
    const auto [least, most] = std::minmax_element(gaps.begin(), gaps.end());
    if (*most - *least > 0.02 * usual)
        header.warnings.push_back(
            fmt::format("slices are {:.4g} to {:.4g} mm apart; even steps are assumed", *least, *most));
}

// Sorts the stack along its normal and puts its third axis and origin into the header.
// Throws InputError for two slices at one place and for a gap.
void placeStack(const std::string& folder, Stack& stack, Header& header) {
    const Vec3 across = cross(*stack[0].row, *stack[0].column);
    if (!(length(across) > 0))
        throw InputError(folder,
                         fmt::format("{}: its rows and columns run the same way (ImageOrientationPatient)",
                                     stack[0].path.filename().string()));
    const Vec3 normal = across / length(across);
    const auto height = [&](const Slice& s) { return dot(*s.position, normal); };
    std::stable_sort(stack.begin(), stack.end(),
                     [&](const Slice& a, const Slice& b) { return height(a) < height(b); });
    header.origin = *stack[0].position;
    if (stack.size() == 1) {
        header.spacing[2] = stack[0].height(true);
        return;
    }
    std::vector<double> gaps;
    for (std::size_t i = 1; i < stack.size(); ++i) gaps.push_back(height(stack[i]) - height(stack[i - 1]));
    checkGaps(folder, stack, gaps, header);

    const Vec3 step =
        (*stack.back().position - *stack.front().position) / static_cast<double>(stack.size() - 1);
    header.spacing[2] = length(step);
    header.axis[2] = step / length(step);
    // Positions are rounded, often to 0.1 mm; a lean below half a pixel over the whole stack is not worth a
    // word.
    const double drift = length(step - normal * dot(step, normal)) * static_cast<double>(stack.size() - 1);
    const double tilt = std::acos(std::clamp(dot(header.axis[2], normal), -1.0, 1.0)) * 180 / M_PI;
    if (drift > 0.5 * header.spacing[0])
        header.warnings.push_back(
            fmt::format("the gantry is tilted by {:.2f} degrees; the voxels are kept so", tilt));
}

// Without positions only the numbers of the slices say their order.
void numberStack(Stack& stack, Header& header) {
    std::stable_sort(stack.begin(), stack.end(),
                     [](const Slice& a, const Slice& b) { return a.instance < b.instance; });
    header.spacing[2] = stack[0].height(stack.size() == 1);
    header.warnings.push_back("the slices say nothing of their places; they are stacked by instance number");
}

class SeriesSource : public VoxelSource {
  public:
    explicit SeriesSource(Stack stack) : stack_(std::move(stack)) {}

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        std::int64_t inexact = 0;
        for (std::int64_t z = z0; z < z1; ++z, out += header.sliceVoxels()) {
            const fs::path& path = stack_[static_cast<std::size_t>(z)].path;
            const auto dicom = openImage(path);
            if (dicom->columns() != header.size[0] || dicom->rows() != header.size[1] || dicom->frames() != 1)
                throw InputError(path.string(), fmt::format("is a slice of {} x {} among slices of {} x {}",
                                                            dicom->columns(), dicom->rows(), header.size[0],
                                                            header.size[1]));
            inexact += readPixels(path, *dicom, out);
        }
        return inexact;
    }

  private:
    Stack stack_;
};

}  // namespace

SourcePtr openDicomFolder(const fs::path& folder, const std::vector<fs::path>& files,
                          const ImageReadOptions& options) {
    prepareGdcm();
    Stack stack = pick(folder.string(), stacksOf(files), options.series);
    requireGrey(stack);
    if (stack[0].frames > 1) {
        if (stack.size() == 1) return openDicomFile(stack[0].path, options);
        throw InputError(folder.string(),
                         fmt::format("the series holds {} files of {} frames; give one of the files",
                                     stack.size(), stack[0].frames));
    }
    Header header;
    takePlane(*openImage(stack[0].path), header);
    header.format = "DICOM series";
    header.size[2] = static_cast<std::int64_t>(stack.size());
    if (stack[0].placed())
        placeStack(folder.string(), stack, header);
    else
        numberStack(stack, header);
    if (header.spacing[2] == 0) {
        header.hasZSpacing = false;
        header.spacing[2] = header.spacing[0];
    }
    auto source = std::make_unique<SeriesSource>(std::move(stack));
    source->header = header;
    return source;
}

// ---- one file

namespace {

class FramesSource : public VoxelSource {
  public:
    FramesSource(fs::path path, std::unique_ptr<DicomImage> dicom)
        : path_(std::move(path)), dicom_(std::move(dicom)) {}
    std::int64_t read(std::int64_t, std::int64_t, float* out) override {
        return readPixels(path_, *dicom_, out);
    }

  private:
    fs::path path_;
    std::unique_ptr<DicomImage> dicom_;
};

}  // namespace

SourcePtr openDicomFile(const fs::path& path, const ImageReadOptions&) {
    prepareGdcm();
    const std::vector<Stack> stacks = stacksOf({path});
    if (stacks.empty()) throw InputError(path.string(), "is a DICOM file without an image");
    requireGrey(stacks[0]);
    auto dicom = openImage(path);
    if (dicom->frames() == 1)
        throw InputError(path.string(),
                         fmt::format("is a 2D image ({} x {}); expected a volume; give the folder "
                                     "of its series",
                                     dicom->columns(), dicom->rows()));
    Header header;
    takePlane(*dicom, header);
    header.format = "DICOM frames";
    const bool enhanced = dicom->reader.GetFile().GetDataSet().FindDataElement(gdcm::Tag(0x5200, 0x9230));
    if (enhanced)
        header.warnings.push_back(
            "the places of the frames are taken from the first two; frames out of order go unseen");
    auto source = std::make_unique<FramesSource>(path, std::move(dicom));
    source->header = header;
    source->slicesPerRead = header.size[2];
    return source;
}

}  // namespace isowave::imageio
