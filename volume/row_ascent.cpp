#include "volume/row_ascent.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/vectors.h"

// Passes:
//   group   rows by the leaf of their first control point, shuffled inside it by a hash of their places
//   gather  the leaves of I that rows reach, copied to doubles; each group's eight of them; sum w^2 of each row
//   sweep   colour by colour; a leaf's rows work on a dense block of 11^3 that is copied in and out
//   scatter doubles back to floats
// invariant: the doubles of a leaf that no row moved are its floats.

namespace isowave {
namespace {

using FloatTree = openvdb::FloatTree;
using FloatLeaf = FloatTree::LeafNodeType;

constexpr int kSize = 11;  // a leaf, and what the four taps of its last point reach in the next one
constexpr int kBlock = kSize * kSize * kSize;

// A dense copy of the control points that the rows of a leaf reach.
struct Block {
    std::array<double, kBlock> c;
    std::array<double, kBlock> known;  // 1 in I, else 0
};

struct Row {
    std::array<float, 3> t;  // of the way from the second to the third control point on each axis
    float sign, bound, rho;
    float squares = 0;    // sum of w^2 over I
    std::uint16_t first;  // of the 64 control points, in the block
    bool equal;
    bool whole = true;  // all 64 are in I
    double lambda = 0;
};

// The rows whose first control point lies in one leaf.
struct Group {
    openvdb::Coord origin;
    std::uint32_t begin, end;  // of its rows
    std::uint32_t active = 0;  // how many of them are listed as active
    bool whole = true;         // all its rows are
    std::array<std::int32_t, 8>
        leaves;                    // bit 2 x, bit 1 y, bit 0 z: the next one on that axis; -1: no leaf there
    std::array<float, 8> uniform;  // the value where there is none
    std::array<std::int32_t, 27> near;  // groups beside it and itself, -1: none
};

std::uint64_t mixed(std::uint64_t h) {  // splitmix64's finaliser
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

openvdb::Coord firstPointOf(const openvdb::Vec3d& at) { return openvdb::Coord::floor(at).offsetBy(-1); }

// ---- group

struct Order {
    openvdb::Coord leaf;
    std::uint64_t hash;
    std::uint32_t row;
};

std::vector<Order> ordered(const std::vector<FieldRow>& rows) {
    std::vector<Order> order(rows.size());
    tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t i) {
        const FieldRow& row = rows[i];
        std::uint64_t hash = 0;
        for (int a = 0; a < 3; ++a) hash = mixed(hash ^ std::bit_cast<std::uint64_t>(row.at[a]));
        for (const float value : {row.sign, row.bound, row.rho})
            hash = mixed(hash ^ std::bit_cast<std::uint32_t>(value));
        order[i] = {firstPointOf(row.at) & ~7, mixed(hash ^ std::uint64_t(row.equal)),
                    static_cast<std::uint32_t>(i)};
    });
    tbb::parallel_sort(order.begin(), order.end(), [](const Order& a, const Order& b) {
        if (a.leaf != b.leaf) return a.leaf < b.leaf;
        if (a.hash != b.hash) return a.hash < b.hash;
        return a.row < b.row;  // equal rows
    });
    return order;
}

Row rowOf(const FieldRow& given, const openvdb::Coord& leaf) {
    Row row{};
    const openvdb::Coord first = firstPointOf(given.at), local = first - leaf;
    for (int a = 0; a < 3; ++a) row.t[a] = static_cast<float>(given.at[a] - (first[a] + 1));
    row.sign = given.sign;
    row.bound = given.bound;
    row.rho = given.rho;
    row.first = static_cast<std::uint16_t>((local[0] * kSize + local[1]) * kSize + local[2]);
    row.equal = given.equal;
    row.whole = true;
    return row;
}

// ---- one row on a block

// Four neighbours in z, side by side: one register of AVX2, two of SSE2, the same bits.
typedef double Quad __attribute__((vector_size(32)));
ISOWAVE_INLINE Quad load(const double* from) {
    Quad v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}
ISOWAVE_INLINE void store(double* to, Quad v) { __builtin_memcpy(to, &v, sizeof v); }

struct RowWeights {
    std::array<std::array<double, 4>, 4> xy;
    Quad z;
    ISOWAVE_INLINE explicit RowWeights(const Row& row) {
        const auto x = sixfold(row.t[0]), y = sixfold(row.t[1]), along = sixfold(row.t[2]);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) xy[i][j] = x[i] * y[j];
        z = load(along.data()) * (1.0 / (6 * 6 * 6));
    }
    // cubicWeights() without its twelve divisions, which cost as much as the row's sum.
    ISOWAVE_INLINE static std::array<double, 4> sixfold(double t) {
        const double u = 1 - t, tt = t * t, ttt = tt * t;
        return {u * u * u, 3 * ttt - 6 * tt + 4, -3 * ttt + 3 * tt + 3 * t + 1, ttt};
    }
};

