#include "lod/slabs/slab_task.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "wavelets/step_order.h"

namespace isowave::lod {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using openvdb::Coord;

constexpr const char* kFit = "fit";
constexpr const char* kHalve = "halve";

// ---- structs <-> JSON

Json jsonOf(const Coord& c) { return {c.x(), c.y(), c.z()}; }
Coord coordOf(const Json& j) { return {j.at(0).get<int>(), j.at(1).get<int>(), j.at(2).get<int>()}; }

// Empty boxes as null.
Json jsonOf(const openvdb::CoordBBox& box) {
    return box.empty() ? Json() : Json{jsonOf(box.min()), jsonOf(box.max())};
}
openvdb::CoordBBox boxOf(const Json& j) {
    return j.is_null() ? openvdb::CoordBBox() : openvdb::CoordBBox(coordOf(j.at(0)), coordOf(j.at(1)));
}

Json jsonOf(const AffineTransform& t) { return {{"origin", t.origin}, {"axes", t.axis}}; }
AffineTransform transformOf(const Json& j) {
    AffineTransform t;
    j.at("origin").get_to(t.origin);
    j.at("axes").get_to(t.axis);
    return t;
}

Json jsonOf(const SlabCuts& cuts) { return {{"axis", cuts.axis}, {"at", cuts.at}}; }
SlabCuts cutsOf(const Json& j) { return {j.at("axis").get<int>(), j.at("at").get<std::vector<int>>()}; }

Json jsonOf(const SlabGrid& grid) { return {jsonOf(grid.rows), jsonOf(grid.columns)}; }
SlabGrid gridOf(const Json& j) { return {cutsOf(j.at(0)), cutsOf(j.at(1))}; }

Json jsonOf(const SlabFitPlan& plan) {
    const ImageSolid& solid = plan.solid;
    const Fitting& fitting = plan.fitting;
    return {{"iso", solid.iso},
            {"invert", solid.invert},
            {"label", solid.label ? Json(*solid.label) : Json()},
            {"open_border", solid.openBorder},
            {"method", static_cast<int>(fitting.method)},
            {"half_width", fitting.distance.halfWidth},
            {"band", fitting.distance.band},
            {"cuts", jsonOf(plan.cuts)},
            {"depth", plan.depth},
            {"memory", plan.memory},
            {"index_to_world", jsonOf(plan.indexToWorld)}};
}
SlabFitPlan planOf(const Json& j) {
    SlabFitPlan plan;
    plan.solid.iso = j.at("iso").get<double>();
    plan.solid.invert = j.at("invert").get<bool>();
    if (!j.at("label").is_null()) plan.solid.label = j.at("label").get<double>();
    plan.solid.openBorder = j.at("open_border").get<bool>();
    plan.fitting.method = static_cast<FitMethod>(j.at("method").get<int>());
    plan.fitting.distance.halfWidth = j.at("half_width").get<double>();
    plan.fitting.distance.band = j.at("band").get<double>();
    plan.cuts = cutsOf(j.at("cuts"));
    plan.depth = j.at("depth").get<std::int64_t>();
    plan.memory = j.at("memory").get<double>();
    plan.indexToWorld = transformOf(j.at("index_to_world"));
    return plan;
}

Json jsonOf(const SlabHalving& halving) {
    const SlabPhase& phase = halving.phase;
    Json j{{"first", phase.first},
           {"end", phase.end},
           {"cut", phase.cut},
           {"before", jsonOf(phase.before)},
           {"after", jsonOf(phase.after)},
           {"order", wavelets::textOf(halving.order)},
           {"keep", halving.keep},
           {"origin", Json()}};
    if (halving.origin) j["origin"] = {jsonOf(halving.origin->indexToWorld), jsonOf(halving.origin->shift)};
    return j;
}
SlabHalving halvingOf(const Json& j) {
    SlabHalving halving;
    halving.phase = {j.at("first").get<int>(), j.at("end").get<int>(), j.at("cut").get<int>(),
                     gridOf(j.at("before")), gridOf(j.at("after"))};
    const auto order = j.at("order").get<std::string>();
    if (!order.empty()) halving.order = wavelets::orderOf(order).value();
    halving.keep = j.at("keep").get<bool>();
    if (const Json& origin = j.at("origin"); !origin.is_null())
        halving.origin = {transformOf(origin.at(0)), coordOf(origin.at(1))};
    return halving;
}

Json jsonOf(const SlabFitted& told) {
    return {{"repaired", told.repair.repaired},
            {"lattice_points", told.repair.latticePoints},
            {"disagreeing", told.repair.disagreeing},
            {"control_points", told.extent.controlPoints},
            {"known", jsonOf(told.extent.box)},
            {"inside", told.inside},
            {"outside", told.outside},
            {"bytes_lacking", told.bytesLacking},
            {"K", told.K}};
}
SlabFitted fittedOf(const Json& j) {
    SlabFitted told;
    j.at("repaired").get_to(told.repair.repaired);
    j.at("lattice_points").get_to(told.repair.latticePoints);
    j.at("disagreeing").get_to(told.repair.disagreeing);
    j.at("control_points").get_to(told.extent.controlPoints);
    told.extent.box = boxOf(j.at("known"));
    j.at("inside").get_to(told.inside);
    j.at("outside").get_to(told.outside);
    j.at("bytes_lacking").get_to(told.bytesLacking);
    j.at("K").get_to(told.K);
    return told;
}

Json jsonOf(const SlabHalved& told) {
    Json extents = Json::array();
    for (const auto& extent : told.extents) extents.push_back(Json{extent.controlPoints, jsonOf(extent.box)});
    return {{"details", told.details}, {"extents", extents}};
}
SlabHalved halvedOf(const Json& j) {
    SlabHalved told;
    j.at("details").get_to(told.details);
    for (const Json& extent : j.at("extents"))
        told.extents.push_back({extent.at(0).get<std::int64_t>(), boxOf(extent.at(1))});
    return told;
}

// ---- tasks

std::string taskOf(const SlabJob& job, const char* kind, int slab, const Json& what) {
    return Json{{"task", kind},       {"folder", job.folder.string()},
                {"image", job.image}, {"mask", job.mask},
                {"slab", slab},       {"what", what}}
        .dump();
}

Json parsed(const std::string& text, const char* what) {
    Json json = Json::parse(text, nullptr, false);
    if (!json.is_object())
        throw InputError(what,
                         "is not what a task of a job in slabs tells; all workers need one version of "
                         "isowave");
    return json;
}

template <class Told, class Of>
std::vector<Told> toldBy(const std::vector<std::string>& texts, std::size_t wanted, const Of& of) {
    if (texts.size() != wanted)
        throw OperationError("slabs",
                             fmt::format("{} tasks were given away and {} came back", wanted, texts.size()));
    std::vector<Told> told;
    for (const std::string& text : texts) {
        try {
            told.push_back(of(parsed(text, "slabs")));
        } catch (const Json::exception&) {
            throw InputError("slabs",
                             "a worker's answer lacks a part; all workers need one version of isowave");
        }
    }
    return told;
}

std::optional<std::string> toldBefore(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    return std::string(std::istreambuf_iterator<char>(file), {});
}

void tell(const fs::path& path, const std::string& text) {
    AtomicFile file(path);
    file.stream() << text;
    file.commit();
}

}  // namespace

