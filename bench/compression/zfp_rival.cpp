#include <array>
#include <map>

#include "field_rivals.h"

#ifdef ISOWAVE_WITH_ZFP

#include <zfp.h>

namespace isowave::bench {
namespace {

constexpr int kEdge = 4;
using Block = std::array<float, 64>;
using Place = std::array<int, 3>;  // of a block, in the order of the file

// Of lattice point (x, y, z) of the box: its block and where in it.
Place blockOf(int x, int y, int z) { return {x / kEdge, y / kEdge, z / kEdge}; }
std::size_t within(int x, int y, int z) {
    return static_cast<std::size_t>(x % kEdge + kEdge * (y % kEdge) + kEdge * kEdge * (z % kEdge));
}

template <class Each>
void forEachPoint(const compress::Lattice& lattice, const Each& each) {
    for (int x = 0; x < lattice.size[0]; ++x)
        for (int y = 0; y < lattice.size[1]; ++y)
            for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                 i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                each(i, x, y, lattice.z[i]);
}

Block blockAt(const Place& place, const FieldPoints& points, openvdb::FloatGrid::ConstAccessor& value) {
    Block block;
    const openvdb::Coord low = points.origin.offsetBy(kEdge * place[0], kEdge * place[1], kEdge * place[2]);
    for (int x = 0; x < kEdge; ++x)
        for (int y = 0; y < kEdge; ++y)
            for (int z = 0; z < kEdge; ++z)
                block[within(x, y, z)] = value.getValue(low.offsetBy(x, y, z)) / static_cast<float>(points.K);
    return block;
}

std::map<Place, Block> blocksOf(const FieldPoints& points, const BSplineField& field) {
    std::map<Place, Block> blocks;
    auto value = field.controlPoints->getConstAccessor();
    forEachPoint(points.lattice, [&](std::size_t, int x, int y, int z) {
        const Place place = blockOf(x, y, z);
        if (!blocks.contains(place)) blocks[place] = blockAt(place, points, value);
    });
    return blocks;
}

// A stream of zfp over bytes.
class Stream {
  public:
    Stream(void* bytes, std::size_t size, double tolerance)
        : bits_(stream_open(bytes, size)), zfp_(zfp_stream_open(bits_)) {
        zfp_stream_set_accuracy(zfp_, tolerance);
        zfp_stream_rewind(zfp_);
    }
    Stream(const Stream&) = delete;
    ~Stream() {
        zfp_stream_close(zfp_);
        stream_close(bits_);
    }
    zfp_stream* get() { return zfp_; }

  private:
    bitstream* bits_;
    zfp_stream* zfp_;
};

std::string encode(const std::map<Place, Block>& blocks, double tolerance) {
    std::string bytes(blocks.size() * sizeof(Block) * 2 + 1024, '\0');
    Stream stream(bytes.data(), bytes.size(), tolerance);
    for (const auto& [place, block] : blocks) zfp_encode_block_float_3(stream.get(), block.data());
    zfp_stream_flush(stream.get());
    bytes.resize(zfp_stream_compressed_size(stream.get()));
    return bytes;
}

Values decode(std::string_view bytes, std::map<Place, Block> blocks, const FieldPoints& points,
              double tolerance) {
    std::string copy(bytes);
    copy.resize(copy.size() + 1024);  // zfp reads ahead
    Stream stream(copy.data(), copy.size(), tolerance);
    for (auto& [place, block] : blocks) zfp_decode_block_float_3(stream.get(), block.data());
    Values values(points.c.size());
    forEachPoint(points.lattice, [&](std::size_t i, int x, int y, int z) {
        values[i] = blocks.at(blockOf(x, y, z))[within(x, y, z)] * static_cast<float>(points.K);
    });
    return values;
}

}  // namespace

FieldRival zfpBlocks(const FieldPoints& points, const BSplineField& field) {
    const auto blocks = std::make_shared<const std::map<Place, Block>>(blocksOf(points, field));
    FieldRival rival{.name = "zfp"};
    rival.encode = [blocks](double tolerance) { return encode(*blocks, tolerance); };
    rival.decode = [blocks, &points](std::string_view bytes, double tolerance) {
        return decode(bytes, *blocks, points, tolerance);
    };
    return rival;
}

}  // namespace isowave::bench

#else

namespace isowave::bench {

FieldRival zfpBlocks(const FieldPoints&, const BSplineField&) { return {.name = "zfp"}; }

}  // namespace isowave::bench

#endif
