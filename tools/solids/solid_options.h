// Options that several of the solid commands share, declared into the library's own structs.
#pragma once

#include "isowave/ladder.h"
#include "isowave/mesh.h"
#include "isowave/solid.h"
#include "tools/command.h"

namespace isowave::tools {

// --iso ... --voxel, --fit ... --band, --size ... --grid: what the solid is, how it is fitted, how its file is read.
void declareSolid(OptionList& options, SolidOptions& solid);
// Of these, --size ... --series: how an image is read.
void declareImage(OptionList& options, SolidOptions& solid);
void declareMaxMemory(OptionList& options, SolidOptions& solid);
void declareSlabs(OptionList& options, SolidOptions& solid);
// The same, with slabs in a hidden folder beside what is made.
SolidOptions withSlabsBeside(const SolidOptions& solid, const std::filesystem::path& output);

// --refine ... --deviation: how the mesh of a level is made. features: --features among them.
void declareMesh(OptionList& options, LevelOptions& level, bool features);
void declareFeatures(OptionList& options, LevelOptions& level);

// --levels, --steps: which meshes.
void declareLevels(OptionList& options, LevelOptions& level);
// --fine, --fine-within, --adaptive: regions that keep a finer level.
void declareRegions(OptionList& options, LevelOptions& level);
// --triangles ... --min-component. A limit on the topology is one of the levels' too, wherefore it goes to `level`.
void declareBudgets(OptionList& options, BudgetOptions& budgets, LevelOptions& level);

// --step, --level.
struct StepChoice {
    std::optional<int> step, level;

    void declare(OptionList& options);
    // Throws UsageError when both were given.
    void check() const;
    // Of a pyramid's file no more is read.
    void limitReading(SolidOptions& solid) const;
    // The step of this solid that was asked for; 0 when neither was given.
    int of(const Solid& solid) const { return level ? solid.order().stepOf(*level) : step.value_or(0); }
};

void declareFormat(OptionList& options, std::optional<MeshFormat>& format);

// What a unit of the solid's coordinates is, in metres: of --unit, or a millimetre.
double metresPerUnitOf(const Solid& solid);

// --space.
struct SpaceChoice {
    std::optional<Space> space;

    void declare(OptionList& options);
    // Where written meshes have their axes. Throws UsageError for --space on a solid whose axes have no meaning.
    Space of(const Solid& solid) const { return of(solid.space()); }
    Space of(Space ofSolid) const;
};

}  // namespace isowave::tools
