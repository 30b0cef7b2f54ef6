#include "lod/edit/edit.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/number_text.h"
#include "base/stage_clock.h"
#include "compress/packed_file.h"
#include "isowave/error.h"
#include "isowave/measure.h"
#include "lod/edit/moved.h"
#include "lod/edit/replace.h"
#include "lod/edit/unite.h"
#include "lod/field_state.h"
#include "lod/fit_solid.h"
#include "lod/memory.h"
#include "lod/option_checks.h"
#include "lod/packing/pack.h"
#include "lod/pyramid_state.h"
#include "lod/source.h"
#include "lod/steps.h"
#include "polygonize/knot_insertion.h"
#include "polygonize/polygonize.h"
#include "volume/vdb_file.h"
#include "wavelets/exact.h"
#include "wavelets/keep_exactly.h"
#include "wavelets/pyramid_file.h"

namespace isowave {
namespace lod {
namespace {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;  // clang 14 needs it said

using Source = std::map<std::string, std::string>;

// ---- --with: what is taken

// The field of a file that `isowave field` wrote, or another program from one.
BSplineField readField(const std::filesystem::path& path, double K) {
    initializeVdb();
    for (const auto& grid : readVdb(path).grids) {
        if (grid->getName() != "field") continue;
        const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
        if (!floats)
            throw InputError(path.string(),
                             fmt::format("the grid 'field' holds {}, expected float", grid->valueType()));
        if (const auto stored = floats->getMetadata<openvdb::DoubleMetadata>("isowave:K");
            stored && stored->value() != K)
            throw InputError(path.string(),
                             fmt::format("the field has K = {:g}, expected {:g}, that of the pyramid",
                                         stored->value(), K));
        for (auto value = floats->cbeginValueAll(); value; ++value)
            if (!std::isfinite(*value)) throw InputError(path.string(), "a control point is not finite");
        return {floats, shapeOf(*floats), K};
    }
    throw InputError(path.string(),
                     "has no grid 'field'; make one with: isowave field PYRAMID --level L -o FIELD.vdb");
}

using Other = std::variant<BSplineField, wavelets::Pyramid>;

Other readOther(const std::filesystem::path& path, double K, const Progress& progress) {
    if (compress::isPackedPath(path) || wavelets::isPyramidFile(path))
        return PyramidAccess::of(Pyramid::open(path, 0, progress));
    return readField(path, K);
}

Other otherOf(const EditWith& edit, double K, const Progress& progress) {
    if (const auto* field = std::get_if<Field>(&edit.other)) return FieldAccess::of(*field);
    if (const auto* pyramid = std::get_if<Pyramid>(&edit.other)) return PyramidAccess::of(*pyramid);
    return readOther(std::get<std::filesystem::path>(edit.other), K, progress);
}

void requireLattice(const BSplineField& other, const BSplineField& own, int level, const std::string& name) {
    const openvdb::Vec3d a = other.transform().voxelSize(), b = own.transform().voxelSize();
    if (other.transform() != own.transform())
        throw InputError(
            name, fmt::format("has another lattice (voxel {:.6g} x {:.6g} x {:.6g}) than level {} of the "
                              "pyramid (voxel {:.6g} x {:.6g} x {:.6g}); take a field of that level",
                              a.x(), a.y(), a.z(), level, b.x(), b.y(), b.z()));
    if (other.K != own.K)
        throw InputError(name,
                         fmt::format("has K = {:g}, expected {:g}, that of the pyramid", other.K, own.K));
}

// Points known in one of two fields whose control points differ by more than `most`, or that one alone knows.
std::int64_t countDiffering(const BSplineField& a, const BSplineField& b, double most) {
    const auto &x = a.controlPoints->constTree(), &y = b.controlPoints->constTree();
    openvdb::MaskTree either(x, false, openvdb::TopologyCopy());
    either.topologyUnion(y);
    const openvdb::FloatGrid::ConstUnsafeAccessor ofA(x), ofB(y);
    std::int64_t count = 0;
    for (auto leaf = either.cbeginLeaf(); leaf; ++leaf)
        for (auto point = leaf->cbeginValueOn(); point; ++point) {
            float p = 0, q = 0;
            const bool inA = ofA.probeValue(point.getCoord(), p), inB = ofB.probeValue(point.getCoord(), q);
            count += inA != inB || std::abs(p - q) > most;
        }
    return count;
}

// ---- the edits, one after the other

// World; of what is known.
PointBox boxAround(const BSplineField& field) {
    const openvdb::BBoxd known =
        field.transform().indexToWorld(field.controlPoints->evalActiveVoxelBoundingBox());
    return {{known.min().x(), known.min().y(), known.min().z()},
            {known.max().x(), known.max().y(), known.max().z()}};
}

MeshTopology measured(const BSplineField& field, const Progress& progress) {
    return topologyOf(polygonize(field, {.refine = 2}, progress));
}

class Editor {
  public:
    Editor(const wavelets::Pyramid& pyramid, const EditingOptions& options, const Progress& progress)
        : options_(options),
          order_(pyramid.order),
          step_(order_.stepOf(options.level)),
          progress_(progress),
          pyramid_(&pyramid),
          field_(pyramid.field(0, progress)) {
        const std::optional<FitSummary> fit = fitOfSource(pyramid.source);
        perK_ = voxelsPerKOf(fit, field_, "the pyramid", progress);
        const DistanceFitOptions usual;
        nearest_ = fit && fit->halfWidth > 0 ? fit->band / fit->halfWidth : usual.band / usual.halfWidth;
    }

