// Every row of "bad input": the documented exit code, exactly one line on standard error that names what is
// wrong, nothing left behind.
#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <limits>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"
#include "volume/vdb_file.h"

namespace isowave::tools_test {
namespace {

using Arguments = std::vector<std::string>;

constexpr Size kSize{24, 20, 16};

void writeBall(const fs::path& file, const std::string& geometry = "spacings: 1 1 1\n") {
    writeNrrd(file, kSize, greyBall(kSize, 6), geometry);
}

void writeImageWith(const fs::path& file, float value) {
    auto values = sampled<float>(kSize, [](int x, int, int) { return x; });
    values[777] = value;
    writeNrrd(file, kSize, values);
}

struct BadInput {
    const char* name;
    int exitCode;
    // Makes the input and gives the command line.
    std::function<Arguments(const Folder&)> make;
    std::vector<std::string> words;  // all of them stand in the line, in any case
};

Arguments lod(const Folder& folder, const std::string& input, Arguments more = {}) {
    Arguments arguments{"lod", (folder / input).string(), "-o", (folder / "out/part").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

// A pyramid file made by the program itself.
void writePyramid(const Folder& folder, const std::string& name) {
    writeBall(folder / "ball.nrrd");
    succeed({"analyse", (folder / "ball.nrrd").string(), "--iso", "0", "-o", (folder / name).string()});
}

const std::vector<BadInput>& rows() {
    static const std::vector<BadInput> kRows{
        {"MissingFile",
         3,
         [](const Folder& f) {
             return lod(f, "no.nrrd", {"--iso", "0"});
         },
         {"no.nrrd", "no such"}},
        {"MissingMesh", 3, [](const Folder& f) { return lod(f, "no.stl"); }, {"no.stl", "no such"}},
        {"RangeOfIsoValues",
         2,
         [](const Folder& f) {
             return lod(f, "no.nrrd", {"--iso", "200..600"});
         },
         {"--iso", "'200..600' is a range", "mask"}},
        {"CadModel",
         3,
         [](const Folder& f) {
             std::ofstream(f / "part.step") << "ISO-10303-21;";
             return lod(f, "part.step");
         },
         {"part.step", "is a CAD model", "gmsh"}},
        {"UnknownKind",
         3,
         [](const Folder& f) {
             std::ofstream(f / "notes.txt") << "hello";
             return lod(f, "notes.txt");
         },
         {"notes.txt", "--size"}},
        {"DamagedGzipAroundAMesh",
         3,
         [](const Folder& f) {
             std::ofstream(f / "a.stl.gz") << "\x1f\x8b";
             return lod(f, "a.stl.gz");
         },
         {"a.stl.gz", "its gzip stream breaks off"}},
        {"NoName",
         2,
         [](const Folder& f) {
             return Arguments{"lod", "", "-o", (f / "out").string()};
         },
         {"empty"}},
        {"EmptyImage",
         3,
         [](const Folder& f) {
             std::ofstream(f / "a.nrrd").flush();
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "empty"}},
        {"EmptyMesh",
         3,
         [](const Folder& f) {
             std::ofstream(f / "a.stl").flush();
             return lod(f, "a.stl");
         },
         {"a.stl", "empty"}},
        {"EmptyVdb",
         3,
         [](const Folder& f) {
             std::ofstream(f / "a.vdb").flush();
             return lod(f, "a.vdb");
         },
         {"a.vdb", "empty"}},
        {"TruncatedNrrd",
         3,
         [](const Folder& f) {
             writeBall(f / "whole.nrrd");
             writeHalf(f / "whole.nrrd", f / "a.nrrd");
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "truncated"}},
        {"TruncatedNifti",
         3,
         [](const Folder& f) {
             writeNifti(f / "whole.nii", kSize, greyBall(kSize, 6));
             writeHalf(f / "whole.nii", f / "a.nii");
             return lod(f, "a.nii", {"--iso", "0"});
         },
         {"a.nii", "truncated"}},
        {"TruncatedStl",
         3,
         [](const Folder& f) {
             writeStl(f / "whole.stl", torus(10, 4));
             writeHalf(f / "whole.stl", f / "a.stl");
             return lod(f, "a.stl");
         },
         {"a.stl", "truncated"}},
        {"TruncatedPly",
         3,
         [](const Folder& f) {
             writePly(f / "whole.ply", torus(10, 4));
             writeHalf(f / "whole.ply", f / "a.ply");
             return lod(f, "a.ply");
         },
         {"a.ply", "truncated"}},
        {"TruncatedVdb",
         3,
         [](const Folder& f) {
             writePyramid(f, "whole.pyramid.vdb");
             succeed({"field", (f / "whole.pyramid.vdb").string(), "-o", (f / "whole.vdb").string()});
             writeHalf(f / "whole.vdb", f / "a.vdb");
             return lod(f, "a.vdb");
         },
         {"a.vdb", "truncated"}},
        {"TruncatedPyramid",
         3,
         [](const Folder& f) {
             writePyramid(f, "whole.pyramid.vdb");
             writeHalf(f / "whole.pyramid.vdb", f / "a.vdb");
             return Arguments{"mesh", (f / "a.vdb").string(), "-o", (f / "a.ply").string()};
         },
         {"a.vdb", "truncated"}},
        {"PyramidOfAnotherVersion",
         3,
         [](const Folder& f) {
             writePyramid(f, "whole.pyramid.vdb");
             VdbContent content = readVdb(f / "whole.pyramid.vdb");
             std::string key;
             for (auto entry = content.metadata->beginMeta(); entry != content.metadata->endMeta(); ++entry)
                 if (entry->first.find("version") != entry->first.npos) key = entry->first;
             EXPECT_FALSE(key.empty());
             content.metadata->insertMeta(key, openvdb::Int32Metadata(99));
             writeVdb(f / "a.vdb", {content.grids.begin(), content.grids.end()}, *content.metadata);
             return Arguments{"mesh", (f / "a.vdb").string(), "-o", (f / "a.ply").string()};
         },
         {"a.vdb", "version", "99"}},
        {"FieldInsteadOfLevelSet",
         3,
         [](const Folder& f) {
             writePyramid(f, "whole.pyramid.vdb");
             succeed({"field", (f / "whole.pyramid.vdb").string(), "-o", (f / "a.vdb").string()});
             return lod(f, "a.vdb");
         },
         {"a.vdb", "control points"}},
        {"FlatImage",
         3,
         [](const Folder& f) {
             std::ofstream out(f / "a.nrrd", std::ios::binary);
             out << "NRRD0004\ntype: uint8\ndimension: 2\nsizes: 8 8\nspacings: 1 1\nencoding: raw\n\n"
                 << std::string(64, 'x');
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "2"}},
        {"NoCrossing",
         3,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return lod(f, "a.nrrd", {"--iso", "5000"});
         },
         {"a.nrrd", "5000", "-100", "100"}},
        {"ConstantImage",
         3,
         [](const Folder& f) {
             writeNrrd(f / "a.nrrd", kSize, sampled<std::int16_t>(kSize, [](int, int, int) { return 7; }));
             return lod(f, "a.nrrd");
         },
         {"a.nrrd", "every voxel", "7"}},
        {"GreyImageWithoutIso",
         2,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return lod(f, "a.nrrd");
         },
         {"--iso", "-100", "100", "%"}},
        {"LabelThatIsNotThere",
         3,
         [](const Folder& f) {
             writeNrrd(f / "a.nrrd", kSize, ringAndBall(kSize, 6, 3, true));
             return lod(f, "a.nrrd", {"--label", "5"});
         },
         {"a.nrrd", "label 5", "0, 1, 2"}},
        {"LabelThatFloatCannotHold",
         3,
         [](const Folder& f) {
             // Both are 312782560 in float32.
             writeNrrd(f / "a.nrrd", kSize, sampled<std::int32_t>(kSize, [](int x, int y, int) {
                           return x < 6 || y < 6 ? 0 : x < 12 ? 312782570 : 312782574;
                       }));
             return lod(f, "a.nrrd", {"--label", "312782574"});
         },
         {"a.nrrd", "label 312782574", "float32", "16777216", "renumber"}},
        {"LabelThatRoundingMakes",
         3,
         [](const Folder& f) {
             writeNrrd(f / "a.nrrd", kSize, sampled<std::int32_t>(kSize, [](int x, int y, int) {
                           return x < 6 || y < 6 ? 0 : 16777217;
                       }));
             return lod(f, "a.nrrd", {"--label", "16777216"});
         },
         {"a.nrrd", "label 16777216", "float32", "renumber"}},
        {"NotANumber",
         3,
         [](const Folder& f) {
             writeImageWith(f / "a.nrrd", std::numeric_limits<float>::quiet_NaN());
             return lod(f, "a.nrrd", {"--iso", "5"});
         },
         {"a.nrrd", "nan"}},
        {"Infinity",
         3,
         [](const Folder& f) {
             writeImageWith(f / "a.nrrd", std::numeric_limits<float>::infinity());
             return lod(f, "a.nrrd", {"--iso", "5"});
         },
         {"a.nrrd", "inf"}},
        {"ZeroSpacing",
         3,
         [](const Folder& f) {
             writeBall(f / "a.nrrd", "spacings: 1 0 1\n");
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "spacing"}},
        {"NegativeSpacing",
         3,
         [](const Folder& f) {
             writeBall(f / "a.nrrd", "spacings: 1 1 -2\n");
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "spacing"}},
        {"DirectionThatCannotBeInverted",
         3,
         [](const Folder& f) {
             writeBall(f / "a.nrrd",
                       "space: left-posterior-superior\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n"
                       "space origin: (0,0,0)\n");
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "direction"}},
        {"ColourImage",
         3,
         [](const Folder& f) {
             std::ofstream out(f / "a.nrrd", std::ios::binary);
             out << "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 8 8 8\nkinds: RGB-color domain domain "
                    "domain\n"
                    "spacings: nan 1 1 1\nencoding: raw\n\n"
                 << std::string(3 * 512, 'x');
             return lod(f, "a.nrrd", {"--iso", "0"});
         },
         {"a.nrrd", "rgb"}},
        {"OpenMesh",
         3,
         [](const Folder& f) {
             SmallMesh mesh = torus(10, 4);
             mesh.triangles.resize(mesh.triangles.size() / 2);  // a bent tube with two open ends of 24 edges
             writeStl(f / "a.stl", mesh);
             return lod(f, "a.stl");
         },
         {"a.stl", "48", "boundary edges"}},
        {"NoTriangles",
         3,
         [](const Folder& f) {
             writeStl(f / "a.stl", {});
             return lod(f, "a.stl");
         },
         {"a.stl", "triangle"}},
        {"HugeCoordinates",
         3,
         [](const Folder& f) {
             SmallMesh mesh = torus(10, 4);
             for (auto& p : mesh.points) p[0] *= 1e200;
             writeOff(f / "a.off", mesh);
             return lod(f, "a.off");
         },
         {"a.off"}},
        {"ZeroVoxels",
         2,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--voxels", "0"});
         },
         {"--voxels", "'0'"}},
        {"TooManyVoxels",
         3,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--voxels", "100000"});
         },
         {"a.stl", "memory", "GB", "--max-memory"}},
        {"MaskOverTheMemoryLimit",
         3,
         [](const Folder& f) {
             const Size size{36, 36, 20};  // read in 130 kB
             writeNrrd(f / "a.nrrd", size, ringAndBall(size, 10, 4, false));
             return lod(f, "a.nrrd", {"--max-memory", "0.0002"});
         },
         {"a.nrrd", "memory", "kB", "crop", "--max-memory"}},
        {"GreyImageOverTheMemoryLimit",
         3,
         [](const Folder& f) {
             const Size size{36, 36, 36};  // read in 280 kB
             writeNrrd(f / "a.nrrd", size, greyBall(size, 14));
             return lod(f, "a.nrrd", {"--iso", "0", "--max-memory", "0.001"});
         },
         {"a.nrrd", "memory", "MB", "crop", "--max-memory"}},
        {"LevelSetOverTheMemoryLimit",
         3,
         [](const Folder& f) {
             openvdb::initialize();
             const auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(12, {}, 1);
             writeVdb(f / "a.vdb", {ball}, openvdb::MetaMap());
             return lod(f, "a.vdb", {"--max-memory", "0.001"});
         },
         {"a.vdb", "memory", "MB", "resample", "--max-memory"}},
        {"VoxelsTooCoarse",
         3,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 0.01));
             return lod(f, "a.stl", {"--voxels", "8"});
         },
         {"a.stl", "--voxels"}},
        {"LevelBeyondTheLast",
         3,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return lod(f, "a.nrrd", {"--iso", "0", "--levels", "50..60"});
         },
         {"a.nrrd", "step 150"}},
        {"StepBeyondTheLast",
         3,
         [](const Folder& f) {
             writePyramid(f, "a.vdb");
             return Arguments{"mesh", (f / "a.vdb").string(), "--step", "500", "-o", (f / "a.ply").string()};
         },
         {"a.vdb", "step 500"}},
        {"OutputBelowAFile",
         1,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             std::ofstream(f / "file") << "in the way";
             return Arguments{"lod", (f / "a.nrrd").string(), "--iso", "0", "-o", (f / "file/part").string()};
         },
         {"file"}},
        {"OutputIsAFile",
         1,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             std::ofstream(f / "file") << "in the way";
             return Arguments{"lod", (f / "a.nrrd").string(), "--iso", "0", "-o", (f / "file").string()};
         },
         {"file", "folder"}},
        {"ReportToAFolder",
         1,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return lod(f, "a.nrrd", {"--iso", "0", "--json", f.path().string()});
         },
         {"folder"}},
        {"MeshThatIsAFolderLeavesNoReport",
         1,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             fs::create_directories(f / "out/part/part_L0.ply");
             return lod(f, "a.nrrd", {"--iso", "0", "--json", (f / "copy.json").string()});
         },
         {"part_L0.ply", "folder"}},
        {"OutputFolderThatNobodyMayWrite",
         1,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return Arguments{"lod", (f / "a.nrrd").string(), "--iso", "0", "-o", "/proc/part"};
         },
         {"/proc"}},
        {"ReportThatCannotBeWritten",
         1,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return lod(f, "a.nrrd", {"--iso", "0", "--json", (f / "a.nrrd/report.json").string()});
         },
         {"a.nrrd"}},
        {"VoxelsOfAnImage",
         2,
         [](const Folder& f) {
             writeBall(f / "a.nrrd");
             return lod(f, "a.nrrd", {"--iso", "0", "--voxels", "64"});
         },
         {"--voxels", "image"}},
        {"IsoOfAMesh",
         2,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--iso", "3"});
         },
         {"--iso", "mesh"}},
        {"SpaceOfACadMesh",
         2,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--voxels", "24", "--space", "ras"});
         },
         {"--space"}},
        {"BandWiderThanHalfWidth",
         2,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--band", "6"});
         },
         {"--band", "--half-width"}},
        {"HalfWidthOfTheWholeRoom",
         2,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--half-width", "1e9"});
         },
         {"--half-width 1000000000 is more than 64 voxels"}},
        {"LevelsAndSteps",
         2,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return lod(f, "a.stl", {"--levels", "0", "--steps", "0"});
         },
         {"--levels", "--steps"}},
        {"UnknownOption", 2, [](const Folder& f) { return lod(f, "a.stl", {"--turbo"}); }, {"--turbo"}},
        {"UnknownSubcommand",
         2,
         [](const Folder&) {
             return Arguments{"polish", "a.stl"};
         },
         {"polish"}},
        {"NoSubcommand", 2, [](const Folder&) { return Arguments{}; }, {"lod", "analyse", "--help"}},
        {"NoInput",
         2,
         [](const Folder&) {
             return Arguments{"lod", "-o", "x"};
         },
         {"lod", "INPUT"}},
        {"NoOutput",
         2,
         [](const Folder&) {
             return Arguments{"lod", "a.stl"};
         },
         {"lod", "-o"}},
        {"BackwardLevels",
         2,
         [](const Folder& f) {
             return lod(f, "a.stl", {"--levels", "4..2"});
         },
         {"--levels", "4..2"}},
        {"NotANumberOfVoxels",
         2,
         [](const Folder& f) {
             return lod(f, "a.stl", {"--voxels", "12q"});
         },
         {"--voxels", "12q"}},
        {"UnknownMeshFormat",
         2,
         [](const Folder& f) {
             return Arguments{"mesh", (f / "a.vdb").string(), "-o", (f / "a.xyz").string()};
         },
         {"a.xyz", "stl"}},
        {"CheckOfNothing",
         3,
         [](const Folder& f) {
             return Arguments{"check", (f / "no.stl").string()};
         },
         {"no.stl"}},
        {"CompareWithNothing",
         3,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(10, 4));
             return Arguments{"compare", (f / "a.stl").string(), (f / "no.stl").string()};
         },
         {"no.stl"}},
        {"InfoOfNothing",
         3,
         [](const Folder& f) {
             return Arguments{"info", (f / "no.vdb").string()};
         },
         {"no.vdb"}},
        {"HeaderlessWithoutType",
         2,
         [](const Folder& f) {
             std::ofstream(f / "a.raw") << "abc";
             return lod(f, "a.raw", {"--iso", "0", "--size", "8x8x8"});
         },
         {"--type"}},
        {"HeaderlessFolder",
         3,
         [](const Folder& f) {
             fs::create_directories(f / "slices");
             std::ofstream(f / "slices/a.png") << "abc";
             return lod(f, "slices", {"--iso", "0", "--size", "8x8x8", "--type", "int16"});
         },
         {"slices", "folder", "size"}},
        {"NameThatIsTooLong",
         3,
         [](const Folder& f) {
             return Arguments{"view", (f / (std::string(300, 'y') + ".ply")).string(), "-o",
                              (f / "a.html").string()};
         },
         {"yyy.ply", "cannot be looked at", "too long"}},
        {"MeshInTinyUnits",
         3,
         [](const Folder& f) {
             writeStl(f / "a.stl", torus(1e-8, 4e-9));
             return lod(f, "a.stl", {"--voxels", "16"});
         },
         {"a.stl", "smaller unit"}},
        {"ListThatIsNoText",
         3,
         [](const Folder& f) {
             std::ofstream(f / "list") << std::string("a\0b\n", 4);
             return Arguments{"lod", "--list", (f / "list").string(), "-o", (f / "out").string()};
         },
         {"list", "is no text", "one path a line"}},
        {"HeaderlessTooShort",
         3,
         [](const Folder& f) {
             std::ofstream(f / "a.raw") << "abc";
             return lod(f, "a.raw", {"--iso", "0", "--size", "8x8x8", "--type", "int16"});
         },
         {"a.raw", "1024"}},
    };
    return kRows;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

