#include "subdivision/meshes/triangle_step.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "subdivision/filters/construct.h"
#include "subdivision/filters/four_point.h"
#include "subdivision/filters/masks.h"
#include "subdivision/meshes/triangle_coarsen.h"

namespace isowave::subdivision {

namespace {

constexpr int kRegularValence = 6;
// The window of A inside: these vertices and all edges at them, which are 2 coarseRings + 1 fine rings. Along the
// boundary: this many nodes either way, so Loop has 7 (wide: 11) taps of the cubic B-spline there, Butterfly 9 (13) of
// the four-point curve.
struct Reach {
    int coarseRings, stepsLoop, stepsButterfly;
};
constexpr Reach kRefinedReach{1, 3, 4}, kWideReach{2, 5, 6};
const Reach& reachOf(TriangleStep::Fit fit) {
    return fit == TriangleStep::Fit::Wide ? kWideReach : kRefinedReach;
}
// The four-point rule looks no farther than this many coarse vertices to either end of an edge.
constexpr int kFarOnBoundary = 3;

// s_j of the header.
double zorinWeight(int j, int valence) {
    if (valence == 3) return j == 0 ? 5.0 / 12 : -1.0 / 12;
    if (valence == 4) return j == 0 ? 3.0 / 8 : j == 2 ? -1.0 / 8 : 0;
    const double turn = 2 * std::numbers::pi * j / valence;
    return (0.25 + std::cos(turn) + std::cos(2 * turn) / 2) / valence;
}

Vec3 sum(const Taps& row, std::span<const Vec3> values) {
    Vec3 result;
    for (const auto& [node, weight] : row) result += weight * values[node];
    return result;
}

// The exact row of A, one sixth of it: the fine nodes i d + j d', i >= 1, j >= 0, for an edge's direction d and the
// next one's d'. A rotation by 60 degrees brings them to the other five; the lattice's symmetries keep the values.
// A node is the coarse vertex (a, b), a d + b d' away, or the edge from there that is `turns` after direction d.
struct RegularRow {
    struct Tap {
        int a, b, turns;
        bool onVertex;
        double weight;
    };
    double centre;
    std::vector<Tap> sixth;
};

RegularRow exactRow(const char* mask, int coarseRings) {
    const int rings = 2 * coarseRings + 1;
    const auto row = leastNormA(namedMask(mask), rings);
    assert(row);
    RegularRow result{toDouble((*row)[{}]), {}};
    for (int i = 1; i <= rings; ++i) {
        for (int j = 0; i + j <= rings; ++j) {
            const double weight = toDouble((*row)[{i, j}]);
            if (weight == 0) continue;
            const bool odd = i % 2 != 0, oddNext = j % 2 != 0;
            if (odd && oddNext) {
                result.sixth.push_back({(i + 1) / 2, (j - 1) / 2, 2, false, weight});
            } else {
                result.sixth.push_back({i / 2, j / 2, oddNext ? 1 : 0, !odd && !oddNext, weight});
            }
        }
    }
    return result;
}

const RegularRow& regularRowOf(TriangleStep::Family family, TriangleStep::Fit fit) {
    static const std::array<RegularRow, 4> rows{
        exactRow("loop", kRefinedReach.coarseRings), exactRow("loop", kWideReach.coarseRings),
        exactRow("butterfly", kRefinedReach.coarseRings), exactRow("butterfly", kWideReach.coarseRings)};
    return rows[(family == TriangleStep::Family::Loop ? 0u : 2u) +
                (fit == TriangleStep::Fit::Wide ? 1u : 0u)];
}

}  // namespace

struct TriangleStep::Irregular {
    std::vector<Index> rowOf;  // of each coarse vertex: its row below; kNone where it is the exact one
    std::vector<Taps> rows;
    std::size_t different = 0;
};

double loopBeta(int n) {
    const double inner = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
    return (5.0 / 8 - inner * inner) / n;
}

TriangleStep::TriangleStep(Family family, Fit fit, const PolygonMesh& coarse)
    : TriangleStep(family, fit, (requireTriangles(coarse), Adjacency(coarse)), coarse.pinned) {}

TriangleStep::TriangleStep(Family family, Fit fit, Adjacency coarse, const std::vector<Index>& pinned)
    : SubdivisionStep(coarse.vertices(), coarse.vertices() + coarse.edges()),
      family_(family),
      fit_(fit),
      coarse_(std::move(coarse)),
      pinned_(pinned),
      place_(coarse_.vertices()),
      valence_(coarse_.vertices()) {
    for (Index v = 0; v < coarse_.vertices(); ++v) {
        valence_[v] = static_cast<int>(coarse_.valence(v));
        const bool single = coarse_.faceValence(v) == 1;
        place_[v] = !coarse_.isBoundaryVertex(v) ? Place::Inside : single ? Place::Corner : Place::Boundary;
    }
    // Inside, Butterfly keeps every vertex.
    for (const Index v : pinned_) {
        if (family == Family::Loop || place(v) == Place::Boundary) place_[v] = Place::Corner;
    }
}

// ---- P ----

void TriangleStep::rowOfP(Index fine, Taps& row) const {
    row.clear();
    if (fine < coarse_.vertices()) return vertexRowOfP(fine, row);
    const Index h = coarse_.edgeCorner(fine - static_cast<Index>(coarse_.vertices()));
    if (coarse_.twin(h) == kNone) return boundaryEdge(h, row);
    if (family_ == Family::Butterfly) return butterflyEdge(h, row);
    row.push_back({coarse_.vertex(h), 3.0 / 8});
    row.push_back({coarse_.target(h), 3.0 / 8});
    row.push_back({apex(h), 1.0 / 8});
    row.push_back({apex(coarse_.twin(h)), 1.0 / 8});
}

void TriangleStep::vertexRowOfP(Index v, Taps& row) const {
    if (family_ == Family::Butterfly || place(v) == Place::Corner) {
        row.push_back({v, 1});
    } else if (place(v) == Place::Boundary) {
        row.push_back({v, 3.0 / 4});
        row.push_back({coarse_.target(boundaryAfter(v)), 1.0 / 8});
        row.push_back({coarse_.vertex(boundaryBefore(v)), 1.0 / 8});
    } else {
        const double beta = loopBeta(valence_[v]);
        row.push_back({v, 1 - valence_[v] * beta});
        coarse_.around(v, [&](Index h) { row.push_back({coarse_.target(h), beta}); });
    }
}

void TriangleStep::butterflyEdge(Index h, Taps& row) const {
    const Index across = coarse_.twin(h);
    const bool first = isIrregular(coarse_.vertex(h)), second = isIrregular(coarse_.target(h));
    if (first || second) {
        const double share = first && second ? 0.5 : 1;
        if (first) addStencilAround(h, share, row);
        if (second) addStencilAround(across, share, row);
        return;
    }
    row.push_back({coarse_.vertex(h), 1.0 / 2});
    row.push_back({coarse_.target(h), 1.0 / 2});
    addWings(h, row);
    addWings(across, row);
}

// 3/4 of the vertex from which h runs, and s_j of its neighbours, j counted from h.
void TriangleStep::addStencilAround(Index h, double factor, Taps& row) const {
    const Index centre = coarse_.vertex(h);
    row.push_back({centre, factor * 3 / 4});
    Index c = h;
    for (int j = 0; j < valence_[centre]; ++j, c = coarse_.nextAround(c)) {
        const double weight = zorinWeight(j, valence_[centre]);
        if (weight != 0) row.push_back({coarse_.target(c), factor * weight});
    }
}

// The vertex across from h in its triangle, and the two wings beyond that triangle's other sides.
void TriangleStep::addWings(Index h, Taps& row) const {
    row.push_back({apex(h), 1.0 / 8});
    const auto addWing = [&](Index side, Index kept, Index turned) {
        if (coarse_.twin(side) != kNone) {
            row.push_back({apex(coarse_.twin(side)), -1.0 / 16});
        } else {
            row.push_back({kept, -1.0 / 16});
            row.push_back({apex(h), -1.0 / 16});
            row.push_back({turned, 1.0 / 16});
        }
    };
    addWing(coarse_.next(h), coarse_.target(h), coarse_.vertex(h));
    addWing(coarse_.prev(h), coarse_.vertex(h), coarse_.target(h));
}

void TriangleStep::boundaryEdge(Index h, Taps& row) const {
    if (family_ == Family::Loop) {
        row.push_back({coarse_.vertex(h), 1.0 / 2});
        row.push_back({coarse_.target(h), 1.0 / 2});
        return;
    }
    // The open curve of the vertices nearby, up to corners.
    std::vector<Index> curve{coarse_.vertex(h), coarse_.target(h)};
    for (int k = 0; k < kFarOnBoundary && place(curve.back()) != Place::Corner; ++k)
        curve.push_back(coarse_.target(boundaryAfter(curve.back())));
    int before = 0;
    for (; before < kFarOnBoundary && place(curve.front()) != Place::Corner; ++before)
        curve.insert(curve.begin(), coarse_.vertex(boundaryBefore(curve.front())));
    for (const auto& [node, weight] : fourPointRow(static_cast<int>(curve.size()), 2 * before + 1))
        row.push_back({curve[static_cast<std::size_t>(node.x)], toDouble(weight)});
}

// ---- A ----

void TriangleStep::rowOfA0(Index v, Taps& row) const {
    row.clear();
    if (family_ == Family::Butterfly || place(v) == Place::Corner) {
        row.push_back({v, 1});
    } else if (place(v) == Place::Boundary) {
        row.push_back({v, 2});
        row.push_back({edgeNode(boundaryAfter(v)), -1.0 / 2});
        row.push_back({edgeNode(boundaryBefore(v)), -1.0 / 2});
    } else {
        const double beta = loopBeta(valence_[v]), centre = 1 / (1 - 8.0 / 5 * valence_[v] * beta);
        row.push_back({v, centre});
        coarse_.around(v, [&](Index h) { row.push_back({edgeNode(h), -8.0 / 5 * beta * centre}); });
    }
}

void TriangleStep::rowOfA(Index v, Taps& row) const {
    if (fit_ == Fit::Trial || place(v) == Place::Corner) return rowOfA0(v, row);
    const Index computed = irregular().rowOf[v];
    if (computed == kNone) return regularRow(v, row);
    row = irregular().rows[computed];
}

void TriangleStep::regularRow(Index v, Taps& row) const {
    const RegularRow& a = regularRowOf(family_, fit_);
    const int reach = reachOf(fit_).coarseRings;
    // The halfedge of the same direction, from the vertex at the end; and of direction d, from the end in direction d'.
    const auto straight = [&](Index h) { return turned(coarse_.twin(h), 3); };
    const auto beside = [&](Index h) { return turned(coarse_.twin(turned(h, 1)), 2); };
    row.clear();
    row.push_back({v, a.centre});
    coarse_.around(v, [&](Index h) {
        std::array<std::array<Index, kWideReach.coarseRings + 1>, kWideReach.coarseRings + 1> from;
        for (std::size_t x = 0; x <= static_cast<std::size_t>(reach); ++x) {
            from[x][0] = x == 0 ? h : straight(from[x - 1][0]);
            for (std::size_t y = 1; x + y <= static_cast<std::size_t>(reach); ++y)
                from[x][y] = beside(from[x][y - 1]);
        }
        for (const auto& [x, y, turns, onVertex, weight] : a.sixth) {
            const Index at = from[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
            row.push_back({onVertex ? coarse_.vertex(at) : edgeNode(turned(at, turns)), weight});
        }
    });
}

// The halfedge out of the same vertex, so many further round. REQUIRES: an inner vertex.
Index TriangleStep::turned(Index h, int turns) const {
    for (int k = 0; k < turns; ++k) h = coarse_.nextAround(h);
    return h;
}

// Vertices whose window sees valence 6 only, inside: all vertices of the window, and one ring more.
std::vector<char> TriangleStep::regularVertices() const {
    std::vector<char> regular(coarse_.vertices());
    for (Index v = 0; v < coarse_.vertices(); ++v)
        regular[v] = place(v) == Place::Inside && valence_[v] == kRegularValence;
    for (int ring = 0; ring <= reachOf(fit_).coarseRings; ++ring) {
        const auto before = regular;
        for (Index h = 0; h < coarse_.corners(); ++h) {
            if (!before[coarse_.target(h)]) regular[coarse_.vertex(h)] = 0;
            if (!before[coarse_.vertex(h)]) regular[coarse_.target(h)] = 0;
        }
    }
    return regular;
}

const TriangleStep::Irregular& TriangleStep::irregular() const {
    std::call_once(once_, [&] {
        auto result = std::make_shared<Irregular>();
        result->rowOf.assign(coarse_.vertices(), kNone);
        const auto regular = regularVertices();
        LeastNormRows solver([&](Index fine, Taps& row) { rowOfP(fine, row); });
        for (Index v = 0; v < coarse_.vertices(); ++v) {
            if (regular[v] || place(v) == Place::Corner) continue;
            const auto window = place(v) == Place::Boundary ? boundaryWindow(v) : ballWindow(v);
            const auto& weights = solver.weights(window);
            result->rowOf[v] = static_cast<Index>(result->rows.size());
            Taps& row = result->rows.emplace_back();
            // A0's row lies in the window, so there is one; a window too hard for doubles keeps A0's.
            if (weights.empty()) rowOfA0(v, row);
            for (std::size_t k = 0; k < weights.size(); ++k) row.push_back({window[k], weights[k]});
        }
        result->different = solver.solutionCount();
        irregular_ = std::move(result);
    });
    return *irregular_;
}

TriangleStep::Count TriangleStep::computedRows() const {
    if (fit_ == Fit::Trial) return {0, 0};
    return {irregular().rows.size(), irregular().different};
}

// The vertices within some coarse rings, and all edges at them. REQUIRES: v lies inside.
std::vector<Index> TriangleStep::ballWindow(Index v) const {
    // Each with a halfedge out of it that only depends on how it was reached, so that equal places are written down
    // equally.
    std::vector<Index> window{v}, from{coarse_.outgoing(v)};
    const auto visitEdges = [&](Index first, auto visit) {  // as halfedges that leave or arrive
        Index h = first, last = first;
        do {
            visit(h, coarse_.target(h));
            last = coarse_.prev(h);
            h = coarse_.nextAround(h);
        } while (h != first && h != kNone);
        if (h == kNone) visit(last, coarse_.vertex(last));
    };
    std::size_t begin = 0;
    for (int ring = 0; ring < reachOf(fit_).coarseRings; ++ring) {
        const std::size_t end = window.size();
        for (; begin < end; ++begin) {
            visitEdges(from[begin], [&](Index h, Index to) {
                if (placeIn(window, to) < window.size()) return;
                window.push_back(to);
                from.push_back(coarse_.isBoundaryVertex(to) ? coarse_.outgoing(to) : coarse_.twin(h));
            });
        }
    }
    for (const Index first : from) visitEdges(first, [&](Index h, Index) { addOnce(window, edgeNode(h)); });
    return window;
}

// Steps of half an edge either way: first onto the edge, then onto its far end.
std::vector<Index> TriangleStep::boundaryWindow(Index v) const {
    const int steps = family_ == Family::Loop ? reachOf(fit_).stepsLoop : reachOf(fit_).stepsButterfly;
    std::vector<Index> window{v};
    for (const bool forwards : {true, false}) {
        Index at = v;
        for (int k = 0; k < steps && (at == v || place(at) != Place::Corner); k += 2) {
            const Index h = forwards ? boundaryAfter(at) : boundaryBefore(at);
            at = forwards ? coarse_.target(h) : coarse_.vertex(h);
            addOnce(window, edgeNode(h));
            if (k + 1 < steps) addOnce(window, at);
        }
    }
    return window;
}

// The boundary's halfedge that leaves v, and the one that arrives.
Index TriangleStep::boundaryAfter(Index v) const { return coarse_.outgoing(v); }
Index TriangleStep::boundaryBefore(Index v) const {
    Index last = kNone;
    coarse_.around(v, [&](Index h) { last = h; });
    return coarse_.prev(last);
}

// ---- points ----

PolygonMesh TriangleStep::fineMesh() const {
    PolygonMesh fine = fineTriangles(coarse_);
    fine.pinned = pinned_;
    return fine;
}

namespace {

// rowOf(k, row) gives what each of n points is the sum of.
template <class RowOf>
std::vector<Vec3> sums(std::size_t n, const RowOf& rowOf, std::span<const Vec3> of) {
    std::vector<Vec3> points(n);
    Taps row;
    for (Index k = 0; k < points.size(); ++k) {
        rowOf(k, row);
        points[k] = sum(row, of);
    }
    return points;
}

}  // namespace

std::vector<Vec3> TriangleStep::subdivide(std::span<const Vec3> coarse) const {
    assert(coarse.size() == coarseSize());
    return sums(
        fineSize(), [this](Index k, Taps& row) { rowOfP(k, row); }, coarse);
}

void TriangleStep::limitRow(Index v, Taps& row) const {
    row.clear();
    if (family_ == Family::Butterfly || place(v) == Place::Corner) {
        row.push_back({v, 1});
    } else if (place(v) == Place::Boundary) {
        row.push_back({v, 4.0 / 6});
        row.push_back({edgeNode(boundaryAfter(v)), 1.0 / 6});
        row.push_back({edgeNode(boundaryBefore(v)), 1.0 / 6});
    } else {
        const double omega = 3 / (8 * loopBeta(valence_[v])), all = omega + valence_[v];
        row.push_back({v, omega / all});
        coarse_.around(v, [&](Index h) { row.push_back({edgeNode(h), 1 / all}); });
    }
}

std::vector<Vec3> TriangleStep::limit(std::span<const Vec3> fine) const {
    assert(fine.size() == fineSize());
    return sums(
        coarseSize(), [this](Index v, Taps& row) { limitRow(v, row); }, fine);
}

SubdivisionStep::Parts TriangleStep::decompose(std::span<const Vec3> fine) const {
    assert(fine.size() == fineSize());
    Parts parts{std::vector<Vec3>(coarseSize()), std::vector<Vec3>(coarse_.edges())};
    Taps row;
    for (Index v = 0; v < coarseSize(); ++v) {
        rowOfA0(v, row);
        parts.coarse[v] = sum(row, fine);
    }
    for (Index e = 0; e < coarse_.edges(); ++e) {
        const Index node = static_cast<Index>(coarseSize()) + e;
        rowOfP(node, row);
        parts.stored[e] = fine[node];
        parts.stored[e] -= sum(row, parts.coarse);
    }
    if (fit_ == Fit::Trial) return parts;
    for (Index v = 0; v < coarseSize(); ++v) {
        rowOfA(v, row);
        parts.coarse[v] = sum(row, fine);
    }
    return parts;
}

// g = Q0 d: at a vertex node what makes A0 g = 0. Butterfly's A0 reads nothing else, so 0.
std::vector<Vec3> TriangleStep::allDetails(std::span<const Vec3>, std::span<const Vec3> stored) const {
    assert(stored.size() == coarse_.edges());
    std::vector<Vec3> g(coarseSize());
    g.insert(g.end(), stored.begin(), stored.end());
    if (family_ == Family::Butterfly) return g;
    Taps row;
    for (Index v = 0; v < coarseSize(); ++v) {
        rowOfA0(v, row);
        const double centre = row.front().weight;
        g[v] = (-1 / centre) * sum(row, g);  // g[v] is still 0, and the others are edge nodes
    }
    return g;
}

std::vector<Vec3> TriangleStep::shift(std::span<const Vec3> allDetails) const {
    assert(allDetails.size() == fineSize());
    std::vector<Vec3> moved(coarseSize());
    if (fit_ == Fit::Trial) return moved;  // A0 Q0 = 0
    Taps row;
    for (Index v = 0; v < coarseSize(); ++v) {
        rowOfA(v, row);
        moved[v] = sum(row, allDetails);
    }
    return moved;
}

}  // namespace isowave::subdivision
