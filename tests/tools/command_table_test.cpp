// The table feeds everything: help, markdown, completion, parser.
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

const std::vector<std::string> kCommands{
    "lod",  "analyse", "mesh",         "field",  "info",    "check",   "compare",   "view", "pack",
    "edit", "filters", "curve-levels", "relief", "reverse", "rebuild", "subdivide", "help", "completion"};

TEST(Help, ListsEverySubcommandAndEveryExitCode) {
    const std::string text = succeed({"--help"}).out;
    for (const std::string& command : kCommands)
        EXPECT_NE(text.find("\n  " + command + "  "), std::string::npos) << command;
    for (const char* code : {"  0  ", "  1  ", "  2  ", "  3  ", "  4  ", "130  "})
        EXPECT_NE(text.find(code), std::string::npos) << code;
    EXPECT_EQ(text, succeed({"help"}).out);
    EXPECT_EQ(text, succeed({"-h"}).out);
}

TEST(Help, ListsTheDocumentedOptionsOfLod) {
    const std::string text = succeed({"lod", "--help"}).out;
    for (const char* option :
         {"--iso V",         "--label L",     "--voxels N",    "--voxel LEN",  "--fit mask|binary|distance",
          "--half-width W",  "--band B",      "--levels A..B", "--steps A..B", "--format stl|ply|obj|off|glb",
          "--space lps|ras", "--open-border", "--threads N",   "--json FILE",  "--quiet",
          "--invert",        "--size",        "--type",        "--spacing",    "--endian",
          "--max-memory"})
        EXPECT_NE(text.find(option), std::string::npos) << option;
    EXPECT_EQ(text, succeed({"help", "lod"}).out);
}

TEST(Help, KeepsItsLinesShort) {
    for (const std::string& command : kCommands) {
        std::istringstream lines(succeed({"help", command}).out);
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 101u) << line;
    }
}

TEST(Version, IsOneLine) { EXPECT_EQ(succeed({"--version"}).out.rfind("isowave ", 0), 0u); }

// docs/interfaces.md holds what `isowave help --markdown` prints, between two marks.
TEST(Markdown, IsWhatTheDocumentationHolds) {
    const std::string document = contentOf(fs::path(ISOWAVE_SOURCE_DIR) / "docs/interfaces.md");
    const std::string begin = "<!-- begin: isowave help --markdown -->\n", end = "<!-- end -->\n";
    const auto from = document.find(begin);
    ASSERT_NE(from, std::string::npos) << "the mark is missing";
    const auto to = document.find(end, from);
    ASSERT_NE(to, std::string::npos) << "the mark is missing";
    EXPECT_EQ(document.substr(from + begin.size(), to - from - begin.size()),
              succeed({"help", "--markdown"}).out)
        << "run scripts/update-docs";
}

// ---- completion: source it in a real bash and press Tab ----

