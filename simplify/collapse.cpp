// Notation of Collapse: an edge with the ends v0, v1 is to become one vertex at p. Its star
// is the triangles at v0 or v1; two of them vanish, the others become the `fan` of p.
#include "simplify/collapse.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Edge_collapse_visitor_base.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/boost/graph/Euler_operations.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <queue>

#include "simplify/nearest_on_triangle.h"

namespace isowave {
namespace {

namespace Simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Point3 = Kernel::Point_3;
using Vector3 = Kernel::Vector_3;
using Surface = CGAL::Surface_mesh<Point3>;
using Vertex = Surface::Vertex_index;
using Halfedge = Surface::Halfedge_index;
using Edge = Surface::Edge_index;
using Face = Surface::Face_index;

Point3 toPoint3(const Point& p) { return {p[0], p[1], p[2]}; }
Point toPoint(const Point3& p) { return {p.x(), p.y(), p.z()}; }
Vec3 toVec3(const Point3& p) { return {p.x(), p.y(), p.z()}; }

// From q to the triangle abc.
double squaredDistance(const Point3& q, const Point3& a, const Point3& b, const Point3& c) {
    const Vec3 from = toVec3(q);
    return squaredLength(from - nearestOnTriangle(from, toVec3(a), toVec3(b), toVec3(c)));
}

Surface surfaceOf(const TriangleMesh& mesh) {
    Surface surface;
    using Size = Surface::size_type;
    surface.reserve(static_cast<Size>(mesh.points.size()), static_cast<Size>(mesh.triangles.size() * 3 / 2),
                    static_cast<Size>(mesh.triangles.size()));
    for (const Point& p : mesh.points) surface.add_vertex(toPoint3(p));
    for (const auto& [a, b, c] : mesh.triangles)
        [[maybe_unused]] const Face face = surface.add_face(Vertex(a), Vertex(b), Vertex(c));
    return surface;
}

// Faces keep their order; their numbers too where none was removed.
TriangleMesh meshOf(const Surface& surface) {
    TriangleMesh mesh;
    std::vector<std::uint32_t> number(surface.num_vertices());
    for (const Vertex v : surface.vertices()) {
        if (surface.is_isolated(v)) continue;
        number[v] = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(toPoint(surface.point(v)));
    }
    for (const Face f : surface.faces()) {
        Triangle t;
        int k = 0;
        for (const Vertex v : surface.vertices_around_face(surface.halfedge(f))) t[k++] = number[v];
        mesh.triangles.push_back(t);
    }
    return mesh;
}

// ---- decimate

// Lets the caller stop CGAL's loop, and tells how far it has come.
struct DecimationVisitor : Simplification::Edge_collapse_visitor_base<Surface> {
    explicit DecimationVisitor(const Progress& p) : progress(p) {}
    void OnCollected(const Profile&, const boost::optional<double>&) { check(); }
    void OnSelected(const Profile&, boost::optional<double>, std::size_t initial, std::size_t current) {
        if (check()) progress("thinning", 1 - static_cast<double>(current) / static_cast<double>(initial));
    }
    bool check() {
        if (++calls % 4096 != 0) return false;
        progress.check();
        return true;
    }
    const Progress& progress;
    std::size_t calls = 0;
};

// ---- what a collapse weighs

// The sum of weighted squares of distances from planes, as a function of x: x'Ax - 2b'x + c, about `origin`
// (Garland and Heckbert 1997).
struct Quadric {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double c = 0;

    void addPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& on, double weight) {
        A += weight * normal * normal.transpose();
        b += weight * normal.dot(on) * normal;
        c += weight * normal.dot(on) * normal.dot(on);
    }
    Quadric operator+(const Quadric& o) const { return {A + o.A, b + o.b, c + o.c}; }
    // Not below zero, where rounding would take it.
    double at(const Eigen::Vector3d& x) const { return std::max(0.0, x.dot(A * x) - 2 * b.dot(x) + c); }

