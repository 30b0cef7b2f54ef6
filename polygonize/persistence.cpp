// classesAt = pair -> join points -> join cubes -> bound squares -> reduce
//
//   pair          each cell of the complex with a face or coface of one value, as far as that goes: a discrete
//                 gradient. Cells that are left over are critical, and few
//   join points   critical edges, upwards, join the basins of critical points: dimension 0
//   join cubes    critical squares, downwards, join the basins of critical cubes: dimension 2
//   bound squares the critical edges that the gradient takes the boundary of each remaining critical square to
//   reduce        the matrix of these: dimension 1
//
// Cells have doubled coordinates: point (x, y, z) is (2x, 2y, 2z), and an odd coordinate spans two points.
// The order of points is that of (value, index). A cell belongs to the star of its last point, and cells are
// ordered by their star and then by `time`, the order in which `pair` built the star up; so a cell comes
// after all its faces.
#include "polygonize/persistence.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>
#include <queue>
#include <unordered_map>

namespace isowave {
namespace {

using openvdb::Coord;
using Cell = std::int64_t;  // index into the doubled lattice

// ---- a star's cells

// The cells around a point are numbered (dx + 1) * 9 + (dy + 1) * 3 + dz + 1 by their offset in doubled
// coordinates.
constexpr int kStar = 27, kCentre = 13;
constexpr std::array<int, 3> offsetOf(int i) { return {i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1}; }

struct StarTables {
    std::array<std::uint32_t, kStar>
        corners{};                             // the star's points (as offsets) that are corners of the cell
    std::array<std::uint32_t, kStar> faces{};  // faces of one dimension less that hold the centre
    std::array<int, kStar> dimension{};
    std::array<int, kStar> ascending{};  // 0..26 by dimension

    constexpr StarTables() {
        for (int i = 0; i < kStar; ++i) {
            const auto d = offsetOf(i);
            for (int j = 0; j < kStar; ++j) {
                const auto e = offsetOf(j);
                bool corner = true;
                int differ = 0;
                for (int a = 0; a < 3; ++a) {
                    corner = corner && (e[a] == 0 || e[a] == d[a]);
                    differ += e[a] != d[a];
                }
                if (corner) corners[i] |= 1u << j;
                if (corner && differ == 1) faces[i] |= 1u << j;
            }
            for (int a = 0; a < 3; ++a) dimension[i] += d[a] != 0;
        }
        int n = 0;
        for (int dim = 0; dim <= 3; ++dim)
            for (int i = 0; i < kStar; ++i)
                if (dimension[i] == dim) ascending[n++] = i;
    }
};
constexpr StarTables kTables;

// ---- the gradient

// What is known of a cell: whom it is paired with, and when its star took it in.
// A pair joins a cell and a face of it; it is stored at both, as the direction to the other one.
class CellState {
  public:
    static constexpr int kCritical = 6, kAbsent = 7;
    CellState() = default;
    CellState(int partner, int time) : bits_(static_cast<std::uint8_t>(partner | time << 3)) {}
    int partner() const { return bits_ & 7; }  // 2 axis + (1: towards larger coordinates), or one of the two
    int time() const { return bits_ >> 3; }

  private:
    std::uint8_t bits_ = kAbsent;
};

struct Critical {
    Cell cell;
    std::int64_t star;  // its last point
    int time;
};

class Gradient {
  public:
    Gradient(const LatticeFunction& f, float last, const Progress& progress);

    // Ascending in the order of cells.
    const std::vector<Critical>& critical(int dimension) const { return critical_[dimension]; }

    // The point whose star holds the cell.
    std::int64_t starOf(Cell cell) const {
        const Coord c = coordOf(cell);
        std::int64_t star = -1;
        for (int k = 0; k < 8; ++k) {
            const std::int64_t p = f_.index((c[0] + (k >> 2 & c[0])) / 2, (c[1] + (k >> 1 & c[1] & 1)) / 2,
                                            (c[2] + (k & c[2] & 1)) / 2);
            if (star < 0 || before(star, p)) star = p;
        }
        return star;
    }
    bool before(std::int64_t p, std::int64_t q) const {
        return f_.values[p] != f_.values[q] ? f_.values[p] < f_.values[q] : p < q;
    }
    CellState state(Cell cell) const { return states_[cell]; }
    bool isCritical(Cell cell) const { return states_[cell].partner() == CellState::kCritical; }
    Cell partner(Cell cell) const {
        const int direction = states_[cell].partner();
        return cell + (direction & 1 ? stride_[direction >> 1] : -stride_[direction >> 1]);
    }
    int dimension(Cell cell) const {
        const Coord c = coordOf(cell);
        return (c[0] & 1) + (c[1] & 1) + (c[2] & 1);
    }
    template <class Body>
    void forEachFace(Cell cell, const Body& body) const {
        const Coord c = coordOf(cell);
        for (int a = 0; a < 3; ++a)
            if (c[a] & 1) {
                body(cell - stride_[a]);
                body(cell + stride_[a]);
            }
    }
    // Also those that are not in the complex: kNone.
    static constexpr Cell kNone = -1;
    template <class Body>
    void forEachCoface(Cell cell, const Body& body) const {
        const Coord c = coordOf(cell);
        for (int a = 0; a < 3; ++a)
            if (!(c[a] & 1))
                for (const int s : {-1, 1}) {
                    const bool inLattice = c[a] + s >= 0 && c[a] + s <= 2 * (f_.size[a] - 1);
                    const Cell other = inLattice ? cell + s * stride_[a] : kNone;
                    body(inLattice && states_[other].partner() != CellState::kAbsent ? other : kNone);
                }
    }
    float value(std::int64_t point) const { return f_.values[point]; }

