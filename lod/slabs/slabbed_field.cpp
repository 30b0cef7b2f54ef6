#include "lod/slabs/slabbed_field.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "base/number_text.h"
#include "isowave/error.h"

namespace isowave::lod {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kWhole =
    20'000;  // control points that are no trouble to anybody; a step leaves half of them at least

SlabCuts moved(SlabCuts cuts, const openvdb::Coord& shift) {
    for (int& cut : cuts.at) cut += shift[cuts.axis];
    return cuts;
}

// Of the repair: as many as the slabs turned out to need.
template <class FitAll>
FitReport withEnoughPasses(int first, const FitAll& fitAll) {
    for (int passes = first;; passes = std::max(16, 2 * passes))
        if (const std::optional<FitReport> report = fitAll(passes)) return *report;
}

}  // namespace

SlabFolder::SlabFolder(const fs::path& in) {
    static std::atomic<int> next{0};
    std::error_code error;
    fs::create_directories(in, error);
    do {
        path_ = in / fmt::format(".isowave-slabs-{}-{}", ::getpid(), next++);
    } while (!fs::create_directory(path_, error) && !error);
    if (error)
        throw OperationError(path_.string(), "cannot be made (" + error.message() +
                                                 "); slabs are kept there until the job is done");
}

SlabFolder::~SlabFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
}

SlabbedField::SlabbedField(ImageStream stream, const SlabFitPlan& plan, const SlabWork& work,
                           const Progress& progress)
    : plan_(plan),
      hidden_(work.map ? std::optional<SlabFolder>() : std::optional<SlabFolder>(std::in_place, work.folder)),
      store_(hidden_ ? hidden_->path() : work.folder),
      allowWhole_(work.allowWhole) {
    const auto ySize = stream.header().size[1];
    if (work.map)
        workers_ = std::make_unique<SlabsByMap>(work.map, SlabJob{work.folder, work.image, work.mask});
    else
        workers_ = std::make_unique<SlabsInTurn>(std::move(stream), store_);
    std::vector<SlabFitted> slabs;
    report_ = withEnoughPasses(workers_->firstPasses(), [&](int passes) {
        slabs = fitSlabs(passes, work.name, progress);
        return reportOf(slabs, plan_, passes);
    });
    workers_->endFit();
    for (const SlabFitted& slab : slabs) {
        inside_ += slab.inside;
        outside_ |= slab.outside;
        extent_.add(slab.extent);
        K_ = slab.K;
    }
    origin_ = {plan_.indexToWorld, shiftOf(slabs)};
    transform_ = origin_.transform();
    extent_.box.translate(origin_.shift);
    grid_ = {moved(plan_.cuts, origin_.shift),
             moved(SlabCuts::even(1, ySize, plan_.cuts.count()), origin_.shift)};
}

std::vector<SlabFitted> SlabbedField::fitSlabs(int passes, const std::string& image,
                                               const Progress& progress) {
    while (true) {
        std::vector<SlabFitted> slabs = workers_->fit(plan_, passes, progress);
        std::optional<SlabCuts> cuts = thinner(slabs, plan_, passes, image);
        if (!cuts) return slabs;
        progress.say(fmt::format(
            "{}: {} slabs instead of {}, each of which would take more than {} of memory beside the program",
            image, cuts->count(), plan_.cuts.count(), bytesText(plan_.memory)));
        plan_.cuts = std::move(*cuts);
    }
}

bool SlabbedField::hasSurface() const { return inside_ > 0 && outside_ && extent_.controlPoints > 0; }

BSplineField SlabbedField::part(int slab) const { return fittedPart(store_, slab, origin_); }

BSplineField SlabbedField::whole() const {
    if (allowWhole_) allowWhole_(report_.latticePoints);
    std::vector<BSplineField> parts;
    for (int slab = 0; slab < slabs(); ++slab) parts.push_back(part(slab));
    return joinedField(parts);
}

struct SlabbedField::Reached {
    wavelets::Halved halved;
    wavelets::FieldExtent extent;
    std::vector<std::int64_t> details;  // by step
    std::vector<int> slabs;             // that each step was made in
    BSplineField field;

    std::int64_t detailsStored() const {
        return std::accumulate(details.begin(), details.end(), std::int64_t{0});
    }
};

