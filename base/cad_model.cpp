#include "base/cad_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>

#include "base/text.h"

namespace isowave {
namespace fs = std::filesystem;
namespace {

enum class CadKind { none, step, iges, brep, freeCad };

struct CadFormat {
    CadKind kind;
    const char* name;
    const char* extensions;  // a blank before and behind each; gmsh goes by them
    const char* extension;   // the first of them
};
constexpr CadFormat kFormats[] = {
    {CadKind::step, "a CAD model in STEP", " .step .stp ", ".step"},
    {CadKind::iges, "a CAD model in IGES", " .iges .igs ", ".iges"},
    {CadKind::brep, "a CAD model in OpenCASCADE's BREP", " .brep .brp ", ".brep"},
    {CadKind::freeCad, "a FreeCAD document", " .fcstd ", ".fcstd"}};

bool names(const CadFormat& format, const std::string& extension) {
    return !extension.empty() &&
           std::string_view(format.extensions).find(" " + extension + " ") != std::string_view::npos;
}

// A line of IGES has 80 columns: a letter for the section in column 73, then the number of the line in it.
bool beginsAsIges(std::string_view start) {
    if (start.size() < 81 || start[72] != 'S' || start[79] != '1') return false;
    return (start[80] == '\n' || start[80] == '\r') &&
           start.substr(73, 6).find_first_not_of(" 0") == std::string_view::npos;
}

CadKind kindByContent(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return CadKind::none;  // a pipe is read but once
    std::string bytes(128, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    std::string_view start = withoutByteOrderMark(bytes);
    if (beginsAsIges(start)) return CadKind::iges;
    if (start.starts_with("PK\3\4") && start.size() > 30 && start.substr(30).starts_with("Document.xml"))
        return CadKind::freeCad;
    start.remove_prefix(std::min(start.find_first_not_of(" \t\r\n"), start.size()));
    if (start.starts_with("ISO-10303-21")) return CadKind::step;
    return start.starts_with("DBRep_DrawableShape") || start.starts_with("CASCADE Topology") ? CadKind::brep
                                                                                             : CadKind::none;
}

const CadFormat* formatOf(const fs::path& path, const std::string& extension) {
    const CadKind kind = kindByContent(path);
    for (const CadFormat& format : kFormats)
        if (kind == CadKind::none ? names(format, extension) : kind == format.kind) return &format;
    return nullptr;
}

}  // namespace

std::optional<std::string> cadModelText(const fs::path& path) {
    const std::string extension = toLower(path.extension().string());
    const CadFormat* const format = formatOf(path, extension);
    if (!format) return std::nullopt;
    if (format->kind == CadKind::freeCad)
        return fmt::format(
            "is {}; export its part in FreeCAD as STL, or as STEP and make a mesh of that with "
            "gmsh",
            format->name);
    const fs::path stem = path.parent_path() / path.stem();
    const bool named = names(*format, extension);
    const std::string model = named ? path.string() : stem.string() + format->extension;
    return fmt::format("is {}; {}make a mesh of it: gmsh {} -2 -clcurv 12 -o {}", format->name,
                       named ? "" : "name it " + inShell(model) + " and ", inShell(model),
                       inShell(stem.string() + ".stl"));
}

std::string inShell(const std::string& name) {
    const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._/-+,:@";
    return name.find_first_not_of(plain) == std::string::npos ? name : "'" + name + "'";
}

}  // namespace isowave
