// A triangle soup to a closed mesh. Passes, each with what holds after it:
//
//   merge       points are distinct
//   drop        triangles have three distinct corners and are listed once
//   crack       no boundary runs along another one at no distance
//   turn        across every edge with two triangles, both agree on outside, as far as the surface is orientable
//   fill        every edge has an even number of triangles: the mesh is closed, solid and void are well-defined
//   bodies      winding numbers add up to what the bodies' author meant
//
// Closedness is taken modulo 2. The edges with an odd number of triangles form a graph in which every vertex
// has an even degree (each triangle at a vertex brings two of its edges), so they always fall apart into
// simple loops; closing every loop makes every edge even. Nothing here depends on the order of
// threads: there are none.
#include "volume/mesh_repair.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <utility>

#include "base/number_text.h"
#include "isowave/error.h"
#include "volume/repair/bodies.h"
#include "volume/repair/cracks.h"
#include "volume/repair/holes.h"
#include "volume/repair/loops.h"
#include "volume/repair/turn.h"

namespace isowave {
namespace {

using namespace repair;

// ---- merge, drop

// Equal points become one, unused ones go; the order of first use stays.
void mergePoints(TriangleMesh& mesh, MeshRepairReport& report, const Progress& progress) {
    std::vector<Point> points = std::move(mesh.points);
    for (Point& p : points) {
        for (double& x : p) x += 0.0;  // -0 is 0
    }
    std::vector<Index> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    sortUnlessStopped(order, progress, [&](Index a, Index b) {
        return points[a] != points[b] ? points[a] < points[b] : a < b;
    });
    std::vector<Index> first(points.size());  // of every point: the first one equal to it
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool equal = i > 0 && points[order[i]] == points[order[i - 1]];
        first[order[i]] = equal ? first[order[i - 1]] : order[i];
    }
    constexpr Index none = ~Index(0);
    std::vector<Index> number(points.size(), none);
    std::vector<bool> used(points.size());
    mesh.points.clear();
    mesh.normals.clear();
    for (Triangle& triangle : mesh.triangles) {
        for (Index& corner : triangle) {
            used[corner] = true;
            const Index point = first[corner];
            if (number[point] == none) {
                number[point] = static_cast<Index>(mesh.points.size());
                mesh.points.push_back(points[point]);
            }
            corner = number[point];
        }
    }
    const auto usedCount = std::count(used.begin(), used.end(), true);
    report.pointsUnused = static_cast<std::int64_t>(points.size()) - usedCount;
    report.pointsMerged = usedCount - static_cast<std::int64_t>(mesh.points.size());
}

void dropDegenerate(TriangleMesh& mesh, MeshRepairReport& report) {
    report.degenerateRemoved = static_cast<std::int64_t>(std::erase_if(
        mesh.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }));
}

// Triangles on the same three points. Two that face each other bound nothing and go (a fin folded onto itself, the wall
// between two boxes), except in a file that lists its whole surface twice, once from either side, as renderers like it: there
// the first stays. Of those that are left, all the same way round, the first stays: `extra` says which the others are.
struct Dropped {
    std::vector<bool> is, extra;  // one a triangle
};

Dropped duplicatesOf(const TriangleMesh& mesh, const Progress& progress) {
    struct Entry {
        Triangle corners;
        Index triangle;
        bool even;
    };
    std::vector<Entry> entries;
    entries.reserve(mesh.triangles.size());
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
        const auto [corners, even] = sortedCorners(mesh.triangles[t]);
        entries.push_back({corners, t, even});
    }
    sortUnlessStopped(entries, progress, [](const Entry& a, const Entry& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.triangle < b.triangle;
    });
    Dropped dropped{std::vector<bool>(mesh.triangles.size()), std::vector<bool>(mesh.triangles.size())};
    std::vector<Index> opposed;  // first triangles of groups that cancel
    std::size_t inOpposed = 0;
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
        std::size_t even = 0;
        for (end = begin; end < entries.size() && entries[end].corners == entries[begin].corners; ++end)
            even += entries[end].even;
        const std::size_t odd = end - begin - even;
        std::size_t pairs[2] = {std::min(even, odd), std::min(even, odd)};
        bool kept = false;
        for (std::size_t i = begin; i < end; ++i) {
            const Index t = entries[i].triangle;
            if (pairs[entries[i].even] > 0) {
                --pairs[entries[i].even];
                dropped.is[t] = true;
            } else {
                dropped.extra[t] = kept;
                kept = true;
            }
        }
        if (even == odd) {
            opposed.push_back(entries[begin].triangle);
            inOpposed += end - begin;
        }
    }
    if (2 * inOpposed > mesh.triangles.size())
        for (const Index triangle : opposed) dropped.is[triangle] = false;
    return dropped;
}