constexpr int lineOf(int i, int j) { return (i * kSize + j) * kSize; }

ISOWAVE_INLINE double dotWith(const RowWeights& w, const double* first) {
    Quad sum{};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum += w.xy[i][j] * load(first + lineOf(i, j));
    sum *= w.z;
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

ISOWAVE_INLINE void add(double scale, const RowWeights& w, double* first) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double* const line = first + lineOf(i, j);
            store(line, load(line) + scale * w.xy[i][j] * w.z);
        }
}

ISOWAVE_INLINE void addWhereKnown(double scale, const RowWeights& w, const double* known, double* first) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double* const line = first + lineOf(i, j);
            store(line, load(line) + scale * w.xy[i][j] * w.z * load(known + lineOf(i, j)));
        }
}

// sum of w^2 over I, and whether that is all of them.
void weigh(Row& row, const Block& block) {
    const RowWeights w(row);
    double squares = 0, count = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k) {
                const double here = w.xy[i][j] * w.z[k], known = block.known[row.first + lineOf(i, j) + k];
                squares += here * here * known;
                count += known;
            }
    row.squares = static_cast<float>(squares);
    row.whole = count == 64;
}

struct Visit {
    double change;  // of F at the row
    bool active;
};

ISOWAVE_INLINE double violationOf(const Row& row, const RowWeights& w, const Block& block) {
    return row.sign * dotWith(w, &block.c[row.first]) + row.bound;
}

ISOWAVE_INLINE Visit visit(Row& row, Block& block, double tolerance) {
    const RowWeights w(row);
    const double r = violationOf(row, w, block);
    double lambda = row.lambda + (r - row.rho * row.lambda) / (double(row.squares) + row.rho);
    if (!row.equal) lambda = std::max(0.0, lambda);
    const double step = lambda - row.lambda;
    row.lambda = lambda;
    if (step != 0) {
        double* first = &block.c[row.first];
        if (row.whole)
            add(-row.sign * step, w, first);
        else
            addWhereKnown(-row.sign * step, w, &block.known[row.first], first);
    }
    return {std::abs(step) * row.squares, lambda > 0 || row.equal || r > -tolerance};
}

// Calls take(offset in the leaf, offset in the block, count) for every line along z of part b of a block.
template <class Take>
void eachLine(int b, const Take& take) {
    const auto from = [b](int bit) { return b & bit ? 8 : 0; };
    const auto to = [b](int bit) { return b & bit ? kSize : 8; };
    for (int x = from(4); x < to(4); ++x)
        for (int y = from(2); y < to(2); ++y)
            take(((x & 7) << 6) | ((y & 7) << 3), (x * kSize + y) * kSize + from(1), to(1) - from(1));
}

// ---- the sweeps

class Ascent {
  public:
    Ascent(BSplineField& field, const std::vector<FieldRow>& rows, const AscentOptions& options)
        : field_(field), options_(options) {
        report_.rows = static_cast<std::int64_t>(rows.size());
        group(rows);
        gather();
    }

    AscentReport run(const Progress& progress) {
        std::vector<std::uint32_t> list(groups_.size());
        std::iota(list.begin(), list.end(), 0);
        report_.settled = list.empty();
        while (!report_.settled && report_.rounds < options_.rounds) {
            progress.check();
            list = round(list);
            ++report_.rounds;
            report_.settled = list.empty();
        }
        countUnmet();
        scatter();
        return report_;
    }

  private:
    void group(const std::vector<FieldRow>& rows) {
        const std::vector<Order> order = ordered(rows);
        rows_.resize(order.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) {
            if (i == 0 || order[i].leaf != order[i - 1].leaf) {
                groups_.push_back({});
                groups_.back().origin = order[i].leaf;
                groups_.back().begin = i;
            }
            groups_.back().end = i + 1;
        }
        tbb::parallel_for(std::size_t(0), order.size(),
                          [&](std::size_t i) { rows_[i] = rowOf(rows[order[i].row], order[i].leaf); });
        active_.resize(rows_.size());
        moved_.resize(groups_.size());
        for (std::uint32_t g = 0; g < groups_.size(); ++g) groupAt_[groups_[g].origin] = std::int32_t(g);
        for (Group& g : groups_)
            for (int b = 0; b < 27; ++b)
                g.near[b] = groupAt(g.origin.offsetBy(8 * (b / 9 - 1), 8 * (b / 3 % 3 - 1), 8 * (b % 3 - 1)));
    }

