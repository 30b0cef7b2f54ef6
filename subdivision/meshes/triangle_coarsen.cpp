#include "subdivision/meshes/triangle_coarsen.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>

#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

// The part that a triangle plays: 0, 1, 2: it lies at that corner, which remains; kMiddle: of a coarse triangle.
using Part = signed char;
constexpr Part kUnknown = -1, kMiddle = 3;
// Two coarse triangles at an edge put three fine ones each around its middle.
constexpr std::size_t kAroundMiddleInside = 6, kAroundMiddleOnBoundary = 3;

Part after(Part k) { return static_cast<Part>((k + 1) % 3); }

using Corners = std::array<Index, 3>;

class Search {
  public:
    // names: of the mesh's vertices, for messages.
    Search(const PolygonMesh& mesh, const std::vector<Index>& names)
        : mesh_(mesh),
          names_(names),
          fine_(mesh),
          part_(mesh.faceCount(), kUnknown),
          inPiece_(mesh.faceCount(), false) {}

    Coarsening run() {
        for (Index v = 0; v < fine_.vertices(); ++v) {
            if (part_[triangleOf(fine_.outgoing(v))] == kUnknown) settlePiece(v);
        }
        return assemble();
    }

  private:
    // Halfedge 3t + k starts at corner k of triangle t.
    static Index triangleOf(Index h) { return h / 3; }
    static Part cornerOf(Index h) { return static_cast<Part>(h % 3); }
    static Index halfedge(Index t, Part k) { return 3 * t + static_cast<Index>(k); }
    Index vertex(Index t, Part k) const { return fine_.vertex(halfedge(t, k)); }
    std::string name(Index v) const { return std::to_string(names_[v]); }
    std::string nameOfTriangle(Index t) const {
        return "the triangle of vertices " + name(vertex(t, 0)) + ", " + name(vertex(t, 1)) + ", " +
               name(vertex(t, 2));
    }
    // The corner across from a halfedge, in its own triangle.
    Index apex(Index h) const { return fine_.vertex(fine_.prev(h)); }

    // The piece that holds v, its lowest vertex.
    void settlePiece(Index v) {
        const auto refuse = [&](const std::string& why) {
            throw InputError("no 1-to-4 subdivision connectivity in the piece of vertex " + name(v) + ": " +
                             why);
        };
        const std::size_t size = pieceSize(v);
        if (size % 4 != 0) refuse("it has " + std::to_string(size) + " triangles, not a multiple of 4");
        // The answer that came farthest says most about what is wrong.
        std::size_t farthest = 0;
        std::string reason;
        for (const auto& [start, as] : answers(v)) {
            const std::string failure = spread(start, as);
            if (failure.empty()) return;
            if (reached_.size() > farthest) {
                farthest = reached_.size();
                reason = failure;
            }
            for (const Index t : reached_) part_[t] = kUnknown;
        }
        refuse(reason);
    }

    std::size_t pieceSize(Index v) {
        std::vector<Index> found{triangleOf(fine_.outgoing(v))};
        inPiece_[found[0]] = true;
        for (std::size_t k = 0; k < found.size(); ++k) {
            for (Index h = 3 * found[k]; h < 3 * found[k] + 3; ++h) {
                const Index across = fine_.twin(h);
                if (across == kNone || inPiece_[triangleOf(across)]) continue;
                found.push_back(triangleOf(across));
                inPiece_[found.back()] = true;
            }
        }
        return found.size();
    }

    // The triangle of v and its lowest neighbour (the left one, as seen from v, where there are two), and the
    // parts that it may play, in the order in which they are tried.
    std::array<std::pair<Index, Part>, 4> answers(Index v) const {
        Index lowest = kNone, start = kNone;
        const auto consider = [&](Index neighbour, Index h) {
            if (neighbour >= lowest) return;
            lowest = neighbour;
            start = triangleOf(h);
        };
        fine_.around(v, [&](Index h) {
            consider(fine_.target(h), h);
            if (fine_.nextAround(h) == kNone) consider(apex(h), h);
        });
        Part first = 0, second = 0;
        for (Part k = 0; k < 3; ++k) {
            if (vertex(start, k) == v) first = k;
            if (vertex(start, k) == lowest) second = k;
        }
        return {{{start, first},
                 {start, second},
                 {start, static_cast<Part>(3 - first - second)},
                 {start, kMiddle}}};
    }

