#include "bench/lifting.h"

#include <cassert>

namespace isowave::bench {

using subdivision::Index;
using subdivision::kNone;

namespace {

// b x + a sum, or what x was before that.
Vec3 lifted(const Vec3& x, double b, const Vec3& added, bool inverse) {
    return inverse ? (1 / b) * (x - added) : b * x + added;
}

struct Mean {
    Vec3 sum;
    int count = 0;
    void add(const Vec3& v) {
        sum += v;
        ++count;
    }
    Vec3 value() const { return (1.0 / count) * sum; }
};

}  // namespace

void LiftingStep::liftVertices(std::vector<Vec3>& p, Lift lift, bool inverse) const {
    const double a = lift.a, b = lift.b;
    const auto edges = static_cast<Index>(mesh_.vertices()),
               faces = edges + static_cast<Index>(mesh_.edges());
    const auto atEdges = [&] {
        for (Index e = 0; e < mesh_.edges(); ++e) {
            if (mesh_.isBoundaryEdge(e))
                continue;  // along the boundary it is a w, and across it there is nothing
            const Index h = mesh_.edgeCorner(e);
            Mean f;
            f.add(p[faces + mesh_.face(h)]);
            f.add(p[faces + mesh_.face(mesh_.twin(h))]);
            p[edges + e] = lifted(p[edges + e], b, 2 * a * f.value(), inverse);
        }
    };
    const auto atVertices = [&] {
        for (Index v = 0; v < mesh_.vertices(); ++v) {
            Mean e, f, alongBoundary;
            int count = 0;
            mesh_.around(v, [&](Index h) {
                ++count;
                e.add(p[edges + mesh_.edge(h)]);
                f.add(p[faces + mesh_.face(h)]);
                if (mesh_.twin(h) == kNone) alongBoundary.add(p[edges + mesh_.edge(h)]);
                if (mesh_.nextAround(h) == kNone) alongBoundary.add(p[edges + mesh_.edge(mesh_.prev(h))]);
            });
            if (!mesh_.isBoundaryVertex(v)) {
                p[v] = lifted(p[v], b * b, 4 * a * b * e.value() + 4 * a * a * f.value(), inverse);
            } else if (count > 1) {
                p[v] = lifted(p[v], b, 2 * a * alongBoundary.value(), inverse);
            }
        }
    };
    // Either way the vertices see the edges as they are outside the lift: before it, apart; restored, together.
    if (inverse) {
        atEdges();
        atVertices();
    } else {
        atVertices();
        atEdges();
    }
}

void LiftingStep::liftFaces(std::vector<Vec3>& p, Lift lift, bool inverse) const {
    const double a = lift.a, b = lift.b;
    const auto edges = static_cast<Index>(mesh_.vertices()),
               faces = edges + static_cast<Index>(mesh_.edges());
    const auto atEdges = [&] {
        for (Index e = 0; e < mesh_.edges(); ++e) {
            const Index h = mesh_.edgeCorner(e);
            Mean v;
            v.add(p[mesh_.vertex(h)]);
            v.add(p[mesh_.target(h)]);
            p[edges + e] = lifted(p[edges + e], b, 2 * a * v.value(), inverse);
        }
    };
    const auto atFaces = [&] {
        for (Index f = 0; f < mesh_.faces(); ++f) {
            Mean e, v;
            for (Index h = mesh_.faceBegin(f); h < mesh_.faceBegin(f) + mesh_.faceSize(f); ++h) {
                e.add(p[edges + mesh_.edge(h)]);
                v.add(p[mesh_.vertex(h)]);
            }
            p[faces + f] =
                lifted(p[faces + f], b * b, 4 * a * b * e.value() + 4 * a * a * v.value(), inverse);
        }
    };
    if (inverse) {
        atEdges();
        atFaces();
    } else {
        atFaces();
        atEdges();
    }
}

void LiftingStep::apart(std::vector<Vec3>& fine) const {
    assert(fine.size() == fineSize());
    liftVertices(fine, {-1.0 / 2, 2}, false);
    liftFaces(fine, {-1.0 / 2, 1}, false);
    liftVertices(fine, {3.0 / 8, 1}, false);
}

void LiftingStep::together(std::vector<Vec3>& fine) const {
    assert(fine.size() == fineSize());
    liftVertices(fine, {3.0 / 8, 1}, true);
    liftFaces(fine, {-1.0 / 2, 1}, true);
    liftVertices(fine, {-1.0 / 2, 2}, true);
}

}  // namespace isowave::bench