    std::int32_t groupAt(const openvdb::Coord& origin) const {
        const auto found = groupAt_.find(origin);
        return found == groupAt_.end() ? -1 : found->second;
    }

    void gather() {
        std::unordered_map<openvdb::Coord, std::int32_t, std::hash<openvdb::Coord>> at;
        auto& tree = field_.controlPoints->tree();
        for (Group& g : groups_)
            for (int b = 0; b < 8; ++b) {
                const openvdb::Coord origin = g.origin.offsetBy(b & 4 ? 8 : 0, b & 2 ? 8 : 0, b & 1 ? 8 : 0);
                FloatLeaf* leaf = tree.probeLeaf(origin);
                g.uniform[b] = leaf ? 0 : tree.getValue(origin);
                g.leaves[b] = -1;
                if (!leaf) continue;
                const auto [found, isNew] = at.emplace(origin, std::int32_t(leaves_.size()));
                if (isNew) leaves_.push_back(leaf);
                g.leaves[b] = found->second;
            }
        values_.resize(leaves_.size());
        tbb::parallel_for(std::size_t(0), leaves_.size(), [this](std::size_t i) {
            std::copy_n(leaves_[i]->buffer().data(), 512, values_[i].begin());
        });
        tbb::parallel_for(std::size_t(0), groups_.size(), [this](std::size_t i) { weighRows(groups_[i]); });
    }

    void weighRows(Group& g) {
        Block block;
        openKnown(g, block);
        for (std::uint32_t i = g.begin; i < g.end; ++i) {
            weigh(rows_[i], block);
            g.whole = g.whole && rows_[i].whole;
        }
    }

    void openKnown(const Group& g, Block& block) const {
        for (int b = 0; b < 8; ++b) {
            const FloatLeaf* leaf = g.leaves[b] < 0 ? nullptr : leaves_[g.leaves[b]];
            eachLine(b, [&](int from, int to, int count) {
                for (int i = 0; i < count; ++i)
                    block.known[to + i] = leaf && leaf->isValueOn(static_cast<openvdb::Index>(from + i));
            });
        }
    }

    void open(const Group& g, Block& block) const {
        for (int b = 0; b < 8; ++b) {
            const double* values = g.leaves[b] < 0 ? nullptr : values_[g.leaves[b]].data();
            eachLine(b, [&](int from, int to, int count) {
                if (values)
                    std::copy_n(values + from, count, &block.c[to]);
                else
                    std::fill_n(&block.c[to], count, double(g.uniform[b]));
            });
        }
        if (!g.whole) openKnown(g, block);
    }

    void close(const Group& g, const Block& block) {
        for (int b = 0; b < 8; ++b)
            if (g.leaves[b] >= 0)
                eachLine(b, [&](int from, int to, int count) {
                    std::copy_n(&block.c[to], count, values_[g.leaves[b]].data() + from);
                });
    }

    // -> the largest change of F at one of its rows.
    double visitAll(Group& g, Block& block) {
        return vectors_ == Vectors::two ? visitAllBy(g, block) : visitAllByFour(g, block);
    }
    ISOWAVE_FOUR double visitAllByFour(Group& g, Block& block) { return visitAllBy(g, block); }
    ISOWAVE_INLINE double visitAllBy(Group& g, Block& block) {
        double most = 0;
        g.active = 0;
        for (std::uint32_t i = g.begin; i < g.end; ++i) {
            if (rows_[i].squares == 0) continue;
            const Visit done = visit(rows_[i], block, options_.tolerance);
            most = std::max(most, done.change);
            if (done.active) active_[g.begin + g.active++] = i;
        }
        return most;
    }

    double visitActive(Group& g, Block& block, bool backwards) {
        return vectors_ == Vectors::two ? visitActiveBy(g, block, backwards)
                                        : visitActiveByFour(g, block, backwards);
    }
    ISOWAVE_FOUR double visitActiveByFour(Group& g, Block& block, bool backwards) {
        return visitActiveBy(g, block, backwards);
    }
    ISOWAVE_INLINE double visitActiveBy(Group& g, Block& block, bool backwards) {
        double most = 0;
        for (std::uint32_t k = 0; k < g.active; ++k) {
            const std::uint32_t i = active_[g.begin + (backwards ? g.active - 1 - k : k)];
            most = std::max(most, visit(rows_[i], block, options_.tolerance).change);
        }
        return most;
    }

