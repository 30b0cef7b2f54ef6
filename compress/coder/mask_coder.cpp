#include "compress/coder/mask_coder.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include "compress/coder/match_model.h"
#include "compress/coder/mixer.h"

namespace isowave::compress {
namespace {

constexpr int kBlock = 8;
using Offset = std::array<int, 3>;
using Template = std::array<Offset, 16>;

// Found by trial on solids of four kinds: near bits first; the second reaches across thin walls, the third looks far.
constexpr std::array<Template, 3> kTemplates{{
    {{{0, 0, -1},
      {0, 0, -2},
      {0, 0, -3},
      {0, -1, 0},
      {0, -1, 1},
      {0, -1, -1},
      {0, -2, 0},
      {-1, 0, 0},
      {-1, 0, 1},
      {-1, 0, -1},
      {-1, 1, 0},
      {-1, -1, 0},
      {-2, 0, 0},
      {0, -1, 2},
      {-1, 0, 2},
      {-1, 1, 1}}},
    {{{0, 0, -1},
      {0, -1, 0},
      {-1, 0, 0},
      {0, -1, 1},
      {-1, 0, 1},
      {-1, 1, 0},
      {-1, 1, 1},
      {-1, 1, -1},
      {-1, -1, 1},
      {0, -2, 1},
      {-2, 0, 1},
      {-2, 1, 0},
      {-3, 0, 0},
      {0, -3, 0},
      {0, 0, -4},
      {-2, 0, 0}}},
    {{{0, 0, -1},
      {0, -1, 0},
      {-1, 0, 0},
      {0, -1, 1},
      {-1, 0, 1},
      {-1, 1, 0},
      {-1, 0, 3},
      {0, -1, 3},
      {-1, 2, 0},
      {-1, 3, 0},
      {0, -2, 2},
      {-2, 0, 2},
      {-2, 2, 0},
      {-1, 2, 2},
      {-2, 0, 0},
      {0, -2, 0}}},
}};

// Which blocks have a node.
class Blocks {
  public:
    explicit Blocks(const Size& size) : box_({blocksOf(size[0]), blocksOf(size[1]), blocksOf(size[2])}) {}
    static int blocksOf(int n) { return (n + kBlock - 1) / kBlock; }

    void mark(const BitBox& nodes) {
        const Size& n = nodes.size();
        for (int x = 0; x < n[0]; ++x)
            for (int y = 0; y < n[1]; ++y)
                for (int z = 0; z < n[2]; ++z)
                    if (nodes.get(x, y, z)) box_.set(x / kBlock, y / kBlock, z / kBlock);
    }
    bool hasNode(int x, int y, int z) const { return box_.get(x / kBlock, y / kBlock, z / kBlock); }
    void code(RangeCoder& coder) {
        const Size& n = box_.size();
        std::array<Counter, 64> counters;
        for (int x = 0; x < n[0]; ++x)
            for (int y = 0; y < n[1]; ++y)
                for (int z = 0; z < n[2]; ++z)
                    if (codeAlone(coder, counters[context(x, y, z)], box_.get(x, y, z))) box_.set(x, y, z);
    }

  private:
    bool at(int x, int y, int z) const {
        const Size& n = box_.size();
        return x >= 0 && y >= 0 && z >= 0 && y < n[1] && z < n[2] && box_.get(x, y, z);
    }
    std::size_t context(int x, int y, int z) const {
        return at(x - 1, y, z) + 2u * at(x, y - 1, z) + 4u * at(x, y, z - 1) + 8u * at(x - 1, y + 1, z) +
               16u * at(x - 1, y, z + 1) + 32u * at(x, y - 1, z + 1);
    }
    BitBox box_;
};

// The last four planes of nodes as bytes, with a margin on all sides so that templates need no test.
class Planes {
  public:
    explicit Planes(const Size& size)
        : stride_(static_cast<std::size_t>(size[2]) + 2 * kMargin),
          plane_(stride_ * (static_cast<std::size_t>(size[1]) + 2 * kMargin)),
          bytes_(4 * plane_, 0) {}

