#include "subdivision/meshes/catmull_clark.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace isowave::subdivision {
namespace {

// A7 of the cubic B-spline curve is the trial inverse moved by 23/49 (d_1 + d_2): its outermost tap 23/196 comes from
// the outermost tap 1/4 of a trial detail alone.
constexpr double kCurveA7 = 23.0 / 49;

// A curve's own refinement: r (r/4 + s)/(r^2 + 2 s^2) with r = 3/4, s = 1/2; without the leading r 11/17.
constexpr double kCurveR = 3.0 / 4, kCurveS = 1.0 / 2;
constexpr double kCurveUnscaled = (kCurveR / 4 + kCurveS) / (kCurveR * kCurveR + 2 * kCurveS * kCurveS);

}  // namespace

CatmullClarkStep::CatmullClarkStep(const PolygonMesh& coarse, CatmullClarkVariant variant)
    : CatmullClarkStep(coarse, Adjacency(coarse), variant) {}

CatmullClarkStep::CatmullClarkStep(const PolygonMesh& coarse, Adjacency adjacency,
                                   CatmullClarkVariant variant)
    : SubdivisionStep(adjacency.vertices(), adjacency.vertices() + adjacency.edges() + adjacency.faces()),
      variant_(variant),
      adjacency_(std::move(adjacency)),
      creases_(coarse.creases),
      pinned_(coarse.pinned) {
    findKinds(coarse);
    findCascade();
    if (variant == CatmullClarkVariant::tensor) findTensorFaces();
}

// ---- what the coarse mesh is: kinds -> cascade -> tensor faces ----

void CatmullClarkStep::findKinds(const PolygonMesh& coarse) {
    const auto sharpness = edgeSharpness(adjacency_, coarse.creases);
    sharp_.resize(adjacency_.edges());
    for (Index e = 0; e < sharp_.size(); ++e) sharp_[e] = sharpness[e] > 0 || adjacency_.isBoundaryEdge(e);
    kind_.assign(adjacency_.vertices(), Kind::smooth);
    valence_.assign(adjacency_.vertices(), 0);
    std::vector<Index> sharpEdges(adjacency_.vertices(), 0);
    for (Index e = 0; e < sharp_.size(); ++e) {
        const Index c = adjacency_.edgeCorner(e);
        for (const Index v : {adjacency_.vertex(c), adjacency_.target(c)}) {
            ++valence_[v];
            if (sharp_[e]) ++sharpEdges[v];
        }
    }
    for (Index v = 0; v < kind_.size(); ++v) {
        const bool loneFace = adjacency_.isBoundaryVertex(v) && valence_[v] == 2;
        if (sharpEdges[v] > 2 || loneFace)
            kind_[v] = Kind::corner;
        else if (sharpEdges[v] == 2)
            kind_[v] = Kind::curve;
    }
    for (const Index v : pinned_) kind_[v] = Kind::corner;
}

// Layer after layer; a vertex of a layer has its candidates in the layers before it.
void CatmullClarkStep::findCascade() {
    std::vector<bool> known(kind_.size());
    for (Index v = 0; v < known.size(); ++v) known[v] = !cascades(v);
    std::vector<Index> front;
    const auto hasKnownNeighbour = [&](Index v) {
        bool any = false;
        adjacency_.around(v, [&](Index c) { any = any || known[adjacency_.target(c)]; });
        return any;
    };
    for (Index v = 0; v < known.size(); ++v)
        if (!known[v] && hasKnownNeighbour(v)) front.push_back(v);
    std::vector<bool> queued(kind_.size(), false);
    for (const Index v : front) queued[v] = true;
    while (!front.empty()) {
        std::vector<Index> next;
        for (const Index v : front) {
            const auto begin = static_cast<Index>(candidates_.size());
            adjacency_.around(v, [&](Index c) {
                const Index w = adjacency_.target(c);
                if (known[w]) {
                    candidates_.push_back({adjacency_.edge(c), w});
                } else if (!queued[w]) {
                    queued[w] = true;
                    next.push_back(w);
                }
            });
            cascade_.push_back({v, begin, static_cast<Index>(candidates_.size())});
        }
        for (const Index v : front) known[v] = true;
        front = std::move(next);
    }
    sign_.assign(kind_.size(), 0);
    evenTree_.assign(kind_.size(), false);
    for (Index v = 0; v < known.size(); ++v)
        if (!known[v]) findTree(v, known);
}