    void run(const Edit& edit) {
        story_ = {};
        story_.text = textOf(edit);
        std::visit([&](const auto& e) { make(e); }, edit);
        if (!hasSurface(field_))
            throw InputError(story_.text, "removes all of the solid; give a smaller tool");
        measured_ = measured(field_, progress_);
        story_.volumeAfter = measured_->volume;
        story_.partsAfter = measured_->parts;
        if (!std::holds_alternative<EditWith>(edit) && story_.volumeAfter == story_.volumeBefore)
            throw InputError(
                story_.text,
                fmt::format("leaves the surface where it is; the tool {}, or changes it by less than a voxel "
                            "of level {}",
                            std::holds_alternative<EditAdd>(edit) ? "lies in the solid" : "misses the solid",
                            options_.level));
        if (std::holds_alternative<EditAdd>(edit) && story_.partsAfter > story_.partsBefore)
            progress_.say(story_.text + ": touches nothing; it is a part of its own");
        stories_.push_back(std::move(story_));
    }

    wavelets::Pyramid pyramid() const {
        if (whole_) return *whole_;
        wavelets::Pyramid result = wavelets::analyse(field_, {.order = order_}, progress_);
        wavelets::keepExactly(result, field_, progress_);
        return result;
    }
    // Whether level 0 and all else are those of a pyramid that was taken whole.
    bool isWhole() const { return whole_.has_value(); }
    std::vector<EditStory> takeStories() { return std::move(stories_); }

  private:
    UniteOptions uniting(bool cut) const {
        UniteOptions how{cut, perK_, 0};
        if (options_.blend) how.radius = *options_.blend / voxelOf(field_.transform());
        return how;
    }

    ToolFunction functionOf(const EditTool& tool, double reach, bool cut) const {
        ToolFunction::Room room{{}, memoryLimit(options_.maxMemory)};
        if (cut) room.solid = boxAround(field_);
        return {tool, story_.text, field_.transform(), order_.halvings(step_), reach, room, progress_};
    }

    void unite(const EditTool& tool, bool cut, const char* nothing) {
        const UniteOptions how = uniting(cut);
        const ToolFunction function = functionOf(tool, reachOf(how), cut);
        story_.toolVolume = function.volume();
        take(lod::unite(field_, function, how, progress_), nothing);
    }