std::string completed(const std::vector<std::string>& words) {
    std::string array;
    for (const std::string& word : words) array += "'" + word + "' ";
    const std::string script = "source <('" ISOWAVE_BINARY "' completion bash); COMP_WORDS=(" + array +
                               "); COMP_CWORD=" + std::to_string(words.size() - 1) +
                               "; _isowave; echo \"${COMPREPLY[*]}\"";
    const fs::path out = fs::temp_directory_path() / ("isowave_completion_" + std::to_string(::getpid()));
    const fs::path file = out.string() + ".sh";
    std::ofstream(file) << script << "\n";
    EXPECT_EQ(::system(("bash " + file.string() + " > " + out.string()).c_str()), 0);
    std::string text = contentOf(out);
    fs::remove(out);
    fs::remove(file);
    if (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
}

TEST(Completion, OffersSubcommandsOptionsAndChoices) {
    EXPECT_EQ(completed({"isowave", "an"}), "analyse");
    EXPECT_EQ(completed({"isowave", "co"}), "compare completion");
    EXPECT_EQ(completed({"isowave", "lod", "a.stl", "--vox"}), "--voxels --voxel");
    EXPECT_EQ(completed({"isowave", "lod", "--format", "o"}), "obj off");
    EXPECT_EQ(completed({"isowave", "lod", "--fit", ""}), "mask binary distance");
    EXPECT_EQ(completed({"isowave", "check", "--vox"}), "") << "check samples nothing";
}

// ---- parser ----

TEST(Parser, TakesNegativeNumbers) {
    // Gets as far as the missing file: -300 was a number, not an option.
    const Result result = isowave({"lod", "no.nrrd", "--iso", "-300", "-o", "x"});
    EXPECT_EQ(result.exitCode, 3) << result.err;
}

TEST(Parser, RefusesAnOptionGivenTwice) {
    const Result result = isowave({"lod", "no.nrrd", "--iso", "1", "--iso", "2", "-o", "x"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.errorLines(), 1);
}

TEST(Parser, SaysWhichOptionLacksItsValue) {
    const Result result = isowave({"lod", "no.nrrd", "--iso", "-o", "x"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_NE(result.err.find("--iso: '-o' is not a number"), std::string::npos) << result.err;
    const Result next = isowave({"lod", "no.stl", "--glb-lods", "--colour", "distance", "-o", "x"});
    EXPECT_EQ(next.exitCode, 2);
    EXPECT_NE(next.err.find("--colour is an option, and the value quantized|float is missing before it"),
              std::string::npos)
        << next.err;
}

// A length with a unit where none is taken, or with an unknown one: what to write instead.
TEST(Lengths, WithAUnitSayWhichUnitTheyAreInAndWhatToWrite) {
    const struct {
        std::vector<std::string> arguments;
        std::string says;
    } cases[] = {
        {{"lod", "no.stl", "--voxel", "0.5mm", "-o", "x"},
         "--voxel: '0.5mm' is not a number; this length is in the units of the coordinates (mm for images) "
         "and is "
         "written without a unit: 0.5"},
        {{"lod", "no.stl", "--voxel", "3 furlong", "-o", "x"}, "written without a unit: 3"},
        {{"lod", "no.stl", "--close-holes", "2cm", "-o", "x"},
         "--close-holes: '2cm' is not a number; this length"},
        {{"lod", "no.stl", "--thicken", "1e-1mm", "-o", "x"}, "without a unit: 1e-1"},
        {{"lod", "no.stl", "--tolerance", "0.1,0.2mm", "-o", "x"},
         "--tolerance: '0.2mm' is not a number; this"},
        {{"lod", "no.nii", "--half-width", "4voxels", "-o", "x"}, "this length is in voxels and is written"},
        {{"lod", "no.nii", "--band", "2vx", "-o", "x"}, "this length is in voxels and is written"},
        {{"lod", "no.stl", "--adaptive", "3furlong", "-o", "x"},
         "--adaptive: '3furlong' is no length; the units are voxel (of level 0) and mm (the unit of the "
         "coordinates, whatever it is), write 3voxel or 3mm, or 3 which is the same as 3mm"},
        {{"lod", "no.stl", "--adaptive", "thin", "-o", "x"}, "--adaptive: 'thin' is not a number"},
        {{"lod", "no.stl", "--adaptive", "0mm", "-o", "x"}, "--adaptive: '0' is not above 0"},
        {{"pack", "no.stl", "--bound", "3um", "-o", "x.iwz"},
         "--bound: '3um' is no length with a unit; the units are voxel (of level 0) and mm (the unit of the "
         "coordinates, whatever it is), write 3voxel or 3mm"},
        {{"pack", "no.stl", "--bound", "0.1", "-o", "x.iwz"}, "write for example 0.1voxel or 0.05mm"},
        {{"compare", "a.stl", "b.stl", "--sampling", "1mm"},
         "--sampling: '1mm' is not a number; this length"},
        {{"edit", "a.vdb", "--blend", "1mm", "-o", "x.vdb"}, "--blend: '1mm' is not a number; this length"},
        {{"curves", "a.png", "--flatness", "1px", "-o", "x"}, "this length is in pixels of level 0"},
        {{"curve-levels", "a.txt", "--threshold", "1km", "-o", "x"},
         "this length is in the units of the input"},
        {{"reverse", "a.obj", "--threshold", "1m", "-o", "x.obj"},
         "this length is in the units of the input"},
        {{"rebuild", "a.obj", "--threshold", "1m", "-o", "x.obj"}, "this length is in the units of BASE"},
        {{"lod", "no.nii", "--iso", "300HU", "-o", "x"},
         "--iso: '300HU' is not a number; a unit is not taken here, write 300"},
        {{"lod", "no.nii", "--spacing", "1mmx1mmx2mm", "-o", "x"}, "a unit is not taken here, write 1"},
    };
    for (const auto& each : cases) {
        const Result result = isowave(each.arguments);
        EXPECT_EQ(result.exitCode, 2) << each.says << ": " << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_NE(result.err.find(each.says), std::string::npos) << each.says << ": " << result.err;
    }
}

}  // namespace
}  // namespace isowave::tools_test