template <class F>
void CatmullClarkStep::forTree(const Tree& tree, F f) const {
    f(tree.root);
    for (Index k = tree.begin; k < tree.end; ++k) f(cascade_[k].vertex);
}

void CatmullClarkStep::findTree(Index root, std::vector<bool>& reached) {
    Tree tree{root, static_cast<Index>(cascade_.size()), 0, {}};
    std::vector<Index> order{root};
    reached[root] = true;
    sign_[root] = 1;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Index v = order[i];
        adjacency_.around(v, [&](Index c) {
            const Index w = adjacency_.target(c);
            if (!reached[w]) {
                reached[w] = true;
                sign_[w] = static_cast<std::int8_t>(-sign_[v]);
                const auto begin = static_cast<Index>(candidates_.size());
                candidates_.push_back({adjacency_.edge(c), v});
                cascade_.push_back({w, begin, begin + 1});
                order.push_back(w);
            } else if (sign_[w] == sign_[v] && adjacency_.edgeCorner(adjacency_.edge(c)) == c) {
                tree.odd.push_back({adjacency_.edge(c), v});
            }
        });
    }
    tree.end = static_cast<Index>(cascade_.size());
    if (tree.odd.empty()) forTree(tree, [&](Index v) { evenTree_[v] = true; });
    trees_.push_back(std::move(tree));
}

void CatmullClarkStep::findTensorFaces() {
    const auto isRegular = [&](Index v) {
        if (kind_[v] != Kind::smooth || valence_[v] != 4) return false;
        bool good = true;
        adjacency_.around(v, [&](Index c) {
            good = good && adjacency_.faceSize(adjacency_.face(c)) == 4 && !sharp_[adjacency_.edge(c)];
        });
        return good;
    };
    std::vector<bool> regular(kind_.size());
    for (Index v = 0; v < regular.size(); ++v) regular[v] = isRegular(v);
    tensorFace_.assign(adjacency_.faces(), true);
    for (Index c = 0; c < adjacency_.corners(); ++c)
        if (!regular[adjacency_.vertex(c)]) tensorFace_[adjacency_.face(c)] = false;
    tensorVertex_.assign(kind_.size(), true);
    for (Index c = 0; c < adjacency_.corners(); ++c)
        if (!tensorFace_[adjacency_.face(c)]) tensorVertex_[adjacency_.vertex(c)] = false;
}

std::size_t CatmullClarkStep::tensorVertices() const {
    return static_cast<std::size_t>(std::count(tensorVertex_.begin(), tensorVertex_.end(), true));
}

std::size_t CatmullClarkStep::ambiguousComponents() const {
    return static_cast<std::size_t>(
        std::count_if(trees_.begin(), trees_.end(), [](const Tree& tree) { return tree.odd.empty(); }));
}

// ---- P ----

PolygonMesh CatmullClarkStep::fineMesh() const {
    PolygonMesh fine;
    fine.points.resize(fineSize());
    fine.corners.reserve(4 * adjacency_.corners());
    fine.faceBegin.reserve(adjacency_.corners() + 1);
    for (Index c = 0; c < adjacency_.corners(); ++c) {
        fine.addFace({adjacency_.vertex(c), edgePoint(adjacency_.edge(c)), facePoint(adjacency_.face(c)),
                      edgePoint(adjacency_.edge(adjacency_.prev(c)))});
    }
    for (const Crease& crease : creases_) {
        const Index middle = edgePoint(adjacency_.edgeBetween(crease.a, crease.b));
        fine.creases.push_back({crease.a, middle, crease.sharpness});
        fine.creases.push_back({middle, crease.b, crease.sharpness});
    }
    fine.pinned = pinned_;
    return fine;
}

CatmullClarkStep::Mask CatmullClarkStep::mask(Index v) const {
    if (kind_[v] == Kind::corner) return {1, {0, 0}, {0, 0, 0}};
    if (kind_[v] == Kind::curve) return {0.5, {0, 0.25}, {0, 0, 0}};
    const double n = valence_[v], n2 = n * n;
    return {(n - 3) / n, {4 / n2, 2 / n2}, {-1 / n2, 0, 1 / n2}};
}