    // The minimum, held near `middle` in the directions that the planes leave open.
    Eigen::Vector3d minimum(const Eigen::Vector3d& middle) const {
        constexpr double kHold = 1e-3;  // of the mean eigenvalue
        const double hold = kHold * A.trace() / 3;
        if (!(hold > 0)) return middle;
        const Eigen::Matrix3d held = A + hold * Eigen::Matrix3d::Identity();
        return held.ldlt().solve(b + hold * middle);
    }
};

// Points of the original are taken evenly: so many for each triangle of the start (decimate() leaves 4 to 16
// for one that is wanted, so those get 8 to 32 points), but enough to see small parts.
constexpr std::size_t kPointsPerTriangle = 2, kFewestPoints = 20'000;

// A corner's triangle in the fan: p, and the two others counter-clockwise.
struct FanTriangle {
    Point3 b, c;
    Vector3 before;  // normal of the triangle that it was, as long as twice its area
};

struct Star {
    std::vector<FanTriangle> fan;
    std::vector<std::uint32_t> points;
    std::vector<std::uint32_t> guess;  // of each point: the triangle of the fan that is probably nearest
};

double meanEdge(const TriangleMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles)
        sum += std::sqrt((toPoint3(mesh.points[t[1]]) - toPoint3(mesh.points[t[0]])).squared_length());
    return mesh.triangles.empty() ? 0 : sum / static_cast<double>(mesh.triangles.size());
}

// What a candidate's cost is. The points' distances to the fan are a lower bound of the error; those of the
// fan's samples to the original, which it lacks, take ten times as long: they are measured when the candidate
// has come to the top of the queue.
enum class Cost { lowerBound, full };

struct Candidate {
    double cost;  // a squared distance
    std::uint64_t stamp;
    Halfedge edge;
    Point3 at;
    Cost kind;
    // The queue's top is the cheapest; of equals the one with the smallest number.
    bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : edge > o.edge; }
};

}  // namespace

struct Collapse::State {
    Surface surface;
    const TriangleMesh& reference;
    const DistanceTarget& original;
    double edgeOfOriginal;                             // mean length
    Point3 origin;                                     // of the quadrics
    std::vector<Point3> points;                        // of the original
    std::vector<std::vector<std::uint32_t>> pointsOf;  // by face
    std::vector<Quadric> quadrics;                     // by vertex
    // By vertex: grows when a triangle at it changes, and over a collapse, so that the sum of an edge's two
    // is another one whenever its star is.
    std::vector<std::uint32_t> stamps;
    std::vector<char> stuck;  // by edge: cannot be collapsed and is not in the queue
    double floor2;            // squared: errors below it count as equal
    double accepted;          // squared: the largest error of a collapse so far, or floor2
    std::priority_queue<Candidate> queue;

    State(const TriangleMesh& start, const TriangleMesh& from, const DistanceTarget& target,
          double errorFloor)
        : surface(surfaceOf(start)),
          reference(from),
          original(target),
          edgeOfOriginal(meanEdge(from)),
          floor2(errorFloor * errorFloor),
          accepted(floor2) {}

    // ---- set up