    // Gives the piece its parts, beginning with `as` for the triangle `start`. Returns why that fails, or nothing;
    // reached_ is what has a part by then.
    std::string spread(Index start, Part as) {
        reached_.clear();
        if (std::string failure = assign(start, as); !failure.empty()) return failure;
        for (std::size_t k = 0; k < reached_.size(); ++k) {
            for (Part corner = 0; corner < 3; ++corner) {
                if (std::string failure = cross(halfedge(reached_[k], corner)); !failure.empty())
                    return failure;
            }
        }
        return repeatedEdge();
    }

    // Settles the triangle across h.
    std::string cross(Index h) {
        const Index t = triangleOf(h), g = fine_.twin(h);
        const bool isMiddle = part_[t] == kMiddle;
        const bool facesMiddle = !isMiddle && cornerOf(h) == after(part_[t]);
        if (g == kNone) {
            if (!isMiddle && !facesMiddle) return {};
            return nameOfTriangle(t) + " would have to " + describe(t, part_[t]) +
                   ", but the coarse triangle would end at its edge between vertices " +
                   name(fine_.vertex(h)) + " and " + name(fine_.target(h)) + ", which lies on the boundary";
        }
        const Part at = cornerOf(g);
        if (facesMiddle) return assign(triangleOf(g), kMiddle);
        if (isMiddle) return assign(triangleOf(g), after(after(at)));  // it lies at its apex over the edge
        // Both lie at the same remaining vertex, one end of the edge.
        return assign(triangleOf(g), cornerOf(h) == part_[t] ? after(at) : at);
    }

    std::string assign(Index t, Part as) {
        if (part_[t] == as) return {};
        if (part_[t] != kUnknown) {
            return nameOfTriangle(t) + " would have to " + describe(t, part_[t]) + " and to " +
                   describe(t, as);
        }
        part_[t] = as;
        reached_.push_back(t);
        for (Part k = 0; k < 3; ++k) {
            if (k == as) continue;
            const Index v = vertex(t, k);
            const std::size_t around = fine_.faceValence(v);
            const bool onBoundary = fine_.isBoundaryVertex(v);
            if (around == (onBoundary ? kAroundMiddleOnBoundary : kAroundMiddleInside)) continue;
            return "vertex " + name(v) + " would have to be the middle of a coarse edge, but has " +
                   std::to_string(around) + (around == 1 ? " triangle" : " triangles") +
                   " around it; such a middle has " + (onBoundary ? "3 on the boundary" : "6 inside");
        }
        return {};
    }

    std::string describe(Index t, Part as) const {
        if (as == kMiddle) return "be the middle of a coarse triangle";
        return "lie at the remaining vertex " + name(vertex(t, as));
    }

    // The coarse triangle around a middle. Its k-th edge has corner k of the middle on it.
    Corners around(Index middle) const {
        const auto across = [&](Part k) { return apex(fine_.twin(halfedge(middle, k))); };
        return {across(2), across(0), across(1)};
    }

    // Coarse edges must be told apart by their ends: files know no others.
    std::string repeatedEdge() const {
        std::vector<std::pair<Index, Index>> edges;
        for (const Index t : reached_) {
            if (part_[t] != kMiddle) continue;
            const Corners c = around(t);
            for (std::size_t k = 0; k < 3; ++k) {
                const Index from = c[k], to = c[(k + 1) % 3];
                if (from == to) {
                    return "the coarse triangle around " + nameOfTriangle(t) + " would have vertex " +
                           name(from) + " twice";
                }
                edges.emplace_back(from, to);
            }
        }
        std::sort(edges.begin(), edges.end());
        const auto twice = std::adjacent_find(edges.begin(), edges.end());
        if (twice == edges.end()) return {};
        return "more than one coarse edge would run from vertex " + name(twice->first) + " to vertex " +
               name(twice->second);
    }

