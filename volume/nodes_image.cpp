// Node-Collections from images, a layer of blocks at a time.
//
//   pack      a slice of voxels -> a plane of bits, one a lattice point, 8 along x in a byte: a block is one byte
//             wide
//   classify  the 9 planes from a layer's first lattice points to the first of the next -> blocks: all inside, all
//             outside (told of 8 blocks at once), or a leaf
//   forget    planes that no later layer needs
// Bytes beside the image: 0, or with an open border the border's voxels continued.
#include "volume/nodes_image.h"

#include <tbb/parallel_for.h>

#include <bit>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>

#include "volume/linear_transform.h"

namespace isowave {
namespace {

using openvdb::Coord;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using Word = std::uint64_t;
static_assert(BoolLeaf::LOG2DIM == 3, "a leaf's masks are eight words, one a position along x");

// Bit i: flags[i], which is 0 or 1.
std::uint8_t packed(const std::uint8_t* flags) {
    if constexpr (std::endian::native == std::endian::little) {
        // Flag i lies at bit 8i of the word and goes to bit 56 + i: times 2^(56 - 7i). No two of the 64
        // products 2^(8i + 56 - 7j) are the same, so nothing carries.
        Word word;
        std::memcpy(&word, flags, sizeof word);
        return static_cast<std::uint8_t>(word * 0x0102040810204080u >> 56);
    } else {
        unsigned byte = 0;
        for (int i = 0; i < 8; ++i) byte |= static_cast<unsigned>(flags[i]) << i;
        return static_cast<std::uint8_t>(byte);
    }
}

// Whether each of n values is inside, from the first bit of `out` on; bits behind the last one are 0.
template <class T>
void packRow(const T* values, std::int64_t n, T low, T high, bool flip, std::uint8_t* out) {
    constexpr std::int64_t kChunk = 64;
    for (std::int64_t from = 0; from < n; from += kChunk) {
        std::uint8_t flags[kChunk] = {};
        const auto count = static_cast<int>(std::min(kChunk, n - from));
        for (int i = 0; i < count; ++i)
            flags[i] =
                static_cast<std::uint8_t>(((values[from + i] >= low) & (values[from + i] <= high)) ^ flip);
        for (int i = 0; i < count; i += 8) *out++ = packed(flags + i);
    }
}

// The bits of one z: rows of a whole number of words. Row r is lattice row y = low.y + r; bit b of a row is
// x = low.x + b. Behind the last block lies at least one bit more, on both axes.
class Plane {
  public:
    Plane(std::size_t rows, std::size_t words) : words_(words), bits_(rows * words, 0) {}
    const Word* row(std::size_t r) const { return &bits_[r * words_]; }
    Word* row(std::size_t r) { return &bits_[r * words_]; }
    std::uint8_t* bytes(std::size_t r) { return reinterpret_cast<std::uint8_t*>(row(r)); }
    const std::uint8_t* bytes(std::size_t r) const { return reinterpret_cast<const std::uint8_t*>(row(r)); }
    std::size_t words() const { return words_; }
    void copyRow(std::size_t from, std::size_t to) { std::copy_n(row(from), words_, row(to)); }

  private:
    std::size_t words_;
    std::vector<Word> bits_;
};

// Where blocks lie. Node i needs corner i + 1, so nodes start one below the box.
struct Layout {
    openvdb::CoordBBox box;   // of lattice points that may be inside
    Coord low, blocks;        // the first block's origin; how many
    std::size_t rows, words;  // of a plane

    explicit Layout(const openvdb::CoordBBox& inside)
        : box(inside), low(box.min().offsetBy(-1) & ~7), blocks((((box.max() & ~7) - low) >> 3).offsetBy(1)) {
        rows = static_cast<std::size_t>(blocks.y()) * 8 + 1;
        words = static_cast<std::size_t>(blocks.x() + 1 + 7) / 8;  // one byte more than blocks
    }
};

class Packer {
  public:
    Packer(const Image& image, const ImageSolid& solid, const Layout& layout)
        : size_(image.size), test_(solid), layout_(layout), margin_(solid.openBorder ? kOpenBorder : 0) {}

