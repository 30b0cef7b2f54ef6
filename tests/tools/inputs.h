// Small inputs, written by the tests themselves: NRRD and NIfTI images, STL, OFF and PLY meshes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace isowave::tools_test {

using Size = std::array<int, 3>;

// f at every voxel, x fastest.
template <class T, class F>
std::vector<T> sampled(Size size, F f) {
    std::vector<T> values;
    values.reserve(static_cast<std::size_t>(size[0]) * size[1] * size[2]);
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) values.push_back(static_cast<T>(f(x, y, z)));
    return values;
}

template <class T>
const char* nrrdType() {
    if constexpr (std::is_same_v<T, std::uint8_t>) return "uint8";
    if constexpr (std::is_same_v<T, std::int16_t>) return "int16";
    if constexpr (std::is_same_v<T, std::int32_t>) return "int32";
    if constexpr (std::is_same_v<T, float>) return "float";
}

// geometry: the header lines that say where the voxels lie.
template <class T>
void writeNrrd(const std::filesystem::path& file, Size size, const std::vector<T>& values,
               const std::string& geometry = "spacings: 1 1 1\n") {
    std::ofstream out(file, std::ios::binary);
    out << "NRRD0004\ntype: " << nrrdType<T>() << "\ndimension: 3\nsizes: " << size[0] << ' ' << size[1]
        << ' ' << size[2] << "\n"
        << geometry << "endian: little\nencoding: raw\n\n";
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(T)));
}

// A ball of radius r in the middle: 100 inside, -100 outside, a ramp of 8 voxels between.
inline std::vector<std::int16_t> greyBall(Size size, double r) {
    return sampled<std::int16_t>(size, [&](int x, int y, int z) {
        const double d =
            std::hypot(x - (size[0] - 1) / 2.0, y - (size[1] - 1) / 2.0, z - (size[2] - 1) / 2.0) - r;
        return std::lround(std::min(100.0, std::max(-100.0, -25 * d)));
    });
}

// A ring of radii R and r in the plane z = middle, value 1; a small ball in a corner, value 2; 0 elsewhere.
inline std::vector<std::uint8_t> ringAndBall(Size size, double R, double r, bool ball) {
    return sampled<std::uint8_t>(size, [&](int x, int y, int z) {
        const double u = x - (size[0] - 1) / 2.0, v = y - (size[1] - 1) / 2.0, w = z - (size[2] - 1) / 2.0;
        if (std::hypot(std::hypot(u, v) - R, w) < r) return 1;
        return ball && std::hypot(x - 4.0, y - 4.0, z - 4.0) < 2.5 ? 2 : 0;
    });
}

// The 348 bytes of a NIfTI-1 header, identity orientation, then the voxels.
inline void writeNifti(const std::filesystem::path& file, Size size,
                       const std::vector<std::int16_t>& values) {
    std::vector<char> header(352, 0);
    const auto put = [&](std::size_t at, auto value) {
        std::memcpy(header.data() + at, &value, sizeof value);
    };
    put(0, std::int32_t{348});
    put(40, std::int16_t{3});
    for (int axis = 0; axis < 3; ++axis) put(42 + 2 * axis, static_cast<std::int16_t>(size[axis]));
    for (int axis = 3; axis < 7; ++axis) put(42 + 2 * axis, std::int16_t{1});
    put(70, std::int16_t{4});   // int16
    put(72, std::int16_t{16});  // bits
    for (int axis = 0; axis < 4; ++axis) put(76 + 4 * axis, 1.0f);
    put(108, 352.0f);           // where the voxels start
    put(112, 1.0f);             // slope
    header[123] = 2;            // mm
    put(254, std::int16_t{1});  // sform holds scanner coordinates
    put(280, 1.0f);
    put(300, 1.0f);
    put(320, 1.0f);
    std::memcpy(header.data() + 344, "n+1", 4);
    std::ofstream out(file, std::ios::binary);
    out.write(header.data(), static_cast<std::streamsize>(header.size()));
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * 2));
}

struct SmallMesh {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<int, 3>> triangles;
};

// A ring of radii R and r about the z axis, counter-clockwise from outside; genus 1.
inline SmallMesh torus(double R, double r, int around = 48, int across = 24) {
    SmallMesh mesh;
    const double turn = 2 * std::acos(-1.0);
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double u = turn * i / around, v = turn * j / across, ring = R + r * std::cos(v);
            mesh.points.push_back({ring * std::cos(u), ring * std::sin(u), r * std::sin(v)});
            const int a = i * across + j, b = (i + 1) % around * across + j;
            const int c = (i + 1) % around * across + (j + 1) % across, d = i * across + (j + 1) % across;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

inline void writeStl(const std::filesystem::path& file, const SmallMesh& mesh) {
    std::ofstream out(file, std::ios::binary);
    std::string header = "a test";
    header.resize(80, ' ');
    out << header;
    const auto put = [&](auto value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
    put(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) put(0.0f);
        for (const int corner : t)
            for (const double x : mesh.points[corner]) put(static_cast<float>(x));
        put(std::uint16_t{0});
    }
}

inline void writeOff(const std::filesystem::path& file, const SmallMesh& mesh) {
    std::ofstream out(file);
    out.precision(17);
    out << "OFF\n" << mesh.points.size() << ' ' << mesh.triangles.size() << " 0\n";
    for (const auto& p : mesh.points) out << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

// comment: for example "SPACE=RAS".
inline void writePly(const std::filesystem::path& file, const SmallMesh& mesh,
                     const std::string& comment = {}) {
    std::ofstream out(file);
    out << "ply\nformat ascii 1.0\n"
        << (comment.empty() ? "" : "comment " + comment + "\n") << "element vertex " << mesh.points.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const auto& p : mesh.points) out << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

// The first half of a file, under another name.
inline void writeHalf(const std::filesystem::path& whole, const std::filesystem::path& half) {
    std::ifstream in(whole, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(in)), {});
    std::ofstream(half, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
}

}  // namespace isowave::tools_test