    Coarsening assemble() const {
        std::vector<Index> middles, number(fine_.vertices(), kNone);
        for (Index t = 0; t < fine_.faces(); ++t) {
            if (part_[t] == kMiddle) {
                middles.push_back(t);
            } else {
                number[vertex(t, part_[t])] = 0;
            }
        }
        Coarsening result;
        for (Index v = 0; v < fine_.vertices(); ++v) {
            if (number[v] == kNone) continue;
            number[v] = static_cast<Index>(result.coarse.points.size());
            result.coarse.points.push_back(mesh_.points[v]);
        }
        for (const Index t : middles) {
            Corners c = around(t);
            for (Index& v : c) v = number[v];
            result.coarse.addFace(c);
            // The fine triangle at a coarse corner lies across the middle's edge before it, with its apex there.
            for (Part k = 0; k < 3; ++k)
                result.fineCorner.push_back(fine_.prev(fine_.twin(halfedge(t, after(after(k))))));
        }
        for (const Index v : mesh_.pinned) {
            if (number[v] == kNone) {
                throw InputError(
                    "vertex " + name(v) +
                    " is pinned, but would be the middle of a coarse edge; only vertices that remain can be");
            }
            result.coarse.pinned.push_back(number[v]);
        }
        return result;
    }

    const PolygonMesh& mesh_;
    const std::vector<Index>& names_;
    const Adjacency fine_;
    std::vector<Part> part_;
    std::vector<bool> inPiece_;
    std::vector<Index> reached_;
};

}  // namespace

void requireTriangles(const PolygonMesh& mesh) {
    for (std::size_t t = 0; t < mesh.faceCount(); ++t) {
        if (mesh.faceSize(t) == 3) continue;
        throw InputError("face " + std::to_string(t) + " has " + std::to_string(mesh.faceSize(t)) +
                         " corners; loop and butterfly take triangles only, catmull-clark takes any face");
    }
    if (!mesh.creases.empty()) {
        throw InputError("the edge between vertices " + std::to_string(mesh.creases[0].a) + " and " +
                         std::to_string(mesh.creases[0].b) +
                         " is a crease; loop and butterfly know none, catmull-clark does");
    }
}

Coarsening coarsenedTriangles(const PolygonMesh& fine) {
    requireTriangles(fine);
    std::vector<Index> names(fine.vertexCount());
    std::iota(names.begin(), names.end(), Index{0});
    return Search(fine, names).run();
}

std::vector<Coarsening> recoverTriangles(const PolygonMesh& fine, int levels, const Progress& progress) {
    requireTriangles(fine);
    std::vector<Coarsening> found;
    // Of the vertices of the coarsest mesh so far, in `fine`.
    std::vector<Index> names(fine.vertexCount());
    std::iota(names.begin(), names.end(), Index{0});
    while (levels == kAllLevels || static_cast<int>(found.size()) < levels) {
        progress("finding coarse meshes", levels > 0 ? static_cast<double>(found.size()) / levels : 0);
        const PolygonMesh& last = found.empty() ? fine : found.back().coarse;
        try {
            Coarsening next = Search(last, names).run();
            std::vector<Index> namesOfNext(next.coarse.vertexCount());
            for (std::size_t c = 0; c < next.fineCorner.size(); ++c)
                namesOfNext[next.coarse.corners[c]] = names[last.corners[next.fineCorner[c]]];
            names = std::move(namesOfNext);
            found.push_back(std::move(next));
        } catch (const InputError& failure) {
            if (levels == kAllLevels && !found.empty()) return found;
            if (levels == kAllLevels) throw;
            throw InputError(std::to_string(found.size()) + " of " + std::to_string(levels) +
                             " levels are possible: " + failure.what());
        }
    }
    return found;
}

PolygonMesh fineTriangles(const Adjacency& coarse) {
    const auto onEdge = [&](Index h) { return static_cast<Index>(coarse.vertices()) + coarse.edge(h); };
    PolygonMesh fine;
    fine.points.resize(coarse.vertices() + coarse.edges());
    fine.corners.reserve(4 * coarse.corners());
    fine.faceBegin.reserve(4 * coarse.faces() + 1);
    for (Index h = 0; h < coarse.corners(); ++h)
        fine.addFace({coarse.vertex(h), onEdge(h), onEdge(coarse.prev(h))});
    for (Index h = 0; h < coarse.corners(); h += 3) fine.addFace({onEdge(h), onEdge(h + 1), onEdge(h + 2)});
    return fine;
}

}  // namespace isowave::subdivision
