#include "volume/grid_bytes.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_pipeline.h>

#include <sstream>
#include <string>
#include <utility>

namespace isowave {
namespace {

constexpr std::size_t kBlockLeaves = 256, kBlocksAhead = 16;

// Leaves [begin, end) as bytes. `like`: the stream that they are for, which carries what OpenVDB wants to
// know (compression, background).
template <class Leaves>
std::string bytesOf(const Leaves& leaves, std::size_t begin, std::size_t end, const std::ostream& like,
                    bool toHalf) {
    std::ostringstream bytes;
    bytes.copyfmt(like);
    for (std::size_t i = begin; i < end; ++i) leaves.leaf(i).writeBuffers(bytes, toHalf);
    return std::move(bytes).str();
}

// pass 1, in order: the next block; pass 2, in parallel: its bytes; pass 3, in order: out with them.
template <class Tree>
void writeLeaves(const Tree& tree, std::ostream& out, bool toHalf) {
    const openvdb::tree::LeafManager<const Tree> leaves(tree);
    const std::size_t count = leaves.leafCount();
    std::size_t next = 0;
    const auto begin = [&](tbb::flow_control& flow) {
        const std::size_t at = next;
        if (at >= count) flow.stop();
        next += kBlockLeaves;
        return at;
    };
    const auto serialise = [&](std::size_t at) {
        return bytesOf(leaves, at, std::min(count, at + kBlockLeaves), out, toHalf);
    };
    const auto write = [&](const std::string& bytes) {
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    };
    using tbb::filter_mode;
    tbb::parallel_pipeline(kBlocksAhead,
                           tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, begin) &
                               tbb::make_filter<std::size_t, std::string>(filter_mode::parallel, serialise) &
                               tbb::make_filter<std::string, void>(filter_mode::serial_in_order, write));
}

template <class Grid>
class ParallelGrid : public Grid {
  public:
    ParallelGrid() = default;
    explicit ParallelGrid(const Grid& grid) : Grid(const_cast<Grid&>(grid), openvdb::ShallowCopy()) {}
    void writeBuffers(std::ostream& out) const override {
        writeLeaves(this->constTree(), out, this->saveFloatAsHalf());
    }
};

// What Archive::write() asks a grid for first is a copy, to which it adds statistics and whose metadata it writes; then it reads the
// grid itself, and writes its buffers last.
template <class Grid>
class GridToBeMade : public ParallelGrid<Grid> {
  public:
    GridToBeMade(const std::string& name, std::function<typename Grid::Ptr()> make) : make_(std::move(make)) {
        this->setName(name);
    }
    openvdb::GridBase::ConstPtr copyGrid() const override {
        const typename Grid::Ptr made = make_();
        made->setName(this->getName());
        put(made->treePtr(), made->transformPtr());
        return std::as_const(*made).copyGrid();
    }
    void writeBuffers(std::ostream& out) const override {
        ParallelGrid<Grid>::writeBuffers(out);
        put(std::make_shared<typename Grid::TreeType>(this->background()),
            openvdb::math::Transform::createLinearTransform());
    }

  private:
    // Archive takes grids that are const; this one is none (madeWhenWritten()).
    void put(const typename Grid::TreePtrType& tree, const openvdb::math::Transform::Ptr& transform) const {
        auto& self = const_cast<GridToBeMade&>(*this);
        self.setTree(tree);
        self.setTransform(transform);
    }
    std::function<typename Grid::Ptr()> make_;
};

template <class Grid>
bool writesInParallel(const openvdb::GridBase& grid) {
    return dynamic_cast<const ParallelGrid<Grid>*>(&grid) != nullptr;
}

}  // namespace

openvdb::GridBase::ConstPtr writtenInParallel(const openvdb::GridBase::ConstPtr& grid) {
    using openvdb::BoolGrid, openvdb::FloatGrid;
    if (writesInParallel<FloatGrid>(*grid) || writesInParallel<BoolGrid>(*grid)) return grid;
    if (const auto floats = openvdb::gridConstPtrCast<FloatGrid>(grid))
        return std::make_shared<ParallelGrid<FloatGrid>>(*floats);
    if (const auto bools = openvdb::gridConstPtrCast<BoolGrid>(grid))
        return std::make_shared<ParallelGrid<BoolGrid>>(*bools);
    return grid;
}

template <class Grid>
openvdb::GridBase::ConstPtr madeWhenWritten(const std::string& name,
                                            std::function<typename Grid::Ptr()> make) {
    return std::make_shared<GridToBeMade<Grid>>(name, std::move(make));
}
template openvdb::GridBase::ConstPtr madeWhenWritten<openvdb::FloatGrid>(
    const std::string&, std::function<openvdb::FloatGrid::Ptr()>);
template openvdb::GridBase::ConstPtr madeWhenWritten<openvdb::BoolGrid>(
    const std::string&, std::function<openvdb::BoolGrid::Ptr()>);

}  // namespace isowave