std::string jobText(const SlabJob& job, const SlabFitPlan& plan) {
    return Json{{"image", job.image}, {"mask", job.mask}, {"plan", jsonOf(plan)}}.dump();
}

std::string fitTask(const SlabJob& job, const SlabFitPlan& plan, int slab, int passes) {
    return taskOf(job, kFit, slab, {{"plan", jsonOf(plan)}, {"passes", passes}});
}
std::string halveTask(const SlabJob& job, const SlabHalving& halving, int slab) {
    return taskOf(job, kHalve, slab, jsonOf(halving));
}

std::vector<SlabFitted> fittedOf(const std::vector<std::string>& told, std::size_t wanted) {
    return toldBy<SlabFitted>(told, wanted, [](const Json& j) { return fittedOf(j); });
}
std::vector<SlabHalved> halvedOf(const std::vector<std::string>& told, std::size_t wanted) {
    return toldBy<SlabHalved>(told, wanted, [](const Json& j) { return halvedOf(j); });
}

std::string runSlabTask(const fs::path& path, const ImageReadOptions& options, const std::string& text,
                        const Progress& progress) {
    const Json task = parsed(text, "task");
    try {
        const SlabStore store(task.at("folder").get<std::string>());
        const fs::path told = store.toldPath(text);
        if (const auto before = toldBefore(told)) return *before;
        const int slab = task.at("slab").get<int>();
        const Json& what = task.at("what");
        std::string result;
        if (task.at("task").get<std::string>() == kFit) {
            ImageStream stream(path, options);
            if (auto mask = task.at("mask").get<std::vector<float>>(); !mask.empty())
                stream.takeAsMask(std::move(mask));
            result = jsonOf(fitSlab(store, stream, planOf(what.at("plan")), slab,
                                    what.at("passes").get<int>(), progress))
                         .dump();
        } else {
            result = jsonOf(halveSlab(store, halvingOf(what), slab, progress)).dump();
        }
        tell(told, result);
        return result;
    } catch (const Json::exception&) {
        throw InputError("task", "lacks a part; all workers need one version of isowave");
    }
}

}  // namespace isowave::lod