SlabbedField::Reached SlabbedField::descendInSlabs(
    const wavelets::AnalyseOptions& options, const std::function<bool(int)>& isAskedFor,
    const std::function<void(int, const BSplineField&)>& onStep, bool keep, const Progress& progress) const {
    Reached reached;
    reached.extent = extent_;
    SlabGrid grid = grid_;
    bool inColumns = false;  // else: as it was fitted
    const auto whole = [&] {
        return inColumns ? wholeField(store_, reached.halved.step, grid) : this->whole();
    };
    if (onStep && isAskedFor(0)) onStep(0, whole());
    const auto isEnd = [&](int step) { return isAskedFor(step) || step >= options.maxSteps; };
    while (reached.halved.step < options.maxSteps && reached.extent.controlPoints > kWhole &&
           (grid.rows.count() > 1 || grid.columns.count() > 1)) {
        const SlabPhase phase = phaseFrom(reached.halved.step, options.order, grid, isEnd);
        if (!inColumns && phase.cut != 2) {
            for (int slab = 0; slab < slabs(); ++slab) putColumns(store_, 0, slab, part(slab), grid);
            inColumns = true;
        }
        const auto steps = static_cast<std::size_t>(phase.end - phase.first);
        std::vector<wavelets::FieldExtent> extents(steps);
        std::vector<std::int64_t> details(steps);
        const SlabHalving halving{phase, options.order, keep,
                                  inColumns ? std::nullopt : std::optional<SlabOrigin>(origin_)};
        for (const SlabHalved& told : workers_->halve(halving, progress))
            for (std::size_t s = 0; s < steps; ++s) {
                extents[s].add(told.extents[s]);
                details[s] += told.details[s];
            }
        if (hidden_ && inColumns) forget(phase.first, grid);
        for (std::size_t s = 0; s < steps; ++s) {
            const int axis = options.order.axisAfter(reached.halved.step);
            reached.halved = wavelets::halvedAlong(axis, reached.halved, reached.extent, extents[s]);
            reached.extent = extents[s];
            reached.details.push_back(details[s]);
            reached.slabs.push_back(phase.slabs());
        }
        grid = phase.after;
        inColumns = true;
        if (onStep && isAskedFor(phase.end)) onStep(phase.end, whole());
    }
    reached.field = whole();
    return reached;
}

// Of a folder that others see nothing goes: a job that begins again goes on from any phase, be it of steps that end elsewhere.
void SlabbedField::forget(int step, const SlabGrid& grid) const {
    for (int row = 0; row < grid.rows.count(); ++row)
        for (int column = 0; column < grid.columns.count(); ++column) store_.forgetField(step, row, column);
}

wavelets::Descent SlabbedField::descend(const wavelets::AnalyseOptions& options,
                                        const std::function<bool(int step)>& isAskedFor,
                                        const std::function<void(int step, const BSplineField&)>& onStep,
                                        const Progress& progress) const {
    Reached reached = descendInSlabs(options, isAskedFor, onStep, false, progress);
    wavelets::AnalyseOptions rest = options;
    rest.from = reached.halved;
    const int here = reached.halved.step;
    wavelets::Descent descent =
        wavelets::descend(std::move(reached.field), rest, progress, [&](int step, const BSplineField& field) {
            if (onStep && step != here) onStep(step, field);
        });
    descent.coefficientsStored += reached.detailsStored();
    return descent;
}

SlabbedField::Apart SlabbedField::takeApart(const StepOrder& order, const Progress& progress) const {
    const Reached reached = descendInSlabs(
        {.order = order}, [](int) { return false; }, {}, true, progress);
    Apart apart{wavelets::analyse(reached.field, {.order = order, .from = reached.halved}, progress),
                reached.slabs, reached.detailsStored()};
    apart.stored += apart.pyramid.coefficientsStored();
    std::vector<wavelets::Step> steps;
    for (int step = 0; step < reached.halved.step; ++step)
        steps.push_back({order.axisAfter(step), nullptr, nullptr});
    steps.insert(steps.end(), apart.pyramid.steps.begin(), apart.pyramid.steps.end());
    apart.pyramid.steps = std::move(steps);
    return apart;
}

wavelets::StepSource SlabbedField::stepsOf(const Apart& apart) const {
    const auto slabsOf = [&apart](int step) { return apart.slabs[static_cast<std::size_t>(step)]; };
    return {[this, slabsOf](int step) {
                std::vector<Shape::Ptr> shapes;
                for (int slab = 0; slab < slabsOf(step); ++slab) shapes.push_back(store_.shape(step, slab));
                return joinedShape(shapes);
            },
            [this, slabsOf](int step) {
                return joinedDetails(slabsOf(step), [&](int slab) { return store_.details(step, slab); });
            }};
}

wavelets::Pyramid SlabbedField::analyse(const StepOrder& order, const Progress& progress) const {
    Apart apart = takeApart(order, progress);
    const wavelets::StepSource lacking = stepsOf(apart);
    for (std::size_t step = 0; step < apart.slabs.size(); ++step) {
        apart.pyramid.steps[step].shape = lacking.shape(static_cast<int>(step));
        apart.pyramid.steps[step].details = lacking.details(static_cast<int>(step));
    }
    return std::move(apart.pyramid);
}

PyramidCounts SlabbedField::analyseTo(const fs::path& path, const StepOrder& order,
                                      std::map<std::string, std::string> source,
                                      const Progress& progress) const {
    Apart apart = takeApart(order, progress);
    apart.pyramid.source = std::move(source);
    progress("writing", 0);
    wavelets::writePyramid(path, apart.pyramid, stepsOf(apart));
    return {apart.pyramid.stepCount(), extent_.controlPoints, apart.stored};
}

}  // namespace isowave::lod
