// relax = stars -> colours -> rounds. The star of a vertex is its triangles, each turned so that the vertex
// comes first.
#include "polygonize/relax.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "polygonize/stars.h"

namespace isowave {
namespace {

using openvdb::Vec3d;

Vec3d toVec(const Point& p) { return {p[0], p[1], p[2]}; }

// Every vertex gets the smallest colour that no neighbour before it has. Vertices by colour, in order.
std::vector<std::vector<std::uint32_t>> colours(const Stars& stars) {
    const std::size_t count = stars.first.size() - 1;
    std::vector<int> colour(count, -1);
    std::vector<std::vector<std::uint32_t>> classes;
    std::vector<char> taken;
    for (std::size_t v = 0; v < count; ++v) {
        taken.assign(classes.size() + 1, 0);
        for (std::size_t i = stars.first[v]; i < stars.first[v + 1]; ++i)
            for (const std::uint32_t w : {stars.corners[i].next, stars.corners[i].previous})
                if (colour[w] >= 0) taken[colour[w]] = 1;
        const auto c = std::find(taken.begin(), taken.end(), 0) - taken.begin();
        colour[v] = static_cast<int>(c);
        if (c == static_cast<std::ptrdiff_t>(classes.size())) classes.emplace_back();
        classes[c].push_back(static_cast<std::uint32_t>(v));
    }
    return classes;
}

// cot is monotone in the angle, and needs no inverse function: the largest cotangent is the smallest angle.
double cotangent(const Vec3d& u, const Vec3d& v) { return u.dot(v) / u.cross(v).length(); }

double largestCotangent(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return std::max({cotangent(b - a, c - a), cotangent(c - b, a - b), cotangent(a - c, b - c)});
}

class Relaxation {
  public:
    Relaxation(TriangleMesh& mesh, const ZeroSet& surface)
        : mesh_(mesh), surface_(surface), stars_(starsOf(mesh)) {}

    void move(std::uint32_t v) {
        const std::size_t first = stars_.first[v], last = stars_.first[v + 1];
        if (first == last || isOpen(v)) return;
        const Vec3d at = toVec(mesh_.points[v]);
        const auto here = surface_.foot(at);
        if (!here) return;
        for (const double share : kShares) {
            const Vec3d aim = (middleOf(v) - at) * share;
            const auto there = surface_.foot(at + aim - aim.dot(here->normal) * here->normal);
            if (!there || !accepts(v, at, *there, here->normal)) continue;
            put(v, *there);
            return;
        }
    }

    const Stars& stars() const { return stars_; }

  private:
    static constexpr std::array<double, 3> kShares{0.8, 0.4, 0.1};  // of the way to the middle, in this order

    void put(std::uint32_t v, const ZeroSet::Foot& there) {
        mesh_.points[v] = {there.at[0], there.at[1], there.at[2]};
        if (!mesh_.normals.empty())
            mesh_.normals[v] = {static_cast<float>(there.normal[0]), static_cast<float>(there.normal[1]),
                                static_cast<float>(there.normal[2])};
    }

    Vec3d pointOf(std::uint32_t v) const { return toVec(mesh_.points[v]); }

    // Round a whole vertex every neighbour comes once as next and once as previous.
    bool isOpen(std::uint32_t v) const {
        std::int64_t balance = 0;
        std::uint32_t mixed = 0;
        for (std::size_t i = stars_.first[v]; i < stars_.first[v + 1]; ++i) {
            balance += std::int64_t{stars_.corners[i].next} - stars_.corners[i].previous;
            mixed ^= stars_.corners[i].next ^ stars_.corners[i].previous;
        }
        return balance != 0 || mixed != 0;
    }

    Vec3d middleOf(std::uint32_t v) const {
        Vec3d sum(0);
        for (std::size_t i = stars_.first[v]; i < stars_.first[v + 1]; ++i)
            sum += pointOf(stars_.corners[i].next);
        return sum / static_cast<double>(stars_.first[v + 1] - stars_.first[v]);
    }

    bool accepts(std::uint32_t v, const Vec3d& from, const ZeroSet::Foot& to, const Vec3d& normal) const {
        double before = -INFINITY, after = -INFINITY, longest = 0;
        if (!(to.normal.dot(normal) > 0)) return false;
        for (std::size_t i = stars_.first[v]; i < stars_.first[v + 1]; ++i) {
            const Vec3d b = pointOf(stars_.corners[i].next), c = pointOf(stars_.corners[i].previous);
            const Vec3d wasNormal = (b - from).cross(c - from), isNormal = (b - to.at).cross(c - to.at);
            if (!(isNormal.dot(wasNormal) > 0) || !(isNormal.dot(to.normal) > 0)) return false;
            before = std::max(before, largestCotangent(from, b, c));
            after = std::max(after, largestCotangent(to.at, b, c));
            longest = std::max(longest, (b - from).length());
        }
        return after < before && (to.at - from).length() <= longest / 2;
    }

    TriangleMesh& mesh_;
    const ZeroSet& surface_;
    Stars stars_;
};

}  // namespace

void relax(TriangleMesh& mesh, const ZeroSet& surface, int rounds, const Progress& progress) {
    Relaxation relaxation(mesh, surface);
    const auto classes = colours(relaxation.stars());
    for (int round = 0; round < rounds; ++round) {
        progress("relaxing", static_cast<double>(round) / rounds);
        for (const auto& vertices : classes)
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices.size(), 256),
                              [&](const auto& range) {
                                  progress.check();
                                  for (std::size_t i = range.begin(); i != range.end(); ++i)
                                      relaxation.move(vertices[i]);
                              });
    }
}

double smallestAngle(const TriangleMesh& mesh) {
    double cot = -INFINITY;
    for (const Triangle& t : mesh.triangles)
        cot = std::max(cot, largestCotangent(toVec(mesh.points[t[0]]), toVec(mesh.points[t[1]]),
                                             toVec(mesh.points[t[2]])));
    return mesh.triangles.empty() ? 180 : std::atan2(1, cot) * 180 / std::numbers::pi;
}

}  // namespace isowave
