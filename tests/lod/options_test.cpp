// Numbers that the command's parser would refuse are refused by the library too, by the option's name.
#include "tests/lod/solids.h"

namespace isowave::lod_test {
namespace {

using testing::HasSubstr;

std::string usageError(const std::function<void()>& work) {
    try {
        work();
    } catch (const UsageError& error) {
        return error.what();
    }
    return "nothing thrown";
}

TEST(SolidOptions, RefuseNumbersThatAreNone) {
    const auto with = [](const SolidOptions& options) {
        return usageError([&] { open(ringMesh(), options); });
    };
    EXPECT_THAT(with({.voxels = 0}), HasSubstr("--voxels: 0 is less than 4"));
    EXPECT_THAT(with({.voxels = -5}), HasSubstr("--voxels: -5"));
    EXPECT_THAT(with({.voxel = 0}), HasSubstr("--voxel: 0 is not a number above 0"));
    EXPECT_THAT(with({.voxel = NAN}), HasSubstr("--voxel: nan"));
    EXPECT_THAT(with({.voxels = 24, .closeHoles = -1}), HasSubstr("--close-holes: -1"));
    EXPECT_THAT(with({.voxels = 24, .thicken = INFINITY}), HasSubstr("--thicken: inf"));
    EXPECT_THAT(with({.voxels = 24, .halfWidth = 0}), HasSubstr("--half-width: 0"));
    EXPECT_THAT(with({.voxels = 24, .band = -2}), HasSubstr("--band: -2"));
    EXPECT_THAT(with({.voxels = 24, .maxMemory = 0}), HasSubstr("--max-memory: 0"));
}

TEST(LevelOptions, RefuseNumbersThatAreNone) {
    const Solid ring = open(ringMesh(), {.voxels = 24});
    const auto with = [&](const LevelOptions& options) {
        return usageError([&] { makeLadder(ring, options); });
    };
    EXPECT_THAT(with({.levels = StepRange{0, 0}, .refine = 3}), HasSubstr("--refine: 3 is not 1, 2 or 4"));
    EXPECT_THAT(with({.levels = StepRange{0, 0}, .refine = 0}), HasSubstr("--refine: 0"));
    EXPECT_THAT(with({.levels = StepRange{5, 2}}), HasSubstr("--levels: 5..2 ends before it begins"));
    EXPECT_THAT(with({.steps = StepRange{-1, 2}}), HasSubstr("--steps: -1 is less than 0"));
    EXPECT_THAT(with({.levels = StepRange{0, 0}, .maxGenus = -1}), HasSubstr("--max-genus: -1"));
    EXPECT_THAT(with({.levels = StepRange{0, 0}, .maxParts = 0}), HasSubstr("--max-parts: 0 is less than 1"));
    EXPECT_THAT(with({.levels = StepRange{0, 0}, .relax = -1}), HasSubstr("--relax: -1"));
}

TEST(BudgetOptions, RefuseNumbersThatAreNone) {
    const Solid ring = open(ringMesh(), {.voxels = 24});
    const auto with = [&](const BudgetOptions& options) {
        return usageError([&] { makeBudget(ring, options); });
    };
    EXPECT_THAT(with({.triangles = {3}}), HasSubstr("--triangles: 3 is less than 4"));
    EXPECT_THAT(with({.ratios = {0}}), HasSubstr("--ratio: 0 is not a number above 0"));
    EXPECT_THAT(with({.ratios = {0.5, 1.5}}), HasSubstr("--ratio: 1.5 is more than 1"));
    EXPECT_THAT(with({.tolerances = {-0.1}}), HasSubstr("--tolerance: -0.1"));
    EXPECT_THAT(with({.triangles = {100}, .minComponent = 0}), HasSubstr("--min-component: 0"));
}

TEST(FieldMeshOptions, RefuseAnIsoValueThatTheFieldNeverHas) {
    const Field field = fieldOf(open(ringMesh(), {.voxels = 24}));
    for (const double iso : {field.K(), -field.K(), 2 * field.K(), double(NAN)})
        EXPECT_THAT(usageError([&] { field.polygonize({.iso = iso}); }), HasSubstr("is not between")) << iso;
    EXPECT_THAT(usageError([&] { field.polygonize({.refine = 3}); }), HasSubstr("--refine: 3"));
    EXPECT_GT(field.polygonize({.iso = 0.5 * field.K()}).triangles.size(), 0u);
}

}  // namespace
}  // namespace isowave::lod_test
