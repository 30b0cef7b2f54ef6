#include "zoo/zoo.h"

#include <algorithm>
#include <cmath>

#include "volume/distance.h"
#include "volume/fit.h"

namespace isowave::zoo {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// A solid given by its distance; signs follow from it.
Solid fromDistance(std::string name, int half, std::function<double(const Vec3d&)> d) {
    return {std::move(name), [d](const Coord& c) { return d(c.asVec3d()) < 0; },
            CoordBBox(-half, -half, -half, half, half, half), d};
}

Solid fromSigns(std::string name, const CoordBBox& box, std::function<bool(const Coord&)> inside) {
    return {std::move(name), std::move(inside), box, {}};
}

// Deterministic on every machine: splitmix64 of the coordinate.
std::uint64_t hash(const Coord& c, std::uint64_t seed) {
    std::uint64_t x = seed + 0x9e3779b97f4a7c15u * (1 + std::uint64_t(std::uint32_t(c.x())) +
                                                    (std::uint64_t(std::uint32_t(c.y())) << 20) +
                                                    (std::uint64_t(std::uint32_t(c.z())) << 40));
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// Off the lattice and not axis-aligned, so that nothing repeats by accident.
const Vec3d kCentre(0.31, -0.27, 0.13);

double cylinder(double x, double y, double z, double radius, double halfHeight) {
    const double r = std::hypot(x, y) - radius, h = std::abs(z) - halfHeight;
    return std::min(std::max(r, h), 0.0) + std::hypot(std::max(r, 0.0), std::max(h, 0.0));
}

}  // namespace

std::vector<Solid> smoothSolids() {
    return {fromDistance("sphere", 18, [](const Vec3d& p) { return (p - kCentre).length() - 11.7; }),
            fromDistance("torus", 22, [](const Vec3d& p) {
                const Vec3d q = p - kCentre;
                return std::hypot(std::hypot(q.x(), q.y()) - 12.3, q.z()) - 4.6;
            })};
}

std::vector<Solid> cadSolids() {
    return {fromDistance("perforated cylinder", 22,
                         [](const Vec3d& p) {
                             const Vec3d q = p - kCentre;
                             const double bore = 5.2 - std::hypot(q.x(), q.y());
                             const double cross = 2.4 - std::hypot(q.y(), q.z());
                             return std::max({cylinder(q.x(), q.y(), q.z(), 15.3, 12.6), bore, cross});
                         }),
            fromDistance("plate with holes", 24, [](const Vec3d& p) {
                const Vec3d q = p - kCentre;
                double d = std::max({std::abs(q.x()) - 18.4, std::abs(q.y()) - 18.4, std::abs(q.z()) - 4.3});
                for (int i = -1; i <= 1; ++i)
                    for (int j = -1; j <= 1; ++j)
                        d = std::max(
                            d, 1.5 + 0.35 * (3 * i + j + 4) - std::hypot(q.x() - 11.2 * i, q.y() - 11.2 * j));
                return d;
            })};
}

std::vector<Solid> thinSolids() {
    return {fromSigns("one voxel", CoordBBox(3, -2, 7, 3, -2, 7), [](const Coord&) { return true; }),
            fromSigns("one-voxel wall", CoordBBox(0, 0, 0, 19, 16, 12),
                      [](const Coord& c) {
                          return c.y() == 8 && !(c.x() > 8 && c.x() < 12 && c.z() > 4 && c.z() < 7);
                      }),
            fromSigns("one-voxel-thick image", CoordBBox(0, 0, 0, 17, 13, 0),
                      [](const Coord& c) {
                          return std::hypot(c.x() - 8, c.y() - 6) < 5.5 && (c.x() + c.y()) % 7 != 0;
                      }),
            fromSigns("specks", CoordBBox(0, 0, 0, 30, 30, 30),
                      [](const Coord& c) { return hash(c, 5) % 97 == 0; })};
}

std::vector<Solid> noisySolids() {
    return {fromSigns("white noise", CoordBBox(0, 0, 0, 20, 18, 22),
                      [](const Coord& c) { return hash(c, 1) & 1; }),
            fromSigns("checkerboard", CoordBBox(0, 0, 0, 11, 10, 9),
                      [](const Coord& c) { return (c.x() + c.y() + c.z()) & 1; }),
            fromSigns("touching corners", CoordBBox(0, 0, 0, 7, 7, 7),
                      [](const Coord& c) { return ((c.x() & 2) + (c.y() & 2) + (c.z() & 2)) % 4 != 0; })};
}

std::vector<Solid> borderSolids() {
    return {fromSigns("full", CoordBBox(0, 0, 0, 17, 12, 9), [](const Coord&) { return true; }),
            fromSigns("half", CoordBBox(-8, -8, -8, 15, 15, 15),
                      [](const Coord& c) { return c.x() + c.y() < 9; })};
}

std::vector<Solid> emptySolids() {
    return {fromSigns("empty", CoordBBox(0, 0, 0, 9, 9, 9), [](const Coord&) { return false; })};
}

std::vector<Solid> allSolids() {
    std::vector<Solid> all;
    for (const auto& group :
         {smoothSolids(), cadSolids(), thinSolids(), noisySolids(), borderSolids(), emptySolids()})
        all.insert(all.end(), group.begin(), group.end());
    return all;
}

BSplineField binaryField(const Solid& solid) { return fitBinary(nodesFromFunction(solid.inside, solid.box)); }

BSplineField distanceField(const Solid& solid, double halfWidth, double band) {
    DistanceFitOptions options;
    options.halfWidth = halfWidth;
    options.band = band;
    return fitDistance(*distanceFromFunction(solid.distance, solid.box, halfWidth), options);
}

std::vector<NamedField> allFields() {
    std::vector<NamedField> fields;
    for (const Solid& solid : allSolids()) {
        fields.push_back({solid.name + ", binary", binaryField(solid)});
        if (solid.distance) fields.push_back({solid.name + ", distance", distanceField(solid)});
    }
    return fields;
}

}  // namespace isowave::zoo