class BadInputs : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, SaysSoInOneLineAndLeavesNothing) {
    const Folder folder;
    const Arguments arguments = GetParam().make(folder);
    const auto before = folder.snapshot();
    const Result result = isowave(arguments);
    EXPECT_EQ(result.exitCode, GetParam().exitCode) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_EQ(result.out, "");
    for (const std::string& word : GetParam().words)
        EXPECT_NE(lower(result.err).find(lower(word)), std::string::npos)
            << "'" << word << "' in: " << result.err;
    EXPECT_EQ(folder.snapshot(), before);
}

INSTANTIATE_TEST_SUITE_P(, BadInputs, ::testing::ValuesIn(rows()),
                         [](const auto& row) { return std::string(row.param.name); });

// The rows above all fail; what they are varied from must not.
TEST(BadInputTable, IsVariedFromInputsThatAreFine) {
    const Folder folder;
    writeBall(folder / "a.nrrd");
    EXPECT_EQ(isowave(lod(folder, "a.nrrd", {"--iso", "0"})).exitCode, 0);
    writeNifti(folder / "a.nii", kSize, greyBall(kSize, 6));
    EXPECT_EQ(isowave(lod(folder, "a.nii", {"--iso", "0"})).exitCode, 0);
    writeStl(folder / "a.stl", torus(10, 4));
    EXPECT_EQ(isowave(lod(folder, "a.stl", {"--voxels", "24"})).exitCode, 0);
    writePly(folder / "a.ply", torus(10, 4));
    EXPECT_EQ(isowave(lod(folder, "a.ply", {"--voxels", "24"})).exitCode, 0);
    writeOff(folder / "a.off", torus(10, 4));
    EXPECT_EQ(isowave(lod(folder, "a.off", {"--voxels", "24"})).exitCode, 0);
}

