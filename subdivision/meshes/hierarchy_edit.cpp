#include "subdivision/meshes/hierarchy_edit.h"

#include <algorithm>
#include <cassert>

#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"

namespace isowave::subdivision {
namespace {

// An orthonormal frame, or none where the surface has no normal.
struct Frame {
    Vec3 axis[3];
    bool valid = false;
};

Vec3 unit(const Vec3& v) {
    const double size = length(v);
    return size > 0 ? (1 / size) * v : Vec3{};
}

// One for every vertex: the normal summed over its faces, and the direction of its first halfedge across it.
std::vector<Frame> framesOf(std::span<const Vec3> points, const PolygonMesh& mesh,
                            const Adjacency& adjacency) {
    std::vector<Vec3> normals(points.size());
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        Vec3 area;
        for (std::size_t k = 1; k + 1 < face.size(); ++k)
            area += cross(points[face[k]] - points[face[0]], points[face[k + 1]] - points[face[0]]);
        for (const Index v : face) normals[v] += area;
    }
    std::vector<Frame> frames(points.size());
    for (Index v = 0; v < frames.size(); ++v) {
        const Vec3 normal = unit(normals[v]);
        const Vec3 edge = points[adjacency.target(adjacency.outgoing(v))] - points[v];
        const Vec3 along = unit(edge - dot(edge, normal) * normal);
        frames[v] = {{normal, along, cross(normal, along)}, length(normal) > 0 && length(along) > 0};
    }
    return frames;
}

// d turns as its frame does: the same coordinates in the other frame.
Vec3 carried(const Vec3& d, const Frame& from, const Frame& to) {
    if (!from.valid || !to.valid) return d;
    Vec3 result;
    for (int k = 0; k < 3; ++k) result += dot(d, from.axis[k]) * to.axis[k];
    return result;
}

// Details as they are after the edit: frames are those of the two subdivided surfaces before their details are added.
void turn(std::vector<Vec3>& details, const SubdivisionStep& step, const PolygonMesh& fine,
          const std::vector<Vec3>& original, const std::vector<Vec3>& edited) {
    const Adjacency adjacency(fine);
    const auto before = framesOf(step.subdivide(original), fine, adjacency);
    const auto after = framesOf(step.subdivide(edited), fine, adjacency);
    for (std::size_t v = 0; v < details.size(); ++v) details[v] = carried(details[v], before[v], after[v]);
}

// One step of the original and of the edited mesh, side by side. The details are always the original's: where P is not
// injective they depend on its coarse points.
void reconstructBoth(const SubdivisionStep& step, const std::vector<Vec3>& stored, const PolygonMesh& fine,
                     Frames frames, std::vector<Vec3>& original, std::vector<Vec3>& edited) {
    const auto details = step.allDetails(original, stored);
    auto turned = details;
    if (frames == Frames::local) turn(turned, step, fine, original, edited);
    original = step.compose(original, details);
    edited = step.compose(edited, turned);
}

}  // namespace

PolygonMesh reconstructEdited(const Hierarchy& hierarchy, const std::vector<Vec3>& moved, int steps,
                              Frames frames, const Progress& progress) {
    assert(moved.size() == hierarchy.base.points.size());
    std::vector<Vec3> original = hierarchy.base.points, edited = moved;
    return rebuilt(hierarchy, steps, progress,
                   [&](const SubdivisionStep& step, const std::vector<Vec3>&, const std::vector<Vec3>& stored,
                       PolygonMesh& fine) {
                       reconstructBoth(step, stored, fine, frames, original, edited);
                       fine.points = edited;
                   });
}

// ---- leaving details out ----

std::size_t detailCount(const Hierarchy& hierarchy) {
    std::size_t count = 0;
    for (const auto& details : hierarchy.details) count += details.size();
    return count;
}

std::size_t nonzeroDetailCount(const Hierarchy& hierarchy) {
    std::size_t count = 0;
    for (const auto& details : hierarchy.details)
        count +=
            details.size() - static_cast<std::size_t>(std::count(details.begin(), details.end(), Vec3{}));
    return count;
}

void threshold(Hierarchy& hierarchy, double shortest) {
    for (auto& details : hierarchy.details)
        for (Vec3& d : details)
            if (length(d) < shortest) d = {};
}

void keepLongest(Hierarchy& hierarchy, std::size_t count) {
    std::vector<std::pair<double, Vec3*>> order;  // in storing order, which a stable partition keeps
    for (auto& details : hierarchy.details)
        for (Vec3& d : details) order.emplace_back(dot(d, d), &d);
    if (count >= order.size()) return;
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (std::size_t k = count; k < order.size(); ++k) *order[k].second = {};
}

void clearDetails(Hierarchy& hierarchy) { keepLongest(hierarchy, 0); }

PointError pointError(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    assert(a.size() == b.size());
    PointError error;
    double sum = 0;
    for (std::size_t v = 0; v < a.size(); ++v) {
        const double square = dot(a[v] - b[v], a[v] - b[v]);
        sum += square;
        error.largest = std::max(error.largest, square);
    }
    error.largest = std::sqrt(error.largest);
    if (!a.empty()) error.rms = std::sqrt(sum / static_cast<double>(a.size()));
    return error;
}

}  // namespace isowave::subdivision
