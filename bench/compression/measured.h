// What every coder of the benchmark is measured against, and by.
#pragma once

#include <cstdint>
#include <ctime>
#include <limits>
#include <string>

#include "field_rivals.h"
#include "isowave/measure.h"

namespace isowave::bench {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// What a coder made of a solid.
struct Coded {
    std::string coder;
    double bound = 0;           // voxels: asked for; 0: to the bit
    std::int64_t bytes = 0;     // the mask included
    double change = kNothing;   // of F at corners of nodes that the surface passes, at most, voxels
    double rms = 0, max = 0;    // between the surfaces, both ways, voxels
    std::string topology = {};  // "same triangles", "same", or parts, handles and cavities for those before
    double write = kNothing, read = kNothing;  // seconds
};

class Original {
  public:
    // Of a distance fit.
    Original(std::string name, BSplineField field, double halfWidth);
    Original(const Original&) = delete;  // rivals refer to its points

    const std::string& name() const { return name_; }
    const BSplineField& field() const { return field_; }
    const FieldPoints& points() const { return points_; }
    const TriangleMesh& mesh() const { return mesh_; }
    double voxel() const { return voxel_; }                // edge, world units
    std::int64_t maskBytes() const { return maskBytes_; }  // as a packed solid has it
    double bitsOf(std::int64_t bytes) const {
        return 8.0 * static_cast<double>(bytes) / static_cast<double>(points_.c.size());
    }

    double changeOf(const Values& values) const;
    TriangleMesh meshOf(const Values& values) const;
    // Distances and topology.
    void judge(const TriangleMesh& mesh, Coded& coded) const;

    // Encodes, decodes and judges. parameter: of the rival.
    Coded measured(const FieldRival& rival, double parameter) const;
    // With the largest parameter found that keeps the bound.
    Coded within(const FieldRival& rival, double bound) const;

  private:
    std::string name_;
    BSplineField field_;
    FieldPoints points_;
    double voxelsPerK_;
    TriangleMesh mesh_;
    MeshTopology topology_;
    double voxel_;
    std::int64_t maskBytes_;
};

// Seconds of CPU, of all threads together, that f() takes: other programs on the machine do not count.
template <class F>
double secondsOf(const F& f) {
    const std::clock_t start = std::clock();
    f();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

}  // namespace isowave::bench