    void make(const EditAdd& edit) {
        unite(edit.tool, false, "lies in the solid altogether; nothing would change");
    }
    void make(const EditCut& edit) { unite(edit.tool, true, "misses the solid; nothing would change"); }

    void make(const EditMove& edit) {
        requireFinite(story_.text, edit.by);
        if (edit.by == Point{})
            throw UsageError(story_.text + ": moves by nothing; --by X,Y,Z behind it says by how much");
        RegionBox moved = edit.box;
        for (std::size_t axis = 0; axis < 3; ++axis)
            moved.low[axis] += edit.by[axis], moved.high[axis] += edit.by[axis];
        UniteOptions how{true, perK_, 0};
        const ToolFunction box = functionOf(edit.box, reachOf(how), true),
                           goal = functionOf(moved, reachOf(how), false);
        const BSplineField whole = field_;
        take(lod::unite(field_, box, how, progress_), "misses the solid; nothing would change");
        const EditStory taken = story_;
        how.cut = false;
        const Change joined = lod::unite(field_, MovedPart(whole, goal, edit.by, perK_), how, progress_);
        if (joined.empty()) {
            progress_.say(story_.text + ": what is moved comes to lie in the solid altogether");
            return;
        }
        take(joined, "");
        story_.touched += taken.touched;
        story_.known += taken.known;
        story_.forgotten += taken.forgotten;
    }

    void make(const EditWith& edit) {
        Other other = otherOf(edit, field_.K, progress_);
        if (auto* pyramid = std::get_if<wavelets::Pyramid>(&other)) {
            takeWhole(std::move(*pyramid));
            return;
        }
        const BSplineField level =
            pyramid_ ? pyramid_->field(step_, progress_)
                     : wavelets::descend(field_, {.order = order_, .maxSteps = step_}, progress_).coarsest;
        const auto& after = std::get<BSplineField>(other);
        requireLattice(after, level, options_.level, story_.text);
        take(replaced(field_, level, after, order_.halvings(step_), progress_),
             "is what the level is already; nothing would change");
    }

    void takeWhole(wavelets::Pyramid other) {
        BSplineField finest = other.field(0, progress_);
        requireLattice(finest, field_, 0, story_.text);
        if (other.order != order_)
            throw InputError(story_.text,
                             "was made with other --axes than the pyramid, so its levels are others");
        if (wavelets::areSame(finest, field_))
            throw InputError(story_.text, "has the level 0 that is there already; nothing would change");
        tellBefore();
        story_.touched = countDiffering(finest, field_, 0);
        field_ = std::move(finest);
        whole_ = std::move(other);
        pyramid_ = nullptr;
    }

    // Before the first change: what makes no sense is told without that.
    void tellBefore() {
        if (!measured_) measured_ = measured(field_, progress_);
        story_.volumeBefore = measured_->volume;
        story_.partsBefore = measured_->parts;
    }

    void take(const Change& change, const char* nothing) {
        if (change.empty()) throw InputError(story_.text, nothing);
        if (story_.touched == 0) tellBefore();
        Changed changed = apply(field_, change, nearest_, progress_);
        field_ = std::move(changed.field);
        story_.touched = changed.touched;
        story_.known = changed.known;
        story_.forgotten = changed.forgotten;
        pyramid_ = nullptr;
        whole_.reset();
    }