    // Visits the groups of the list, colour by colour; moved_[g] becomes the largest change in each.
    template <class Work>
    void sweep(const std::vector<std::uint32_t>& list, const Work& work) {
        std::array<std::vector<std::uint32_t>, 8> colours;
        for (const std::uint32_t g : list) {
            const openvdb::Coord leaf = groups_[g].origin >> 3;
            colours[(leaf[0] & 1) << 2 | (leaf[1] & 1) << 1 | (leaf[2] & 1)].push_back(g);
        }
        for (const auto& colour : colours)
            tbb::parallel_for(std::size_t(0), colour.size(), [&](std::size_t i) {
                Group& g = groups_[colour[i]];
                Block block;
                open(g, block);
                moved_[colour[i]] = work(g, block);
                if (moved_[colour[i]] > 0) close(g, block);
            });
    }

    // The groups of the list that moved by more than `least`.
    std::vector<std::uint32_t> moved(const std::vector<std::uint32_t>& list, double least) const {
        std::vector<std::uint32_t> result;
        for (const std::uint32_t g : list)
            if (moved_[g] > least) result.push_back(g);
        return result;
    }

    // These and those beside them, in order.
    std::vector<std::uint32_t> around(const std::vector<std::uint32_t>& list) const {
        std::vector<std::uint32_t> result;
        for (const std::uint32_t g : list)
            for (const std::int32_t near : groups_[g].near)
                if (near >= 0) result.push_back(static_cast<std::uint32_t>(near));
        std::sort(result.begin(), result.end());
        result.erase(std::unique(result.begin(), result.end()), result.end());
        return result;
    }

    // -> the groups to visit in the next round.
    std::vector<std::uint32_t> round(const std::vector<std::uint32_t>& list) {
        sweep(list, [this](Group& g, Block& block) { return visitAll(g, block); });
        report_.change = 0;
        for (const std::uint32_t g : list) report_.change = std::max(report_.change, moved_[g]);
        std::vector<std::uint32_t> next = moved(list, options_.tolerance), inner = next;
        for (int pass = 0; pass < options_.innerSweeps && !inner.empty(); ++pass) {
            const std::vector<std::uint32_t> visited = around(inner);
            sweep(visited,
                  [this, pass](Group& g, Block& block) { return visitActive(g, block, pass % 2 == 0); });
            inner = moved(visited, options_.tolerance / 2);
            next.insert(next.end(), inner.begin(), inner.end());
        }
        return around(next);
    }

    void countUnmet() {
        std::vector<std::int64_t> unmet(groups_.size());
        tbb::parallel_for(std::size_t(0), groups_.size(), [&](std::size_t n) {
            Block block;
            open(groups_[n], block);
            for (std::uint32_t i = groups_[n].begin; i < groups_[n].end; ++i) {
                if (rows_[i].rho > 0) continue;
                const double r = violationOf(rows_[i], RowWeights(rows_[i]), block);
                unmet[n] += (rows_[i].equal ? std::abs(r) : r) > 2 * options_.tolerance;
            }
        });
        report_.unmet = std::accumulate(unmet.begin(), unmet.end(), std::int64_t(0));
    }

    void scatter() {
        std::vector<std::int64_t> changed(leaves_.size());
        tbb::parallel_for(std::size_t(0), leaves_.size(), [&](std::size_t i) {
            for (auto known = leaves_[i]->beginValueOn(); known; ++known) {
                const auto value = static_cast<float>(values_[i][known.pos()]);
                changed[i] += value != *known;
                known.setValue(value);
            }
        });
        report_.changed = std::accumulate(changed.begin(), changed.end(), std::int64_t(0));
    }

    BSplineField& field_;
    const Vectors vectors_ = widestVectors();
    AscentOptions options_;
    AscentReport report_;
    std::vector<Row> rows_;
    std::vector<std::uint32_t> active_;  // of group g: active_[g.begin .. g.begin + g.active)
    std::vector<Group> groups_;
    std::unordered_map<openvdb::Coord, std::int32_t, std::hash<openvdb::Coord>> groupAt_;
    std::vector<FloatLeaf*> leaves_;
    std::vector<std::array<double, 512>> values_;  // of leaves_
    std::vector<double> moved_;                    // by each group in its last visit
};

}  // namespace

AscentReport ascend(BSplineField& field, const std::vector<FieldRow>& rows, const AscentOptions& options,
                    const Progress& progress) {
    progress.check();
    return Ascent(field, rows, options).run(progress);
}

}  // namespace isowave
