// One volume stored in all 48 orders and directions of its axes: every voxel lies where it lay, whichever header says so.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/io/image/files.h"
#include "tests/io/image/written.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using Size = std::array<std::int64_t, 3>;

// The volume itself: 5 x 4 x 3 voxels, each with a value of its own, oblique, of three spacings. RAS, mm.
constexpr Size kSize{5, 4, 3};
constexpr std::array<double, 3> kSpacing{0.75, 1.25, 2.5};
const Vec3 kOrigin{12, -40, 7};

std::int16_t valueAt(const Size& p) { return static_cast<std::int16_t>(1 + p[0] + 10 * p[1] + 100 * p[2]); }

// ---- rotations as quaternions (Hamilton), which share nothing with the matrices of the reader

struct Quaternion {
    double a, b, c, d;
};

Quaternion operator*(const Quaternion& p, const Quaternion& q) {
    return {p.a * q.a - p.b * q.b - p.c * q.c - p.d * q.d, p.a * q.b + p.b * q.a + p.c * q.d - p.d * q.c,
            p.a * q.c - p.b * q.d + p.c * q.a + p.d * q.b, p.a * q.d + p.b * q.c - p.c * q.b + p.d * q.a};
}

Vec3 rotated(const Quaternion& q, const Vec3& v) {
    const Quaternion r = q * Quaternion{0, v.x, v.y, v.z} * Quaternion{q.a, -q.b, -q.c, -q.d};
    return {r.b, r.c, r.d};
}

const Quaternion kTilt = [] {
    const double l = std::sqrt(0.9 * 0.9 + 0.2 * 0.2 + 0.3 * 0.3 + 0.1 * 0.1);
    return Quaternion{0.9 / l, 0.2 / l, -0.3 / l, 0.1 / l};
}();

Vec3 unit(std::size_t axis) {
    Vec3 v;
    v[static_cast<int>(axis)] = 1;
    return v;
}

// World step along axis a of the volume as it is.
Vec3 stepOf(std::size_t a) { return rotated(kTilt, unit(a)) * kSpacing[a]; }

// ---- orders

// Stored axis a runs along axis[a] of the volume, backwards where sign[a] is -1.
struct Order {
    std::array<std::size_t, 3> axis;
    std::array<int, 3> sign;

    Size size() const { return {kSize[axis[0]], kSize[axis[1]], kSize[axis[2]]}; }
    Size original(const Size& stored) const {
        Size p{};
        for (std::size_t a = 0; a < 3; ++a)
            p[axis[a]] = sign[a] > 0 ? stored[a] : kSize[axis[a]] - 1 - stored[a];
        return p;
    }
    Vec3 step(std::size_t a) const { return stepOf(axis[a]) * double(sign[a]); }
    Vec3 origin() const {
        const Size p = original({0, 0, 0});
        return kOrigin + stepOf(0) * double(p[0]) + stepOf(1) * double(p[1]) + stepOf(2) * double(p[2]);
    }
    std::vector<std::int16_t> voxels() const {
        std::vector<std::int16_t> values;
        for (std::int64_t z = 0; z < size()[2]; ++z)
            for (std::int64_t y = 0; y < size()[1]; ++y)
                for (std::int64_t x = 0; x < size()[0]; ++x) values.push_back(valueAt(original({x, y, z})));
        return values;
    }
};

std::vector<Order> allOrders() {
    std::vector<Order> orders;
    std::array<std::size_t, 3> axis{0, 1, 2};
    do {
        for (int flips = 0; flips < 8; ++flips)
            orders.push_back({axis, {flips & 1 ? -1 : 1, flips & 2 ? -1 : 1, flips & 4 ? -1 : 1}});
    } while (std::next_permutation(axis.begin(), axis.end()));
    return orders;
}