    const EditingOptions& options_;
    StepOrder order_;
    int step_;  // of options_.level
    const Progress& progress_;
    const wavelets::Pyramid* pyramid_;  // of field_; null where that has changed
    std::optional<wavelets::Pyramid> whole_;
    BSplineField field_;
    double perK_ = 0, nearest_ = 0;
    std::optional<MeshTopology> measured_;  // of field_, but for the edit that is being made
    EditStory story_;
    std::vector<EditStory> stories_;
};

void checkOptions(const wavelets::Pyramid& pyramid, const std::vector<Edit>& edits,
                  const EditingOptions& options) {
    if (edits.empty()) throw UsageError("no edit; give --add, --cut, --move or --with");
    requirePositive("--blend", options.blend);
    requirePositive("--max-memory", options.maxMemory);
    const int last = pyramid.order.levelUpTo(pyramid.stepCount());
    if (options.level < 0 || options.level > last)
        throw UsageError(fmt::format("--level: the pyramid has levels 0 to {}, not {}", last, options.level));
    for (const Edit& edit : edits)
        if (options.blend &&
            (std::holds_alternative<EditMove>(edit) || std::holds_alternative<EditWith>(edit)))
            throw UsageError("--blend is of --add and --cut; " + textOf(edit) + " has none");
}

// What the file says of the solid that it was made of, but for what is no longer so.
Source editedSource(Source source, const std::vector<EditStory>& edits, const EditingOptions& options) {
    for (const char* key : {"input.volume", "input.parts", "input.handles", "input.cavities"})
        source.erase(key);
    std::size_t number = 0;
    while (source.contains(fmt::format("edit.{}", number))) ++number;
    for (const EditStory& edit : edits) {
        std::string text = fmt::format("{} --level {}", edit.text, options.level);
        if (options.blend) text += fmt::format(" --blend {:g}", *options.blend);
        source[fmt::format("edit.{}", number++)] = valueOf(text);
    }
    return source;
}

void checkSteps(const wavelets::Pyramid& pyramid, EditReport& report, const Progress& progress) {
    report.checkedSteps = report.closedSteps = 0;
    for (int step = 0; step <= pyramid.stepCount(); ++step) {
        const TriangleMesh mesh = polygonize(pyramid.field(step, progress), {}, progress);
        if (mesh.triangles.empty()) continue;
        const MeshTopology topology = topologyOf(mesh);
        ++*report.checkedSteps;
        *report.closedSteps += topology.closed() && topology.manifold() && topology.oriented();
    }
}

}  // namespace

std::string textOf(const Edit& edit) {
    return std::visit(
        Overloaded{
            [](const EditAdd& e) { return "--add " + textOf(e.tool); },
            [](const EditCut& e) { return "--cut " + textOf(e.tool); },
            [](const EditMove& e) { return "--move " + textOf(EditTool(e.box)) + " by " + textOf(e.by); },
            [](const EditWith& e) {
                const auto* path = std::get_if<std::filesystem::path>(&e.other);
                if (path) return "--with " + path->string();
                return std::string("--with ") +
                       (std::holds_alternative<Field>(e.other) ? "a field" : "a pyramid");
            }},
        edit);
}

}  // namespace lod

EditedPyramid edit(const Pyramid& pyramid, const std::vector<Edit>& edits, const EditingOptions& options,
                   const Progress& progress) {
    const wavelets::Pyramid& before = PyramidAccess::of(pyramid);
    lod::checkOptions(before, edits, options);
    const StageClock clock;
    lod::Editor editor(before, options, progress);
    for (const Edit& edit : edits) editor.run(edit);
    wavelets::Pyramid after = editor.pyramid();
    EditReport report;
    report.level = options.level;
    report.edits = editor.takeStories();
    if (!editor.isWhole()) after.source = lod::editedSource(before.source, report.edits, options);
    const int step = before.order.stepOf(options.level);
    if (step <= after.stepCount())
        report.touchedOfLevel =
            lod::countDiffering(before.field(step, progress), after.field(step, progress), 1e-4 * before.K);
    report.controlPoints = lod::finestControlPoints(after);
    report.steps = after.stepCount();
    if (options.checkSteps) lod::checkSteps(after, report, progress);
    report.seconds = clock.secondsSoFar();
    return {PyramidAccess::make(std::move(after)), std::move(report)};
}

}  // namespace isowave
