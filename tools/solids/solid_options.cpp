#include "tools/solids/solid_options.h"

#include "io/mesh/units.h"
#include "io/mesh/write.h"
#include "lod/source.h"
#include "tools/option_values.h"

namespace isowave::tools {
namespace {

// What describes a headerless image; the library says what is missing.
RawLayout& raw(SolidOptions& solid) {
    if (!solid.image.raw) solid.image.raw.emplace();
    return *solid.image.raw;
}

void takeLabels(const std::string& text, SolidOptions& solid) {
    solid.labels = list(text, number);
    if (solid.labels.size() > 1) return;
    solid.label = solid.labels.front();
    solid.labels.clear();
}

// A surface has one value; who gives a range wants the voxels within it.
double isoValue(const std::string& text) {
    if (text.find("..") != std::string::npos)
        throw UsageError(
            "'" + text +
            "' is a range; expected one number. For the voxels between two values, write them as a mask, "
            "1 inside and 0 elsewhere, and give that");
    return number(text);
}

void declareInside(OptionList& options, SolidOptions& solid) {
    options.value("--iso", "V", "masks: midpoint; labels: not zero; level sets: 0; other images: required",
                  "the surface is where the value is V; inside is where it is larger (level sets: smaller)",
                  [&](const std::string& v) { solid.iso = isoValue(v); });
    options.value("--label", "L[,L...]", "every label but 0",
                  "the solid is where a label image is L, or one of several (after NIfTI's scaling)",
                  [&](const std::string& v) { takeLabels(v, solid); });
    options.flag("--invert", "swap inside and outside", solid.invert);
    options.flag("--open-border", "no cap where the solid touches the border of the image", solid.openBorder);
    options.value("--voxels", "N", "256", "meshes: sample with N voxels along the longest axis",
                  [&](const std::string& v) { solid.voxels = integer(v, 4, 1'000'000'000); });
    options.value("--voxel", "LEN", "", "meshes: sample with voxels of this size (world units)",
                  [&](const std::string& v) { solid.voxel = lengthIn(v, kWorldUnits); });
    options.value("--close-holes", "WIDTH", "1/6 of the diagonal, unless the area is large",
                  "open meshes: fill holes up to this width (world units)",
                  [&](const std::string& v) { solid.closeHoles = lengthIn(v, kWorldUnits); });
    options.value("--thicken", "T", "",
                  "meshes: the solid is what lies within T/2 of the triangles; makes a plate of a sheet, at "
                  "least 2 voxels "
                  "thick (world units)",
                  [&](const std::string& v) { solid.thicken = lengthIn(v, kWorldUnits); });
    options.value("--unit", "mm|cm|m|in|ft", "mm",
                  "meshes: what their coordinates are measured in; coordinates stay as they are, GLB (in "
                  "metres) and the "
                  "report say it",
                  [&](const std::string& v) {
                      solid.unit = choice<std::string>(
                          v, {{"mm", "mm"}, {"cm", "cm"}, {"m", "m"}, {"in", "in"}, {"ft", "ft"}});
                  });
}

void declareFit(OptionList& options, SolidOptions& solid) {
    options.value("--fit", "mask|binary|distance", "mask for masks and labels, otherwise distance",
                  "from signs alone, smooth and with the volume of the voxels (mask) or by filtered weights "
                  "(binary); or from signed distances",
                  [&](const std::string& v) {
                      solid.fit = choice<FitMethod>(v, {{"mask", FitMethod::mask},
                                                        {"binary", FitMethod::binary},
                                                        {"distance", FitMethod::distance}});
                  });
    options.value("--half-width", "W", "4",
                  "distance fit: the distance is clamped to W voxels each side, at most 64",
                  [&](const std::string& v) { solid.halfWidth = lengthIn(v, kVoxels); });
    options.value("--band", "B", "2", "distance fit: nodes nearer than B voxels are kept; at most W",
                  [&](const std::string& v) { solid.band = lengthIn(v, kVoxels); });
}

// Of the triangles of a mesh, or of level 0.
double share(const std::string& text) {
    const double ratio = positive(text);
    if (ratio > 1) throw UsageError("'" + text + "' is above 1, all triangles");
    return ratio;
}

void declareLevelIso(OptionList& options, LevelOptions& level) {
    options.flag("--preserve-volume",
                 "each level at the iso-value that gives it the input's volume (level 0's where it is not "
                 "known), to 0.01 %",
                 level.preserveVolume);
    options.value("--hold", "local|shift|none", "local",
                  "walls and rods thinner than a level's voxel stay whole: by a change beside them alone; by "
                  "moving the whole "
                  "surface outwards; not at all, the plain wavelet level",
                  [&](const std::string& v) {
                      level.hold = choice<Holding>(
                          v, {{"local", Holding::local}, {"shift", Holding::shift}, {"none", Holding::none}});
                  });
    options.flag("--keep-specks",
                 "coarser levels keep components and cavities that are smaller than one of their nodes",
                 level.keepSpecks);
}

}  // namespace

void declareSolid(OptionList& options, SolidOptions& solid) {
    declareInside(options, solid);
    declareFit(options, solid);
    options.value(
        "--axes", "auto|cubes|xyz", "auto",
        "which axes levels halve. auto: where a voxel's edges differ by a factor of 2 or more, the short "
        "ones "
        "alone until they do not, then all; cubes: the short ones alone wherever that brings voxels nearer "
        "to "
        "a cube; xyz: all from the start",
        [&](const std::string& v) {
            solid.axes = choice<StepAxes>(
                v, {{"auto", StepAxes::automatic}, {"cubes", StepAxes::cubes}, {"xyz", StepAxes::xyz}});
        });
    declareImage(options, solid);
    options.value("--grid", "NAME", "", ".vdb with several level sets: which grid",
                  [&](const std::string& v) { solid.grid = v; });
}

void declareImage(OptionList& options, SolidOptions& solid) {
    options.value("--size", "NXxNYxNZ", "", "the image has no header: voxels on each axis, x fastest",
                  [&](const std::string& v) { raw(solid).size = wholeTriple(v, "256x256x108"); });
    options.value("--type", "int8|uint8|int16|uint16|int32|uint32|float32|float64", "",
                  "headerless image: type of a voxel", [&](const std::string& v) {
                      raw(solid).type = choice<std::string>(v, {{"int8", "int8"},
                                                                {"uint8", "uint8"},
                                                                {"int16", "int16"},
                                                                {"uint16", "uint16"},
                                                                {"int32", "int32"},
                                                                {"uint32", "uint32"},
                                                                {"float32", "float32"},
                                                                {"float64", "float64"}});
                  });
    options.value("--spacing", "XxYxZ", "1x1x1 where the file has none",
                  "voxel size in mm; replaces the header's",
                  [&](const std::string& v) { solid.image.spacing = triple(v, "0.957x0.957x1.5"); });
    options.value("--endian", "little|big", "little", "headerless image: byte order",
                  [&](const std::string& v) {
                      raw(solid).bigEndian = choice<bool>(v, {{"little", false}, {"big", true}});
                  });
    options.value("--header-bytes", "N", "0", "headerless image: bytes to skip at the start",
                  [&](const std::string& v) { raw(solid).headerBytes = integer(v, 0, kHuge); });
    options.value("--volume", "N", "",
                  "file of several volumes (4D NIfTI, layers of a .seg.nrrd): which one, from 1 on",
                  [&](const std::string& v) { solid.image.volume = integer(v, 1, kHuge); });
    options.value("--nan", "V", "",
                  "what voxels that are NaN, not measured, are taken as; else they are refused",
                  [&](const std::string& v) { solid.image.nan = static_cast<float>(number(v)); });
    options.value("--series", "ID", "", "DICOM folder with several series: a part of its UID or description",
                  [&](const std::string& v) { solid.image.series = v; });
    options.value("--stack", "N", "",
                  "DICOM with several stacks of slices, or segments: which one, as the message lists them",
                  [&](const std::string& v) { solid.image.stack = integer(v, 1, kHuge); });
    options.value("--channel", "N", "", "TIFF or OME-Zarr with several channels: which one, from 1 on",
                  [&](const std::string& v) { solid.image.channel = integer(v, 1, kHuge); });
    options.value("--time", "N", "", "several volumes at one place (times, echoes): which one, from 1 on",
                  [&](const std::string& v) { solid.image.time = integer(v, 1, kHuge); });
    options.flag("--resample-slices",
                 "DICOM slices in uneven steps: interpolate them, linearly, to even steps",
                 solid.image.resampleSlices);
}

void declareMaxMemory(OptionList& options, SolidOptions& solid) {
    options.value(
        "--max-memory", "GB", "70 % of this computer's",
        "refuse images, meshes and level sets that would take more, as far as can be told beforehand",
        [&](const std::string& v) { solid.maxMemory = positive(v) * kBytesPerGigabyte; });
}

void declareSlabs(OptionList& options, SolidOptions& solid) {
    options.value("--slabs", "N", "1",
                  "images: read, fit and halve N slabs of slices one after the other, more where one would "
                  "take more than --max-memory; the result is the same",
                  [&](const std::string& v) { solid.slabs = static_cast<int>(integer(v, 1, 4096)); });
}

SolidOptions withSlabsBeside(const SolidOptions& solid, const std::filesystem::path& output) {
    SolidOptions result = solid;
    result.slabFolder = std::filesystem::absolute(output).parent_path();
    return result;
}

void declareMesh(OptionList& options, LevelOptions& level, bool features) {
    options.value("--refine", "1|2|4", "chosen by each level",
                  "samples of a node along each axis: more triangles, closer to the spline. Without it a "
                  "level that holds what "
                  "is thin takes 2 and brings the triangles back to about the number of 1",
                  [&](const std::string& v) {
                      level.refine = choice<int>(v, {{"1", 1}, {"2", 2}, {"4", 4}});
                  });
    declareLevelIso(options, level);
    if (features) declareFeatures(options, level);
    options.flag(
        "--refit",
        "the field of each level fitted once more to the surface of level 0: nearer to it, and to its volume",
        level.refit);
    options.flag(
        "--compact",
        "with --refine: collapse each mesh down to about the triangles that it has without it; nearer "
        "to the surface at the same size",
        level.compact);
    options.value("--relax", "N", "0",
                  "N rounds of sliding vertices along the surface: larger angles, same zero set",
                  [&](const std::string& v) { level.relax = static_cast<int>(integer(v, 0, 1000)); });
    options.flag("--deviation", "measure how far triangles are from the zero set of the spline",
                 level.deviation);
}

void declareLevels(OptionList& options, LevelOptions& level) {
    options.value("--levels", "A..B", "0 until one node is left", "which levels (A.., ..B and A will do)",
                  [&](const std::string& v) { level.levels = range(v); });
    options.value("--steps", "A..B", "",
                  "steps instead of levels: each halves one axis, three are a level (two or one where voxels "
                  "are no cubes)",
                  [&](const std::string& v) { level.steps = range(v); });
}

void declareRegions(OptionList& options, LevelOptions& level) {
    options.values(
        "--fine", "REGION",
        "in this region coarser levels keep the details of a finer one; may be given several times. "
        "X,Y,Z:X,Y,Z, "
        "two opposite corners of a box, or the file of a closed mesh, world coordinates (LPS mm for "
        "images); :LEVEL behind it where the level to keep is not 0",
        [&](const std::string& v) { level.fine.push_back(region(v)); });
    options.value("--fine-within", "D", "0", "widen the regions of --fine by D (world units)",
                  [&](const std::string& v) {
                      const double within = number(v);
                      if (within < 0) throw UsageError("'" + v + "' is below 0");
                      if (level.fine.empty()) throw UsageError("widens the regions of --fine; give one");
                      for (FineRegion& r : level.fine) r.within = within;
                  });
    options.value(
        "--adaptive", "LEN", "",
        "coarser levels keep the details of finer ones wherever they would be farther than this from "
        "level 0: 0.3voxel (of level 0), 0.2mm or 0.2 (both world units)",
        [&](const std::string& v) { level.adaptive = lengthOrNumber(v); });
}

void declareBudgets(OptionList& options, BudgetOptions& budgets, LevelOptions& level) {
    options.value("--triangles", "N,N,...", "",
                  "instead of the levels, meshes of at most so many triangles: name_TN",
                  [&](const std::string& v) {
                      budgets.triangles = list(v, [](const std::string& n) { return integer(n, 4, kHuge); });
                  });
    options.value("--ratio", "R,R,...", "",
                  "the same as a share of the mesh's own triangles, of level 0's for other inputs (0.01 = 1 "
                  "%): name_RR",
                  [&](const std::string& v) { budgets.ratios = list(v, share); });
    options.value("--tolerance", "D,D,...", "",
                  "the fewest triangles that stay within D (world units) of the mesh that was read, of "
                  "level 0 for images, both ways: name_DD",
                  [&](const std::string& v) {
                      budgets.tolerances =
                          list(v, [](const std::string& d) { return lengthIn(d, kWorldUnits); });
                  });
    options.value(
        "--max-genus", "N", "",
        "at most N handles in every mesh: holes are filled or their rings cut, whichever takes less volume",
        [&](const std::string& v) { level.maxGenus = integer(v, 0, kHuge); });
    options.value(
        "--max-parts", "N", "",
        "at most N parts in every mesh: the others are removed, or joined where that takes less volume",
        [&](const std::string& v) { level.maxParts = integer(v, 1, kHuge); });
    options.value("--min-component", "VOLUME", "",
                  "budgets: only from steps without components smaller than that (world units cubed)",
                  [&](const std::string& v) { budgets.minComponent = positive(v); });
}

void declareFeatures(OptionList& options, LevelOptions& level) {
    options.flag("--features",
                 "measure parts, holes and cavities, and say up to which size they vanish (takes longer)",
                 level.features);
}

void StepChoice::declare(OptionList& options) {
    options.value("--step", "S", "0", "which step",
                  [this](const std::string& v) { step = static_cast<int>(integer(v, 0, kMostSteps)); });
    options.value("--level", "L", "", "which level, instead of --step", [this](const std::string& v) {
        level = static_cast<int>(integer(v, 0, kMostSteps / kStepsPerLevel));
    });
}

void StepChoice::check() const {
    if (step && level) throw UsageError("--step and --level exclude each other; give one of them");
}

void StepChoice::limitReading(SolidOptions& solid) const {
    solid.finestStep = step.value_or(0);
    solid.finestLevel = level;
}

namespace {

// "stl|ply|obj"
std::string formatNames(const char* between) {
    std::string names;
    for (const MeshFormatName& format : meshFormatNames())
        names += (names.empty() ? "" : between) + std::string(format.extension + 1);
    return names;
}

MeshFormat formatNamed(const std::string& text) {
    for (const MeshFormatName& format : meshFormatNames())
        if (text == format.extension + 1) return format.format;
    throw UsageError("'" + text + "' is not one of " + formatNames(", "));
}

}  // namespace

void declareFormat(OptionList& options, std::optional<MeshFormat>& format) {
    static const std::string names = formatNames("|");
    options.value("--format", names, "ply for lod, by the file's extension for mesh", "format of the meshes",
                  [&](const std::string& v) { format = formatNamed(v); });
}

void SpaceChoice::declare(OptionList& options) {
    options.value("--space", "lps|ras", "lps for images, as it is for meshes",
                  "axes of the written coordinates, for medical images and meshes that say SPACE=",
                  [this](const std::string& v) {
                      space = choice<Space>(v, {{"lps", Space::lps}, {"ras", Space::ras}});
                  });
}

double metresPerUnitOf(const Solid& solid) {
    const std::string unit = lod::unitOf(solid.input());
    return metresPer(unit.empty() ? "mm" : unit);
}

Space SpaceChoice::of(Space ofSolid) const {
    if (!space) return ofSolid;
    if (ofSolid == Space::unspecified)
        throw UsageError(
            "--space: the axes of this input have no medical meaning (an image that names no sides of a "
            "body, or a "
            "mesh without SPACE=); leave it out");
    return *space;
}

}  // namespace isowave::tools