// The 24 rotations of a cube: 1 and 180 degrees about the axes, 120 degrees about the diagonals, and these with 90 degrees
// about x.
std::vector<Quaternion> cubeRotations() {
    std::vector<Quaternion> result{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    for (int s = 0; s < 8; ++s)
        result.push_back({0.5, s & 1 ? -0.5 : 0.5, s & 2 ? -0.5 : 0.5, s & 4 ? -0.5 : 0.5});
    const double h = std::sqrt(0.5);
    for (std::size_t i = 0; i < 12; ++i) result.push_back(Quaternion{h, h, 0, 0} * result[i]);
    return result;
}

// The rotation that takes the axes to those of the order, the third one turned round if `mirrored`.
std::optional<Quaternion> rotationOf(const Order& order, bool mirrored) {
    for (const Quaternion& q : cubeRotations()) {
        bool same = true;
        for (std::size_t a = 0; a < 3; ++a) {
            const double sign = order.sign[a] * (mirrored && a == 2 ? -1 : 1);
            same = same && length(rotated(q, unit(a)) - unit(order.axis[a]) * sign) < 1e-9;
        }
        if (same) return q;
    }
    return std::nullopt;
}

// ---- files

test::NiftiFile niftiOf(const Order& order) {
    test::NiftiFile file;
    file.size = {order.size()[0], order.size()[1], order.size()[2]};
    for (std::size_t a = 0; a < 3; ++a) file.pixdim[a + 1] = kSpacing[order.axis[a]];
    file.voxels = test::bytes(order.voxels());
    return file;
}

std::string sformFile(const Order& order, bool second) {
    test::NiftiFile file = niftiOf(order);
    file.second = second;
    file.sformCode = 1;
    for (int row = 0; row < 3; ++row)
        for (std::size_t a = 0; a < 4; ++a)
            file.srow[static_cast<std::size_t>(row) * 4 + a] =
                a < 3 ? order.step(a)[row] : order.origin()[row];
    return file.file();
}

std::string qformFile(const Order& order) {
    test::NiftiFile file = niftiOf(order);
    file.qformCode = 1;
    const bool mirrored = !rotationOf(order, false);
    Quaternion q = kTilt * rotationOf(order, mirrored).value();
    if (q.a < 0) q = {-q.a, -q.b, -q.c, -q.d};
    file.pixdim[0] = mirrored ? -1 : 1;
    file.quaternion = {q.b, q.c, q.d, order.origin().x, order.origin().y, order.origin().z};
    return file.file();
}

// In the space whose sides are right or left, anterior or posterior, superior or inferior, by the bits of `sides`.
std::string nrrdFile(const Order& order, unsigned sides) {
    const auto inSpace = [&](const Vec3& ras) {
        return test::vectorText(
            {sides & 1 ? -ras.x : ras.x, sides & 2 ? -ras.y : ras.y, sides & 4 ? -ras.z : ras.z});
    };
    const std::string space =
        fmt::format("{}-{}-{}", sides & 1 ? "left" : "right", sides & 2 ? "posterior" : "anterior",
                    sides & 4 ? "inferior" : "superior");
    const Size size = order.size();
    return test::nrrdFile(
        fmt::format("type: short\ndimension: 3\nsizes: {} {} {}\nendian: little\nencoding: raw\nspace: {}\n"
                    "space directions: {} {} {}\nspace origin: {}\n",
                    size[0], size[1], size[2], space, inSpace(order.step(0)), inSpace(order.step(1)),
                    inSpace(order.step(2)), inSpace(order.origin())),
        test::bytes(order.voxels()));
}

std::string metaFile(const Order& order) {
    const auto lps = [](const Vec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", -v.x, -v.y, v.z); };
    const Size size = order.size();
    std::string matrix, spacing;
    for (std::size_t a = 0; a < 3; ++a) {
        matrix += " " + lps(order.step(a) / kSpacing[order.axis[a]]);
        spacing += fmt::format(" {}", kSpacing[order.axis[a]]);
    }
    return fmt::format(
               "ObjectType = Image\nNDims = 3\nDimSize = {} {} {}\nElementType = MET_SHORT\nTransformMatrix "
               "={}\n"
               "Offset = {}\nElementSpacing ={}\nElementDataFile = LOCAL\n",
               size[0], size[1], size[2], matrix, lps(order.origin()), spacing) +
           test::bytes(order.voxels());
}

// ---- what is read

class Axes : public test::ImageFiles {
  protected:
    // Every voxel has its value and lies within `near` mm of its place.
    void expectTheVolume(const fs::path& path, const Order& order, double near) {
        const Image image = readImage(path);
        ASSERT_EQ(image.size, order.size());
        std::size_t i = 0;
        for (std::int64_t z = 0; z < image.size[2]; ++z)
            for (std::int64_t y = 0; y < image.size[1]; ++y)
                for (std::int64_t x = 0; x < image.size[0]; ++x, ++i) {
                    const Size p = order.original({x, y, z});
                    const Vec3 ras = kOrigin + stepOf(0) * double(p[0]) + stepOf(1) * double(p[1]) +
                                     stepOf(2) * double(p[2]);
                    const auto found = image.indexToWorld({double(x), double(y), double(z)});
                    ASSERT_EQ(image.values[i], valueAt(p));
                    ASSERT_LT(length(Vec3{found[0], found[1], found[2]} - Vec3{-ras.x, -ras.y, ras.z}), near);
                }
    }
    template <class Write>
    void sweep(const std::string& name, double near, const Write& write) {
        const std::vector<Order> orders = allOrders();
        ASSERT_EQ(orders.size(), 48u);
        for (std::size_t i = 0; i < orders.size(); ++i) {
            SCOPED_TRACE(fmt::format("{} in order {}", name, i));
            expectTheVolume(test::put(folder / name, write(orders[i], i)), orders[i], near);
            if (HasFatalFailure()) return;
        }
    }
};

// float32 holds 40 mm to 2e-6 mm.
TEST_F(Axes, OfNiftiBySform) {
    sweep("a.nii", 1e-5, [](const Order& order, std::size_t) { return sformFile(order, false); });
}
TEST_F(Axes, OfNiftiByQform) {
    sweep("a.nii", 1e-5, [](const Order& order, std::size_t) { return qformFile(order); });
}
TEST_F(Axes, OfNifti2BySform) {
    sweep("a.nii", 1e-12, [](const Order& order, std::size_t) { return sformFile(order, true); });
}
TEST_F(Axes, OfNrrdInEverySpace) {
    for (unsigned sides = 0; sides < 8; ++sides)
        sweep("a.nrrd", 1e-12, [&](const Order& order, std::size_t) { return nrrdFile(order, sides); });
}
TEST_F(Axes, OfMetaImage) {
    sweep("a.mha", 1e-12, [](const Order& order, std::size_t) { return metaFile(order); });
}

// The check can fail: a file in one order is not what another order says.
TEST_F(Axes, AreToldApart) {
    const std::vector<Order> orders = allOrders();
    const fs::path path = test::put(folder / "a.nii", sformFile(orders[1], false));
    const auto place = [&](const Order& order) {
        const Vec3 v = order.origin();
        return Vec3{-v.x, -v.y, v.z};
    };
    const auto found = readImage(path).indexToWorld.origin;
    EXPECT_LT(length(Vec3{found[0], found[1], found[2]} - place(orders[1])), 1e-5);
    EXPECT_GT(length(Vec3{found[0], found[1], found[2]} - place(orders[0])), 1);
}

}  // namespace
}  // namespace isowave
