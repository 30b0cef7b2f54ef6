// CAD models of curved faces, which isowave does not read: what such a file is, and how to make a mesh of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace isowave {

// "is a CAD model in STEP; make a mesh of it: gmsh part.step -2 -clcurv 12 -o part.stl"; nothing for any other file. STEP
// (ISO 10303-21), IGES, BREP (OpenCASCADE) and FreeCAD's documents are told by their first bytes, whatever their name, and by
// their extension where the first bytes say nothing. -clcurv 12: twelve edges to a full turn.
std::optional<std::string> cadModelText(const std::filesystem::path& path);

// A name as a shell takes it: in quotation marks where it has to be.
std::string inShell(const std::string& name);

}  // namespace isowave