    void begin(int x) {
        const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(start(x));
        std::fill(first, first + static_cast<std::ptrdiff_t>(plane_), std::uint8_t{0});
    }
    std::size_t at(int x, int y, int z) const {
        return start(x) + static_cast<std::size_t>(y + kMargin) * stride_ +
               static_cast<std::size_t>(z + kMargin);
    }
    std::uint32_t get(std::size_t place) const { return bytes_[place]; }
    void set(std::size_t place) { bytes_[place] = 1; }

  private:
    static constexpr int kMargin = 4;
    std::size_t start(int x) const { return static_cast<std::size_t>((x + 4) % 4) * plane_; }
    std::size_t stride_, plane_;
    std::vector<std::uint8_t> bytes_;
};

class NodeModel {
  public:
    explicit NodeModel(const Size& size)
        : planes_(size), mixer_(1), matches_{MatchModel(16), MatchModel(40)} {
        for (auto& t : tables_) t.resize(std::size_t{1} << 16);
        for (auto& t : matchTables_) t.resize(16 * 8 * 2);
    }
    void begin(int x) { planes_.begin(x); }
    bool code(RangeCoder& coder, int x, int y, int z, bool bit) {
        Mixer<5>::Slots slots;
        for (std::size_t t = 0; t < 3; ++t) slots[t] = &tables_[t][contextOf(kTemplates[t], x, y, z)];
        const std::size_t near = planes_.get(planes_.at(x, y, z - 1)) +
                                 2 * planes_.get(planes_.at(x, y - 1, z)) +
                                 4 * planes_.get(planes_.at(x - 1, y, z));
        for (std::size_t m = 0; m < 2; ++m)
            slots[3 + m] = &matchTables_[m][contextOf(matches_[m]) * 8 + near];
        bit = mixer_.code(coder, slots, 0, bit);
        for (MatchModel& match : matches_) match.add(bit);
        if (bit) planes_.set(planes_.at(x, y, z));
        return bit;
    }

  private:
    std::size_t contextOf(const Template& offsets, int x, int y, int z) const {
        std::size_t context = 0;
        for (const Offset& o : offsets)
            context = 2 * context + planes_.get(planes_.at(x + o[0], y + o[1], z + o[2]));
        return context;
    }
    static std::size_t contextOf(const MatchModel& match) {
        const auto symbol = match.predicted();
        return symbol ? static_cast<std::size_t>(2 * matchBucket(match.length()) + *symbol) : 0;
    }
    Planes planes_;
    Mixer<5> mixer_;
    std::array<MatchModel, 2> matches_;
    std::array<std::vector<Counter>, 3> tables_;
    std::array<std::vector<Counter>, 2> matchTables_;
};

void codeNodes(RangeCoder& coder, BitBox& nodes) {
    const Size& n = nodes.size();
    Blocks blocks(n);
    if (!coder.decodes()) blocks.mark(nodes);
    blocks.code(coder);
    NodeModel model(n);
    for (int x = 0; x < n[0]; ++x) {
        model.begin(x);
        for (int y = 0; y < n[1]; ++y)
            for (int z = 0; z < n[2]; ++z)
                if (!blocks.hasNode(x, y, z))
                    z |= kBlock - 1;  // the block's end
                else if (model.code(coder, x, y, z, nodes.get(x, y, z)))
                    nodes.set(x, y, z);
    }
}

}  // namespace

std::string encodeNodes(const BitBox& nodes) {
    RangeCoder coder;
    BitBox copy = nodes;
    codeNodes(coder, copy);
    return coder.finish();
}

BitBox decodeNodes(std::string_view bytes, const Size& size) {
    RangeCoder coder(bytes);
    BitBox nodes(size);
    codeNodes(coder, nodes);
    if (!coder.atEnd()) throw std::runtime_error("the nodes end before their bytes do");
    return nodes;
}

}  // namespace isowave::compress
