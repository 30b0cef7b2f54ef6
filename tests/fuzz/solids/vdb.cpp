#include "tests/fuzz/solids/vdb.h"

#include <cmath>

#include "isowave/isowave.h"
#include "tests/fuzz/bytes.h"
#include "tests/zoo/mesh_check.h"
#include "tests/zoo/zoo.h"
#include "volume/vdb_file.h"
#include "wavelets/pyramid.h"
#include "wavelets/pyramid_file.h"

namespace isowave::fuzz {
namespace {

// ---- vdb

void readAsPyramid(const std::filesystem::path& path) {
    const Pyramid pyramid = Pyramid::open(path);
    for (int step = pyramid.stepCount(); step >= 0; --step) pyramid.field(step);
}

Answer readAny(std::string_view bytes) {
    const auto path = fileOf(bytes, "any.vdb");
    if (wavelets::isPyramidFile(path)) return answerOf(path.string(), [&] { readAsPyramid(path); });
    return answerOf(path.string(), [&] { require(readLevelSet(path) != nullptr, "no level set"); });
}

// ---- pyramid

const wavelets::Pyramid& smallPyramid() {
    static const wavelets::Pyramid pyramid = wavelets::analyse(zoo::distanceField(zoo::smoothSolids().at(1)));
    return pyramid;
}

// Sets or clears a voxel near the origin, or a value, of one grid.
template <class Grid>
void change(Grid& grid, Bytes& bytes, const typename Grid::ValueType& value) {
    const openvdb::Coord at(bytes.between(-20, 40), bytes.between(-20, 40), bytes.between(-20, 40));
    switch (bytes.between(0, 4)) {
        case 0:
            return grid.tree().setValueOn(at, value);
        case 1:
            return grid.tree().setValueOff(at, value);
        case 2:
            return grid.tree().setActiveState(at, bytes.flag());
        case 3:
            return grid.clear();
        default:
            grid.tree().addTile(bytes.between(1, 2), at, value, bytes.flag());
    }
}

template <class Grid>
typename Grid::Ptr copyOf(const typename Grid::Ptr& grid) {
    return grid ? grid->deepCopy() : nullptr;
}

float floatOf(Bytes& bytes) {
    constexpr float kOdd[] = {0, -1, 1, 1e30f, NAN, INFINITY, -INFINITY, 1e-40f};
    return bytes.flag() ? kOdd[bytes.between(0, 7)] : static_cast<float>(2 * bytes.unit() - 1);
}

void changeStep(wavelets::Step& step, Bytes& bytes) {
    step.shape = copyOf<Shape>(step.shape);
    step.details = copyOf<wavelets::DetailGrid>(step.details);
    switch (bytes.between(0, 2)) {
        case 0:
            step.axis = bytes.between(0, 2);
            break;
        case 1:
            change(*step.shape, bytes, bytes.flag());
            break;
        default:
            change(*step.details, bytes, floatOf(bytes));
    }
}

void changePyramid(wavelets::Pyramid& pyramid, Bytes& bytes) {
    switch (bytes.between(0, 7)) {
        case 0:
            pyramid.K = std::abs(floatOf(bytes));
            return;
        case 1:
            pyramid.coarsest.controlPoints = copyOf<openvdb::FloatGrid>(pyramid.coarsest.controlPoints);
            return change(*pyramid.coarsest.controlPoints, bytes, floatOf(bytes));
        case 2:
            pyramid.coarsest.shape = copyOf<Shape>(pyramid.coarsest.shape);
            return change(*pyramid.coarsest.shape, bytes, bytes.flag());
        case 3:
            if (!pyramid.steps.empty())
                pyramid.steps.erase(pyramid.steps.begin() + bytes.next() % pyramid.stepCount());
            return;
        case 4:
            pyramid.source["input.path"] = std::string(static_cast<std::size_t>(bytes.next()), '"');
            return;
        default:
            if (!pyramid.steps.empty()) changeStep(pyramid.steps[bytes.next() % pyramid.steps.size()], bytes);
    }
}

void checkSteps(const Pyramid& pyramid) {
    for (int step = pyramid.stepCount(); step >= 0; --step) {
        const std::string wrong = zoo::whatIsWrongWith(pyramid.field(step).polygonize());
        require(wrong.empty(), ("a step's mesh is not closed and 2-manifold: " + wrong).c_str());
    }
}

Answer readPyramid(std::string_view input) {
    Bytes bytes(input);
    wavelets::Pyramid pyramid = smallPyramid();
    for (int k = bytes.between(1, 4); k-- > 0;) changePyramid(pyramid, bytes);
    const auto path = scratchFolder() / "small.pyramid.vdb";
    return answerOf(path.string(), [&] {
        wavelets::writePyramid(path, pyramid);
        checkSteps(Pyramid::open(path));
        makeLadder(open(path));
    });
}

}  // namespace

std::vector<Target> vdbTargets() { return {{"vdb", readAny}, {"pyramid", readPyramid}}; }

}  // namespace isowave::fuzz
