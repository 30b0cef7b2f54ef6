#include "lod/slabs/slab_store.h"

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/read_file.h"
#include "isowave/error.h"
#include "volume/content_hash.h"
#include "volume/vdb_file.h"

namespace isowave::lod {
namespace {

namespace fs = std::filesystem;

constexpr const char* kControlPoints = "control_points";
constexpr const char* kShape = "shape";
constexpr const char* kDetails = "details";
constexpr const char* kK = "isowave:K";
const std::string kTold = "told_";

template <class Grid>
openvdb::GridBase::ConstPtr named(const typename Grid::Ptr& grid, const char* name) {
    const auto copy = grid->copy();  // shares the tree
    copy->setName(name);
    return copy;
}

template <class Grid>
typename Grid::Ptr gridOf(const fs::path& path, VdbParts& parts, const char* name) {
    const auto grid = openvdb::gridPtrCast<Grid>(parts.read({name}).front());
    if (!grid)
        throw InputError(path.string(), fmt::format("has no grid '{}'; the job in slabs that wrote it was "
                                                    "another one: remove the folder and run it again",
                                                    name));
    return grid;
}

void writePart(const fs::path& path, const BSplineField& part) {
    openvdb::MetaMap meta;
    meta.insertMeta(kK, openvdb::DoubleMetadata(part.K));
    writeVdbForNow(
        path,
        {named<openvdb::FloatGrid>(part.controlPoints, kControlPoints), named<Shape>(part.shape, kShape)},
        meta);
}

BSplineField readPart(const fs::path& path) {
    VdbParts parts(path);
    BSplineField part;
    part.controlPoints = gridOf<openvdb::FloatGrid>(path, parts, kControlPoints);
    part.shape = gridOf<Shape>(path, parts, kShape);
    part.K = static_cast<double>(part.controlPoints->background());
    if (const auto K = parts.metadata().getMetadata<openvdb::DoubleMetadata>(kK)) part.K = K->value();
    part.controlPoints->setName("field");
    return part;
}

void forget(const fs::path& path) {
    std::error_code error;
    fs::remove(path, error);
}

}  // namespace

SlabStore::SlabStore(fs::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error)
        throw OperationError(folder_.string(), "cannot be made (" + error.message() +
                                                   "); slabs are kept there between the phases of a job");
}

void SlabStore::begin(const std::string& job) const {
    const fs::path path = folder_ / "job.json";
    if (fs::exists(path) && readFile(path, "a job in slabs") == job) return;
    for (const auto& entry : fs::directory_iterator(folder_))
        if (entry.path().filename().string().starts_with(kTold)) forget(entry.path());
    AtomicFile file(path);
    file.stream() << job;
    file.commit();
}

fs::path SlabStore::toldPath(const std::string& task) const {
    ContentHash hash;
    hash.add(task.data(), task.size());
    return folder_ / (kTold + hash.hex() + ".json");
}

fs::path SlabStore::fittedPath(int slab) const { return folder_ / fmt::format("fit_{}.vdb", slab); }
fs::path SlabStore::fieldPath(int step, int row, int column) const {
    return folder_ / fmt::format("field_{}_{}_{}.vdb", step, row, column);
}
fs::path SlabStore::stepPath(int step, int slab) const {
    return folder_ / fmt::format("step_{}_{}.vdb", step, slab);
}

void SlabStore::putFitted(int slab, const BSplineField& part) const { writePart(fittedPath(slab), part); }
BSplineField SlabStore::fitted(int slab) const { return readPart(fittedPath(slab)); }
void SlabStore::putField(int step, int row, int column, const BSplineField& part) const {
    writePart(fieldPath(step, row, column), part);
}
BSplineField SlabStore::field(int step, int row, int column) const {
    return readPart(fieldPath(step, row, column));
}

void SlabStore::putStep(int step, int slab, const Shape::Ptr& shape,
                        const wavelets::DetailGrid::Ptr& details) const {
    writeVdbForNow(stepPath(step, slab),
                   {named<Shape>(shape, kShape), named<wavelets::DetailGrid>(details, kDetails)});
}
Shape::Ptr SlabStore::shape(int step, int slab) const {
    const fs::path path = stepPath(step, slab);
    VdbParts parts(path);
    return gridOf<Shape>(path, parts, kShape);
}
wavelets::DetailGrid::Ptr SlabStore::details(int step, int slab) const {
    const fs::path path = stepPath(step, slab);
    VdbParts parts(path);
    return gridOf<wavelets::DetailGrid>(path, parts, kDetails);
}

void SlabStore::forgetField(int step, int row, int column) const { forget(fieldPath(step, row, column)); }

}  // namespace isowave::lod