// Calls edge(e) for the edges at v and face(f, k) for its faces, k of whose two edges at v are sharp.
template <class Edge, class Face>
void CatmullClarkStep::forStar(Index v, Edge edge, Face face) const {
    Index last = kNone;
    adjacency_.around(v, [&](Index c) {
        const Index e = adjacency_.edge(c), before = adjacency_.edge(adjacency_.prev(c));
        edge(e);
        face(adjacency_.face(c), (sharp_[e] ? 1 : 0) + (sharp_[before] ? 1 : 0));
        last = before;
    });
    if (adjacency_.isBoundaryVertex(v)) edge(last);
}

// sum(alpha_e e) + sum(alpha_f f).
Vec3 CatmullClarkStep::aroundVertex(Index v, std::span<const Vec3> fine) const {
    Vec3 sum;
    if (kind_[v] == Kind::corner) return sum;
    const Mask m = mask(v);
    forStar(
        v, [&](Index e) { sum += m.edge[sharp_[e] ? 1 : 0] * fine[edgePoint(e)]; },
        [&](Index f, int sharp) { sum += m.face[sharp] * fine[facePoint(f)]; });
    return sum;
}

std::vector<Vec3> CatmullClarkStep::subdivide(std::span<const Vec3> coarse) const {
    assert(coarse.size() == coarseSize());
    std::vector<Vec3> fine(fineSize());
    for (Index f = 0; f < adjacency_.faces(); ++f) {
        Vec3 sum;
        const Index begin = adjacency_.faceBegin(f), size = adjacency_.faceSize(f);
        for (Index c = begin; c < begin + size; ++c) sum += coarse[adjacency_.vertex(c)];
        fine[facePoint(f)] = (1.0 / size) * sum;
    }
    for (Index e = 0; e < adjacency_.edges(); ++e) {
        const Index c = adjacency_.edgeCorner(e);
        const Vec3 ends = coarse[adjacency_.vertex(c)] + coarse[adjacency_.target(c)];
        fine[edgePoint(e)] = sharp_[e] ? 0.5 * ends
                                       : 0.25 * (ends + fine[facePoint(adjacency_.face(c))] +
                                                 fine[facePoint(adjacency_.face(adjacency_.twin(c)))]);
    }
    for (Index v = 0; v < adjacency_.vertices(); ++v)
        fine[v] = mask(v).mu * coarse[v] + aroundVertex(v, fine);
    return fine;
}

// ---- limit ----

namespace {

// b_i of a dart with n edges. REQUIRES: 0 <= i <= n. The sharp edge, 0 and n, counts as 0 beside its neighbours.
double dartEdge(int i, int n) {
    const double r = (7 - std::sqrt(45.0)) / 2;
    return 4 * (1 - (std::pow(r, i) + std::pow(r, n - i)) / (1 + std::pow(r, n)));
}

}  // namespace

std::vector<Vec3> CatmullClarkStep::limit(std::span<const Vec3> fine) const {
    assert(fine.size() == fineSize());
    std::vector<Vec3> points(coarseSize());
    for (Index v = 0; v < points.size(); ++v)
        points[v] = kind_[v] == Kind::corner  ? fine[v]
                    : kind_[v] == Kind::curve ? curveLimit(v, fine)
                                              : smoothLimit(v, fine);
    return points;
}

Vec3 CatmullClarkStep::curveLimit(Index v, std::span<const Vec3> fine) const {
    Vec3 sum = 4.0 * fine[v];
    forStar(
        v, [&](Index e) { sum += sharp_[e] ? fine[edgePoint(e)] : Vec3{}; }, [](Index, int) {});
    return (1.0 / 6) * sum;
}

Vec3 CatmullClarkStep::smoothLimit(Index v, std::span<const Vec3> fine) const {
    const double n = valence_[v];
    Vec3 sum = n * n * fine[v];
    Index sharp = kNone;
    adjacency_.around(v, [&](Index c) {
        sum += 4.0 * fine[edgePoint(adjacency_.edge(c))] + fine[facePoint(adjacency_.face(c))];
        if (sharp_[adjacency_.edge(c)]) sharp = c;
    });
    return sharp == kNone ? (1 / (n * (n + 5))) * sum : dartLimit(v, sharp, fine);
}

