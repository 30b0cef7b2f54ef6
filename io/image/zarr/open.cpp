#include "io/image/zarr/open.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>

#include "base/peak_memory.h"
#include "io/image/check.h"
#include "io/image/formats/stored_volume.h"
#include "io/image/zarr/array.h"
#include "io/image/zarr/multiscale.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// One volume of an array: which axis is x, y and z, and the index on each of the others.
struct Volume {
    std::array<std::size_t, 3> axis{};
    std::vector<std::int64_t> index;  // of t and c; of x, y, z nothing
};

// Chunks of a volume, by their numbers along x, y, z.
class VolumeChunks {
  public:
    VolumeChunks(ZarrArray array, Volume volume) : array_(std::move(array)), volume_(std::move(volume)) {
        strides_ = array_.strides();
        for (std::size_t a = 0; a < array_.axes(); ++a) first_.push_back(volume_.index[a] % array_.chunk[a]);
    }
    const ZarrArray& array() const { return array_; }
    std::int64_t size(std::size_t a) const { return array_.shape[volume_.axis[a]]; }
    std::int64_t chunk(std::size_t a) const { return array_.chunk[volume_.axis[a]]; }
    std::int64_t count(std::size_t a) const { return array_.chunksAlong(volume_.axis[a]); }
    std::int64_t stride(std::size_t a) const { return strides_[volume_.axis[a]]; }
    // Of the volume's first voxel in a chunk.
    std::int64_t offset() const {
        std::int64_t voxels = 0;
        for (std::size_t a = 0; a < array_.axes(); ++a) voxels += first_[a] * strides_[a];
        return voxels;
    }
    std::vector<std::int64_t> numbersOf(const std::array<std::int64_t, 3>& at) const {
        std::vector<std::int64_t> numbers(array_.axes());
        for (std::size_t a = 0; a < numbers.size(); ++a) numbers[a] = volume_.index[a] / array_.chunk[a];
        for (std::size_t a = 0; a < 3; ++a) numbers[volume_.axis[a]] = at[a];
        return numbers;
    }
    // Chunks that are there. What the folder holds is counted, for its shape may promise any number of them.
    std::int64_t present() const { return presentIn(array_.folder, 0); }

  private:
    // Of a folder whose path has the first `known` numbers of a chunk: all of them are in a file's name, or one is in a folder's.
    std::int64_t presentIn(const fs::path& folder, std::size_t known) const {
        std::int64_t count = 0;
        std::error_code ignored;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
            const std::size_t now = known + numbersIn(entry.path().filename().string(), known);
            if (now == array_.axes())
                ++count;
            else if (now == known + 1 && array_.separator == '/' && entry.is_directory(ignored))
                count += presentIn(entry.path(), now);
        }
        return count;
    }
    // How many numbers a name holds, from this axis on; 0 where it is of no chunk of the volume.
    std::size_t numbersIn(std::string_view name, std::size_t axis) const {
        std::size_t count = 0;
        for (std::size_t begin = 0; begin <= name.size(); ++count) {
            const std::size_t end = std::min(name.find(array_.separator, begin), name.size());
            if (axis + count == array_.axes() || !isChunkOn(axis + count, name.substr(begin, end - begin)))
                return 0;
            begin = end + 1;
        }
        return count;
    }
    bool isChunkOn(std::size_t axis, std::string_view text) const {
        std::int64_t number = 0;
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
        if (parsed.ec != std::errc() || std::to_string(number) != text) return false;
        const auto& along = volume_.axis;
        if (std::find(along.begin(), along.end(), axis) == along.end())
            return number == volume_.index[axis] / array_.chunk[axis];
        return 0 <= number && number < array_.chunksAlong(axis);
    }

    ZarrArray array_;
    Volume volume_;
    std::vector<std::int64_t> strides_, first_;
};

// Each unpacks a chunk, which may hold other times and channels, too: as many as fit into memory, packed and unpacked.
int threadsFor(std::int64_t chunkBytes) {
    const double fit = usualMemoryLimit() / (2 * static_cast<double>(chunkBytes));
    return static_cast<int>(
        std::clamp(fit, 1.0, static_cast<double>(tbb::this_task_arena::max_concurrency())));
}

class ZarrSource : public VoxelSource {
  public:
    ZarrSource(VolumeChunks chunks, Header from) : chunks_(std::move(chunks)) {
        header = std::move(from);
        native = true;
        slicesPerRead = std::min(chunks_.chunk(2), header.size[2]);
        threads_ = threadsFor(chunks_.array().chunkBytes());
    }

