#include "python/native/edits.h"

#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "python/native/arrays.h"
#include "python/native/options.h"
#include "python/native/watch.h"
#include "tools/report/edit_report.h"
#include "tools/solids/edit_options.h"

namespace isowave::python {
namespace {

// Edits in the order in which they are given. Texts are taken by the command's own table.
class Edits {
  public:
    Edits() = default;

    void option(const std::string& name, const std::string& value) {
        tools::OptionList options;
        choices_.declare(options);
        take({{name, value}}, options);
    }
    void addFile(const std::filesystem::path& path) { choices_.edits.push_back(EditAdd{path}); }
    void cutFile(const std::filesystem::path& path) { choices_.edits.push_back(EditCut{path}); }
    void addMesh(const PointArray& points, const IndexArray& triangles) {
        choices_.edits.push_back(EditAdd{meshOf(points, triangles, "mesh")});
    }
    void cutMesh(const PointArray& points, const IndexArray& triangles) {
        choices_.edits.push_back(EditCut{meshOf(points, triangles, "mesh")});
    }
    void withFile(const std::filesystem::path& path) { choices_.edits.push_back(EditWith{path}); }
    void withField(const Field& field) { choices_.edits.push_back(EditWith{field}); }
    void withPyramid(const Pyramid& pyramid) { choices_.edits.push_back(EditWith{pyramid}); }

    const tools::EditChoices& choices() const { return choices_; }

  private:
    tools::EditChoices choices_;
};

// The new pyramid, and what `isowave edit --json` tells.
py::tuple edited(const Pyramid& pyramid, const Edits& edits, const py::object& watch) {
    tools::EditTale tale;
    const Pyramid result = watched(watch, [&](const Progress& progress) {
        Progress telling = progress;
        telling.remark = [&](std::string_view line) {
            tale.remarks.emplace_back(line);
            progress.say(line);
        };
        EditedPyramid made = edit(pyramid, edits.choices().edits, edits.choices().how, telling);
        tale.report = std::move(made.report);
        return std::move(made.pyramid);
    });
    return py::make_tuple(result, tools::jsonOf(tale));
}

std::vector<std::string> optionNames() {
    tools::EditChoices choices;
    tools::OptionList options;
    choices.declare(options);
    return namesOf(options);
}

}  // namespace

void bindEdits(py::module_& module) {
    py::class_<Edits>(module, "Edits")
        .def(py::init<>())
        .def("option", &Edits::option)
        .def("add_file", &Edits::addFile)
        .def("cut_file", &Edits::cutFile)
        .def("add_mesh", &Edits::addMesh)
        .def("cut_mesh", &Edits::cutMesh)
        .def("with_file", &Edits::withFile)
        .def("with_field", &Edits::withField)
        .def("with_pyramid", &Edits::withPyramid);
    module.def("edit", edited);
    module.def("edit_option_names", optionNames);
}

}  // namespace isowave::python
