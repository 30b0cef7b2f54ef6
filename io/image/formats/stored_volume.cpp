#include "io/image/formats/stored_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>

#include "base/text.h"
#include "io/image/check.h"
#include "io/image/plain.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// ~64 MB of the voxels at a time.
constexpr std::int64_t kMostBytes = std::int64_t(64) << 20;

std::int64_t bytesEach(const Header& header) { return static_cast<std::int64_t>(sizeOf(header.type)); }

std::int64_t slicesAtATime(const Header& header) {
    return std::clamp<std::int64_t>(kMostBytes / (header.sliceVoxels() * bytesEach(header)), 1,
                                    header.size[2]);
}

// One volume of voxels that have to be decoded, or that lie between others.
class DecodedSource : public VoxelSource {
  public:
    DecodedSource(const Header& from, const VoxelLayout& layout, std::int64_t volume)
        : inner_(layout.inner),
          swap_(layout.encoding != Encoding::text &&
                layout.bigEndian != (std::endian::native == std::endian::big)) {
        header = from;
        native = true;
        slicesPerRead = slicesAtATime(header);
        const std::int64_t voxels = header.sliceVoxels() * header.size[2];
        bytes_ =
            openVoxelBytes(layout, header.type, voxels * layout.inner * layout.outer * bytesEach(header));
        first_ = volume % inner_ + volume / inner_ * voxels * inner_;
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        auto* values = static_cast<char*>(out);
        const std::int64_t slice = header.sliceVoxels(), count = (z1 - z0) * slice;
        if (inner_ == 1)
            bytes_->read((first_ + z0 * slice) * bytesEach(header), values, count * bytesEach(header));
        else
            readEvery(z0 * slice, count, values);
        if (swap_) reverseBytes(sizeOf(header.type), values, count);
    }

  private:
    // Voxels `from` and on; each is one of inner_ numbers.
    void readEvery(std::int64_t from, std::int64_t count, char* out) {
        const std::int64_t each = bytesEach(header), chunk = std::max<std::int64_t>(1, (1 << 16) / inner_);
        const auto bytes = static_cast<std::size_t>(each);
        const std::int64_t number = first_ % inner_, before = first_ - number;
        std::vector<char> all(static_cast<std::size_t>(chunk * inner_ * each));
        for (std::int64_t n; count > 0; count -= n, from += n) {
            n = std::min(chunk, count);
            bytes_->read((before + from * inner_) * each, all.data(), n * inner_ * each);
            for (std::int64_t i = 0; i < n; ++i, out += each)
                std::copy_n(all.data() + (i * inner_ + number) * each, bytes, out);
        }
    }

    std::unique_ptr<VoxelBytes> bytes_;
    std::int64_t inner_, first_ = 0;  // first_: of the volume's numbers, among all that are stored
    bool swap_;
};

// slope * stored + intercept, computed in double precision and rounded to float32.
class ScaledSource : public VoxelSource {
  public:
    explicit ScaledSource(SourcePtr stored) : stored_(std::move(stored)) {
        header = stored_->header;
        header.storedType = header.type;
        header.type = ValueType::float32;
        slicesPerRead = stored_->slicesPerRead;
        plain = stored_->plain;
    }

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        const ValueType type = stored_->header.type;
        const auto count = static_cast<std::size_t>((z1 - z0) * header.sliceVoxels());
        std::vector<char> bytes(count * sizeOf(type));
        stored_->readNative(z0, z1, bytes.data());
        withType(type, [&]<class T>(T value) {
            for (std::size_t i = 0; i < count; ++i) {
                std::copy_n(bytes.data() + i * sizeof(T), sizeof(T), reinterpret_cast<char*>(&value));
                out[i] = static_cast<float>(header.slope * static_cast<double>(value) + header.intercept);
            }
        });
        return 0;
    }

    bool isZero(std::int64_t z0, std::int64_t z1) override {
        return header.intercept == 0 && stored_->isZero(z0, z1);
    }

  private:
    SourcePtr stored_;
};

[[noreturn]] void throwSeveral(const fs::path& path, const StoredVolume& volume, std::int64_t count) {
    throw InputError(path.string(),
                     fmt::format("is a series of {} volumes{}; choose one with --volume, 1 to {}", count,
                                 volume.volumesText.empty() ? "" : " (" + volume.volumesText + ")", count));
}