    // By layers of chunks; a layer's chunks go to different voxels, so threads do not meet.
    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        const std::int64_t columns = chunks_.count(0), rows = chunks_.count(1);
        tbb::task_arena arena(threads_);
        for (std::int64_t layer = z0 / chunks_.chunk(2); layer * chunks_.chunk(2) < z1; ++layer)
            arena.execute([&] {
                tbb::parallel_for(std::int64_t{0}, columns * rows, [&](std::int64_t i) {
                    put({i % columns, i / columns, layer}, z0, z1, static_cast<char*>(out));
                });
            });
    }

  private:
    void put(const std::array<std::int64_t, 3>& at, std::int64_t z0, std::int64_t z1, char* out) const {
        std::vector<char> voxels;
        const bool there = readZarrChunk(chunks_.array(), chunks_.numbersOf(at), voxels);
        withType(header.type, [&](auto zero) {
            using T = decltype(zero);
            const auto fill = static_cast<T>(chunks_.array().fill);
            std::array<std::int64_t, 3> low{}, high{};
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = at[a] * chunks_.chunk(a);
                high[a] = std::min(low[a] + chunks_.chunk(a), header.size[a]);
            }
            const std::int64_t across = high[0] - low[0];
            for (std::int64_t z = std::max(low[2], z0); z < std::min(high[2], z1); ++z)
                for (std::int64_t y = low[1]; y < high[1]; ++y) {
                    T* const to =
                        reinterpret_cast<T*>(out) + low[0] + header.size[0] * (y + header.size[1] * (z - z0));
                    if (!there) {
                        std::fill(to, to + across, fill);
                        continue;
                    }
                    const T* from = reinterpret_cast<const T*>(voxels.data()) + chunks_.offset() +
                                    (z - low[2]) * chunks_.stride(2) + (y - low[1]) * chunks_.stride(1);
                    for (std::int64_t x = 0; x < across; ++x, from += chunks_.stride(0)) to[x] = *from;
                }
        });
    }

    VolumeChunks chunks_;
    int threads_ = 1;
};

// Of an axis of times or channels.
std::int64_t indexOn(const std::string& name, char axis, std::int64_t count,
                     const ImageReadOptions& options) {
    const bool time = axis == 't';
    const char* const what = time ? "time" : "channel";
    const std::optional<std::int64_t>& wanted = time ? options.time : options.channel;
    if (!wanted && count > 1)
        throw InputError(
            name, fmt::format("holds {} {}s; choose one with --{}, 1 to {}", count, what, what, count));
    if (wanted && (*wanted < 1 || *wanted > count))
        throw InputError(name, fmt::format("holds {} {}{}; --{} says {}", count, what, count > 1 ? "s" : "",
                                           what, *wanted));
    return wanted.value_or(1) - 1;
}

void refuseMissingAxes(const std::string& name, const std::vector<ZarrAxis>& axes,
                       const ImageReadOptions& options) {
    const auto isThere = [&](char axis) {
        return std::any_of(axes.begin(), axes.end(), [&](const ZarrAxis& a) { return a.name == axis; });
    };
    if (options.time && !isThere('t'))
        throw UsageError("--time: " + name + " has no axis of times; leave it out");
    if (options.channel && !isThere('c'))
        throw UsageError("--channel: " + name + " has no axis of channels; leave it out");
}

Volume volumeOf(const std::string& name, const ZarrArray& array, const std::vector<ZarrAxis>& axes,
                const ImageReadOptions& options) {
    Volume volume;
    volume.index.resize(array.axes());
    std::array<int, 3> found{};
    std::vector<char> seen;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const char axis = axes[a].name;
        if (axis == 0 && array.shape[a] > 1)
            throw InputError(
                name, fmt::format("its axis {} is none of x, y, z, t, c and {} long; expected a volume", a,
                                  array.shape[a]));
        if (axis != 0 && std::find(seen.begin(), seen.end(), axis) != seen.end())
            throw InputError(name, fmt::format("has two axes {}", axis));
        seen.push_back(axis);
        if (axis == 't' || axis == 'c') volume.index[a] = indexOn(name, axis, array.shape[a], options);
        if (axis < 'x') continue;
        volume.axis[static_cast<std::size_t>(axis - 'x')] = a;
        ++found[static_cast<std::size_t>(axis - 'x')];
    }
    refuseMissingAxes(name, axes, options);
    if (found[0] && found[1] && !found[2])
        throwFlat(name, array.shape[volume.axis[0]], array.shape[volume.axis[1]], "");
    if (!found[0] || !found[1] || !found[2]) throw InputError(name, "has no axes x, y and z");
    return volume;
}