std::vector<Triangle> without(const std::vector<Triangle>& triangles, const std::vector<bool>& dropped) {
    std::vector<Triangle> kept;
    kept.reserve(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (!dropped[t]) kept.push_back(triangles[t]);
    return kept;
}

std::size_t openEdges(const std::vector<EdgeUse>& uses) {
    std::size_t open = 0;
    forEachEdge(uses, [&](const EdgeUse*, std::size_t count) { open += count % 2; });
    return open;
}

// invariant: a mesh whose edges are used equally often both ways stays one. Pairs that face each other take as much one way
// as the other; copies that face the same way go unless they keep the mesh closed.
void dropDuplicates(TriangleMesh& mesh, MeshRepairReport& report, const Progress& progress) {
    const std::size_t before = mesh.triangles.size();
    const Dropped dropped = duplicatesOf(mesh, progress);
    const auto any = [](const std::vector<bool>& marks) {
        return std::find(marks.begin(), marks.end(), true) != marks.end();
    };
    if (!any(dropped.is) && !any(dropped.extra)) return;
    std::vector<bool> all = dropped.is;
    for (std::size_t t = 0; t < all.size(); ++t) all[t] = all[t] || dropped.extra[t];
    std::vector<Triangle> kept = without(mesh.triangles, all);
    if (any(dropped.extra)) {
        std::vector<Triangle> copies = without(mesh.triangles, dropped.is);
        const std::vector<EdgeUse> uses = edgeUses(copies, progress);
        if (isBalanced(uses) && openEdges(uses) < openEdges(edgeUses(kept, progress)))
            kept = std::move(copies);
    }
    mesh.triangles = std::move(kept);
    report.duplicatesRemoved = static_cast<std::int64_t>(before - mesh.triangles.size());
}

void refuseNothing(const TriangleMesh& mesh, const std::string& name, const MeshRepairReport& report) {
    if (!mesh.triangles.empty()) return;
    throw InputError(name, fmt::format("no triangles are left of {}: {} degenerate, {} duplicates, {} loose",
                                       report.facesRead, report.degenerateRemoved, report.duplicatesRemoved,
                                       report.looseRemoved));
}

// Distance between neighbouring numbers at the largest coordinate.
double stepOf(const TriangleMesh& mesh) {
    double largest = 0;
    bool isFloat32 = true;
    for (const Point& p : mesh.points)
        for (const double x : p) {
            largest = std::max(largest, std::abs(x));
            isFloat32 = isFloat32 && static_cast<double>(static_cast<float>(x)) == x;
        }
    return largest > 0 ? std::ldexp(1.0, std::ilogb(largest) - (isFloat32 ? 23 : 52)) : 0;
}

void closeCracks(TriangleMesh& mesh, std::vector<EdgeUse>& uses, const RepairOptions& options,
                 MeshRepairReport& report, const Progress& progress) {
    const Cracks cracks = repair::closeCracks(mesh, uses, options.step.value_or(stepOf(mesh)), progress);
    report.pointsWelded = cracks.welded;
    report.weldedFarthest = cracks.farthest;
    report.edgesSplit = cracks.split;
    if (cracks.welded + cracks.split > 0) uses = edgeUses(mesh.triangles, progress);
}

void describe(MeshRepairReport& report) {
    const auto note = [&](std::int64_t count, const char* one, const char* many,
                          const std::string& more = {}) {
        if (count > 0) report.notes.push_back(fmt::format("{} {}{}", count, count == 1 ? one : many, more));
    };
    note(report.pointsUnused, "point in no triangle left out", "points in no triangle left out");
    note(report.pointsMerged, "equal point merged", "equal points merged");
    note(report.degenerateRemoved, "degenerate triangle removed", "degenerate triangles removed");
    note(report.duplicatesRemoved, "duplicate triangle removed", "duplicate triangles removed");
    note(report.pointsWelded, "point on a crack moved onto its neighbour",
         "points on cracks moved onto their neighbours",
         fmt::format(", at most {:.3g} away", report.weldedFarthest));
    note(report.edgesSplit, "edge split at points that lie on it (T-junctions)",
         "edges split at points that lie on them (T-junctions)");
    note(report.looseRemoved, "loose triangle removed", "loose triangles removed");
    note(report.facesFlipped, "triangle turned to agree with its neighbours",
         "triangles turned to agree with their neighbours");
    note(report.holesFilled, "hole filled", "holes filled",
         fmt::format("{}{:.3g} wide", report.holesFilled == 1 ? ", " : ", at most ", report.widestFilled));
    note(report.nonManifoldEdges, "edge with four or more triangles kept",
         "edges with four or more triangles kept");
    note(report.bodiesTurned, "closed body was inside out: turned", "closed bodies were inside out: turned");
    note(report.nestedSolid, "closed shell lies in another one and faces the same way: solid, no cavity",
         "closed shells lie in other ones and face the same way: solid, no cavities");
    if (report.evenOdd)
        report.notes.push_back("its orientation cannot be trusted: inside by counting crossings");
}

std::int64_t edgesOfFour(const std::vector<EdgeUse>& uses) {
    std::int64_t found = 0;
    forEachEdge(uses, [&](const EdgeUse*, std::size_t count) { found += count > 2 && count % 2 == 0; });
    return found;
}

// Fills or refuses what is open.
void closeBoundary(TriangleMesh& mesh, std::vector<EdgeUse>& uses, const std::string& name,
                   const RepairOptions& options, MeshRepairReport& report, const Progress& progress) {
    std::vector<BoundaryEdge> boundary = boundaryOf(uses);
    report.boundaryEdges = static_cast<std::int64_t>(boundary.size());
    const std::vector<Hole> holes =
        holesOf(mesh, loopsOf(std::move(boundary), mesh.points.size(), progress), progress);
    report.boundaryLoops = static_cast<std::int64_t>(holes.size());
    if (holes.empty() || options.mayStayOpen) return;
    refuseLargeHoles(mesh, name, holes, report, options);
    progress("repairing", 0.9);
    closeHoles(mesh, name, holes, report);
    refuseNothing(mesh, name, report);
    uses = edgeUses(mesh.triangles, progress);
}

}  // namespace

