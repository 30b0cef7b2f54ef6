#include "io/image/formats/vti.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/read_file.h"
#include "io/image/check.h"
#include "io/image/formats/stored_volume.h"
#include "io/image/header.h"
#include "io/vtk/data_array.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// Inflated, if the file is compressed by gzip as a whole; what is behind a damaged place is missing.
std::string wholeFile(const fs::path& path) {
    if (!isGzip(path)) return readFile(path, "an image");
    return firstBytes(path, std::numeric_limits<std::size_t>::max());
}

// Numbers of an attribute, `otherwise` where it is missing.
template <std::size_t N>
std::array<double, N> numbersOf(const XmlElement& element, const char* attribute,
                                const std::array<double, N>& otherwise, const std::string& name) {
    if (!element.attributes.contains(attribute)) return otherwise;
    const std::vector<double> found = numbers(element.get(attribute));
    if (found.size() != N)
        throw InputError(name, fmt::format("its {} is '{}'; expected {} numbers", attribute,
                                           oneLine(element.get(attribute)), N));
    std::array<double, N> result{};
    std::copy(found.begin(), found.end(), result.begin());
    return result;
}

// First and last index along x, y, z.
std::array<std::int64_t, 6> extentOf(const XmlElement& element, const char* attribute,
                                     const std::string& name) {
    const std::vector<std::int64_t> found = wholeNumbers(name, attribute, element.get(attribute));
    constexpr std::int64_t kMost = std::int64_t(1) << 40;
    bool good = found.size() == 6;
    for (std::size_t a = 0; good && a < 6; ++a)
        good = std::abs(found[a]) < kMost && (a % 2 == 0 || found[a] >= found[a - 1]);
    if (!good)
        throw InputError(name, fmt::format("its {} is '{}'; expected first and last index along x, y, z",
                                           attribute, oneLine(element.get(attribute))));
    std::array<std::int64_t, 6> extent{};
    std::copy(found.begin(), found.end(), extent.begin());
    return extent;
}

// One component of one array.
struct Choice {
    vtk::Array array;
    std::int64_t component = 0;
};

struct Choices {
    std::vector<Choice> all;
    std::optional<std::size_t> active;  // the scalars that VTK shows
    std::string text;                   // "volume 1: density; volume 2: vector[0]"
};

Choices choicesOf(const XmlElement& data, const std::string& name) {
    Choices choices;
    const std::string scalars = data.get("Scalars");
    for (const XmlElement& element : data.children) {
        if (element.name != "DataArray" && element.name != "Array") continue;
        if (element.get("type") == "String") continue;
        const vtk::Array array = vtk::describe(element, name);
        if (array.name == scalars && !scalars.empty() && array.components == 1)
            choices.active = choices.all.size();
        for (std::int64_t c = 0; c < array.components; ++c) {
            choices.all.push_back({array, c});
            choices.text += fmt::format("{}volume {}: {}", choices.text.empty() ? "" : "; ",
                                        choices.all.size(), array.name) +
                            (array.components > 1 ? fmt::format("[{}]", c) : std::string());
        }
    }
    choices.text = oneLine(choices.text);
    return choices;
}

std::size_t chosen(const Choices& choices, const std::string& name, const ImageReadOptions& options,
                   Header& header) {
    const auto count = static_cast<std::int64_t>(choices.all.size());
    if (count == 0) throw InputError(name, "holds no array of numbers; expected one value a voxel");
    if (options.volume && (*options.volume < 1 || *options.volume > count))
        throw InputError(name, fmt::format("holds {} volumes, 1 to {} ({}); --volume says {}", count, count,
                                           choices.text, *options.volume));
    if (options.volume) return static_cast<std::size_t>(*options.volume - 1);
    if (count == 1) return 0;
    if (!choices.active)
        throw InputError(
            name, fmt::format("is a series of {} volumes ({}); choose one with --volume, 1 to {}", count,
                              choices.text, count));
    header.warnings.push_back(
        fmt::format("its active scalars '{}' are read; it holds {} ({}), of which --volume chooses",
                    oneLine(choices.all[*choices.active].array.name), count, choices.text));
    return *choices.active;
}

// What has to be decoded as a whole.
class DecodedVti : public VoxelSource {
  public:
    DecodedVti(const fs::path& path, vtk::File file, Choice choice, const Header& from)
        : path_(path), file_(std::move(file)), choice_(std::move(choice)) {
        header = from;
        native = true;
        slicesPerRead = header.size[2];
    }

