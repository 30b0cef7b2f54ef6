#include "subdivision/lattice/surface.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <set>

#include "isowave/error.h"
#include "subdivision/filters/construct.h"
#include "subdivision/filters/four_point.h"
#include "subdivision/filters/masks.h"

namespace isowave::subdivision {

namespace {

using Family = SurfaceScheme::Family;
constexpr Lattice kLattice = Lattice::Triangular;

// ---- where a node is ----

int sidesAt(const Patch& patch, Node node) {
    int count = 0;
    for (const int d : patch.distances(node)) count += d == 0;
    return patch.isTorus() ? 0 : count;
}

// The side on which all of the nodes lie, or -1.
int commonSide(const Patch& patch, std::initializer_list<Node> nodes) {
    for (std::size_t s = 0; s < 6; ++s) {
        if (std::all_of(nodes.begin(), nodes.end(), [&](Node n) { return patch.distances(n)[s] == 0; })) {
            return patch.isTorus() ? -1 : static_cast<int>(s);
        }
    }
    return -1;
}

// A side, seen from one of its nodes: the step along it, and how many steps there are either way to the
// corners.
struct SidePlace {
    Node step;
    int before = 0, after = 0;
    int nodes() const { return before + after + 1; }
};

// A side may be as long as a picture; nothing farther than this is ever asked for.
constexpr int kFarAlongSide = 64;

SidePlace placeOnSide(const Patch& patch, Node node) {
    const int side = commonSide(patch, {node});
    assert(side >= 0);
    SidePlace place{Patch::stepAlong(static_cast<std::size_t>(side))};
    while (place.before < kFarAlongSide && patch.contains(node - (place.before + 1) * place.step))
        ++place.before;
    while (place.after < kFarAlongSide && patch.contains(node + (place.after + 1) * place.step))
        ++place.after;
    return place;
}

// ---- P ----

// The coarse edge in whose middle a fine node lies.
struct Edge {
    Node u, v;
};
Edge edgeOf(Node fine) {
    const Node half{(fine.x & 1) != 0, (fine.y & 1) != 0};
    // Along (1,0), (0,1), or, when both are odd, (-1,1): the fine node minus the unit step is twice one end.
    const Node unit = half == Node{1, 1} ? Node{-1, 1} : half;
    const Node twice = fine - unit;
    const Node u{twice.x / 2, twice.y / 2};
    return {u, u + unit};
}

// The two coarse nodes that form triangles with an edge of direction u: u turned by 60 degrees either way.
std::array<Node, 2> opposite(const Edge& edge) {
    const Node d = edge.v - edge.u;
    return {edge.u + Node{-d.y, d.x + d.y}, edge.u + Node{d.x + d.y, -d.x}};
}

// The row of P of an open curve with n coarse points at its fine point i.
using LineRule = Diagram (*)(int n, int i);

// The cubic B-spline inside, the ends kept.
Diagram cubicRule(int n, int i) {
    const int j = i / 2;
    if (i % 2 == 1) return {{{j, 0}, Rational(1, 2)}, {{j + 1, 0}, Rational(1, 2)}};
    if (j == 0 || j == n - 1) return Diagram::delta({j, 0});
    return {{{j - 1, 0}, Rational(1, 8)}, {{j, 0}, Rational(3, 4)}, {{j + 1, 0}, Rational(1, 8)}};
}

LineRule sideRule(const SurfaceScheme& scheme) {
    return scheme.family == Family::Butterfly ? fourPointRow : cubicRule;
}

// A row of P at a fine node of a side: the curve's rule, laid along the side.
Diagram sideRow(const SurfaceScheme& scheme, const Patch& coarse, Node near, int offset) {
    // `near` is a coarse node of the side, the fine node is `offset` fine steps after its vertex node.
    const SidePlace place = placeOnSide(coarse, near);
    const Diagram line = sideRule(scheme)(place.nodes(), 2 * place.before + offset);
    Diagram row;
    for (const auto& [node, value] : line) row.add(near + (node.x - place.before) * place.step, value);
    return row;
}

Diagram butterflyEdgeRow(const Patch& coarse, const Edge& edge) {
    const Rational w(1, 16);
    Diagram row{{edge.u, Rational(1, 2)}, {edge.v, Rational(1, 2)}};
    for (const Node c : opposite(edge)) {
        row.add(c, 2 * w);
        // The wings lie across the triangle's two other sides (u, c) and (v, c).
        for (const auto& [kept, turned] : {std::pair(edge.u, edge.v), std::pair(edge.v, edge.u)}) {
            const Node wing = kept + c - turned;
            if (coarse.contains(wing)) {
                row.add(wing, -w);
            } else {
                row.add(kept, -w);
                row.add(c, -w);
                row.add(turned, w);
            }
        }
    }
    return row;
}

// Rows of the mask itself: the fine node takes mask.p[fine - 2t] from the coarse t.
Diagram maskRow(const Mask& mask, Node fine) {
    Diagram row;
    for (const auto& [offset, weight] : mask.p) {
        const Node twice = fine - offset;
        if (isVertexNode(twice)) row.add({twice.x / 2, twice.y / 2}, weight);
    }
    return row;
}

// ---- A ----

FiniteSubdivision around(const SurfaceScheme& scheme, const Patch& coarse, const std::vector<Node>& window) {
    // The rows on the window: all that the equations of A see.
    FiniteSubdivision p;
    for (const Node fine : window) p.addRow(fine, surfaceRowOfP(scheme, coarse, fine));
    return p;
}

Diagram leastNorm(const SurfaceScheme& scheme, const Patch& coarse, Node node,
                  const std::vector<Node>& window) {
    const auto row = leastNormRow(around(scheme, coarse, window), node, window);
    if (!row) {
        throw InputError(scheme.name, "no A of this width exists at node (" + std::to_string(node.x) + "," +
                                          std::to_string(node.y) + ") of the " + coarse.name());
    }
    return *row;
}

// The fine nodes of the side within `steps` of the node's vertex node.
std::vector<Node> sideWindow(const Patch& fine, const SidePlace& place, Node node, int steps) {
    std::vector<Node> window;
    for (int k = -steps; k <= steps; ++k) {
        const Node at = 2 * node + k * place.step;
        if (fine.contains(at)) window.push_back(at);
    }
    return window;
}

int stepsAlongSide(const SurfaceScheme& scheme) {
    if (scheme.family == Family::Butterfly) return scheme.width >= 3 ? 4 : 0;
    return scheme.width >= 3 ? 3 : 1;
}

std::vector<Node> ballWindow(const Patch& fine, Node node, int width, bool oneTap) {
    std::vector<Node> window;
    for (const Node at : spiral(kLattice, 2 * node, width)) {
        if (!fine.contains(at) || (oneTap && isVertexNode(at) && at != 2 * node)) continue;
        window.push_back(at);
    }
    return window;
}

Diagram rowOfA(const SurfaceScheme& scheme, const Patch& coarse, Node node, int width, int steps,
               bool oneTap) {
    const Patch fine = coarse.subdivided();
    switch (sidesAt(coarse, node)) {
        case 0:
            return leastNorm(scheme, coarse, node, ballWindow(fine, node, width, oneTap));
        case 1:
            return leastNorm(scheme, coarse, node, sideWindow(fine, placeOnSide(coarse, node), node, steps));
        default:
            return Diagram::delta(2 * node);  // a corner is kept
    }
}

// ---- systems ----

Diagram wrapped(const Diagram& diagram, const Patch& patch) {
    Diagram result;
    for (const auto& [node, value] : diagram) result.add(patch.wrapped(node), value);
    return result;
}

std::string knownSchemes() {
    std::string known;
    for (const auto& each : surfaceSchemeNames()) known += (known.empty() ? "" : ", ") + each;
    return known + ", loop-like:ALPHA,GAMMA";
}

}  // namespace

const std::vector<std::string>& surfaceSchemeNames() {
    static const std::vector<std::string> names = {"butterfly-trivial", "butterfly-3", "butterfly-4",
                                                   "loop-1", "loop-3"};
    return names;
}

SurfaceScheme surfaceScheme(std::string_view name) {
    const auto unknown = [&](const std::string& why) {
        return InputError("scheme '" + std::string(name) + "'",
                          why + "; the known ones are " + knownSchemes());
    };
    SurfaceScheme scheme;
    scheme.name = name;
    if (name.starts_with("loop-like:")) {
        const auto values = parseRationals(name.substr(10));
        if (values.size() != 2) throw unknown("needs two numbers, as in loop-like:1/16,1/8");
        scheme.family = Family::LoopLike;
        scheme.width = 1;
        scheme.mask = loopLike(values[0], values[1]);
        construct(scheme.mask, 1);  // says why when there is none
        return scheme;
    }
    const std::size_t dash = name.find('-');
    const std::string_view base = name.substr(0, dash),
                           width = dash == name.npos ? "" : name.substr(dash + 1);
    if (base != "butterfly" && base != "loop") throw unknown("is not known");
    scheme.family = base == "loop" ? Family::LoopLike : Family::Butterfly;
    scheme.mask = namedMask(base);
    if (dash == name.npos) {
        scheme.width = base == "loop" ? 1 : 3;
        scheme.name += "-" + std::to_string(scheme.width);
    } else if (width == "trivial" && base == "butterfly") {
        scheme.width = 0;
    } else {
        const auto read = std::from_chars(width.data(), width.data() + width.size(), scheme.width);
        const int least = base == "loop" ? 1 : 0;
        if (read.ec != std::errc() || read.ptr != width.data() + width.size()) throw unknown("has no width");
        if (scheme.width < least || scheme.width > 4)
            throw unknown("has a width outside " + std::to_string(least) + " to 4");
    }
    return scheme;
}

Diagram surfaceRowOfP(const SurfaceScheme& scheme, const Patch& coarse, Node fine) {
    if (isVertexNode(fine)) {
        const Node node{fine.x / 2, fine.y / 2};
        if (sidesAt(coarse, node) >= 2) return Diagram::delta(node);
        if (sidesAt(coarse, node) == 1) return sideRow(scheme, coarse, node, 0);
        return maskRow(scheme.mask, fine);
    }
    const Edge edge = edgeOf(fine);
    if (const int side = commonSide(coarse, {edge.u, edge.v}); side >= 0) {
        // An end of the edge may be a corner, on two sides: take the row from where only this side is meant.
        const Node step = Patch::stepAlong(side);
        const Node first = coarse.contains(edge.u) && edge.v - edge.u == step ? edge.u : edge.v;
        SidePlace place{step};
        while (place.before < kFarAlongSide && coarse.contains(first - (place.before + 1) * step))
            ++place.before;
        while (place.after < kFarAlongSide && coarse.contains(first + (place.after + 1) * step))
            ++place.after;
        const Diagram line = sideRule(scheme)(place.nodes(), 2 * place.before + 1);
        Diagram row;
        for (const auto& [node, value] : line) row.add(first + (node.x - place.before) * step, value);
        return row;
    }
    return scheme.family == Family::Butterfly ? butterflyEdgeRow(coarse, edge) : maskRow(scheme.mask, fine);
}

Diagram surfaceRowOfA(const SurfaceScheme& scheme, const Patch& coarse, Node node) {
    return rowOfA(scheme, coarse, node, scheme.width, stepsAlongSide(scheme), false);
}

Diagram surfaceRowOfA0(const SurfaceScheme& scheme, const Patch& coarse, Node node) {
    if (scheme.family == Family::Butterfly) return Diagram::delta(2 * node);
    return rowOfA(scheme, coarse, node, 1, 1, true);
}

System surfaceSystem(const SurfaceScheme& scheme, const Patch& coarse) {
    const Patch fine = coarse.subdivided();
    FiniteSubdivision p;
    for (const Node n : fine.nodes()) p.addRow(n, wrapped(surfaceRowOfP(scheme, coarse, n), coarse));
    System system;
    std::vector<std::pair<Node, Diagram>> a, a0;
    for (const Node n : coarse.nodes()) {
        a.emplace_back(n, wrapped(surfaceRowOfA(scheme, coarse, n), fine));
        a0.emplace_back(n, wrapped(surfaceRowOfA0(scheme, coarse, n), fine));
        system.a.push_back(a.back().second);
        system.p.push_back(p.column(n));
    }
    // The column of A0 at an edge node, on the vertex nodes, each over the row's own tap there.
    std::map<Node, Diagram> vertexPart;
    std::map<Node, const Diagram*> rowOfA0;
    for (const auto& [n, row] : a0) {
        rowOfA0[n] = &row;
        for (const auto& [at, value] : row) {
            if (at != 2 * n) vertexPart[at].add(2 * n, -value / row[2 * n]);
        }
    }
    for (const Node e : fine.edgeNodes()) {
        Diagram b = Diagram::delta(e);
        for (const auto& [n, weight] : p.row(e)) b.add(*rowOfA0.at(n), -weight);
        system.b.push_back(b);
        Diagram q = Diagram::delta(e);
        if (const auto found = vertexPart.find(e); found != vertexPart.end())
            q.add(found->second, Rational(1));
        system.q.push_back(lifted(p, a, q));
    }
    const Proof proof = prove(system, fine.size());
    if (!proof)
        throw InputError(scheme.name, "has no filters on the " + coarse.name() + ": " + proof.failure);
    return system;
}

// ---- doubles ----

namespace {

using Map = SurfaceFilters::Map;
using Stencil = SurfaceFilters::Stencil;

int floorHalf(int v) { return (v - (v & 1)) / 2; }

// The node of the input from which the taps of an output node are counted.
Node baseOf(Map map, Node node) {
    return map == Map::P ? Node{floorHalf(node.x), floorHalf(node.y)} : 2 * node;
}

// The nodes of row j that are at least `reach` from every side (on a torus: from the seam).
struct Run {
    int begin, end;
};
Run innerRun(const Patch& patch, int j, int reach) {
    const int low = patch.low(j), high = patch.high(j);
    const auto isInner = [&](int i) {
        if (patch.isTorus()) {
            return i >= reach && high - i >= reach && j >= reach && patch.lastRow() - j >= reach;
        }
        const auto d = patch.distances({i, j});
        return *std::min_element(d.begin(), d.end()) >= reach;
    };
    // The inner nodes of a row are one run (the patch is convex) and begin and end within `reach` of its
    // ends, if there are any; a slanted side costs one node for each row of distance, hence twice the reach.
    int begin = low, end = high + 1;
    while (begin < end && begin - low <= 2 * reach && !isInner(begin)) ++begin;
    if (begin == end || !isInner(begin)) return {end, end};
    while (!isInner(end - 1)) --end;
    return {begin, end};
}

// For each tap, where its value lies for this node of the output.
std::vector<std::pair<std::ptrdiff_t, double>> tapsAlongRow(const Stencil& stencil, Map map,
                                                            const Patch& input, Node node) {
    std::vector<std::pair<std::ptrdiff_t, double>> taps;
    for (const auto& [offset, weight] : stencil) {
        const Node at = baseOf(map, node) + offset;
        taps.emplace_back(static_cast<std::ptrdiff_t>(input.index(at)), weight);
    }
    return taps;
}

// sums[k] += weight * from[k Advance], for nodes of `channels` numbers.
template <std::size_t Advance>
void addScaled(double weight, const double* from, std::size_t count, std::size_t channels, double* sums) {
    if (channels == 1) {
        for (std::size_t k = 0; k < count; ++k) sums[k] += weight * from[k * Advance];
        return;
    }
    for (std::size_t k = 0; k < count; ++k) {
        for (std::size_t c = 0; c < channels; ++c)
            sums[k * channels + c] += weight * from[k * Advance * channels + c];
    }
}

// out = map in. REQUIRES: sizes as the patches say.
void apply(Map map, SurfaceFilters& filters, const Patch& coarse, int channels, const std::vector<double>& in,
           std::vector<double>& out) {
    const Patch fine = coarse.subdivided();
    const Patch &input = map == Map::P ? coarse : fine, &output = map == Map::P ? fine : coarse;
    const auto ch = static_cast<std::size_t>(channels);
    assert(in.size() == input.size() * ch);
    out.assign(output.size() * ch, 0.0);

    const auto general = [&](Node node) {
        double* const to = out.data() + output.index(node) * ch;
        for (const auto& [offset, weight] : filters.at(map, coarse, node)) {
            const double* from = in.data() + input.index(input.wrapped(baseOf(map, node) + offset)) * ch;
            for (std::size_t c = 0; c < ch; ++c) to[c] += weight * from[c];
        }
    };
    // Along an inner run a stencil's taps move on evenly: P has one stencil for each parity of i and its
    // input moves by one every two nodes; A has one, and its input moves by two.
    const int stride = map == Map::P ? 2 : 1;
    std::vector<double> sums;
    for (int j = output.firstRow(); j <= output.lastRow(); ++j) {
        const Run run = innerRun(output, j, filters.reach(map));
        for (int i = output.low(j); i < run.begin; ++i) general({i, j});
        for (int phase = 0; phase < stride && run.begin + phase < run.end; ++phase) {
            const Node first{run.begin + phase, j};
            const auto taps = tapsAlongRow(filters.at(map, coarse, first), map, input, first);
            // Tap by tap along the row, not node by node: each is one pass over contiguous (A: every second)
            // values.
            const std::size_t count = static_cast<std::size_t>((run.end - first.x + stride - 1) / stride);
            sums.assign(count * ch, 0.0);
            for (const auto& [index, weight] : taps) {
                const double* const from = in.data() + static_cast<std::size_t>(index) * ch;
                if (map == Map::P) {
                    addScaled<1>(weight, from, count, ch, sums.data());
                } else {
                    addScaled<2>(weight, from, count, ch, sums.data());
                }
            }
            double* to = out.data() + output.index(first) * ch;
            for (std::size_t k = 0; k < count; ++k, to += ch * static_cast<std::size_t>(stride)) {
                std::copy_n(sums.data() + k * ch, ch, to);
            }
        }
        for (int i = run.end; i <= output.high(j); ++i) general({i, j});
    }
}

bool keepsVertexNodes(const SurfaceScheme& scheme) { return scheme.family == Family::Butterfly; }

// A is A0: Butterfly of widths 0 to 2 has only the trivial one, Loop of width 1 and 2 only its one-tap row.
bool isSmallest(const SurfaceScheme& scheme) { return scheme.width < 3; }

std::vector<double> halve(const SurfaceField& fine, SurfaceFilters& filters, SurfaceField& coarse) {
    const auto ch = static_cast<std::size_t>(fine.channels);
    std::vector<double> narrow, predicted;
    apply(Map::A0, filters, coarse.patch, fine.channels, fine.values, narrow);
    apply(Map::P, filters, coarse.patch, fine.channels, narrow, predicted);
    std::vector<double> details;
    details.reserve((fine.patch.size() - coarse.patch.size()) * ch);
    std::size_t at = 0;
    for (int j = fine.patch.firstRow(); j <= fine.patch.lastRow(); ++j) {
        for (int i = fine.patch.low(j); i <= fine.patch.high(j); ++i, at += ch) {
            if (isVertexNode({i, j})) continue;
            for (std::size_t c = 0; c < ch; ++c) details.push_back(fine.values[at + c] - predicted[at + c]);
        }
    }
    if (isSmallest(filters.scheme())) {
        coarse.values = std::move(narrow);
    } else {
        apply(Map::A, filters, coarse.patch, fine.channels, fine.values, coarse.values);
    }
    return details;
}

// g = Q0 d: d on the edge nodes; on a vertex node minus what A0 makes of those, over A0's tap there.
std::vector<double> spread(const std::vector<double>& details, SurfaceFilters& filters,
                           const SurfaceField& coarse, const Patch& fine) {
    const auto ch = static_cast<std::size_t>(coarse.channels);
    std::vector<double> g(fine.size() * ch, 0.0);
    std::size_t at = 0, next = 0;
    for (int j = fine.firstRow(); j <= fine.lastRow(); ++j) {
        for (int i = fine.low(j); i <= fine.high(j); ++i, at += ch) {
            if (isVertexNode({i, j})) continue;
            for (std::size_t c = 0; c < ch; ++c) g[at + c] = details[next++];
        }
    }
    if (keepsVertexNodes(filters.scheme())) return g;
    std::vector<double> sums;
    apply(Map::A0, filters, coarse.patch, coarse.channels, g, sums);
    std::size_t k = 0;
    for (const Node n : coarse.patch.nodes()) {
        double centre = 0;
        for (const auto& tap : filters.at(Map::A0, coarse.patch, n))
            centre += tap.offset == Node{} ? tap.weight : 0;
        for (std::size_t c = 0; c < ch; ++c, ++k) g[fine.index(2 * n) * ch + c] = -sums[k] / centre;
    }
    return g;
}

SurfaceField doubled(SurfaceField coarse, const std::vector<double>* details, SurfaceFilters& filters) {
    SurfaceField fine{coarse.patch.subdivided(), coarse.channels, {}};
    std::vector<double> g;
    if (details) {
        g = spread(*details, filters, coarse, fine.patch);
        if (!isSmallest(filters.scheme())) {  // else A g = A0 Q0 d = 0
            std::vector<double> shift;
            apply(Map::A, filters, coarse.patch, coarse.channels, g, shift);
            for (std::size_t k = 0; k < shift.size(); ++k) coarse.values[k] -= shift[k];
        }
    }
    apply(Map::P, filters, coarse.patch, coarse.channels, coarse.values, fine.values);
    for (std::size_t k = 0; k < g.size(); ++k) fine.values[k] += g[k];
    return fine;
}

void checkField(const SurfaceField& field) {
    const std::size_t needed = field.patch.size() * static_cast<std::size_t>(field.channels);
    if (field.channels < 1 || field.values.size() != needed) {
        throw InputError("surface", "holds " + std::to_string(field.values.size()) + " numbers; the " +
                                        field.patch.name() + " with " + std::to_string(field.channels) +
                                        " a node has " + std::to_string(needed));
    }
    const auto bad =
        std::find_if(field.values.begin(), field.values.end(), [](double v) { return !std::isfinite(v); });
    if (bad == field.values.end()) return;
    const auto index =
        static_cast<std::size_t>(bad - field.values.begin()) / static_cast<std::size_t>(field.channels);
    const Node node = field.patch.nodes()[index];
    throw InputError("surface", "the value at node (" + std::to_string(node.x) + "," +
                                    std::to_string(node.y) +
                                    ") is not a finite number; fill such gaps before");
}

void checkScheme(const SurfaceLevels& levels, const SurfaceFilters& filters) {
    if (levels.scheme == filters.scheme().name) return;
    throw InputError(
        "levels", "were made by the scheme '" + levels.scheme + "', not by '" + filters.scheme().name + "'");
}

SurfaceField rebuilt(const SurfaceLevels& levels, SurfaceFilters& filters, int level, int lastWithDetails) {
    checkScheme(levels, filters);
    checkField(levels.coarse);
    SurfaceField field = levels.coarse;
    for (int k = levels.levels() - 1; k >= level; --k) {
        const auto& details = levels.details[static_cast<std::size_t>(k)];
        const std::size_t needed =
            (field.patch.subdivided().size() - field.patch.size()) * static_cast<std::size_t>(field.channels);
        if (details.size() != needed) {
            throw InputError("levels", "details of level " + std::to_string(k) + " hold " +
                                           std::to_string(details.size()) + " numbers, not " +
                                           std::to_string(needed));
        }
        field = doubled(std::move(field), k >= lastWithDetails ? &details : nullptr, filters);
    }
    return field;
}

void checkLevel(const SurfaceLevels& levels, int level) {
    if (level >= 0 && level <= levels.levels()) return;
    throw InputError("levels", "there is no level " + std::to_string(level) + "; they are 0 to " +
                                   std::to_string(levels.levels()));
}

}  // namespace

int SurfaceFilters::reach(Map map) const {
    // A row of P sees three fine steps around, and along a side whether there are more than three coarse
    // nodes: six fine steps tell. A row of A sees the rows of P within four fine steps: (6 + 4)/2 coarse
    // ones.
    return map == Map::P ? 6 : 5;
}

const SurfaceFilters::Stencil& SurfaceFilters::at(Map map, const Patch& coarse, Node node) {
    const int far = reach(map);
    std::array<int, 9> key{static_cast<int>(map), 0, 0};
    if (map == Map::P) {
        key[1] = node.x & 1;
        key[2] = node.y & 1;
    }
    const auto distances = map == Map::P ? coarse.fineDistances(node) : coarse.distances(node);
    for (std::size_t s = 0; s < 6; ++s) key[s + 3] = std::min(distances[s], far);
    const auto [place, isNew] = stencils_.try_emplace(key);
    if (isNew) {
        const Diagram row = map == Map::P   ? surfaceRowOfP(scheme_, coarse, node)
                            : map == Map::A ? surfaceRowOfA(scheme_, coarse, node)
                                            : surfaceRowOfA0(scheme_, coarse, node);
        for (const auto& [n, weight] : row)
            place->second.push_back({n - baseOf(map, node), toDouble(weight)});
    }
    return place->second;
}

Patch SurfaceLevels::patch(int level) const {
    Patch patch = coarse.patch;
    for (int k = levels(); k > level; --k) patch = patch.subdivided();
    return patch;
}

SurfaceLevels decompose(const SurfaceField& field, SurfaceFilters& filters, int levels) {
    checkField(field);
    if (levels < 0)
        throw InputError("levels", std::to_string(levels) + " levels are asked for; there may be 0 or more");
    int most = 0;
    for (Patch patch = field.patch; patch.canCoarsen(); patch = patch.coarsened()) ++most;
    if (levels > most) {
        throw InputError("surface", "the sides of the " + field.patch.name() + " can be halved " +
                                        std::to_string(most) + " times, not " + std::to_string(levels) +
                                        "; crop them to multiples of 2^levels");
    }
    SurfaceLevels result{filters.scheme().name, field, {}};
    for (int k = 0; k < levels; ++k) {
        SurfaceField coarse{result.coarse.patch.coarsened(), field.channels, {}};
        result.details.push_back(halve(result.coarse, filters, coarse));
        result.coarse = std::move(coarse);
    }
    return result;
}

SurfaceField reconstruct(const SurfaceLevels& levels, SurfaceFilters& filters, int level) {
    checkLevel(levels, level);
    return rebuilt(levels, filters, level, 0);
}

SurfaceField subdivided(const SurfaceLevels& levels, SurfaceFilters& filters, int from) {
    checkLevel(levels, from);
    return rebuilt(levels, filters, 0, from);
}

}  // namespace isowave::subdivision