TriangleMesh repairMesh(TriangleMesh mesh, const std::string& name, MeshRepairReport* reportOut,
                        const RepairOptions& options, const Progress& progress) {
    MeshRepairReport report;
    report.facesRead = static_cast<std::int64_t>(mesh.triangles.size());
    progress("repairing", 0);
    mergePoints(mesh, report, progress);
    dropDegenerate(mesh, report);
    progress("repairing", 0.3);
    dropDuplicates(mesh, report, progress);
    refuseNothing(mesh, name, report);

    progress("repairing", 0.5);
    std::vector<EdgeUse> uses = edgeUses(mesh.triangles, progress);
    closeCracks(mesh, uses, options, report, progress);
    refuseNothing(mesh, name, report);
    report.oriented = isBalanced(uses);
    bool trusted = true;
    if (!report.oriented) {
        progress("repairing", 0.7);
        trusted = turnToAgree(mesh, uses, report.facesFlipped, progress);
        uses = edgeUses(mesh.triangles, progress);
    }

    progress("repairing", 0.8);
    report.nonManifoldEdges = edgesOfFour(uses);
    closeBoundary(mesh, uses, name, options, report, progress);
    report.evenOdd = !trusted || !isBalanced(uses);
    if (!report.evenOdd && !options.mayStayOpen) {
        const Bodies bodies = orientBodies(mesh, uses, progress);
        report.bodiesTurned = bodies.turned;
        report.nestedSolid = bodies.nested;
    }

    progress("repairing", 1);
    describe(report);
    if (reportOut) *reportOut = std::move(report);
    return mesh;
}

}  // namespace isowave