    // The plane of slice z of a slab.
    Plane plane(const Slab& slab, std::int64_t z) const {
        Plane plane(layout_.rows, layout_.words);
        if (slab.zero && !test_(0.0f)) return plane;
        const auto first = static_cast<std::size_t>(-layout_.low.y());
        std::visit(
            [&]<class T>(std::span<const T> voxels) {
                const auto [low, high] = test_.rangeIn<T>();
                const T* slice = voxels.data() + (z - slab.z0) * size_[0] * size_[1];
                for (std::int64_t y = 0; y < size_[1]; ++y) {
                    const std::size_t r = first + static_cast<std::size_t>(y);
                    packRow(slice + y * size_[0], size_[0], low, high, test_.flip,
                            plane.bytes(r) + (-layout_.low.x() >> 3));
                    if (margin_ > 0) continueRow(plane.bytes(r));
                }
            },
            slab.voxels);
        for (std::size_t i = 1; i <= static_cast<std::size_t>(margin_); ++i) {
            const std::size_t last = first + static_cast<std::size_t>(size_[1]) - 1;
            plane.copyRow(first, first - i);
            plane.copyRow(last, last + i);
        }
        return plane;
    }

  private:
    void continueRow(std::uint8_t* row) const {
        const std::int64_t first = -layout_.low.x(), last = first + size_[0] - 1;
        const auto get = [&](std::int64_t bit) { return row[bit >> 3] >> (bit & 7) & 1; };
        const int before = get(first), behind = get(last);
        for (int i = 1; i <= margin_; ++i) {
            row[(first - i) >> 3] =
                static_cast<std::uint8_t>(row[(first - i) >> 3] | before << ((first - i) & 7));
            row[(last + i) >> 3] =
                static_cast<std::uint8_t>(row[(last + i) >> 3] | behind << ((last + i) & 7));
        }
    }

    std::array<std::int64_t, 3> size_;
    InsideTest test_;
    const Layout& layout_;
    int margin_;
};

using Layer = std::array<const Plane*, 9>;  // z = origin .. origin + 8

// The leaf at byte k of the 9 rows from r on. S(x, y, z): the sign at its lattice point, 0 <= x, y, z <= 8. A
// node is stabbed unless its 8 corners agree.
std::unique_ptr<BoolLeaf> makeLeaf(const Layer& layer, std::size_t r, std::size_t k, const Coord& origin) {
    std::array<std::array<unsigned, 9>, 9> alongZ{};  // [x][y]: bit z
    for (unsigned z = 0; z < 9; ++z)
        for (std::size_t y = 0; y < 9; ++y) {
            const std::uint8_t* row = layer[z]->bytes(r + y) + k;
            const unsigned bits = row[0] | static_cast<unsigned>(row[1]) << 8;
            for (unsigned x = 0; x < 9; ++x) alongZ[x][y] |= (bits >> x & 1) << z;
        }
    // Words of bits 8y + z, as in a leaf's masks: S(x, y + dy, z + dz) for 0 <= y, z < 8.
    const auto word = [&](std::size_t x, std::size_t dy, unsigned dz) {
        Word result = 0;
        for (std::size_t y = 0; y < 8; ++y) result |= Word(alongZ[x][y + dy] >> dz & 0xff) << 8 * y;
        return result;
    };
    struct Corners {
        Word first, any, all;
    };
    const auto corners = [&](std::size_t x) {
        const Word a = word(x, 0, 0), b = word(x, 0, 1), c = word(x, 1, 0), d = word(x, 1, 1);
        return Corners{a, a | b | c | d, a & b & c & d};
    };
    auto leaf = std::make_unique<BoolLeaf>(origin, false, false);
    BoolLeaf::NodeMaskType stabbed;
    Corners here = corners(0);
    for (unsigned x = 0; x < 8; ++x) {
        const Corners next = corners(x + 1);
        leaf->buffer().data()[x] = here.first;
        stabbed.getWord<Word>(x) = (here.any | next.any) & ~(here.all & next.all);
        here = next;
    }
    leaf->setValueMask(stabbed);
    return leaf;
}

// The blocks of one row of blocks.
struct Row {
    std::vector<std::unique_ptr<BoolLeaf>> leaves;
    std::vector<int> inside;  // x of blocks that are all inside
};

Row classifyRow(const Layer& layer, const Layout& layout, int by, int z) {
    Row row;
    const std::size_t r = static_cast<std::size_t>(by) * 8, words = layout.words;
    std::vector<Word> any(words, 0), all(words, ~Word(0));
    for (const Plane* plane : layer)
        for (std::size_t y = 0; y < 9; ++y) {
            const Word* bits = plane->row(r + y);
            for (std::size_t w = 0; w < words; ++w) {
                any[w] |= bits[w];
                all[w] &= bits[w];
            }
        }
    const auto* anyByte = reinterpret_cast<const std::uint8_t*>(any.data());
    const auto* allByte = reinterpret_cast<const std::uint8_t*>(all.data());
    for (int bx = 0; bx < layout.blocks.x(); ++bx) {
        const Coord origin(layout.low.x() + 8 * bx, layout.low.y() + 8 * by, z);
        if (anyByte[bx] == 0 && (anyByte[bx + 1] & 1) == 0) continue;
        if (allByte[bx] == 0xff && (allByte[bx + 1] & 1) != 0)
            row.inside.push_back(origin.x());
        else
            row.leaves.push_back(makeLeaf(layer, r, static_cast<std::size_t>(bx), origin));
    }
    return row;
}

// Planes come in any order within a batch and go as soon as their last layer is made.
class Layers {
  public:
    Layers(const Image& image, const ImageSolid& solid, openvdb::BoolTree& tree)
        : layout_(boxOf(image, solid.openBorder)),
          packer_(image, solid, layout_),
          depth_(image.size[2]),
          margin_(solid.openBorder ? kOpenBorder : 0),
          nothing_(layout_.rows, layout_.words),
          next_(layout_.low.z()),
          tree_(tree) {}