// An array of three axes that no one has named is a volume as stacks of pictures are.
std::vector<ZarrAxis> axesOf(const std::string& name, const ZarrArray& array, const ZarrChoice& choice,
                             Header& header) {
    if (choice.axes.size() == array.axes()) return choice.axes;
    if (!choice.axes.empty())
        throw InputError(name,
                         fmt::format("has {} axes, and {} are named", array.axes(), choice.axes.size()));
    if (array.axes() == 2) throwFlat(name, array.shape[1], array.shape[0], "");
    if (array.axes() != 3)
        throw InputError(name,
                         fmt::format("has {} axes and no names for them; expected three, z, y, x, or the "
                                     "attribute _ARRAY_DIMENSIONS",
                                     array.axes()));
    header.warnings.push_back("its indices are taken as z, y, x: the array names no axes");
    std::vector<ZarrAxis> axes(3);
    for (std::size_t a = 0; a < 3; ++a) axes[a].name = "zyx"[a];
    return axes;
}

// Millimetres of the axis' unit. The first unit that is none, or is missing, is said.
double millimetresOf(const std::string& name, const ZarrAxis& axis) {
    if (axis.unit.empty()) return 1;
    const auto millimetres = millimetresIn(axis.unit);
    if (!millimetres)
        throw InputError(name,
                         fmt::format("its axis {} is in '{}', which is no length that is known; expected "
                                     "\"micrometer\", \"nanometer\", ...",
                                     axis.name, oneLine(axis.unit)));
    return *millimetres;
}

void placeZarr(const std::string& name, const Volume& volume, const std::vector<ZarrAxis>& axes,
               const ZarrChoice& choice, Header& header) {
    std::array<Vec3, 3> step;
    Vec3 origin;
    bool anyUnit = false, anyWithout = false;
    for (std::size_t a = 0; a < 3; ++a) {
        const ZarrAxis& axis = axes[volume.axis[a]];
        const double millimetres = millimetresOf(name, axis);
        if (axis.scale == 0) throw InputError(name, fmt::format("its scale along {} is 0", axis.name));
        step[a][static_cast<int>(a)] = millimetres * axis.scale;
        origin[static_cast<int>(a)] = millimetres * axis.translation;
        (axis.unit.empty() ? anyWithout : anyUnit) = true;
        if (a == 0 && !axis.unit.empty()) remarkUnit(header, axis.unit, millimetres);
    }
    place(header, step, origin);
    header.hasZSpacing = choice.placed;
    header.space = Space::unspecified;
    if (choice.placed && anyWithout)
        header.warnings.push_back(anyUnit ? "an axis names no unit; its lengths are taken as mm"
                                          : "its axes name no unit; lengths are taken as mm");
    header.warnings.push_back("its axes x, y, z are taken as they are: Zarr names no sides of a body");
}

}  // namespace

SourcePtr openZarr(const fs::path& path, const ImageReadOptions& options) {
    const ZarrChoice choice = chooseZarrArray(path);
    const std::string name = choice.array.string();
    ZarrArray array = readZarrArray(choice.array);
    Header header;
    header.format = choice.isOme ? "OME-Zarr" : "Zarr";
    header.type = array.type;
    const std::vector<ZarrAxis> axes = axesOf(name, array, choice, header);
    const Volume volume = volumeOf(name, array, axes, options);
    for (std::size_t a = 0; a < 3; ++a) header.size[a] = array.shape[volume.axis[a]];
    byteCount(name, {header.size[0], header.size[1], header.size[2]},
              static_cast<std::int64_t>(sizeOf(array.type)));
    placeZarr(name, volume, axes, choice, header);
    if (!choice.others.empty() && choice.array != path)
        header.warnings.push_back(
            fmt::format("its resolution {} is read; there are also {}: give {}",
                        choice.array.lexically_relative(path).string(), oneLine(choice.others),
                        (path / choice.others.substr(0, choice.others.find(','))).string()));
    const VolumeChunks chunks(std::move(array), volume);
    const std::int64_t all = chunks.count(0) * chunks.count(1) * chunks.count(2),
                       missing = all - chunks.present();
    if (missing == all)
        throw InputError(name, fmt::format("has none of its {} chunks; copy the store again", all));
    if (missing > 0)
        header.warnings.push_back(
            fmt::format("{} of {} chunks are not there; their voxels are the fill value, {}", missing, all,
                        chunks.array().fillText));
    return std::make_unique<ZarrSource>(chunks, std::move(header));
}

}  // namespace isowave::imageio
