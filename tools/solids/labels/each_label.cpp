#include "tools/solids/labels/each_label.h"

#include <fmt/format.h>

#include <set>

#include "io/image/segments.h"
#include "isowave/error.h"
#include "lod/open_image.h"
#include "lod/source.h"
#include "tools/report/json.h"

namespace isowave::tools {
namespace {

// What the file calls the label. Of several volumes only the chosen one has it.
const imageio::ImageSegment* segmentOf(const std::vector<imageio::ImageSegment>& segments, double label,
                                       const SolidOptions& options) {
    for (const imageio::ImageSegment& segment : segments) {
        const bool isThere = !options.image.volume || segment.layer + 1 == *options.image.volume;
        if (segment.label == label && isThere) return &segment;
    }
    return nullptr;
}

std::vector<double> askedLabels(const std::filesystem::path& input, const SolidOptions& options,
                                const Progress& progress) {
    if (!options.labels.empty()) return options.labels;
    if (options.label) return {*options.label};
    return lod::labelsIn(input, options, progress);
}

SolidOptions ofLabel(SolidOptions options, double label) {
    options.label = label;
    options.labels.clear();
    return options;
}

std::string unitShown(const Solid& solid) {
    const std::string unit = lod::unitOf(solid.input());
    return unit.empty() ? "" : " [" + unit + "]";
}

// What is said of the image is the same for every label, and is said once.
Progress onceOf(const Progress& progress, std::set<std::string>& said) {
    Progress once = progress;
    once.remark = [&progress, &said](std::string_view line) {
        if (said.insert(std::string(line)).second) progress.say(line);
    };
    return once;
}

// Remarks begin with the label's name.
Progress ofLabel(const Progress& progress, const std::string& name) {
    Progress named = progress;
    named.remark = [&progress, name](std::string_view line) {
        progress.say(fmt::format("{}: {}", name, line));
    };
    return named;
}

}  // namespace

void LabelChoice::declare(OptionList& options) {
    options.flag("--each-label",
                 "label images: every label of --label, else every one but 0, is a solid of its own, and an "
                 "object with its name and colour in the one file of each level (--format 3mf)",
                 each);
}

void LabelChoice::check(MeshFormat format, const BudgetOptions& budgets, bool view, bool lods,
                        bool tiles) const {
    if (!each) return;
    if (format != MeshFormat::threeMf)
        throw UsageError(
            fmt::format("--each-label makes an object of each label, which {} files have not; give --format "
                        "3mf",
                        extensionOf(format) + 1));
    if (budgets.any()) throw UsageError("--each-label and budgets exclude each other; give one of them");
    const char* const other = view ? "--view" : lods ? "--glb-lods" : tiles ? "--tiles" : nullptr;
    if (other)
        throw UsageError(fmt::format(
            "{} shows one solid, and with --each-label there are several; give one of them", other));
}

std::vector<NamedLabel> namedLabels(const std::filesystem::path& input, const SolidOptions& options,
                                    const Progress& progress) {
    const std::vector<imageio::ImageSegment> segments = imageio::segmentsOf(input);
    std::vector<NamedLabel> labels;
    for (const double label : askedLabels(input, options, progress)) {
        NamedLabel named{label, fmt::format("label {}", label), modelColour(labels.size())};
        if (const auto* segment = segmentOf(segments, label, options)) {
            if (!segment->name.empty()) named.name = segment->name;
            named.colour = segment->colour.value_or(named.colour);
        }
        labels.push_back(std::move(named));
    }
    return labels;
}

LabelLadders makeEachLabel(const std::filesystem::path& input, const SolidOptions& solid,
                           const LevelOptions& levels, const MeshNames& names,
                           const std::function<MeshWriteOptions(const Solid&)>& options,
                           const std::function<std::filesystem::path(const std::string&)>& place,
                           const Progress& progress) {
    LabelLadders made;
    made.labels = namedLabels(input, solid, progress);
    std::map<int, std::vector<ModelObject>> objects;  // by step: a level of all labels is one file
    std::map<int, std::string> fileOf;
    MeshWriteOptions writing;
    std::set<std::string> said;
    for (const NamedLabel& label : made.labels) {
        Solid one = open(input, ofLabel(solid, label.label), onceOf(progress, said));
        writing = options(one);
        made.unit = unitShown(one);
        LadderFiles& files = made.files.emplace_back();
        const auto level = [&](const LevelReport& report, const TriangleMesh& mesh) {
            files.levels.push_back(names.ofLevel(report));
            fileOf[report.step] = files.levels.back();
            objects[report.step].push_back({label.name, label.colour, mesh});
        };
        made.ladders.push_back(
            makeLadder(std::move(one), levels, {.level = level}, ofLabel(progress, label.name)));
    }
    for (const auto& [step, all] : objects) {
        made.written.push_back(fileOf[step]);
        writeThreeMfObjects(place(fileOf[step]), all, writing);
    }
    return made;
}

std::string jsonOf(const LabelLadders& made) {
    Json report;
    report["version"] = 1;
    report["files"] = made.written;
    report["labels"] = Json::array();
    for (std::size_t i = 0; i < made.labels.size(); ++i)
        report["labels"].push_back({{"label", made.labels[i].label},
                                    {"name", made.labels[i].name},
                                    {"colour", isowave::textOf(made.labels[i].colour)},
                                    {"report", Json::parse(jsonOf(made.ladders[i], made.files[i]))}});
    return dumped(report);
}

std::string textOf(const LabelLadders& made) {
    std::string text;
    for (std::size_t i = 0; i < made.labels.size(); ++i) {
        const auto& [label, name, colour] = made.labels[i];
        const std::string number = fmt::format("label {}", label);
        text += fmt::format("{}{}:\n{}", i == 0 ? "" : "\n",
                            name == number ? name : fmt::format("{} ({})", name, number),
                            textOf(made.ladders[i], made.files[i], made.unit));
    }
    return text;
}

}  // namespace isowave::tools