    void spreadPoints(double reach, const Progress& progress) {
        const DistanceTarget nearby(meshOf(surface));  // nothing was removed yet: faces have the same numbers
        const std::size_t wanted = std::max(kFewestPoints, kPointsPerTriangle * surface.number_of_faces());
        const std::size_t stride = std::max<std::size_t>(1, reference.points.size() / wanted);
        for (std::size_t i = 0; i < reference.points.size(); i += stride)
            points.push_back(toPoint3(reference.points[i]));
        std::vector<NearestPoint> nearest(points.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 1024), [&](const auto& range) {
            progress.check();
            for (std::size_t i = range.begin(); i != range.end(); ++i)
                nearest[i] = nearby.nearest(toPoint(points[i]));
        });
        pointsOf.resize(surface.num_faces());
        for (std::size_t i = 0; i < points.size(); ++i)
            if ((toPoint3(nearest[i].at) - points[i]).squared_length() <= reach * reach)
                pointsOf[nearest[i].triangle].push_back(static_cast<std::uint32_t>(i));
    }

    Eigen::Vector3d relative(const Point3& p) const {
        return {p.x() - origin.x(), p.y() - origin.y(), p.z() - origin.z()};
    }

    void makeQuadrics() {
        quadrics.resize(surface.num_vertices());
        for (const Face f : surface.faces()) {
            const Halfedge h = surface.halfedge(f);
            const Point3 &a = surface.point(surface.source(h)), &b = surface.point(surface.target(h)),
                         &c = surface.point(surface.target(surface.next(h)));
            const Vector3 n = CGAL::cross_product(b - a, c - a);
            const double twiceArea = std::sqrt(n.squared_length());
            if (!(twiceArea > 0)) continue;
            const Eigen::Vector3d normal(n.x() / twiceArea, n.y() / twiceArea, n.z() / twiceArea);
            for (const Vertex v : surface.vertices_around_face(h))
                quadrics[v].addPlane(normal, relative(a), twiceArea);
        }
    }

    // ---- one candidate

    std::uint64_t stampOf(Halfedge h) const {
        return std::uint64_t{stamps[surface.source(h)]} + stamps[surface.target(h)];
    }

    // The ends have two common neighbours, the corners that face the edge, and are not part of a tetrahedron.
    bool keepsTopology(Halfedge h) const {
        const Vertex v0 = surface.source(h), v1 = surface.target(h);
        int common = 0;
        for (const Vertex a : surface.vertices_around_target(surface.halfedge(v0)))
            for (const Vertex b : surface.vertices_around_target(surface.halfedge(v1))) common += a == b;
        return common == 2 && (surface.degree(v0) > 3 || surface.degree(v1) > 3);
    }

    Star starOf(Halfedge h) const {
        Star star;
        const Face left = surface.face(h), right = surface.face(surface.opposite(h));
        const auto takePoints = [&](Face f, std::size_t guess) {
            star.points.insert(star.points.end(), pointsOf[f].begin(), pointsOf[f].end());
            star.guess.resize(star.points.size(), static_cast<std::uint32_t>(guess));
        };
        takePoints(left, 0);
        takePoints(right, 0);
        for (const Vertex v : {surface.source(h), surface.target(h)})
            for (const Halfedge in : surface.halfedges_around_target(surface.halfedge(v))) {
                const Face f = surface.face(in);
                if (f == left || f == right) continue;
                takePoints(f, star.fan.size());
                const Halfedge out = surface.next(in);
                const Point3 &a = surface.point(v), &b = surface.point(surface.target(out)),
                             &c = surface.point(surface.source(in));
                star.fan.push_back({b, c, CGAL::cross_product(b - a, c - a)});
            }
        return star;
    }

    static bool fits(const std::vector<FanTriangle>& fan, const Point3& p) {
        return std::all_of(fan.begin(), fan.end(), [&](const FanTriangle& t) {
            const Vector3 u = t.b - p, v = t.c - p, w = t.c - t.b;
            const Vector3 normal = CGAL::cross_product(u, v);
            const double longest2 = std::max({u.squared_length(), v.squared_length(), w.squared_length()});
            // |normal| = height * longest
            return normal * t.before > 0 && normal.squared_length() > kNeedle * kNeedle * longest2 * longest2;
        });
    }

    // The square of the largest distance of the star's points to the fan; anything that is at least `enough`
    // when it is known to be.
    double pointsError2(const Star& star, const Point3& p, double enough) const {
        double largest = 0;
        for (std::size_t k = 0; k < star.points.size(); ++k) {
            const Point3& point = points[star.points[k]];
            const auto squaredTo = [&](const FanTriangle& t) { return squaredDistance(point, p, t.b, t.c); };
            double nearest = squaredTo(star.fan[star.guess[k]]);
            for (const FanTriangle& t : star.fan) {
                if (nearest <= largest) break;  // this point will not raise the maximum
                nearest = std::min(nearest, squaredTo(t));
            }
            largest = std::max(largest, nearest);
            if (largest >= enough) break;
        }
        return largest;
    }

    // The square of the largest distance of samples of the fan to the original, or `largest`, or anything
    // that is at least `enough`; infinite where a triangle of the fan faces against the original.
    double samplesError2(const Star& star, const Point3& p, double largest, double enough) const {
        const auto measure = [&](const Point3& at) {
            largest = std::max(largest, original.squaredBeyond(toPoint(at), largest));
        };
        measure(p);
        for (const FanTriangle& t : star.fan) {
            const int n = partsOf(p, t);
            for (int j = 0; j < n; ++j)  // k = 0 is the side that the next triangle has too
                for (int k = 1; j + k < n; ++k) {
                    if (largest >= enough) return largest;
                    measure(p + (t.b - p) * j / n + (t.c - p) * k / n);
                }
            const Point3 centroid = CGAL::centroid(p, t.b, t.c);
            const NearestPoint nearest = original.nearest(toPoint(centroid));
            largest = std::max(largest, (centroid - toPoint3(nearest.at)).squared_length());
            const Vector3 theirs = normalOf(nearest.triangle);
            const Vector3 ours = CGAL::cross_product(t.b - p, t.c - p);
            // Beyond a right angle by more than the triangles of a sharp edge differ.
            constexpr double kAgainst = -0.25;
            if (ours * theirs < kAgainst * std::sqrt(ours.squared_length() * theirs.squared_length()))
                return std::numeric_limits<double>::infinity();
        }
        return largest;
    }

    // A triangle's sides are cut into so many parts to sample it: a sample at least every kSampleEvery edges
    // of the original, as far as kMostParts goes.
    int partsOf(const Point3& p, const FanTriangle& t) const {
        constexpr double kSampleEvery = 6;
        constexpr int kLeastParts = 2, kMostParts = 6;
        const double longest = std::sqrt(
            std::max({(t.b - p).squared_length(), (t.c - p).squared_length(), (t.c - t.b).squared_length()}));
        return static_cast<int>(std::clamp<double>(std::ceil(longest / (kSampleEvery * edgeOfOriginal)),
                                                   kLeastParts, kMostParts));
    }

    Vector3 normalOf(std::uint32_t triangle) const {
        const Triangle& t = reference.triangles[triangle];
        const Point3 a = toPoint3(reference.points[t[0]]);
        return CGAL::cross_product(toPoint3(reference.points[t[1]]) - a,
                                   toPoint3(reference.points[t[2]]) - a);
    }

    // Errors up to the floor count as equal: they are ordered by the quadric error q, mapped to [0, floor2).
    double ranked(double error2, double q) const {
        if (error2 > floor2 || floor2 == 0) return error2;  // 0/0 is no order
        const double scale =
            floor2 * edgeOfOriginal * edgeOfOriginal;  // of q: a squared length times an area
        return floor2 * (q / (q + scale));
    }

    // Where to put p, and what it costs; nothing when the edge must stay.
    std::optional<Candidate> evaluate(Halfedge h, Cost kind) const {
        if (!keepsTopology(h)) return {};
        const Star star = starOf(h);
        const Vertex v0 = surface.source(h), v1 = surface.target(h);
        const Point3 &p0 = surface.point(v0), &p1 = surface.point(v1), middle = CGAL::midpoint(p0, p1);
        const Eigen::Vector3d minimum = (quadrics[v0] + quadrics[v1]).minimum(relative(middle));
        const Point3 optimal = origin + Vector3(minimum[0], minimum[1], minimum[2]);
        Candidate best{std::numeric_limits<double>::infinity(), stampOf(h), h, optimal, kind};
        for (const Point3& p : {optimal, middle, p0, p1}) {
            if (!fits(star.fan, p)) continue;
            double error = pointsError2(star, p, best.cost);
            if (kind == Cost::full) error = samplesError2(star, p, error, best.cost);
            if (error >= best.cost) continue;
            best.cost = error;
            best.at = p;
            if (error <= accepted) break;  // no better place would keep the surfaces closer than they are
        }
        if (!std::isfinite(best.cost)) return {};
        best.cost = ranked(best.cost, (quadrics[v0] + quadrics[v1]).at(relative(best.at)));
        // Among surfaces that are equally near, short edges go first: the triangles stay even.
        constexpr double kEvenness = 1e-7;
        best.cost += kEvenness * (p1 - p0).squared_length();
        return best;
    }

    // ---- the loop

    void push(Edge e, Cost kind = Cost::lowerBound) {
        const auto candidate = evaluate(surface.halfedge(e), kind);
        stuck[e] = !candidate;
        if (candidate) queue.push(*candidate);
    }

    void fillQueue(const Progress& progress) {
        stamps.assign(surface.num_vertices(), 0);
        std::vector<std::optional<Candidate>> all(surface.num_edges());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, all.size(), 256), [&](const auto& range) {
            progress.check();
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const Edge e(static_cast<std::uint32_t>(i));
                if (!surface.is_removed(e)) all[i] = evaluate(surface.halfedge(e), Cost::lowerBound);
            }
        });
        stuck.assign(all.size(), 0);
        for (std::size_t e = 0; e < all.size(); ++e) {
            stuck[e] = !all[e];
            if (all[e]) queue.push(*all[e]);
        }
    }

    void collapse(const Candidate& c) {
        accepted = std::max(accepted, c.cost);
        const Star star = starOf(c.edge);
        const Quadric sum = quadrics[surface.source(c.edge)] + quadrics[surface.target(c.edge)];
        const std::uint32_t newer = std::max(stamps[surface.source(c.edge)], stamps[surface.target(c.edge)]);
        const Vertex v = CGAL::Euler::collapse_edge(surface.edge(c.edge), surface);
        surface.point(v) = c.at;
        quadrics[v] = sum;
        dealPoints(v, star.points);
        stamps[v] = newer + 1;
        for (const Vertex w : surface.vertices_around_target(surface.halfedge(v))) ++stamps[w];
        // The edges at v have a new cost; those around it that could not be collapsed perhaps can be now. The
        // others wait in the queue until they come up.
        for (const Halfedge h : surface.halfedges_around_target(surface.halfedge(v))) push(surface.edge(h));
        for (const Vertex w : surface.vertices_around_target(surface.halfedge(v)))
            for (const Halfedge h : surface.halfedges_around_target(surface.halfedge(w)))
                if (stuck[surface.edge(h)]) push(surface.edge(h));
    }

    // Every point to its nearest triangle of the fan.
    void dealPoints(Vertex v, const std::vector<std::uint32_t>& dealt) {
        struct Fan {
            Face face;
            Point3 a, b, c;
        };
        std::vector<Fan> fan;
        for (const Halfedge in : surface.halfedges_around_target(surface.halfedge(v))) {
            const Face f = surface.face(in);
            fan.push_back({f, surface.point(v), surface.point(surface.target(surface.next(in))),
                           surface.point(surface.source(in))});
            pointsOf[f].clear();
        }
        for (const std::uint32_t i : dealt) {
            const Fan* nearest = nullptr;
            double least = std::numeric_limits<double>::infinity();
            for (const Fan& t : fan) {
                const double d = squaredDistance(points[i], t.a, t.b, t.c);
                if (nearest && d >= least) continue;
                least = d;
                nearest = &t;
            }
            pointsOf[nearest->face].push_back(i);
        }
    }

    void reduce(std::int64_t triangles, double distance, const Progress& progress) {
        const auto begin = static_cast<std::int64_t>(surface.number_of_faces());
        for (std::size_t turn = 0; !queue.empty(); ++turn) {
            const auto now = static_cast<std::int64_t>(surface.number_of_faces());
            if (now <= triangles) break;
            if (turn % 1024 == 0)
                progress("collapsing",
                         static_cast<double>(begin - now) / static_cast<double>(begin - triangles));
            const Candidate top = queue.top();
            if (top.cost > distance * distance) break;
            queue.pop();
            if (surface.is_removed(surface.edge(top.edge))) continue;
            if (top.stamp != stampOf(top.edge))
                push(surface.edge(top.edge));
            else if (top.kind == Cost::lowerBound)
                push(surface.edge(top.edge), Cost::full);
            else
                collapse(top);
        }
    }
};

