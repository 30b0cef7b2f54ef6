#include "polygonize/collapse/block.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/triangle.h"
#include "polygonize/collapse/apart.h"

namespace isowave::collapse {

void Block::load(const TriangleMesh& mesh, const std::vector<char>& kept,
                 const std::vector<Quadric>& quadrics, bool first, const Index* begin, const Index* end,
                 const Lattice& blocks, const Cell& block, double cell) {
    blocks_ = &blocks;
    block_ = block;
    number(mesh, begin, end);
    gatherStars();
    markFree(kept);
    isFirst_ = first;
    quadrics_.assign(points_.size(), {});
    if (first)
        makeQuadrics();
    else
        for (std::size_t v = 0; v < points_.size(); ++v)
            if (free_[v]) quadrics_[v] = quadrics[vertexOf_[v]];
    layCells(cell);
    counts_ = {};
}

void Block::collapse(const Limits& limits, std::vector<double>* log) {
    limits_ = limits;
    fillHeap();
    while (!heap_.empty() && counts_.collapsed < limits.collapses) {
        const Entry top = heap_.front();
        if (!(top.cost <= limits.cost)) break;
        std::pop_heap(heap_.begin(), heap_.end(), Later{});
        heap_.pop_back();
        if (take(top) && log) log->push_back(top.cost);
    }
}

void Block::store(TriangleMesh& mesh, std::vector<Quadric>& quadrics) const {
    for (std::size_t v = 0; v < points_.size(); ++v) {
        if (free_[v] || (isFirst_ && inside_[v])) quadrics[vertexOf_[v]] = quadrics_[v];
        if (free_[v]) mesh.points[vertexOf_[v]] = {points_[v].x, points_[v].y, points_[v].z};
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Triangle& corners = triangles_[t];
        if (isDegenerate(corners))
            mesh.triangles[triangleOf_[t]] = {0, 0, 0};
        else if (inside_[corners[0]] && inside_[corners[1]] && inside_[corners[2]])
            mesh.triangles[triangleOf_[t]] = {vertexOf_[corners[0]], vertexOf_[corners[1]],
                                              vertexOf_[corners[2]]};
    }
}

std::int64_t Block::freeTriangles() const {
    return std::count_if(triangles_.begin(), triangles_.end(),
                         [&](const Triangle& t) { return free_[t[0]] && free_[t[1]] && free_[t[2]]; });
}

// ---- load

void Block::number(const TriangleMesh& mesh, const Index* begin, const Index* end) {
    const std::size_t count = static_cast<std::size_t>(end - begin);
    std::size_t slots = 64;
    while (slots < 4 * count) slots *= 2;
    table_.assign(slots, {kNone, 0});
    points_.clear(), vertexOf_.clear(), inside_.clear(), triangles_.clear();
    triangleOf_.assign(begin, end);
    triangles_.reserve(count);
    for (const Index id : triangleOf_) {
        Triangle t = mesh.triangles[id];
        for (Index& v : t) v = localOf(mesh, v);
        triangles_.push_back(t);
    }
}

Index Block::localOf(const TriangleMesh& mesh, Index vertex) {
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = (vertex * std::size_t{0x9e3779b97f4a7c15}) >> 40 & mask;
    while (table_[slot].vertex != vertex) {
        if (table_[slot].vertex != kNone) {
            slot = (slot + 1) & mask;
            continue;
        }
        table_[slot] = {vertex, static_cast<Index>(points_.size())};
        vertexOf_.push_back(vertex);
        points_.push_back(toVec3(mesh.points[vertex]));
        inside_.push_back(isInside(points_.back()));
    }
    return table_[slot].local;
}

void Block::gatherStars() {
    const std::size_t count = points_.size();
    stars_.assign(count, {});
    for (const Triangle& t : triangles_)
        for (const Index v : t) ++stars_[v].room;
    Index first = 0;
    for (Star& star : stars_) {
        star.first = first;
        first += star.room;
    }
    pool_.resize(first);
    for (Index t = 0; t < triangles_.size(); ++t)
        for (const Index v : triangles_[t]) pool_[stars_[v].first + stars_[v].size++] = t;
    versions_.assign(count, 0);
    into_.resize(count);
    std::iota(into_.begin(), into_.end(), Index{0});
    marks_.assign(count, 0);
    mark_ = 0;
}

void Block::markFree(const std::vector<char>& kept) {
    free_ = inside_;
    for (const Triangle& t : triangles_)
        if (!(inside_[t[0]] && inside_[t[1]] && inside_[t[2]])) free_[t[0]] = free_[t[1]] = free_[t[2]] = 0;
    if (kept.empty()) return;
    for (std::size_t v = 0; v < points_.size(); ++v)
        if (kept[vertexOf_[v]]) free_[v] = 0;
}

void Block::makeQuadrics() {
    for (const Triangle& t : triangles_) {
        const Quadric q = Quadric::ofCorner(normalOf(t));
        for (const Index v : t) quadrics_[v] += q;
    }
}

// Cubes over what is inside, larger ones where they would be many more than the triangles.
void Block::layCells(double side) {
    Box box;
    for (std::size_t v = 0; v < points_.size(); ++v)
        if (free_[v]) box.add(points_[v]);
    if (!(box.low.x <= box.high.x)) box.add(points_[0]);  // nothing to do here
    cells_ = latticeOver(box, side, 64 + 4 * triangles_.size());
    facing_.assign(cells_.size(), ~Facing{0});
    listed_ = false;
    for (const Triangle& t : triangles_) face(boxOf(t), facingOf(normalOf(t), longest2Of(t)));
}

double Block::longest2Of(const Triangle& t) const {
    const Vec3 a = points_[t[1]] - points_[t[0]], b = points_[t[2]] - points_[t[1]],
               c = points_[t[0]] - points_[t[2]];
    return std::max({dot(a, a), dot(b, b), dot(c, c)});
}

Box Block::boxOf(const Triangle& t) const {
    Box box;
    for (const Index v : t) box.add(points_[v]);
    return box;
}

void Block::face(const Box& box, Facing facing) {
    cells_.forCells(cells_.cellOf(box.low), cells_.cellOf(box.high), [&](std::size_t cell) {
        facing_[cell] &= facing;
        return true;
    });
}

// ---- the heap

void Block::fillHeap() {
    heap_.clear();
    tried_ = {0, kNone, kNone, 0};
    for (const Triangle& t : triangles_)
        for (int k = 0; k < 3; ++k) {
            const Index v0 = t[k], v1 = t[(k + 1) % 3];
            if (v0 > v1 || !free_[v0] || !free_[v1]) continue;
            const double cost = costOf(v0, v1);
            if (cost <= limits_.cost) heap_.push_back({cost, v0, v1, 0});
        }
    std::make_heap(heap_.begin(), heap_.end(), Later{});
}

void Block::push(const Entry& entry) {
    if (!(entry.cost <= limits_.cost)) return;
    heap_.push_back(entry);
    std::push_heap(heap_.begin(), heap_.end(), Later{});
}

Quadric Block::sumOf(Index v0, Index v1) const {
    Quadric q = quadrics_[v1].about(points_[v0] - points_[v1]);
    q += quadrics_[v0];
    return q;
}

double Block::costOf(Index v0, Index v1) const {
    const Quadric q = sumOf(v0, v1);
    const QuadricSolver solver(q);
    return solver.solvable() ? std::max(0.0, q.c - dot(q.b, solver.solve(q.b))) : 0;
}

Index Block::mergedInto(Index v) {
    while (into_[v] != v) v = into_[v] = into_[into_[v]];
    return v;
}

bool Block::take(const Entry& top) {
    const Index v0 = mergedInto(top.v0), v1 = mergedInto(top.v1);
    if (v0 == v1) return false;
    const Index stamp = versions_[v0] + versions_[v1];
    if ((top.stamp & ~kPlaced) != stamp) {
        push({std::max(top.cost, costOf(v0, v1)), v0, v1, stamp});
        return false;
    }
    const Entry trial{0, std::min(v0, v1), std::max(v0, v1), top.stamp};
    if (tried_ == trial) return false;
    tried_ = trial;
    Candidate& c = candidate_;
    c.v0 = v0, c.v1 = v1;
    if (!gather(c)) return ++counts_.refusedTopology, false;
    if (!place(c)) return ++counts_.refusedShape, false;
    constexpr double kMuch = 1.1;  // a cost that grew by less keeps its turn
    if (!(top.stamp & kPlaced) && c.cost > kMuch * top.cost && c.cost > 0) {
        push({c.cost, v0, v1, stamp | kPlaced});
        return false;
    }
    if (c.deviation2 > limits_.deviation2) return ++counts_.refusedDeviation, false;
    if (!isShapely(c)) return ++counts_.refusedShape, false;
    if (!isClear(c)) return ++counts_.refusedSheets, false;
    apply(c);
    ++counts_.collapsed;
    return true;
}

// ---- a candidate

bool Block::gather(Candidate& c) {
    c.size = 0;
    ++mark_;
    int removed = 0, common = 0;
    const Star &s0 = stars_[c.v0], &s1 = stars_[c.v1];
    if (s0.size + s1.size - 4 > Candidate::kLargest || s0.size + s1.size < 7) return false;
    for (Index i = 0; i < s0.size; ++i) {
        const FanTriangle t = turned(pool_[s0.first + i], c.v0);
        marks_[t.b] = mark_;
        if (t.b != c.v1 && t.c != c.v1) {
            c.fan[c.size++] = t;
            continue;
        }
        if (removed == 2) return false;
        c.removed[removed] = t.id;
        c.opposite[removed++] = t.b == c.v1 ? t.c : t.b;
    }
    c.ofFirst = c.size;
    for (Index i = 0; i < s1.size; ++i) {
        const FanTriangle t = turned(pool_[s1.first + i], c.v1);
        common += marks_[t.b] == mark_ ? 1 : 0;
        if (t.b != c.v0 && t.c != c.v0) c.fan[c.size++] = t;
    }
    return removed == 2 && common == 2;
}

FanTriangle Block::turned(Index id, Index v) const {
    const Triangle& t = triangles_[id];
    const int k = t[0] == v ? 0 : t[1] == v ? 1 : 2;
    return {id, t[(k + 1) % 3], t[(k + 2) % 3], {}, {}};
}

bool Block::place(Candidate& c) {
    const Vec3 origin = points_[c.v0], edge = points_[c.v1] - origin;
    Vec3 ofFirst, ofSecond;  // sums of normals
    double area = 0, reach2 = 0;
    for (int i = 0; i < c.size; ++i) {
        FanTriangle& t = c.fan[i];
        const Vec3& corner = points_[i < c.ofFirst ? c.v0 : c.v1];
        const Vec3 side = points_[t.b] - corner;
        t.before = cross(side, points_[t.c] - corner);
        (i < c.ofFirst ? ofFirst : ofSecond) += t.before;
        area += length(t.before);
        reach2 = std::max(reach2, dot(side, side));
    }
    for (const Index id : c.removed) ofFirst += normalOf(triangles_[id]);
    const Vec3 g = c.normal = ofFirst + ofSecond;
    const double d = dot(ofSecond, edge);
    const Quadric q = sumOf(c.v0, c.v1);
    const QuadricSolver solver(q);
    const Vec3 middle = 0.5 * edge;
    constexpr double kFlat = 1e-3;  // of the area: below it g is the difference of what cancels
    const bool keepsVolume = length(g) > kFlat * area;
    Vec3 x = middle;
    if (solver.solvable()) {
        x = solver.solve(q.b);
        const Vec3 towards = solver.solve(g);
        if (keepsVolume) x += ((d - dot(g, x)) / dot(g, towards)) * towards;
    }
    const auto isNear = [&](const Vec3& y) {
        return dot(y - middle, y - middle) <= std::max(dot(edge, edge), reach2 / 4);
    };
    if (!isNear(x)) x = keepsVolume ? middle + ((d - dot(g, middle)) / dot(g, g)) * g : middle;
    if (!isNear(x)) x = middle;
    c.at = origin + x;
    c.cost = std::max(0.0, q.at(x));
    c.deviation2 = limits_.deviation2 < kInfinity ? q.meanSquareAt(x) : 0;
    return isInside(c.at);
}

bool Block::isShapely(Candidate& c) const {
    double thinnest2 = -1;  // of the star, once it is asked for
    for (FanTriangle& t : c) {
        const Vec3 b = points_[t.b] - c.at, e = points_[t.c] - c.at, opposite = e - b;
        t.after = cross(b, e);
        t.longest2 = std::max({dot(b, b), dot(e, e), dot(opposite, opposite)});
        if (std::max(dot(b, b), dot(e, e)) > limits_.longest2) return false;
        if (!turnsLittle(t.before, t.after) && !(wasNeedle(t) && turnsLittle(c.normal, t.after)))
            return false;
        if (!isNeedle(t.after, t.longest2)) continue;
        if (thinnest2 < 0) thinnest2 = thinnestOf(c);
        if (dot(t.after, t.after) < thinnest2 * t.longest2 * t.longest2) return false;
    }
    return true;
}

bool Block::turnsLittle(const Vec3& from, const Vec3& to) {
    static const double kLeast2 = std::pow(std::cos(Limits::kTurn * std::numbers::pi / 180), 2);
    const double cosine = dot(from, to);
    return cosine > 0 && cosine * cosine > kLeast2 * dot(from, from) * dot(to, to);
}

bool Block::isNeedle(const Vec3& normal, double longest2) {
    return dot(normal, normal) < Limits::kNeedle * Limits::kNeedle * longest2 * longest2;
}

bool Block::wasNeedle(const FanTriangle& t) const { return isNeedle(t.before, longest2Of(triangles_[t.id])); }

double Block::thinnestOf(const Candidate& c) const {
    double least = kInfinity;
    const auto add = [&](Index id) {
        const Vec3 normal = normalOf(triangles_[id]);
        const double longest2 = longest2Of(triangles_[id]);
        least = std::min(least, dot(normal, normal) / (longest2 * longest2));
    };
    for (int i = 0; i < c.size; ++i) add(c.fan[i].id);
    for (const Index id : c.removed) add(id);
    return least;
}

// ---- other sheets

bool Block::isClear(Candidate& c) {
    Box box;
    box.add(c.at), box.add(points_[c.v0]), box.add(points_[c.v1]);
    for (const FanTriangle& t : c) box.add(points_[t.b]);
    const Cell low = cells_.cellOf(box.low), high = cells_.cellOf(box.high);
    return facesOneWay(c, low, high) || meetsNothing(c, low, high);
}

bool Block::facesOneWay(Candidate& c, const Cell& low, const Cell& high) const {
    Facing facing = ~Facing{0};
    for (FanTriangle& t : c) facing &= t.facing = facingOf(t.after, t.longest2);
    cells_.forCells(low, high, [&](std::size_t cell) { return (facing &= facing_[cell]) != 0; });
    return facing != 0;
}

bool Block::meetsNothing(Candidate& c, const Cell& low, const Cell& high) {
    for (int i = 0; i < c.size; ++i)
        for (int j = i + 1; j < c.size; ++j)
            if (!areApart(c, c.fan[i], c.fan[j])) return false;
    if (!listed_) list();
    Box whole;
    std::array<Box, Candidate::kLargest> boxes;
    for (int i = 0; i < c.size; ++i) {
        boxes[i].add(c.at), boxes[i].add(points_[c.fan[i].b]), boxes[i].add(points_[c.fan[i].c]);
        whole.add(boxes[i].low), whole.add(boxes[i].high);
    }
    ++query_;
    for (const FanTriangle& t : c) seen_[t.id] = query_;
    for (const Index id : c.removed) seen_[id] = query_;
    bool apart = true;
    cells_.forCells(low, high, [&](std::size_t cell) {
        forListed(cell, [&](Index id) {
            if (!apart || seen_[id] == query_) return;
            seen_[id] = query_;
            const Box box = boxOf(triangles_[id]);
            if (!box.meets(whole)) return;
            for (int i = 0; i < c.size && apart; ++i)
                apart = !boxes[i].meets(box) || areApart(c, c.fan[i], triangles_[id]);
        });
        return apart;
    });
    return apart;
}

bool Block::areApart(const Candidate& c, const FanTriangle& t, const FanTriangle& u) const {
    if (t.b == u.c || t.c == u.b) return triangleIsUnfolded(t.after, u.after);
    return triangleIsApartAtCorner(points_[t.b] - c.at, points_[t.c] - c.at, points_[u.b] - c.at,
                                   points_[u.c] - c.at);
}

bool Block::areApart(const Candidate& c, const FanTriangle& t, const Triangle& u) const {
    int corner = -1, shared = 0, ofFan = 0;
    for (int k = 0; k < 3; ++k)
        if (u[k] == t.b || u[k] == t.c) {
            ++shared;
            corner = k;
            ofFan = u[k] == t.b ? 0 : 1;
        }
    if (shared == 2) return triangleIsUnfolded(t.after, normalOf(u));
    const Vec3 &b = points_[t.b], &e = points_[t.c];
    if (shared == 0) return triangleIsApart({c.at, b, e}, {points_[u[0]], points_[u[1]], points_[u[2]]});
    const Vec3& o = ofFan == 0 ? b : e;
    return triangleIsApartAtCorner((ofFan == 0 ? e : b) - o, c.at - o, points_[u[(corner + 1) % 3]] - o,
                                   points_[u[(corner + 2) % 3]] - o);
}

void Block::list() {
    listed_ = true;
    heads_.assign(cells_.size(), kNone);
    nodes_.clear();
    seen_.assign(triangles_.size(), 0);
    query_ = 0;
    for (Index t = 0; t < triangles_.size(); ++t)
        if (!isDegenerate(triangles_[t])) enter(t, boxOf(triangles_[t]), nullptr);
}

void Block::enter(Index id, const Box& box, const Box* before) {
    const Cell low = cells_.cellOf(box.low), high = cells_.cellOf(box.high);
    Cell oldLow{1, 1, 1}, oldHigh{0, 0, 0};
    if (before) oldLow = cells_.cellOf(before->low), oldHigh = cells_.cellOf(before->high);
    for (int x = low[0]; x <= high[0]; ++x)
        for (int y = low[1]; y <= high[1]; ++y)
            for (int z = low[2]; z <= high[2]; ++z) {
                if (x >= oldLow[0] && x <= oldHigh[0] && y >= oldLow[1] && y <= oldHigh[1] &&
                    z >= oldLow[2] && z <= oldHigh[2])
                    continue;
                Index& head = heads_[cells_.indexOf(x, y, z)];
                nodes_.push_back({id, head});
                head = static_cast<Index>(nodes_.size() - 1);
            }
}

// ---- apply

void Block::apply(Candidate& c) {
    quadrics_[c.v0] = sumOf(c.v0, c.v1).about(c.at - points_[c.v0]);
    std::array<Box, Candidate::kLargest> before;
    if (listed_)
        for (int i = 0; i < c.size; ++i) before[i] = boxOf(triangles_[c.fan[i].id]);
    points_[c.v0] = c.at;
    for (int i = 0; i < 2; ++i) {
        leave(c.opposite[i], c.removed[i]);
        triangles_[c.removed[i]] = {0, 0, 0};
    }
    joinStars(c);
    for (int i = 0; i < c.size; ++i) {
        const FanTriangle& t = c.fan[i];
        triangles_[t.id] = {c.v0, t.b, t.c};
        const Box box = boxOf(triangles_[t.id]);
        face(box, t.facing);
        if (listed_) enter(t.id, box, &before[i]);
    }
    versions_[c.v0] += versions_[c.v1] + 1;
    into_[c.v1] = c.v0;
}

void Block::leave(Index v, Index triangle) {
    Star& star = stars_[v];
    Index* const first = &pool_[star.first];
    *std::find(first, first + star.size, triangle) = first[star.size - 1];
    --star.size;
}

void Block::joinStars(const Candidate& c) {
    Star &s0 = stars_[c.v0], &s1 = stars_[c.v1];
    const Index size = static_cast<Index>(c.size);
    if (s1.room > s0.room) s0 = s1;
    if (s0.room < size) {
        s0 = {static_cast<Index>(pool_.size()), 0, size};
        pool_.resize(pool_.size() + size);
    }
    s0.size = size;
    s1 = {};
    for (int i = 0; i < c.size; ++i) pool_[s0.first + static_cast<Index>(i)] = c.fan[i].id;
}

}  // namespace isowave::collapse