// `sharp`: the halfedge from v along the sharp edge.
Vec3 CatmullClarkStep::dartLimit(Index v, Index sharp, std::span<const Vec3> fine) const {
    const int n = static_cast<int>(valence_[v]);
    double weights = 0;
    Vec3 sum;
    const auto add = [&](double weight, Index at) {
        weights += weight;
        sum += weight * fine[at];
    };
    add(double(n) * n, v);
    Index c = sharp;
    for (int i = 0; i < n; ++i, c = adjacency_.nextAround(c)) {
        const double b = dartEdge(i, n), next = dartEdge(i + 1, n);
        add(i == 0 ? (10 + next) / 3 : b, edgePoint(adjacency_.edge(c)));
        add(1.0 / 3 + (b + next) / 12, facePoint(adjacency_.face(c)));
    }
    return (1 / weights) * sum;
}

// ---- A without refinement ----

// 4e - fa - fb, or 2e: what the ends of an edge add up to. Of details: h.
Vec3 CatmullClarkStep::sumOfEnds(Index e, std::span<const Vec3> fine) const {
    if (sharp_[e]) return 2.0 * fine[edgePoint(e)];
    const Index c = adjacency_.edgeCorner(e);
    return 4.0 * fine[edgePoint(e)] - fine[facePoint(adjacency_.face(c))] -
           fine[facePoint(adjacency_.face(adjacency_.twin(c)))];
}

std::vector<Vec3> CatmullClarkStep::trial(std::span<const Vec3> fine) const {
    std::vector<Vec3> coarse(coarseSize());
    for (Index v = 0; v < coarse.size(); ++v)
        if (!cascades(v)) coarse[v] = (1 / mask(v).mu) * (fine[v] - aroundVertex(v, fine));
    for (const Tree& tree : trees_) coarse[tree.root] = fine[tree.root];
    for (const Cascaded& each : cascade_) {
        Vec3 sum;
        for (Index k = each.begin; k < each.end; ++k)
            sum += sumOfEnds(candidates_[k].edge, fine) - coarse[candidates_[k].other];
        coarse[each.vertex] = (1.0 / (each.end - each.begin)) * sum;
    }
    for (const Tree& tree : trees_) solveTree(tree, fine, coarse);
    return coarse;
}

// The tree was solved with x = 0; v_i = c_i + s_i x.
//   odd edge   c_i + c_j + 2 s_i x = sum of ends    =>  x = s_i (sum - c_i - c_j)/2
//   else       d/dx sum |c_i + s_i x - v'_i|^2 = 0  =>  x = mean of s_i (v'_i - c_i)
void CatmullClarkStep::solveTree(const Tree& tree, std::span<const Vec3> fine,
                                 std::vector<Vec3>& coarse) const {
    Vec3 x;
    if (!tree.odd.empty()) {
        for (const Candidate& odd : tree.odd) {
            const Index c = adjacency_.edgeCorner(odd.edge);
            const Vec3 ends = coarse[adjacency_.vertex(c)] + coarse[adjacency_.target(c)];
            x += (0.5 * sign_[odd.other]) * (sumOfEnds(odd.edge, fine) - ends);
        }
        x *= 1.0 / static_cast<double>(tree.odd.size());
    } else {
        forTree(tree, [&](Index v) { x += double(sign_[v]) * (fine[v] - coarse[v]); });
        x *= 1.0 / (tree.end - tree.begin + 1);
    }
    forTree(tree, [&](Index v) { coarse[v] += double(sign_[v]) * x; });
}

// ---- details ----

SubdivisionStep::Parts CatmullClarkStep::decompose(std::span<const Vec3> fine) const {
    assert(fine.size() == fineSize());
    Parts parts;
    parts.coarse = trial(fine);
    auto details = subdivide(parts.coarse);
    for (std::size_t k = 0; k < details.size(); ++k) details[k] = fine[k] - details[k];
    parts.stored.assign(details.begin() + static_cast<std::ptrdiff_t>(coarseSize()), details.end());
    for (const Cascaded& each : cascade_) parts.stored[candidates_[each.end - 1].edge] = details[each.vertex];
    for (const Tree& tree : trees_) {
        if (!tree.odd.empty()) {
            parts.stored[tree.odd.back().edge] = details[tree.root];
            continue;
        }
        Vec3 t;
        forTree(tree, [&](Index v) { t += (double(sign_[v]) / (tree.end - tree.begin + 1)) * details[v]; });
        for (Index k = tree.begin; k < tree.end; ++k)
            parts.stored[candidates_[cascade_[k].end - 1].edge] -= double(sign_[cascade_[k].vertex]) * t;
    }
    const auto moved = shift(details);
    for (std::size_t v = 0; v < moved.size(); ++v) parts.coarse[v] += moved[v];
    return parts;
}