TriangleMesh decimate(const TriangleMesh& mesh, std::int64_t triangles, const Progress& progress) {
    Surface surface = surfaceOf(mesh);
    const auto edges = static_cast<std::size_t>(triangles / 2 * 3);  // of a closed surface
    const DecimationVisitor visitor(progress);
    Simplification::edge_collapse(surface, Simplification::Count_stop_predicate<Surface>(edges),
                                  CGAL::parameters::get_cost(Simplification::LindstromTurk_cost<Surface>())
                                      .get_placement(Simplification::LindstromTurk_placement<Surface>())
                                      .filter(Simplification::Bounded_normal_change_filter<>())
                                      .visitor(visitor));
    return meshOf(surface);
}

Collapse::Collapse(const TriangleMesh& start, const TriangleMesh& surface, const DistanceTarget& original,
                   const Options& options, const Progress& progress)
    : state_(std::make_unique<State>(start, surface, original, options.errorFloor)) {
    State& s = *state_;
    if (!start.points.empty()) s.origin = toPoint3(start.points.front());
    s.spreadPoints(options.reach, progress);
    s.makeQuadrics();
    s.fillQueue(progress);
}
Collapse::~Collapse() = default;
Collapse::Collapse(Collapse&&) noexcept = default;

void Collapse::reduce(std::int64_t triangles, double distance, const Progress& progress) {
    state_->reduce(triangles, distance, progress);
}

