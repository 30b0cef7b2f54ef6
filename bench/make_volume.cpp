// make_volume N OUT: a mask of N^3 voxels of uint8, 0 or 1, written a slice at a time; OUT ends in .raw, .mha or .nrrd.
// make_volume N OUT part: instead the solid of bench/part.h in grey, 0 .. 200, which falls over two voxels; its surface is at 100.
//
// A flange: a disc with a bore and eight bolt holes, turned so that none of its faces lies along the lattice. Its
// surface is about 2.2 N^2 voxel faces whatever N is. Rows are cut analytically (a row meets each cylinder in one
// interval), so that the disk is what takes the time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "part.h"

namespace {

using Vec = std::array<double, 3>;

double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec along(const Vec& p, const Vec& d, double t) {
    return {p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]};
}
Vec unit(const Vec& a) {
    const double length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}
Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Interval {
    double low, high;
    bool empty() const { return !(low <= high); }
};

// |(p + t x - centre) - its part along axis| <= radius, t real: |u + t v|^2 <= r^2.
Interval cutByCylinder(const Vec& p, const Vec& centre, const Vec& axis, double radius) {
    const Vec from = along(p, centre, -1), u = along(from, axis, -dot(from, axis)),
              v = along({1, 0, 0}, axis, -axis[0]);
    const double a = dot(v, v), b = dot(u, v), c = dot(u, u) - radius * radius, d = b * b - a * c;
    if (d < 0) return {1, 0};
    return {(-b - std::sqrt(d)) / a, (-b + std::sqrt(d)) / a};
}

// |(p + t x - centre) . axis| <= half
Interval cutBySlab(const Vec& p, const Vec& centre, const Vec& axis, double half) {
    const double at = dot(along(p, centre, -1), axis);
    const double s = (-half - at) / axis[0], t = (half - at) / axis[0];
    return {std::min(s, t), std::max(s, t)};
}

struct Flange {
    Vec centre, axis, across, third;
    double n;

    explicit Flange(double size)
        : centre{0.497 * size, 0.503 * size, 0.499 * size}, axis(unit({0.31, 0.44, 0.84})), n(size) {
        across = unit(cross(axis, {1, 0, 0}));
        third = cross(axis, across);
    }

    // Fills the row of voxels (0..n-1, y, z), which is 0 before.
    void fill(double y, double z, std::vector<char>& row) const {
        const Vec p{0, y, z};
        const Interval disc = cutByCylinder(p, centre, axis, 0.42 * n),
                       slab = cutBySlab(p, centre, axis, 0.1 * n);
        const Interval solid{std::max(disc.low, slab.low), std::min(disc.high, slab.high)};
        if (solid.empty()) return;
        set(solid, 1, row);
        set(cutByCylinder(p, centre, axis, 0.15 * n), 0, row);
        for (int hole = 0; hole < 8; ++hole) {
            const double turn = std::acos(-1.0) / 4 * hole;
            const Vec at =
                along(along(centre, across, 0.3 * n * std::cos(turn)), third, 0.3 * n * std::sin(turn));
            set(cutByCylinder(p, at, axis, 0.05 * n), 0, row);
        }
    }

  private:
    static void set(const Interval& interval, char value, std::vector<char>& row) {
        if (interval.empty()) return;
        const auto size = static_cast<double>(row.size());
        const double first = std::clamp(std::ceil(interval.low), 0.0, size);
        const double last = std::clamp(std::floor(interval.high), -1.0, size - 1);
        if (first <= last)
            std::memset(&row[static_cast<std::size_t>(first)], value,
                        static_cast<std::size_t>(last - first) + 1);
    }
};

void fillGrey(const isowave::bench::PerforatedPart& part, long y, long z, std::vector<char>& row) {
    for (std::size_t x = 0; x < row.size(); ++x) {
        const double distance = part({double(x), double(y), double(z)});
        row[x] = static_cast<char>(
            static_cast<unsigned char>(std::lround(std::clamp(100 - 100 * distance, 0.0, 200.0))));
    }
}

std::string headerFor(const std::string& name, long n) {
    const std::string size = std::to_string(n) + ' ' + std::to_string(n) + ' ' + std::to_string(n) + '\n';
    if (name.ends_with(".mha"))
        return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize "
               "= " +
               size + "ElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    if (name.ends_with(".nrrd"))
        return "NRRD0004\ntype: uint8\ndimension: 3\nsizes: " + size + "spacings: 1 1 1\nencoding: raw\n\n";
    return "";
}

}  // namespace

int main(int argc, char** argv) {
    const bool isPart = argc == 4 && std::strcmp(argv[3], "part") == 0;
    const long n = argc == 3 || isPart ? std::strtol(argv[1], nullptr, 10) : 0;
    if (n < 1) {
        std::cerr << "usage: make_volume N OUT.raw|OUT.mha|OUT.nrrd [part]\n";
        return 2;
    }
    const std::string name = argv[2];
    std::ofstream file(name, std::ios::binary);
    file << headerFor(name, n);
    const Flange flange(static_cast<double>(n));
    const isowave::bench::PerforatedPart part(static_cast<int>(n));
    std::vector<char> row(static_cast<std::size_t>(n));
    for (long z = 0; z < n; ++z)
        for (long y = 0; y < n; ++y) {
            std::fill(row.begin(), row.end(), char(0));
            if (isPart)
                fillGrey(part, y, z, row);
            else
                flange.fill(static_cast<double>(y), static_cast<double>(z), row);
            file.write(row.data(), n);
        }
    if (!file.flush()) {
        std::cerr << name << ": writing failed; is the disk full?\n";
        return 1;
    }
    return 0;
}
