#include "python/native/curves.h"

#include <memory>

#include "isowave/curves.h"
#include "isowave/error.h"
#include "python/native/options.h"
#include "python/native/watch.h"
#include "tools/curves/curve_options.h"
#include "tools/output.h"
#include "tools/report/curves.h"

namespace isowave::python {
namespace {

using namespace curves2d;

struct Choices : tools::CurveOptions {
    explicit Choices(const GivenOptions& given) {
        tools::OptionList options;
        declareAll(options);
        take(given, options);
    }
    void declareAll(tools::OptionList& options) {
        declareLevels(options);
        declareDrawing(options);
        declareInput(options);
        declareFit(options);
        declareEdits(options);
        declarePyramid(options);
    }
};

// One step as it is kept.
struct KeptCurves {
    std::string name;
    int step = 0;
    DrawnCurves drawn;
};

struct MadeCurves {
    View view;
    std::vector<KeptCurves> levels;
    std::vector<Panel> panels;
    tools::CurvesReport report;
};
using CurvesPointer = std::shared_ptr<MadeCurves>;

void visit(const LadderStep& step, const Choices& choices, MadeCurves& made) {
    if (choices.isWanted(step) && !step.curves().rings.empty()) {
        made.levels.push_back({step.name(), step.facts().step, step.drawn(choices.draw)});
        made.panels.push_back(step.panel(made.view));
        if (const auto& smooth = made.levels.back().drawn.smooth) {
            made.report.deviation = std::max(made.report.deviation, smooth->deviation / made.report.pixel);
            made.report.straightPieces += smooth->straightPieces;
        }
    }
    made.report.steps.push_back({step.facts(), {}});
}

CurvesPointer climb(Input input, const std::string& name, const Choices& choices, const Progress& progress) {
    auto made = std::make_shared<MadeCurves>();
    for (const std::string& remark : input.remarks) progress.say(remark);
    for (const std::string& remark : choices.remarks()) progress.say(remark);
    std::optional<tools::ResultFile> pyramid;
    if (choices.pyramid) {
        tools::Inputs(choices.inputs(name)).refuse(*choices.pyramid);
        pyramid.emplace(*choices.pyramid);
    }
    input = choices.prepared(std::move(input), progress);
    if (pyramid) pyramid->write(pyramidBytes(input));
    made->view = viewOf(input);
    made->report.path = name;
    made->report.kind = input.kind;
    made->report.pixel = input.pixel;
    made->report.hold = choices.hold;
    made->report.smooth = choices.draw.smooth;
    made->report.ladder = makeLadder(
        std::move(input), choices.ladder(), [&](const LadderStep& step) { visit(step, choices, *made); },
        progress);
    for (const std::string& remark : tools::fitRemarks(made->report.ladder.fitReport)) progress.say(remark);
    tools::requireFirstLevel(choices, made->report.ladder, name);
    if (pyramid) pyramid->commit();
    return made;
}

CurvesPointer ofFile(const std::filesystem::path& path, const GivenOptions& given, const py::object& watch) {
    const Choices choices(given);
    choices.ladder();
    choices.refuseForeign(path.string(), tools::curveInputOf(path));
    return watched(watch, [&](const Progress& progress) {
        return climb(readInput(path, choices.input(), progress), path.string(), choices, progress);
    });
}

// values: (rows, columns), row 0 at the top.
CurvesPointer ofPicture(const py::array_t<float, py::array::c_style | py::array::forcecast>& values,
                        const GivenOptions& given, const py::object& watch) {
    const Choices choices(given);
    choices.ladder();
    choices.refuseForeign("picture", tools::CurveInput::image);
    const auto rows = static_cast<std::int32_t>(values.shape(0)),
               columns = static_cast<std::int32_t>(values.shape(1));
    std::vector<float> copy(values.data(), values.data() + values.size());
    return watched(watch, [&](const Progress& progress) {
        return climb(pictureInput(columns, rows, std::move(copy), choices.input()), "picture", choices,
                     progress);
    });
}

using Ring2 = py::array_t<double, py::array::c_style | py::array::forcecast>;

CurvesPointer ofPolygons(const std::vector<std::vector<Ring2>>& polygons, const GivenOptions& given,
                         const py::object& watch) {
    const Choices choices(given);
    choices.ladder();
    choices.refuseForeign("polygons", tools::CurveInput::polygons);
    std::vector<Polygon> taken;
    for (const auto& rings : polygons) {
        Polygon& polygon = taken.emplace_back();
        for (const Ring2& ring : rings) {
            Ring& points = polygon.rings.emplace_back();
            for (py::ssize_t i = 0; i < ring.shape(0); ++i) points.push_back({ring.at(i, 0), ring.at(i, 1)});
        }
    }
    return watched(watch, [&](const Progress& progress) {
        return climb(polygonInput(taken, choices.input(), progress), "polygons", choices, progress);
    });
}

// (points (N, 2), parent, hole) for each ring.
py::list ringsOf(const MadeCurves& made, std::size_t i) {
    const Curves& curves = made.levels.at(i).drawn.curves;
    py::list list;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const Ring points = curves.world(r);
        py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t(2)});
        std::memcpy(array.mutable_data(), points.data(), points.size() * sizeof(curves2d::Point));
        list.append(py::make_tuple(array, curves.rings[r].parent, curves.rings[r].hole));
    }
    return list;
}

// A level in a format of the command: svg, geojson, txt.
std::string textOf(const MadeCurves& made, std::size_t i, const std::string& format) {
    const KeptCurves& kept = made.levels.at(i);
    if (format == "svg") return svg(kept.drawn, made.view);
    if (format == "geojson") return geojson(kept.drawn.curves, kept.name);
    if (format == "txt") return gmtText(kept.drawn.curves);
    throw UsageError("--format: '" + format + "' is not one of svg, geojson, txt");
}

// A file that appears whole or not at all.
void writeText(const std::filesystem::path& path, const std::string& text) {
    const py::gil_scoped_release release;
    tools::ResultFile file(path);
    file.write(text);
    file.commit();
}

std::vector<std::string> optionNames() {
    Choices choices({});
    tools::OptionList options;
    choices.declareAll(options);
    return namesOf(options);
}

}  // namespace

void bindCurves(py::module_& module) {
    py::class_<MadeCurves, CurvesPointer>(module, "Curves")
        .def("__len__", [](const MadeCurves& made) { return made.levels.size(); })
        .def("step", [](const MadeCurves& made, std::size_t i) { return made.levels.at(i).step; })
        .def("rings", ringsOf)
        .def("text", textOf)
        .def("sheet", [](const MadeCurves& made) { return sheetOf(made.panels, made.view); })
        .def("report", [](const MadeCurves& made) { return tools::jsonOf(made.report); });
    module.def("curves_of_file", ofFile);
    module.def("curves_of_picture", ofPicture);
    module.def("curves_of_polygons", ofPolygons);
    module.def("curve_option_names", optionNames);
    module.def("write_text", writeText);
}

}  // namespace isowave::python