// No rows of the table, which compares what the folder holds: to read a pipe is to wait.
TEST(InfoOfWhatIsNoFile, SaysSoAtOnce) {
    const Folder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.nii").c_str(), 0600), 0);
    fs::create_symlink("loop.nii", folder / "loop.nii");
    const Result pipe = isowave({"info", (folder / "pipe.nii").string()}),
                 loop = isowave({"info", (folder / "loop.nii").string()});
    EXPECT_EQ(pipe.exitCode, 3);
    EXPECT_THAT(pipe.err, ::testing::HasSubstr("pipe.nii: is neither a file nor a folder"));
    EXPECT_EQ(loop.exitCode, 3);
    EXPECT_THAT(loop.err, ::testing::HasSubstr("loop.nii: cannot be looked at"));
}

// `info` sends those to other commands who ask about a picture, not those whose volume is damaged.
TEST(InfoOfAnArray, SpeaksOfPicturesWhereItIsFlat) {
    const Folder folder;
    const auto write = [&](const std::string& shape, std::size_t bytes) {
        std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (" + shape + "), }";
        header.resize(117, ' ');
        std::ofstream(folder / "a.npy", std::ios::binary)
            << std::string("\x93NUMPY\1\0\x76\0", 10) + header + "\n" + std::string(bytes, 'x');
        return isowave({"info", (folder / "a.npy").string()}).err;
    };
    EXPECT_THAT(write("4, 3", 12), ::testing::HasSubstr("isowave curves draws the outline"));
    EXPECT_THAT(write("4, 3, 2", 20), ::testing::Not(::testing::HasSubstr("isowave curves")));
    EXPECT_THAT(write("4, 3, 2, 2", 48), ::testing::Not(::testing::HasSubstr("isowave curves")));
}