std::vector<Vec3> CatmullClarkStep::allDetails(std::span<const Vec3> coarse,
                                               std::span<const Vec3> stored) const {
    assert(stored.size() == fineSize() - coarseSize());
    std::vector<Vec3> details(coarseSize());
    details.insert(details.end(), stored.begin(), stored.end());
    fillSlots(stored, details);
    for (Index v = 0; v < coarseSize(); ++v)
        if (!cascades(v)) details[v] = aroundVertex(v, details);
    if (ambiguousComponents() > 0) fillEvenTrees(coarse, details);
    return details;
}

// The edge whose slot holds d_v: its own d_e is what makes the sum of h, over the candidates, or of s h, over the odd
// edges, vanish.   smooth: d_e = (h + d_fa + d_fb)/4,  sharp: d_e = h/2,  h = -(the others').
void CatmullClarkStep::fillSlots(std::span<const Vec3> stored, std::vector<Vec3>& details) const {
    const auto setEdge = [&](Index e, const Vec3& h) {
        details[edgePoint(e)] = {};
        details[edgePoint(e)] = (sharp_[e] ? 0.5 : 0.25) * (h - sumOfEnds(e, details));
    };
    for (const Cascaded& each : cascade_) {
        Vec3 others;
        for (Index k = each.begin; k + 1 < each.end; ++k) others += sumOfEnds(candidates_[k].edge, details);
        const Index slot = candidates_[each.end - 1].edge;
        details[each.vertex] = stored[slot];
        setEdge(slot, -1.0 * others);
    }
    for (const Tree& tree : trees_) {
        if (tree.odd.empty()) continue;
        Vec3 others;
        for (std::size_t k = 0; k + 1 < tree.odd.size(); ++k)
            others += double(sign_[tree.odd[k].other]) * sumOfEnds(tree.odd[k].edge, details);
        const Candidate& slot = tree.odd.back();
        details[tree.root] = stored[slot.edge];
        setEdge(slot.edge, -double(sign_[slot.other]) * others);
    }
}

// t = mean of s_i (v_i - v~_i); the slots hold e_i = d_i - s_i t, and d_root follows from mean s_i d_i = t:
//   s_root d_root = n t - sum s_i (e_i + s_i t) = t - sum s_i e_i   over the n - 1 others.
// shift() reads none of these d, so the unrefined v are known before them.
void CatmullClarkStep::fillEvenTrees(std::span<const Vec3> coarse, std::vector<Vec3>& details) const {
    auto unrefined = shift(details);
    for (std::size_t v = 0; v < unrefined.size(); ++v) unrefined[v] = coarse[v] - unrefined[v];
    const auto tilde = subdivide(unrefined);
    for (const Tree& tree : trees_) {
        if (!tree.odd.empty()) continue;
        Vec3 t;
        forTree(tree, [&](Index v) {
            t += (double(sign_[v]) / (tree.end - tree.begin + 1)) * (unrefined[v] - tilde[v]);
        });
        Vec3 root = t;
        for (Index k = tree.begin; k < tree.end; ++k) {
            const Index v = cascade_[k].vertex;
            root -= double(sign_[v]) * details[v];
            details[v] += double(sign_[v]) * t;
        }
        details[tree.root] = double(sign_[tree.root]) * root;
    }
}

// ---- refinement ----

