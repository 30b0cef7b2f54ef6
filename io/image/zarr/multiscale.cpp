#include "io/image/zarr/multiscale.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "io/image/check.h"
#include "io/image/zarr/json_file.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

bool has(const fs::path& folder, const char* name) {
    std::error_code ignored;
    return fs::is_regular_file(folder / name, ignored);
}

// "scan.zarr", without a slash behind it, so that it has a parent.
fs::path tidy(const fs::path& path) {
    const fs::path normal = path.lexically_normal();
    return normal.has_filename() ? normal : normal.parent_path();
}

// The key of a JSON object, null where there is none.
const json& at(const json& object, const char* key) {
    static const json nothing;
    if (!object.is_object()) return nothing;
    const auto found = object.find(key);
    return found == object.end() ? nothing : *found;
}

std::string textOf(const json& value) { return value.is_string() ? value.get<std::string>() : ""; }

ZarrAxis axisNamed(const std::string& name, const std::string& unit) {
    ZarrAxis axis;
    if (name.size() == 1 && std::string("xyztc").find(name[0]) != std::string::npos) axis.name = name[0];
    axis.unit = unit;
    return axis;
}

// One entry of "multiscales", with the file that it stands in.
class Multiscale {
  public:
    Multiscale(fs::path folder, json entry) : folder_(std::move(folder)), entry_(std::move(entry)) {}

    std::vector<std::string> paths() const {
        std::vector<std::string> all;
        const json& datasets = at(entry_, "datasets");
        for (const json& dataset : datasets.is_array() ? datasets : json::array())
            all.push_back(textOf(at(dataset, "path")));
        if (all.empty() || std::find(all.begin(), all.end(), "") != all.end())
            refuse("has no datasets with a path");
        for (const std::string& path : all)
            if (leavesTheStore(path))
                refuse("has the dataset " + path +
                       ", which is not in the store; expected a name beside .zattrs");
        return all;
    }

    ZarrChoice choose(std::size_t dataset) const {
        const std::vector<std::string> names = paths();
        ZarrChoice choice;
        choice.array = folder_ / names[dataset];
        choice.isOme = true;
        choice.axes = axes();
        choice.placed =
            transform(at(at(entry_, "datasets")[dataset], "coordinateTransformations"), choice.axes);
        choice.placed |= transform(at(entry_, "coordinateTransformations"), choice.axes);
        for (std::size_t i = 0; i < names.size(); ++i)
            if (i != dataset) choice.others += (choice.others.empty() ? "" : ", ") + names[i];
        return choice;
    }

  private:
    static bool leavesTheStore(const fs::path& path) {
        return path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
    }
    [[noreturn]] void refuse(const std::string& what) const {
        throw InputError((folder_ / ".zattrs").string(), "its multiscales " + what);
    }

    // 0.4: objects; 0.3: names; before that t, c, z, y, x.
    std::vector<ZarrAxis> axes() const {
        std::vector<ZarrAxis> all;
        const json& named = at(entry_, "axes");
        if (named.is_null())
            for (const char* name : {"t", "c", "z", "y", "x"}) all.push_back(axisNamed(name, ""));
        for (const json& axis : named.is_array() ? named : json::array())
            all.push_back(axisNamed(axis.is_string() ? textOf(axis) : textOf(at(axis, "name")),
                                    textOf(at(axis, "unit"))));
        if (all.empty()) refuse("has axes " + oneLine(named.dump()) + "; expected a list");
        return all;
    }

