// Images that are never whole in memory: slabs of slices, read as often as wanted, each forgotten afterwards.
//
//   ImageStream scan("scan.mha");                                   // 1024^3 uint8: 1 GB on disk
//   const ImageStatistics values = statisticsOf(scan);              // one pass (volume/image_statistics.h)
//   const NodeCollection nodes = nodesFromImage(scan, {.iso = 0.5});  // another (volume/nodes_image.h)
//
// Memory: a few MB, plus what comes out. Voxels that do not lie in a file as they are (compressed, rescaled,
// DICOM) are decoded once and kept, as int8, uint8, int16 or uint16 where that is what the file holds and as
// float32 otherwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "isowave/image.h"
#include "isowave/progress.h"

namespace isowave {

// Voxels as they are held; wider integers and float64 become float32, as in an Image.
using Voxels =
    std::variant<std::span<const std::int8_t>, std::span<const std::uint8_t>, std::span<const std::int16_t>,
                 std::span<const std::uint16_t>, std::span<const float>>;

// Slices z0 <= z < z1, x fastest.
struct Slab {
    std::int64_t z0, z1;
    Voxels voxels;
    bool zero = false;  // all voxels are 0, known without looking (a hole of a sparse file)
};

class ImageStream {
  public:
    // Throws what readImage() throws, but for voxels that are not finite, which the first pass finds.
    // slabSlices: slices that are read at a time; 0: about 1 MB of them. No result depends on it.
    explicit ImageStream(const std::filesystem::path& path, const ImageReadOptions& options = {},
                         std::int64_t slabSlices = 0);
    // Over an image in memory, which must outlive the stream.
    explicit ImageStream(const Image& image, std::int64_t slabSlices = 0);
    // Over voxels in memory of the caller's, which must outlive the stream; they are gathered a slab at a time unless they lie
    // as they are handed out. Of the options only `nan` has a meaning.
    explicit ImageStream(const VoxelView& view, const ImageReadOptions& options = {},
                         std::int64_t slabSlices = 0);
    ~ImageStream();
    ImageStream(ImageStream&&) noexcept;
    ImageStream& operator=(ImageStream&&) noexcept;

    // From now on voxels are 1 where they hold one of these values (as float32) and 0 elsewhere, as uint8: the union of
    // several labels. REQUIRES: at least one value.
    void takeAsMask(std::vector<float> values);

    // From now on the image is its slices z0 <= z < z1 alone, counted from 0, with their origin. Each call counts in the whole image.
    // Voxels that are not finite are found by the first pass over all slices that it comes to, be they all or some.
    void showSlices(std::int64_t z0, std::int64_t z1);

    // All but `values`. The warning about rounded integers is there after the first pass.
    const Image& header() const;
    // Slices in a slab; the last one of the image may have fewer.
    std::int64_t slabSlices() const;
    // False when all voxels are in memory.
    bool isInFile() const;
    // Bytes of the voxels that the stream itself keeps in memory, once it has been passed over.
    std::int64_t bytesKept() const;

    // One pass: each(slab) for every slab, by several threads at once, a batch of slabs at a time; after a
    // batch, done(z) on the calling thread, z the number of slices that are behind.
    // Throws InputError: a file that cannot be read any more; in the first pass, after its last batch, voxels
    // that are not finite. Throws Cancelled.
    void pass(std::string_view stage, const Progress& progress, const std::function<void(const Slab&)>& each,
              const std::function<void(std::int64_t z)>& done = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace isowave