    // All of it: z0 is 0 and z1 the last one.
    void readNative(std::int64_t, std::int64_t, void* out) override {
        const std::int64_t voxels = header.sliceVoxels() * header.size[2],
                           components = choice_.array.components;
        const std::string all =
            vtk::decode(file_, choice_.array, wholeFile(path_), voxels * components, path_.string());
        const std::size_t each = sizeOf(header.type);
        const char* from = all.data() + static_cast<std::size_t>(choice_.component) * each;
        auto* to = static_cast<char*>(out);
        for (std::int64_t i = 0; i < voxels;
             ++i, to += each, from += each * static_cast<std::size_t>(components))
            std::memcpy(to, from, each);
    }

  private:
    fs::path path_;
    vtk::File file_;
    Choice choice_;
};

void placeVti(const XmlElement& image, const std::array<std::int64_t, 6>& extent, bool cells,
              const std::string& name, Header& header) {
    const auto spacing = numbersOf<3>(image, "Spacing", {1, 1, 1}, name);
    const auto origin = numbersOf<3>(image, "Origin", {0, 0, 0}, name);
    const auto direction = numbersOf<9>(image, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1}, name);
    header.origin = {origin[0], origin[1], origin[2]};
    for (std::size_t a = 0; a < 3; ++a) {
        header.size[a] = extent[2 * a + 1] - extent[2 * a] + (cells ? 0 : 1);
        header.spacing[a] = spacing[a];
        header.axis[a] = {direction[a], direction[3 + a], direction[6 + a]};
        header.origin +=
            header.axis[a] * (spacing[a] * (static_cast<double>(extent[2 * a]) + (cells ? 0.5 : 0)));
    }
    header.space = Space::unspecified;
}

vtk::File parsed(const fs::path& path) {
    const std::string name = path.string();
    if (auto file = vtk::parse(headerFileText(path), name, "ImageData")) return std::move(*file);
    if (auto file = vtk::parse(wholeFile(path), name, "ImageData")) return std::move(*file);
    throw InputError(name, "ends within its XML; it is truncated");
}

const XmlElement& pieceOf(const vtk::File& file, const std::string& name) {
    const XmlElement& image = file.dataset();
    const XmlElement* const piece = image.child("Piece");
    const auto isPiece = [](const XmlElement& element) { return element.name == "Piece"; };
    if (!piece || std::count_if(image.children.begin(), image.children.end(), isPiece) != 1)
        throw InputError(name, "is not of one piece; save it as one in ParaView");
    return *piece;
}

// Values at points, or else those of cells.
const XmlElement& dataOf(const XmlElement& piece, const std::string& name) {
    for (const char* kind : {"PointData", "CellData"})
        if (const XmlElement* const data = piece.child(kind); data && !data->children.empty()) return *data;
    throw InputError(name, "holds no array of numbers; expected one value a voxel");
}

}  // namespace

SourcePtr openVti(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    vtk::File file = parsed(path);
    const XmlElement& piece = pieceOf(file, name);
    const XmlElement& data = dataOf(piece, name);
    Header header;
    header.format = "VTK ImageData";
    placeVti(file.dataset(), extentOf(piece, "Extent", name), data.name == "CellData", name, header);
    const Choices choices = choicesOf(data, name);
    const Choice choice = choices.all[chosen(choices, name, options, header)];
    header.type = choice.array.type;
    const auto bytesEach = static_cast<std::int64_t>(sizeOf(header.type));
    const std::int64_t all =
        byteCount(name, {header.size[0], header.size[1], header.size[2], choice.array.components}, bytesEach);
    const auto start = isGzip(path) ? std::nullopt : vtk::plainStart(file, choice.array);
    const std::int64_t lengthBytes = file.longLengths ? 8 : 4;
    if (!start) {
        if (all / 1032 > static_cast<std::int64_t>(fs::file_size(path)))
            throw InputError(name,
                             fmt::format("its Extent says {}, more than the file can hold; it is truncated",
                                         sizeText(header.size)));
        return std::make_unique<DecodedVti>(path, std::move(file), choice, header);
    }
    StoredVolume volume;
    volume.header = header;
    volume.voxels.bigEndian = file.bigEndian;
    volume.voxels.inner = choice.array.components;
    volume.voxels.pieces = {VoxelPiece{path, *start + lengthBytes, 0}};
    volume.promise = "its Extent says " + sizeText(header.size);
    ImageReadOptions component = options;
    component.volume = choice.component + 1;
    return openStored(path, std::move(volume), component);
}

}  // namespace isowave::imageio
