// persistence MESH N: the classes of classesAt() beside those that GUDHI finds, on the distance lattice of a
// closed mesh.
//
//   MESH   a file that readMesh() takes
//   N      the lattice has N^3 points; the mesh's longest axis spans those that are farther than kReach from its border
//
// Prints, for each of the two, wall seconds and the memory that it took beyond what was there before, and how
// many classes are the same. GUDHI: Bitmap_cubical_complex (MIT) and Persistent_cohomology (MIT), one thread,
// as it comes from Debian; cells get the largest value of their corners, which is the filtration of
// classesAt().
#include <fmt/format.h>
#include <gudhi/Bitmap_cubical_complex.h>
#include <gudhi/Persistent_cohomology.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>

#include "io/mesh/read.h"
#include "polygonize/persistence.h"
#include "volume/distance.h"
#include "volume/mesh_repair.h"

namespace {

using namespace isowave;
using openvdb::Coord;

constexpr int kReach = 16;  // in lattice steps, as FeatureOptions has it

LatticeFunction distanceLattice(const TriangleMesh& mesh, int n) {
    const double spacing = voxelForCount(mesh, n - 2 * (kReach + 2));
    const auto transform = transformForMesh(mesh, spacing);
    const auto distance = distanceFromMesh(mesh, *transform, kReach);
    const openvdb::CoordBBox box = distance->evalActiveVoxelBoundingBox();
    const Coord low = ((box.min() + box.max()) >> 1).offsetBy(-n / 2);
    LatticeFunction d{Coord(n), {}};
    d.values.reserve(static_cast<std::size_t>(n) * n * n);
    const auto accessor = distance->getConstAccessor();
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z) d.values.push_back(accessor.getValue(low.offsetBy(x, y, z)));
    return d;
}

// ---- GUDHI

// GUDHI's bitmap, filled from the points instead of from the cubes. Its first axis is the fastest: z.
class BitmapOfPoints : public Gudhi::cubical_complex::Bitmap_cubical_complex_base<float> {
  public:
    BitmapOfPoints(const std::vector<unsigned>& cubes, const std::vector<float>& points)
        : Bitmap_cubical_complex_base(cubes) {
        const std::array<std::size_t, 3> cells{2 * cubes[0] + 1, 2 * cubes[1] + 1, 2 * cubes[2] + 1};
        std::size_t cell = 0;
        for (std::size_t x = 0; x < cells[2]; ++x)
            for (std::size_t y = 0; y < cells[1]; ++y)
                for (std::size_t z = 0; z < cells[0]; ++z, ++cell) {
                    float largest = -INFINITY;
                    for (std::size_t i = x / 2; i <= (x + 1) / 2; ++i)
                        for (std::size_t j = y / 2; j <= (y + 1) / 2; ++j)
                            for (std::size_t k = z / 2; k <= (z + 1) / 2; ++k)
                                largest =
                                    std::max(largest, points[(i * (cubes[1] + 1) + j) * (cubes[0] + 1) + k]);
                    data[cell] = largest;
                }
    }
};

struct Interval {
    int dimension;
    float birth, death;
    auto operator<=>(const Interval&) const = default;
};

std::vector<Interval> classesByGudhi(const LatticeFunction& d, float at, float last) {
    using Complex = Gudhi::cubical_complex::Bitmap_cubical_complex<BitmapOfPoints>;
    using Field = Gudhi::persistent_cohomology::Field_Zp;
    const auto cubes = [&](int axis) { return static_cast<unsigned>(d.size[axis] - 1); };
    Complex complex({cubes(2), cubes(1), cubes(0)}, d.values);
    Gudhi::persistent_cohomology::Persistent_cohomology<Complex, Field> cohomology(complex);
    cohomology.init_coefficients(2);
    cohomology.compute_persistent_cohomology();
    std::vector<Interval> found;
    for (const auto& [birth, death, field] : cohomology.get_persistent_pairs()) {
        Interval c{static_cast<int>(complex.dimension(birth)), complex.filtration(birth),
                   complex.filtration(death)};
        if (!(c.birth <= at && at < c.death)) continue;
        // As classesAt(): nothing is known beyond `last`, and a cavity that is not filled by then is left
        // out.
        if (c.death > last && c.dimension == 2) continue;
        if (c.death > last) c.death = INFINITY;
        found.push_back(c);
    }
    return found;
}

std::vector<Interval> classesOfOurs(const LatticeFunction& d, float at, float last) {
    std::vector<Interval> found;
    for (const PersistentClass& c : classesAt(d, at, last)) found.push_back({c.dimension, c.birth, c.death});
    return found;
}

// ---- measuring

double kilobytes(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (word == key + ":") {
            double value = 0;
            status >> value;
            return value;
        }
    return NAN;
}

template <class Find>
std::vector<Interval> measured(const char* name, const Find& find) {
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak begins anew
    const double before = kilobytes("VmRSS");
    const auto start = std::chrono::steady_clock::now();
    std::vector<Interval> found = find();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::sort(found.begin(), found.end());
    fmt::print("{:8} {:8.2f} s {:8.0f} MB {:6} classes\n", name, seconds.count(),
               (kilobytes("VmHWM") - before) / 1024, found.size());
    std::fflush(stdout);
    return found;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: persistence MESH N\n");
        return 2;
    }
    const TriangleMesh mesh = repairMesh(readMesh(argv[1]), argv[1]);
    const LatticeFunction d = distanceLattice(mesh, std::atoi(argv[2]));
    const float last = std::nextafter(static_cast<float>(kReach), 0.0f);
    const auto ours = measured("isowave", [&] { return classesOfOurs(d, 0, last); });
    const auto theirs = measured("gudhi", [&] { return classesByGudhi(d, 0, last); });
    std::vector<Interval> same;
    std::set_intersection(ours.begin(), ours.end(), theirs.begin(), theirs.end(), std::back_inserter(same));
    fmt::print("the same: {}\n", same.size());
    return same.size() == ours.size() && same.size() == theirs.size() ? 0 : 1;
}