    void take(const Slab& slab) {
        for (std::int64_t z = slab.z0; z < slab.z1; ++z) {
            auto plane = std::make_unique<Plane>(packer_.plane(slab, z));
            const std::lock_guard lock(mutex_);
            planes_[z] = std::move(plane);
        }
    }

    // All slices below z have been taken.
    void classify(std::int64_t z) {
        const int end = layout_.low.z() + 8 * layout_.blocks.z();
        for (; next_ < end && (next_ + 8 < z || z == depth_); next_ += 8) addLayer(next_);
        // An open border continues the last slice, which is never behind the next layer.
        planes_.erase(planes_.begin(), planes_.lower_bound(std::min<std::int64_t>(next_, depth_ - 1)));
    }

  private:
    const Plane* planeAt(std::int64_t z) const {
        if (z < -margin_ || z >= depth_ + margin_) return &nothing_;
        return planes_.at(std::clamp<std::int64_t>(z, 0, depth_ - 1)).get();
    }

    void addLayer(int z) {
        Layer layer;
        for (int i = 0; i < 9; ++i) layer[static_cast<std::size_t>(i)] = planeAt(z + i);
        std::vector<Row> rows(static_cast<std::size_t>(layout_.blocks.y()));
        tbb::parallel_for(0, layout_.blocks.y(), [&](int by) {
            rows[static_cast<std::size_t>(by)] = classifyRow(layer, layout_, by, z);
        });
        for (int by = 0; by < layout_.blocks.y(); ++by) {
            Row& row = rows[static_cast<std::size_t>(by)];
            for (auto& leaf : row.leaves) tree_.addLeaf(leaf.release());
            for (const int x : row.inside)
                tree_.addTile(1, Coord(x, layout_.low.y() + 8 * by, z), true, false);
        }
    }

    Layout layout_;
    Packer packer_;
    std::int64_t depth_;
    int margin_;
    Plane nothing_;
    int next_;  // origin of the next layer
    std::mutex mutex_;
    std::map<std::int64_t, std::unique_ptr<Plane>> planes_;
    openvdb::BoolTree& tree_;
};

}  // namespace

NodeCollection nodesFromImage(ImageStream& stream, const ImageSolid& solid, const Progress& progress) {
    const Image& image = stream.header();
    const auto transform = linearTransform(image.indexToWorld, "image");
    NodeCollection nodes{openvdb::BoolGrid::create(false)};
    nodes.grid->setTransform(transform);
    if (image.voxelCount() == 0) return nodes;
    Layers layers(image, solid, nodes.grid->tree());
    stream.pass(
        "collecting nodes", progress, [&](const Slab& slab) { layers.take(slab); },
        [&](std::int64_t z) { layers.classify(z); });
    nodes.grid->tree().prune();
    return nodes;
}

NodeCollection nodesFromImage(const Image& image, const ImageSolid& solid, const Progress& progress) {
    ImageStream stream(image);
    return nodesFromImage(stream, solid, progress);
}

NodeCollection nodesFromLabel(const Image& image, double label, bool openBorder, const Progress& progress) {
    return nodesFromImage(image, {.label = label, .openBorder = openBorder}, progress);
}

}  // namespace isowave
