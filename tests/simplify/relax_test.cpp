#include "polygonize/relax.h"

#include <gtest/gtest.h>

#include "polygonize/polygonize.h"
#include "simplify/self_intersections.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

TEST(Relax, AddsNoSelfIntersections) {
    for (const auto& [name, field] : zoo::allFields()) {
        TriangleMesh mesh = polygonize(field);
        const std::int64_t before = countSelfIntersections(mesh);
        relax(mesh, ZeroSet(field), 5);
        EXPECT_LE(countSelfIntersections(mesh), before) << name;
    }
}

}  // namespace
}  // namespace isowave
