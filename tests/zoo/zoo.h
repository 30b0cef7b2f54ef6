// The zoo: solids grouped by property, for the tests of every module. Small enough to run through everything.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "volume/field.h"

namespace isowave::zoo {

struct Solid {
    std::string name;
    std::function<bool(const openvdb::Coord&)> inside;      // sign of every lattice point of the box
    openvdb::CoordBBox box;                                 // outside beyond it
    std::function<double(const openvdb::Vec3d&)> distance;  // signed distance in voxels, or empty
};

std::vector<Solid> smoothSolids();  // sphere, torus
std::vector<Solid> cadSolids();     // perforated cylinder, plate with holes
std::vector<Solid> thinSolids();    // 1-voxel wall, 1-voxel-thick dimension, single voxel, specks
std::vector<Solid>
noisySolids();  // white noise at 50 %, checkerboard, voxels that touch at corners and edges
std::vector<Solid> borderSolids();  // full box, half box (fills its box up to the border)
std::vector<Solid> emptySolids();   // nothing
std::vector<Solid> allSolids();     // every group

// fitBinary of its signs; for solids with a distance, fitDistance as well.
struct NamedField {
    std::string name;
    BSplineField field;
};
std::vector<NamedField> allFields();
BSplineField binaryField(const Solid& solid);
BSplineField distanceField(const Solid& solid, double halfWidth = 4, double band = 2);

}  // namespace isowave::zoo