std::vector<Vec3> CatmullClarkStep::shift(std::span<const Vec3> details) const {
    assert(details.size() == fineSize());
    std::vector<Vec3> result(coarseSize());
    if (variant_ == CatmullClarkVariant::trial) return result;
    for (Index v = 0; v < coarseSize(); ++v)
        if (variant_ != CatmullClarkVariant::tensor || !tensorVertex_[v]) result[v] = refinement(v, details);
    if (variant_ != CatmullClarkVariant::tensor) return result;

    // A = A3 + S B on the line, S = 23/49 of the two neighbours; so on the product
    //   A7 x A7 - A3 x A3 = S (B x A3 + A3 x B) + S^2 B x B.
    // Of the trial details d:  (B x A3) d = 2 d_e - (d_fa + d_fb)/2 at an edge;  (B x B) d: tensorOfFace.
    std::vector<Vec3> ofFace(adjacency_.faces());
    for (Index f = 0; f < ofFace.size(); ++f)
        if (tensorFace_[f]) ofFace[f] = tensorOfFace(f, details);
    for (Index v = 0; v < coarseSize(); ++v) {
        if (!tensorVertex_[v]) continue;
        Vec3 one, two;
        forStar(
            v, [&](Index e) { one += 2.0 * details[edgePoint(e)]; },
            [&](Index f, int) {
                one -= details[facePoint(f)];
                two += ofFace[f];
            });
        result[v] = kCurveA7 * (one + kCurveA7 * two);
    }
    return result;
}

Vec3 CatmullClarkStep::refinement(Index v, std::span<const Vec3> details) const {
    if (kind_[v] == Kind::corner) return {};
    const bool scaled = variant_ != CatmullClarkVariant::unscaled;
    if (kind_[v] == Kind::curve) {
        Vec3 sum;
        forStar(
            v,
            [&](Index e) {
                if (sharp_[e]) sum += details[edgePoint(e)];
            },
            [](Index, int) {});
        const double factor =
            variant_ == CatmullClarkVariant::tensor ? kCurveA7 : (scaled ? kCurveR : 1) * kCurveUnscaled;
        return factor * sum;
    }
    const Mask m = mask(v);
    const double n = valence_[v];
    const bool constrained = !cascades(v);
    double r = (n - 2) / n, square = 0;
    adjacency_.around(v, [&](Index c) { r += 1 / (n * n * adjacency_.faceSize(adjacency_.face(c))); });
    Vec3 sum;
    adjacency_.around(v, [&](Index c) {
        const Index e = adjacency_.edge(c), f = adjacency_.face(c),
                    other = adjacency_.face(adjacency_.twin(c));
        const bool before = sharp_[adjacency_.edge(adjacency_.prev(c))];
        const double t = 1.0 / adjacency_.faceSize(f);
        const double s = sharp_[e] ? 0.5 : 0.25 * (1 + t + 1.0 / adjacency_.faceSize(other));
        const double alphaE = constrained ? m.edge[sharp_[e] ? 1 : 0] : 0;
        const double alphaF = constrained ? m.face[(sharp_[e] ? 1 : 0) + (before ? 1 : 0)] : 0;
        sum += (r * alphaE + s) * details[edgePoint(e)] + (r * alphaF + t) * details[facePoint(f)];
        square += s * s + t * t;
    });
    if (!constrained && !evenTree_[v]) sum += r * details[v];
    return ((scaled ? r : 1) / (r * r + square)) * sum;
}

// B x B around a face, b = (1/4, -1, 3/2, -1, 1/4): 9/4 at the face, and at each of its four corners, whose outgoing
// halfedges are c (own), c1 (own), c2, c3:
//   -3/2 on each of the four own edges (half of it from either end), 1 on the vertex, -1/4 on the edges c2, c3,
//   3/8 on the faces across the own edges (half from either end), 1/16 on the face opposite.
Vec3 CatmullClarkStep::tensorOfFace(Index f, std::span<const Vec3> details) const {
    Vec3 sum = 9.0 / 4 * details[facePoint(f)];
    const Index begin = adjacency_.faceBegin(f);
    for (Index c = begin; c < begin + 4; ++c) {
        const Index c1 = adjacency_.nextAround(c), c2 = adjacency_.nextAround(c1),
                    c3 = adjacency_.nextAround(c2);
        const auto edge = [&](Index at) { return details[edgePoint(adjacency_.edge(at))]; };
        const auto face = [&](Index at) { return details[facePoint(adjacency_.face(at))]; };
        sum += details[adjacency_.vertex(c)] - 3.0 / 4 * (edge(c) + edge(c1)) -
               1.0 / 4 * (edge(c2) + edge(c3)) + 3.0 / 16 * (face(c1) + face(c3)) + 1.0 / 16 * face(c2);
    }
    return sum;
}

}  // namespace isowave::subdivision
