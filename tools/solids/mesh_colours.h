// --colour: what the meshes' files say of how far they are from level 0.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "isowave/ladder.h"
#include "tools/command.h"
#include "view/distances.h"

namespace isowave::tools {

struct ColourChoice {
    bool distance = false;

    void declare(OptionList& options);
    // Throws UsageError where the format has no numbers at vertices.
    void requireFormat(MeshFormat format) const;
    // Throws UsageError where no mesh of level 0 is made.
    void requireLevel0(const LevelOptions& levels, const BudgetOptions& budgets) const;
};

// Measures each mesh's vertices, level 0 first. All meshes of a run have one range of colours: up to the largest distance of any of
// them.
class MeshColours {
  public:
    explicit MeshColours(const ColourChoice& choice) : choice_(choice) {}

    void setLevel0(const TriangleMesh& mesh);
    // `plain`, and the distances where they are wanted: of level 0 itself 0. REQUIRES: setLevel0() was called where they are.
    MeshWriteOptions with(MeshWriteOptions plain, const TriangleMesh& mesh, bool isLevel0,
                          const Progress& progress);

    // The distance of the last colour, world units, of what has been measured so far; nothing without distances.
    std::optional<double> range() const;
    // Gives a file that was written before the range was known its colours. Of formats without colours there is nothing to do.
    void recolour(const std::filesystem::path& file, MeshFormat format) const;

  private:
    ColourChoice choice_;
    float largest_ = 0;
    std::unique_ptr<view::SurfaceDistance> level0_;
};

}  // namespace isowave::tools