std::int64_t Collapse::triangles() const {
    return static_cast<std::int64_t>(state_->surface.number_of_faces());
}

namespace {

// Weights of p over the corners of a triangle that it lies in, or near.
std::array<double, 3> barycentric(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
    const Vector3 normal = CGAL::cross_product(b - a, c - a);
    const double whole = normal.squared_length();
    if (!(whole > 0)) return {1, 0, 0};
    const double atB = CGAL::cross_product(p - a, c - a) * normal / whole;
    const double atC = CGAL::cross_product(b - a, p - a) * normal / whole;
    return {1 - atB - atC, atB, atC};
}

std::array<float, 3> normalAt(const TriangleMesh& surface, const NearestPoint& nearest) {
    const Triangle& t = surface.triangles[nearest.triangle];
    const std::array<double, 3> weights =
        barycentric(toPoint3(nearest.at), toPoint3(surface.points[t[0]]), toPoint3(surface.points[t[1]]),
                    toPoint3(surface.points[t[2]]));
    Vector3 n(0, 0, 0);
    for (int i = 0; i < 3; ++i) {
        const auto& corner = surface.normals[t[i]];
        n = n + weights[i] * Vector3(corner[0], corner[1], corner[2]);
    }
    const double length = std::sqrt(n.squared_length());
    if (!(length > 0)) return surface.normals[t[0]];
    n = n / length;
    return {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())};
}

}  // namespace

TriangleMesh withNormalsOf(const TriangleMesh& surface, const DistanceTarget& original, TriangleMesh mesh) {
    if (surface.normals.empty() || !mesh.normals.empty()) return mesh;
    mesh.normals.resize(mesh.points.size());
    tbb::parallel_for(std::size_t{0}, mesh.points.size(), [&](std::size_t i) {
        mesh.normals[i] = normalAt(surface, original.nearest(mesh.points[i]));
    });
    return mesh;
}

TriangleMesh Collapse::mesh() const {
    return withNormalsOf(state_->reference, state_->original, meshOf(state_->surface));
}

}  // namespace isowave