// Which volume is read, counted from 0; options.volume counts from 1.
std::int64_t chosen(const fs::path& path, const StoredVolume& volume, const ImageReadOptions& options) {
    const std::int64_t count = volume.voxels.inner * volume.voxels.outer;
    if (!options.volume && count > 1) throwSeveral(path, volume, count);
    const std::int64_t number = options.volume.value_or(1);
    if (number < 1 || number > count)
        throw InputError(
            path.string(),
            count == 1 ? fmt::format("holds one volume, number 1; --volume says {}", number)
                       : fmt::format("holds {} volumes, 1 to {}; --volume says {}", count, count, number));
    return number - 1;
}

}  // namespace

SourcePtr openStored(const fs::path& path, StoredVolume volume, const ImageReadOptions& options) {
    Header& header = volume.header;
    VoxelLayout& voxels = volume.voxels;
    const std::int64_t one =
        byteCount(path.string(), {header.size[0], header.size[1], header.size[2]}, bytesEach(header));
    const std::int64_t all = byteCount(path.string(), {one, voxels.inner, voxels.outer}, 1);
    checkVoxelBytes(path, voxels, header.type, all, volume.promise);
    const std::int64_t number = chosen(path, volume, options);
    SourcePtr source;
    if (voxels.encoding == Encoding::raw && voxels.pieces.size() == 1 && voxels.inner == 1) {
        const VoxelPiece& piece = voxels.pieces[0];
        source = openPlain({piece.file, piece.start + piece.skip + number * one, voxels.bigEndian}, header);
    } else {
        source = std::make_unique<DecodedSource>(header, voxels, number);
    }
    if (header.slope == 1 && header.intercept == 0) return source;
    return std::make_unique<ScaledSource>(std::move(source));
}

void place(Header& header, const std::array<Vec3, 3>& step, const Vec3& origin) {
    for (std::size_t a = 0; a < 3; ++a) {
        header.spacing[a] = length(step[a]);
        header.axis[a] = header.spacing[a] > 0 ? step[a] / header.spacing[a] : step[a];
    }
    header.origin = origin + Vec3{};  // -0 + 0 = 0
}

std::optional<double> millimetresIn(std::string unit) {
    static const std::map<std::string, double> units = {{"mm", 1},
                                                        {"millimeter", 1},
                                                        {"millimetre", 1},
                                                        {"millimeters", 1},
                                                        {"millimetres", 1},
                                                        {"m", 1e3},
                                                        {"meter", 1e3},
                                                        {"metre", 1e3},
                                                        {"meters", 1e3},
                                                        {"metres", 1e3},
                                                        {"cm", 10},
                                                        {"centimeter", 10},
                                                        {"centimetre", 10},
                                                        {"centimeters", 10},
                                                        {"centimetres", 10},
                                                        {"um", 1e-3},
                                                        {"\u00b5m", 1e-3},
                                                        {"\u03bcm", 1e-3},
                                                        {"micron", 1e-3},
                                                        {"microns", 1e-3},
                                                        {"micrometer", 1e-3},
                                                        {"micrometre", 1e-3},
                                                        {"micrometers", 1e-3},
                                                        {"micrometres", 1e-3},
                                                        {"nm", 1e-6},
                                                        {"nanometer", 1e-6},
                                                        {"nanometre", 1e-6},
                                                        {"nanometers", 1e-6},
                                                        {"nanometres", 1e-6},
                                                        {"angstrom", 1e-7},
                                                        {"in", 25.4},
                                                        {"inch", 25.4},
                                                        {"inches", 25.4}};
    const auto found = units.find(toLower(std::move(unit)));
    return found == units.end() ? std::nullopt : std::optional(found->second);
}

void remarkUnit(Header& header, const std::string& unit, double millimetres) {
    if (millimetres != 1)
        header.warnings.push_back(
            fmt::format("its lengths are in {}; they are taken as {:g} mm each", unit, millimetres));
}

void throwFlat(const fs::path& path, std::int64_t x, std::int64_t y, const std::string& remedy) {
    throw InputError(path.string(),
                     fmt::format("is a 2D image ({} x {}); expected a volume{}", x, y, remedy));
}

void throwNotScalar(const fs::path& path, const std::string& kind, std::int64_t numbers) {
    throw InputError(path.string(),
                     fmt::format("holds {} voxels of {} numbers; expected one number a voxel; convert it "
                                 "to grey",
                                 kind, numbers));
}

}  // namespace isowave::imageio
