#include "subdivision/meshes/catmull_clark_wide.h"

#include <array>
#include <cassert>

#include "subdivision/filters/construct.h"
#include "subdivision/filters/masks.h"

namespace isowave::subdivision {

namespace {

// The window inside: vertices within two faces, 5 x 5 of them where four meet, and their edges and faces: 11 x 11 fine
// points. Along a curve as many steps of half an edge either way.
constexpr int kFaceRings = 2, kSteps = 2 * kFaceRings + 1;
constexpr int kTaps = 2 * kSteps + 1;

// The cubic B-spline's A11 from its middle on: where four meet, the row is its product with itself (the least norm of
// a product is the product of the least norms).
const std::array<double, kSteps + 1>& curveRow() {
    static const auto row = [] {
        const auto exact = leastNormA(namedMask("cubic"), kTaps);
        assert(exact);
        std::array<double, kSteps + 1> half;
        for (int k = 0; k <= kSteps; ++k) half[static_cast<std::size_t>(k)] = toDouble((*exact)[{k, 0}]);
        return half;
    }();
    return row;
}

// Every halfedge out of a vertex, counter-clockwise from `first`.
template <class Visit>
Index aroundFrom(const Adjacency& mesh, Index first, Visit visit) {
    Index h = first, last = first;
    do {
        visit(h);
        last = h;
        h = mesh.nextAround(h);
    } while (h != first && h != kNone);
    return h == kNone ? mesh.prev(last) : kNone;  // the boundary's halfedge that arrives, where there is one
}

}  // namespace

WideCatmullClarkStep::WideCatmullClarkStep(const PolygonMesh& coarse)
    : WideCatmullClarkStep(coarse, std::make_unique<CatmullClarkStep>(coarse, CatmullClarkVariant::trial)) {}

WideCatmullClarkStep::WideCatmullClarkStep(const PolygonMesh& coarse, std::unique_ptr<CatmullClarkStep> trial)
    : SubdivisionStep(trial->coarseSize(), trial->fineSize()),
      trial_(std::move(trial)),
      rows_([this](Index fine, Taps& row) { rowOfP(fine, row); }) {
    findKinds(coarse);
    findRows();
}

void WideCatmullClarkStep::findKinds(const PolygonMesh& coarse) {
    const auto sharpness = edgeSharpness(mesh(), coarse.creases);
    sharp_.resize(mesh().edges());
    sharpAt_.resize(mesh().vertices());
    corner_.assign(mesh().vertices(), false);
    for (Index e = 0; e < mesh().edges(); ++e) {
        sharp_[e] = sharpness[e] > 0 || mesh().isBoundaryEdge(e);
        if (!sharp_[e]) continue;
        sharpAt_[mesh().vertex(mesh().edgeCorner(e))].push_back(e);
        sharpAt_[mesh().target(mesh().edgeCorner(e))].push_back(e);
    }
    for (Index v = 0; v < mesh().vertices(); ++v) {
        const bool single = mesh().isBoundaryVertex(v) && mesh().faceValence(v) == 1;
        corner_[v] = single || sharpAt_[v].size() > 2;
    }
    for (const Index v : coarse.pinned) corner_[v] = true;
}

// ---- P, as catmull_clark.h has it ----

void WideCatmullClarkStep::addFaceRow(Index f, double factor, Taps& row) const {
    const Index size = mesh().faceSize(f);
    for (Index c = mesh().faceBegin(f); c < mesh().faceBegin(f) + size; ++c)
        row.push_back({mesh().vertex(c), factor / size});
}

void WideCatmullClarkStep::rowOfP(Index fine, Taps& row) const {
    row.clear();
    const auto vertices = static_cast<Index>(mesh().vertices()), edges = static_cast<Index>(mesh().edges());
    if (fine >= vertices + edges) return addFaceRow(fine - vertices - edges, 1, row);
    if (fine >= vertices) {
        const Index e = fine - vertices, h = mesh().edgeCorner(e);
        row.push_back({mesh().vertex(h), sharp_[e] ? 1.0 / 2 : 1.0 / 4});
        row.push_back({mesh().target(h), sharp_[e] ? 1.0 / 2 : 1.0 / 4});
        if (sharp_[e]) return;
        addFaceRow(mesh().face(h), 1.0 / 4, row);
        addFaceRow(mesh().face(mesh().twin(h)), 1.0 / 4, row);
        return;
    }
    const Index v = fine;
    if (corner_[v]) {
        row.push_back({v, 1});
    } else if (sharpAt_[v].size() == 2) {
        row.push_back({v, 3.0 / 4});
        for (const Index e : sharpAt_[v]) {
            const Index h = mesh().edgeCorner(e);
            row.push_back({mesh().vertex(h) == v ? mesh().target(h) : mesh().vertex(h), 1.0 / 8});
        }
    } else {
        const auto n = static_cast<double>(mesh().valence(v));
        row.push_back({v, (n - 2) / n});
        mesh().around(v, [&](Index h) {
            row.push_back({mesh().target(h), 1 / (n * n)});
            addFaceRow(mesh().face(h), 1 / (n * n), row);
        });
    }
}

// ---- windows ----

std::vector<Index> WideCatmullClarkStep::window(Index v) const {
    return sharpAt_[v].size() == 2 ? curveWindow(v) : ballWindow(v);
}

// REQUIRES: v is smooth. Every vertex comes with a halfedge out of it that only depends on how it was reached, so that
// equal places are written down equally.
std::vector<Index> WideCatmullClarkStep::ballWindow(Index v) const {
    std::vector<Index> window{v}, from{mesh().outgoing(v)};
    std::size_t begin = 0;
    for (int ring = 0; ring < kFaceRings; ++ring) {
        for (const std::size_t end = window.size(); begin < end; ++begin) {
            aroundFrom(mesh(), from[begin], [&](Index h) {
                for (Index c = mesh().next(h); c != h; c = mesh().next(c)) {
                    const Index u = mesh().vertex(c);
                    if (placeIn(window, u) < window.size()) continue;
                    window.push_back(u);
                    from.push_back(mesh().isBoundaryVertex(u) ? mesh().outgoing(u) : c);
                }
            });
        }
    }
    const auto vertices = static_cast<Index>(mesh().vertices()), edges = static_cast<Index>(mesh().edges());
    for (const Index first : from) {
        const Index arriving = aroundFrom(mesh(), first, [&](Index h) {
            addOnce(window, vertices + mesh().edge(h));
            addOnce(window, vertices + edges + mesh().face(h));
        });
        if (arriving != kNone) addOnce(window, vertices + mesh().edge(arriving));
    }
    return window;
}

// REQUIRES: two sharp edges at v. Either way along them, up to a vertex where they do not go on.
std::vector<Index> WideCatmullClarkStep::curveWindow(Index v) const {
    std::vector<Index> window{v};
    for (Index e : sharpAt_[v]) {
        Index at = v;
        for (int k = 0; k < kSteps; k += 2) {
            const Index h = mesh().edgeCorner(e);
            at = mesh().vertex(h) == at ? mesh().target(h) : mesh().vertex(h);
            addOnce(window, static_cast<Index>(mesh().vertices()) + e);
            if (k + 1 < kSteps) addOnce(window, at);
            if (corner_[at] || sharpAt_[at].size() != 2) break;
            e = sharpAt_[at][0] == e ? sharpAt_[at][1] : sharpAt_[at][0];
        }
    }
    return window;
}

// Vertices whose window is smooth, of quads, with valence 4 everywhere.
std::vector<bool> WideCatmullClarkStep::regularVertices() const {
    std::vector<bool> regular(mesh().vertices());
    for (Index v = 0; v < mesh().vertices(); ++v) {
        regular[v] =
            !mesh().isBoundaryVertex(v) && mesh().valence(v) == 4 && sharpAt_[v].empty() && !corner_[v];
        mesh().around(v, [&](Index h) { regular[v] = regular[v] && mesh().faceSize(mesh().face(h)) == 4; });
    }
    for (int ring = 0; ring < kFaceRings; ++ring) {
        const auto before = regular;
        for (Index f = 0; f < mesh().faces(); ++f) {
            const Index begin = mesh().faceBegin(f), end = begin + mesh().faceSize(f);
            bool all = true;
            for (Index c = begin; c < end; ++c) all = all && before[mesh().vertex(c)];
            for (Index c = begin; c < end && !all; ++c) regular[mesh().vertex(c)] = false;
        }
    }
    return regular;
}

void WideCatmullClarkStep::findRows() {
    weights_.assign(mesh().vertices(), nullptr);
    regular_ = regularVertices();
    for (Index v = 0; v < mesh().vertices(); ++v) {
        if (corner_[v] || regular_[v]) continue;
        const auto& weights = rows_.weights(window(v));
        if (weights.empty()) {
            ++withoutRow_;
        } else {
            weights_[v] = &weights;
        }
    }
}

// ---- points ----

// Four quarters: the fine points i d + j d', i >= 1, j >= 0, for each direction d and the next one, d'. The coarse
// vertex (a, b) is at 2a, 2b; the halfedge of direction d from there has its face on the left, towards d'.
Vec3 WideCatmullClarkStep::regularShift(Index v, std::span<const Vec3> details) const {
    const auto& half = curveRow();
    const std::size_t edges = mesh().vertices(), faces = edges + mesh().edges();
    const auto straight = [&](Index h) { return mesh().nextAround(mesh().nextAround(mesh().twin(h))); };
    const auto beside = [&](Index h) { return mesh().nextAround(mesh().twin(mesh().nextAround(h))); };
    Vec3 moved = half[0] * half[0] * details[v];
    mesh().around(v, [&](Index first) {
        Index h = first;
        for (std::size_t a = 0; a <= kFaceRings; ++a) {
            if (a > 0) h = straight(h);
            Index at = h;
            for (std::size_t b = 0; b <= kFaceRings; ++b) {
                if (b > 0) at = beside(at);
                const std::size_t i = 2 * a, j = 2 * b;
                if (a > 0) {
                    moved += half[i] * half[j] * details[mesh().vertex(at)];
                    moved += half[i] * half[j + 1] * details[edges + mesh().edge(mesh().nextAround(at))];
                }
                moved += half[i + 1] * half[j] * details[edges + mesh().edge(at)];
                moved += half[i + 1] * half[j + 1] * details[faces + mesh().face(at)];
            }
        }
    });
    return moved;
}

std::vector<Vec3> WideCatmullClarkStep::shift(std::span<const Vec3> allDetails) const {
    assert(allDetails.size() == fineSize());
    std::vector<Vec3> moved(mesh().vertices());
    for (Index v = 0; v < mesh().vertices(); ++v) {
        if (regular_[v]) {
            moved[v] = regularShift(v, allDetails);
        } else if (weights_[v]) {
            const auto nodes = window(v);
            for (std::size_t k = 0; k < nodes.size(); ++k)
                moved[v] += (*weights_[v])[k] * allDetails[nodes[k]];
        }
    }
    return moved;
}

SubdivisionStep::Parts WideCatmullClarkStep::decompose(std::span<const Vec3> fine) const {
    Parts parts = trial_->decompose(fine);
    const auto moved = shift(trial_->allDetails(parts.coarse, parts.stored));
    for (std::size_t v = 0; v < moved.size(); ++v) parts.coarse[v] += moved[v];
    return parts;
}

}  // namespace isowave::subdivision