// What fits the limit is read: a headerless image takes its own size, not that of the slab it is read by.
TEST(MemoryLimit, IsNotReachedByASmallHeaderlessImage) {
    const Folder folder;
    std::ofstream(folder / "a.raw", std::ios::binary) << std::string(1024, 'x');
    const Result result = isowave(
        {"info", (folder / "a.raw").string(), "--size", "8x8x8", "--type", "int16", "--max-memory", "0.001"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
}

// Every byte count from nothing to all but one, in steps, of a pyramid.
TEST(PyramidCutShort, IsRefusedAtEveryLength) {
    const Folder folder;
    writePyramid(folder, "whole.vdb");
    const std::string bytes = contentOf(folder / "whole.vdb");
    const std::size_t stride = bytes.size() / 23 + 1;
    for (std::size_t length = 0; length < bytes.size(); length += stride) {
        std::ofstream(folder / "cut.vdb", std::ios::binary) << bytes.substr(0, length);
        const Result result = isowave({"info", (folder / "cut.vdb").string()});
        EXPECT_EQ(result.exitCode, 3) << length << " of " << bytes.size() << ": " << result.err << result.out;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
    }
}

// ---- the world fails ----

TEST(FullDisk, LeavesNothingOfALadder) {
    const Folder folder;
    writeBall(folder / "a.nrrd");
    const auto before = folder.snapshot();
    const Result result = isowave(lod(folder, "a.nrrd", {"--iso", "0"}), {.largestFile = 1000});
    EXPECT_EQ(result.exitCode, 1) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_EQ(folder.snapshot(), before);
}

TEST(FullDisk, BehindStandardOutputLeavesNothingOfALadder) {
    const Folder folder;
    writeBall(folder / "a.nrrd");
    const auto before = folder.snapshot();
    const Result result =
        isowave(lod(folder, "a.nrrd", {"--iso", "0", "--json", (folder / "copy.json").string()}),
                {.standardOutput = "/dev/full"});
    EXPECT_EQ(result.exitCode, 1) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_NE(result.err.find("standard output"), std::string::npos) << result.err;
    EXPECT_EQ(folder.snapshot(), before);
}

TEST(FullDisk, KeepsAnEarlierLadder) {
    const Folder folder;
    writeBall(folder / "a.nrrd");
    succeed(lod(folder, "a.nrrd", {"--iso", "0"}));
    const auto before = folder.snapshot();
    const Result result = isowave(lod(folder, "a.nrrd", {"--iso", "20"}), {.largestFile = 1000});
    EXPECT_EQ(result.exitCode, 1) << result.err;
    EXPECT_EQ(folder.snapshot(), before);
}

TEST(FullDisk, LeavesNothingOfASingleFile) {
    const Folder folder;
    writePyramid(folder, "a.pyramid.vdb");
    const auto before = folder.snapshot();
    const std::string pyramid = (folder / "a.pyramid.vdb").string();
    const std::vector<Arguments> commands{
        {"analyse", (folder / "ball.nrrd").string(), "--iso", "0", "-o", (folder / "new/b.vdb").string()},
        {"mesh", pyramid, "-o", (folder / "new/b.stl").string()},
        {"mesh", pyramid, "-o", (folder / "new/b.glb").string()},
        {"field", pyramid, "-o", (folder / "new/b.vdb").string()}};
    for (const Arguments& command : commands) {
        const Result result = isowave(command, {.largestFile = 500});
        EXPECT_EQ(result.exitCode, 1) << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_EQ(folder.snapshot(), before) << command[0];
    }
}

// Wherever it runs out: while trees grow, and, a few megabytes further, while what was made is let go of.
TEST(Memory, ThatDoesNotSufficeIsSaidInOneLineAndLeavesNothing) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers need terabytes of address space";
#endif
    const Folder folder;
    const std::string part = std::string(ISOWAVE_TEST_DATA) + "/meshes/gearwheel.bin.stl";
    for (const rlim_t megabytes : {200, 230, 245}) {
        const Result result =
            isowave({"lod", part, "--voxels", "360", "--threads", "1", "-o", (folder / "out").string()},
                    {.mostMemory = megabytes << 20});
        EXPECT_EQ(result.exitCode, 1) << megabytes << ": " << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_NE(result.err.find("memory did not suffice"), std::string::npos) << result.err;
        EXPECT_TRUE(folder.snapshot().empty());
    }
}

TEST(Interrupt, LeavesTheFolderAsItWas) {
    const Folder folder;
    const Size size{160, 160, 160};
    // Small balls on a lattice that is no multiple of the voxel: much surface, seconds of work.
    writeNrrd(folder / "a.nrrd", size, sampled<std::int16_t>(size, [](int x, int y, int z) {
                  return 100 * (std::sin(0.61 * x) + std::sin(0.57 * y) + std::sin(0.53 * z));
              }));
    const auto before = folder.snapshot();
    const Arguments command = lod(folder, "a.nrrd", {"--iso", "10"});
    const auto atWork = [&](pid_t) { return fs::exists(folder / "out"); };  // the hidden folder is made in it
    const auto meshWritten = [&](pid_t) {
        if (!fs::exists(folder / "out")) return false;
        for (const auto& entry : fs::recursive_directory_iterator(folder / "out"))
            if (entry.path().extension() == ".ply") return true;
        return false;
    };
    for (const std::function<bool(pid_t)>& moment :
         {std::function<bool(pid_t)>(atWork), std::function<bool(pid_t)>(meshWritten)}) {
        const Result result = isowave(command, {.interruptWhen = moment});
        EXPECT_EQ(result.exitCode, 130) << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_EQ(folder.snapshot(), before);
    }
}

}  // namespace
}  // namespace isowave::tools_test
