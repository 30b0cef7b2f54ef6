// Every module of the installed package once: a torus as a field, its pyramid, a mesh of a coarser step.
#include <cmath>
#include <cstdio>

#include "isowave/error.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "isowave/image.h"
#include "wavelets/pyramid.h"

int main() {
    using namespace isowave;
    initializeVdb();
    try {
        readImage("no_such_image.nrrd");  // links the readers of images, and with them ITK
        return 1;
    } catch (const InputError&) {
    }
    const auto torus = [](const openvdb::Vec3d& p) {
        return std::hypot(std::hypot(p[0], p[1]) - 20.0, p[2]) - 8.0;
    };
    const auto distance = distanceFromFunction(torus, {openvdb::Coord(-32), openvdb::Coord(32)}, 4.0);
    const wavelets::Pyramid pyramid = wavelets::analyse(fitDistance(*distance));
    const MeshTopology topology = topologyOf(polygonize(pyramid.field(3)));
    std::printf("level 1: %lld triangles, genus %lld\n", static_cast<long long>(topology.triangles),
                static_cast<long long>(topology.genus));
    return topology.closed() && topology.manifold() && topology.genus == 1 ? 0 : 1;
}