    // Each transformation after the one before it. Returns whether there is a scale.
    bool transform(const json& steps, std::vector<ZarrAxis>& axes) const {
        bool scaled = false;
        for (const json& step : steps.is_array() ? steps : json::array()) {
            const std::string type = textOf(at(step, "type"));
            if (type == "identity") continue;
            if (type != "scale" && type != "translation")
                refuse("has the transformation " + oneLine(step.dump()) + "; expected scale or translation");
            const json& numbers = at(step, type.c_str());
            const auto isNumber = [](const json& n) {
                return n.is_number() && std::isfinite(n.get<double>());
            };
            if (!numbers.is_array() || numbers.size() != axes.size() ||
                !std::all_of(numbers.begin(), numbers.end(), isNumber))
                refuse(fmt::format("has the {} {}; expected {} numbers, one an axis", type,
                                   oneLine(numbers.dump()), axes.size()));
            for (std::size_t a = 0; a < axes.size(); ++a) {
                const auto number = numbers[a].get<double>();
                if (type == "translation")
                    axes[a].translation += number;
                else
                    axes[a].scale *= number, axes[a].translation *= number;
            }
            scaled |= type == "scale";
        }
        return scaled;
    }

    fs::path folder_;
    json entry_;
};

std::optional<Multiscale> multiscaleOf(const fs::path& folder) {
    if (!has(folder, ".zattrs")) return std::nullopt;
    const json all = at(readJsonObject(folder / ".zattrs"), "multiscales");
    if (!all.is_array() || all.empty()) return std::nullopt;
    return Multiscale(folder, all[0]);
}

// The image that an array is a resolution of: its own folder's, or one above.
std::optional<ZarrChoice> choiceOfParents(const fs::path& array) {
    constexpr int kDeepest = 3;  // "scale0/image" is one
    fs::path folder = array.parent_path();
    for (int depth = 0; depth < kDeepest; ++depth, folder = folder.parent_path()) {
        const auto image = multiscaleOf(folder.empty() ? "." : folder);
        if (image) {
            const std::vector<std::string> paths = image->paths();
            const auto found = std::find(paths.begin(), paths.end(),
                                         array.lexically_relative(folder.empty() ? "." : folder));
            if (found != paths.end()) return image->choose(static_cast<std::size_t>(found - paths.begin()));
        }
        if (folder.empty() || folder == folder.parent_path()) break;
    }
    return std::nullopt;
}

// xarray's names of an array's axes.
std::vector<ZarrAxis> axesOfArray(const fs::path& array) {
    std::vector<ZarrAxis> axes;
    if (!has(array, ".zattrs")) return axes;
    const json names = at(readJsonObject(array / ".zattrs"), "_ARRAY_DIMENSIONS");
    for (const json& name : names.is_array() ? names : json::array())
        axes.push_back(axisNamed(textOf(name), ""));
    return axes;
}

[[noreturn]] void refuseGroup(const fs::path& group) {
    std::vector<std::string> parts;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(group, ignored))
        if (isZarr(entry.path())) parts.push_back(entry.path().filename().string());
    std::sort(parts.begin(), parts.end());
    if (parts.empty()) throw InputError(group.string(), "is a Zarr group without arrays; expected an image");
    constexpr std::size_t kShown = 12;
    const std::size_t shown = std::min(parts.size(), kShown);
    throw InputError(
        group.string(),
        fmt::format("is a Zarr group of {}{}; choose one: {}",
                    fmt::join(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                    shown < parts.size() ? ", ..." : "", (group / parts[0]).string()));
}

}  // namespace

bool isZarr(const fs::path& folder) {
    return has(folder, ".zarray") || has(folder, ".zgroup") || has(folder, "zarr.json");
}

ZarrChoice chooseZarrArray(const fs::path& path) {
    const fs::path folder = tidy(path);
    if (has(folder, "zarr.json"))
        throw InputError(path.string(),
                         "is Zarr of version 3; version 2 is read. In Python, zarr 3: "
                         "zarr.save_array('out.zarr', zarr.open_array('ARRAY')[:], zarr_format=2)");
    if (has(folder, ".zarray")) {
        if (auto choice = choiceOfParents(folder)) return *choice;
        ZarrChoice choice;
        choice.array = folder;
        choice.axes = axesOfArray(folder);
        return choice;
    }
    if (const auto image = multiscaleOf(folder)) return image->choose(0);
    refuseGroup(folder);
}

}  // namespace isowave::imageio
