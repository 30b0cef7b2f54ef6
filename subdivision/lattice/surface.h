// Multiresolution on the triangular lattice: Butterfly and Loop-like subdivisions on tori and on patches with
// sides and corners. Bartels and Samavati (B): sections 6 to 10.
//
//   scheme               A inside                    along a side                        P across a side
//   butterfly-trivial    the vertex node             the vertex node                     reflection, see below
//   butterfly-W (3, 4)   least norm, W rings         least norm, 9 points of the side    reflection
//   loop-W (1, 2, 3)     least norm, W rings         cubic B-spline, 3 or 7 points       as inside
//   loop-like:a,g        width 1, with alpha, gamma  cubic B-spline, 3 points            as inside
//
// Sides and corners. A side is a curve of its own: its fine nodes come from its coarse nodes alone, and its A
// reads its own nodes alone, so two patches that share a side stay together whatever happens inside them (B
// section 10). For Butterfly it is the four-point curve of curve_schemes.h with its end rules, for Loop the
// cubic B-spline that keeps its ends; a corner is kept. Inside, Butterfly takes the wings that lie outside by
// *reflection*: the wing across the triangle (a, b, c) beyond the side (a, c) is a + c - b, the fourth corner
// of the parallelogram. (Mirroring at the side's line instead, also found in print, gives other filters: the
// centre of the row one level in becomes 603803769/805874419 instead of 10994599/16197945, and B(10.1) is not
// reproduced.) Inside, A takes the part of its ball that lies on the patch.
//
// No Q is needed to put a surface together. With A0 the left inverse that B and Q0 were made from,
//     d = (f - P A0 f) at edge nodes,      g = Q0 d,      f = P (c - A g) + g,
// since Q = (I - P A) Q0: two passes over small stencils, and exact for every A. For an interpolating P, A0
// just reads the vertex nodes and g is d on the edge nodes and 0 on the others.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/subdivision.h"
#include "subdivision/filters/finite_subdivision.h"
#include "subdivision/lattice/patch.h"

namespace isowave::subdivision {

struct SurfaceScheme {
    enum class Family { Butterfly, LoopLike };
    std::string name;
    Family family = Family::Butterfly;
    int width = 3;  // rings of A
    Mask mask;
};

// "butterfly-trivial", "butterfly-3", "loop-1", "loop-like:1/16,1/8". Throws InputError that lists them.
SurfaceScheme surfaceScheme(std::string_view name);

// Diagrams of one node, exactly. `coarse` is the coarse patch, fine nodes are those of coarse.subdivided(). On a
// torus they are those of the plane: wrap them around.
Diagram surfaceRowOfP(const SurfaceScheme& scheme, const Patch& coarse, Node fine);  // over coarse nodes
Diagram surfaceRowOfA(const SurfaceScheme& scheme, const Patch& coarse, Node coarseNode);  // over fine nodes
Diagram surfaceRowOfA0(const SurfaceScheme& scheme, const Patch& coarse, Node coarseNode);

// Everything at once, for small patches, proved. B and Q in the order of edgeNodes().
System surfaceSystem(const SurfaceScheme& scheme, const Patch& coarse);

// Values on the nodes of a patch: one number each (a height field) or three (a grid of points).
struct SurfaceField {
    Patch patch;
    int channels = 1;
    std::vector<double> values;  // channels of node 0, of node 1, .. in the order of patch.nodes()
};

struct SurfaceLevels {
    std::string scheme;
    SurfaceField coarse;
    // details[k] turns level k+1 into level k: `channels` numbers for each of the level's edgeNodes().
    std::vector<std::vector<double>> details;

    int levels() const { return static_cast<int>(details.size()); }
    Patch patch(int level) const;
};

// The stencils of a scheme in doubles. They depend on the place only through the distances to the sides, as far as a
// filter sees: a stencil is solved for once for all places with the same distances, when the first of them is met. Not
// for several threads at once.
class SurfaceFilters {
  public:
    explicit SurfaceFilters(const SurfaceScheme& scheme) : scheme_(scheme) {}
    const SurfaceScheme& scheme() const { return scheme_; }

    struct Tap {
        Node offset;  // from twice the coarse node (A, A0), or from half the fine node rounded down (P)
        double weight;
    };
    using Stencil = std::vector<Tap>;
    enum class Map { P, A, A0 };
    // The stencil at a node of the map's output.
    const Stencil& at(Map map, const Patch& coarse, Node node);
    // Farther than this from every side (in steps of the output's patch) all nodes of one parity have the same stencil.
    int reach(Map map) const;
    // Stencils solved for so far.
    std::size_t stencilCount() const { return stencils_.size(); }

  private:
    SurfaceScheme scheme_;
    std::map<std::array<int, 9>, Stencil> stencils_;
};

// Throws InputError when the sides cannot be halved that often (and says what would do), when the number of
// values is not that of the patch, or when one is not finite.
SurfaceLevels decompose(const SurfaceField& field, SurfaceFilters& filters, int levels);
// Throws InputError when levels, details and scheme do not belong together.
SurfaceField reconstruct(const SurfaceLevels& levels, SurfaceFilters& filters, int level = 0);
// With all details finer than `from` taken for 0: what subdivision alone makes of that level.
SurfaceField subdivided(const SurfaceLevels& levels, SurfaceFilters& filters, int from);

}  // namespace isowave::subdivision