  private:
    Coord coordOf(Cell cell) const {
        return {static_cast<int>(cell / stride_[0]), static_cast<int>(cell % stride_[0] / stride_[1]),
                static_cast<int>(cell % stride_[1])};
    }
    std::uint32_t earlierAround(std::int64_t point, const Coord& at) const;
    void pairStar(std::int64_t point, const Coord& at, std::array<std::vector<Critical>, 4>& critical);
    void pair(Cell centre, int low, int high, int time);
    Cell at(Cell centre, int i) const {
        const auto d = offsetOf(i);
        return centre + d[0] * stride_[0] + d[1] * stride_[1] + d[2] * stride_[2];
    }

    const LatticeFunction& f_;
    std::array<Cell, 3> stride_;
    std::vector<CellState> states_;
    std::array<std::vector<Critical>, 4> critical_;
};

// The points around `point` that come before it, as a mask over the star.
std::uint32_t Gradient::earlierAround(std::int64_t point, const Coord& at) const {
    std::uint32_t mask = 1u << kCentre;
    for (int i = 0; i < kStar; ++i) {
        const auto d = offsetOf(i);
        bool inLattice = i != kCentre;
        for (int a = 0; a < 3; ++a) inLattice = inLattice && at[a] + d[a] >= 0 && at[a] + d[a] < f_.size[a];
        if (inLattice && before(f_.index(at[0] + d[0], at[1] + d[1], at[2] + d[2]), point)) mask |= 1u << i;
    }
    return mask;
}

void Gradient::pair(Cell centre, int low, int high, int time) {
    const auto a = offsetOf(low), b = offsetOf(high);
    for (int axis = 0; axis < 3; ++axis)
        if (a[axis] != b[axis]) {
            const bool up = b[axis] > a[axis];
            states_[at(centre, low)] = {2 * axis + up, time};
            states_[at(centre, high)] = {2 * axis + !up, time + 1};
        }
}

// Builds the star up by expansions: a cell that has exactly one face in the star that is not there yet comes
// with that face, as a pair, which does not change the homotopy type. Where there is none, a cell without
// such faces comes alone: it is critical.
// invariant: `missing` are the star's cells that are not there yet.
void Gradient::pairStar(std::int64_t point, const Coord& at, std::array<std::vector<Critical>, 4>& critical) {
    const std::uint32_t earlier = earlierAround(point, at);
    const Cell centre = 2 * (at[0] * stride_[0] + at[1] * stride_[1] + at[2] * stride_[2]);
    std::uint32_t missing = 0;
    for (int i = 0; i < kStar; ++i)
        if ((kTables.corners[i] & ~earlier) == 0) missing |= 1u << i;
    int time = 0;
    while (missing != 0) {
        bool expanded = false;
        for (const int i : kTables.ascending) {
            if (!(missing >> i & 1)) continue;
            const std::uint32_t faces = kTables.faces[i] & missing;
            if (std::popcount(faces) != 1) continue;
            pair(centre, std::countr_zero(faces), i, time);
            missing &= ~(faces | 1u << i);
            time += 2;
            expanded = true;
        }
        if (expanded) continue;
        const int alone = *std::find_if(kTables.ascending.begin(), kTables.ascending.end(),
                                        [&](int i) { return missing >> i & 1; });
        const Cell cell = this->at(centre, alone);
        states_[cell] = {CellState::kCritical, time};
        critical[kTables.dimension[alone]].push_back({cell, point, time});
        missing &= ~(1u << alone);
        ++time;
    }
}

Gradient::Gradient(const LatticeFunction& f, float last, const Progress& progress) : f_(f) {
    const Coord doubled(2 * f.size[0] - 1, 2 * f.size[1] - 1, 2 * f.size[2] - 1);
    stride_ = {Cell{doubled[1]} * doubled[2], doubled[2], 1};
    states_.resize(static_cast<std::size_t>(doubled[0] * stride_[0]));
    std::vector<std::array<std::vector<Critical>, 4>> ofSlab(static_cast<std::size_t>(f.size[0]));
    tbb::parallel_for(0, f.size[0], [&](int x) {
        progress.check();
        for (int y = 0; y < f.size[1]; ++y)
            for (int z = 0; z < f.size[2]; ++z)
                if (const std::int64_t point = f.index(x, y, z); f.values[point] <= last)
                    pairStar(point, {x, y, z}, ofSlab[x]);
    });
    for (int dimension = 0; dimension < 4; ++dimension) {
        auto& all = critical_[dimension];
        for (const auto& slab : ofSlab) all.insert(all.end(), slab[dimension].begin(), slab[dimension].end());
        std::sort(all.begin(), all.end(), [&](const Critical& a, const Critical& b) {
            return a.star != b.star ? before(a.star, b.star) : a.time < b.time;
        });
    }
}

// ---- unions

class Basins {
  public:
    explicit Basins(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
    std::size_t rootOf(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    // `younger` is absorbed.
    void absorb(std::size_t younger, std::size_t older) { parent_[younger] = older; }

  private:
    std::vector<std::size_t> parent_;
};

std::unordered_map<Cell, std::size_t> positionsOf(const std::vector<Critical>& critical) {
    std::unordered_map<Cell, std::size_t> positions;
    positions.reserve(critical.size());
    for (std::size_t i = 0; i < critical.size(); ++i) positions.emplace(critical[i].cell, i);
    return positions;
}

// ---- the classes

class Classes {
  public:
    Classes(const Gradient& gradient, float at, const Progress& progress)
        : gradient_(gradient), at_(at), progress_(progress) {}

    std::vector<PersistentClass> run() {
        joinPoints();
        joinCubes();
        boundSquaresAndReduce();
        std::sort(found_.begin(), found_.end(), [](const PersistentClass& a, const PersistentClass& b) {
            return std::tuple(a.dimension, a.birth, a.birthPoint) <
                   std::tuple(b.dimension, b.birth, b.birthPoint);
        });
        return std::move(found_);
    }

  private:
    void add(int dimension, std::int64_t birth, std::int64_t death) {
        PersistentClass c;
        c.dimension = dimension;
        c.birth = gradient_.value(birth);
        c.birthPoint = birth;
        c.deathPoint = death;
        if (death != PersistentClass::kNever) c.death = gradient_.value(death);
        if (c.birth <= at_ && at_ < c.death) found_.push_back(c);
    }

    // Every point is critical or paired with an edge, whose other end comes before it: the way down.
    Cell minimumBelow(Cell point) const {
        while (!gradient_.isCritical(point)) {
            const Cell edge = gradient_.partner(point);
            point = edge + (edge - point);
        }
        return point;
    }

    // positive_[i]: critical edge i closes a loop: a class of dimension 1 begins.
    void joinPoints() {
        const auto& points = gradient_.critical(0);
        const auto& edges = gradient_.critical(1);
        const auto positions = positionsOf(points);
        Basins basins(points.size());
        positive_.assign(edges.size(), false);
        for (std::size_t i = 0; i < edges.size(); ++i) {
            std::array<std::size_t, 2> ends;
            int n = 0;
            gradient_.forEachFace(
                edges[i].cell, [&](Cell end) { ends[n++] = basins.rootOf(positions.at(minimumBelow(end))); });
            if (ends[0] == ends[1]) {
                positive_[i] = true;
                continue;
            }
            const auto [older, younger] = std::minmax(ends[0], ends[1]);
            basins.absorb(younger, older);
            add(0, points[younger].star, edges[i].star);
        }
        for (std::size_t i = 0; i < points.size(); ++i)
            if (basins.rootOf(i) == i) add(0, points[i].star, PersistentClass::kNever);
    }

    // Every cube is critical or paired with a square, behind which is the next cube on the way up, or
    // nothing.
    Cell maximumAbove(Cell cube) const {
        while (cube != Gradient::kNone && !gradient_.isCritical(cube)) {
            const Cell square = gradient_.partner(cube), from = cube;
            gradient_.forEachCoface(square, [&](Cell other) {
                if (other != from) cube = other;
            });
        }
        return cube;
    }

    // What is beyond the complex is one more cube, which comes last. negative_: the squares that join no
    // cubes: each ends a class of dimension 1.
    void joinCubes() {
        const auto& squares = gradient_.critical(2);
        const auto& cubes = gradient_.critical(3);
        const auto positions = positionsOf(cubes);
        const std::size_t beyond = cubes.size();
        Basins basins(cubes.size() + 1);
        for (std::size_t i = squares.size(); i-- > 0;) {
            std::array<std::size_t, 2> sides;
            int n = 0;
            gradient_.forEachCoface(squares[i].cell, [&](Cell cube) {
                const Cell top = maximumAbove(cube);
                sides[n++] = basins.rootOf(top == Gradient::kNone ? beyond : positions.at(top));
            });
            if (sides[0] == sides[1]) {
                negative_.push_back(i);
                continue;
            }
            const auto [younger, older] =
                std::minmax(sides[0], sides[1]);  // downwards: the later cube is older
            basins.absorb(younger, older);
            add(2, squares[i].star, cubes[younger].star);
        }
        std::reverse(negative_.begin(), negative_.end());
    }

    // A cell in the order of cells.
    struct Place {
        std::int64_t star;
        int time;
        Cell cell;
    };
    bool comesBefore(const Place& a, const Place& b) const {
        return a.star != b.star ? gradient_.before(a.star, b.star) : a.time < b.time;
    }

    // The boundary of a square with every edge that is paired with a square replaced by the rest of that
    // square's boundary, until none is: modulo 2, and the last edge first, so that each is met once. Edges
    // that are paired with a point lead nowhere. Returns positions of positive critical edges, ascending.
    std::vector<std::size_t> boundaryOf(Cell square) const {
        const auto later = [&](const Place& a, const Place& b) { return comesBefore(a, b); };
        std::priority_queue<Place, std::vector<Place>, decltype(later)> chain(later);
        const auto addFaces = [&](Cell s) {
            gradient_.forEachFace(s, [&](Cell edge) {
                const CellState state = gradient_.state(edge);
                const bool isHead = state.partner() != CellState::kCritical &&
                                    gradient_.dimension(gradient_.partner(edge)) == 0;
                if (!isHead) chain.push({gradient_.starOf(edge), state.time(), edge});
            });
        };
        addFaces(square);
        std::vector<std::size_t> boundary;
        while (!chain.empty()) {
            const Cell edge = chain.top().cell;
            int times = 0;
            for (; !chain.empty() && chain.top().cell == edge; chain.pop()) ++times;
            if (times % 2 == 0) continue;
            if (gradient_.isCritical(edge)) {
                const std::size_t i = edgePositions_.at(edge);
                if (positive_[i]) boundary.push_back(i);
            } else {
                chain.push(
                    {gradient_.starOf(edge), gradient_.state(edge).time(), edge});  // cancels itself there
                addFaces(gradient_.partner(edge));
            }
        }
        std::reverse(boundary.begin(), boundary.end());
        return boundary;
    }

    // Columns are negative squares in their order, rows positive edges; a column's last row, once no earlier
    // column has it, is the edge at which the class began that the square ends.
    void boundSquaresAndReduce() {
        const auto& edges = gradient_.critical(1);
        const auto& squares = gradient_.critical(2);
        edgePositions_ = positionsOf(edges);
        std::vector<std::vector<std::size_t>> columns(negative_.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, negative_.size(), 16), [&](const auto& range) {
            progress_.check();
            for (std::size_t k = range.begin(); k != range.end(); ++k)
                columns[k] = boundaryOf(squares[negative_[k]].cell);
        });
        constexpr std::size_t kNobody = ~std::size_t{0};
        std::vector<std::size_t> columnOf(edges.size(), kNobody);
        std::vector<std::size_t> sum;
        for (std::size_t k = 0; k < columns.size(); ++k) {
            if (k % 256 == 0) progress_.check();
            std::vector<std::size_t>& column = columns[k];
            while (!column.empty() && columnOf[column.back()] != kNobody) {
                const auto& other = columns[columnOf[column.back()]];
                sum.clear();
                std::set_symmetric_difference(column.begin(), column.end(), other.begin(), other.end(),
                                              std::back_inserter(sum));
                column.swap(sum);
            }
            if (column.empty()) continue;
            columnOf[column.back()] = k;
            add(1, edges[column.back()].star, squares[negative_[k]].star);
        }
        for (std::size_t i = 0; i < edges.size(); ++i)
            if (positive_[i] && columnOf[i] == kNobody) add(1, edges[i].star, PersistentClass::kNever);
    }

    const Gradient& gradient_;
    float at_;
    const Progress& progress_;
    std::vector<bool> positive_;
    std::vector<std::size_t> negative_;
    std::unordered_map<Cell, std::size_t> edgePositions_;
    std::vector<PersistentClass> found_;
};

}  // namespace

std::vector<PersistentClass> classesAt(const LatticeFunction& function, float at, float last,
                                       const Progress& progress) {
    assert(static_cast<std::int64_t>(function.values.size()) ==
           std::int64_t{function.size[0]} * function.size[1] * function.size[2]);
    assert(at <= last);
    const Gradient gradient(function, last, progress);
    return Classes(gradient, at, progress).run();
}

}  // namespace isowave
