// What is said beside results: progress, --verbose, suggestions, --dry-run, --version --verbose, man pages, completion.
#include <gmock/gmock.h>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"
#include "tools/overall.h"
#include "tools/similar.h"

namespace isowave::tools_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// ---- the whole of a run from its stages

TEST(Overall, NeverFallsAndEndsAtOne) {
    tools::Overall overall;
    double before = 0;
    for (const char* stage : {"reading", "repairing", "finding the inside", "measuring distances", "walls",
                              "fitting", "analysing"})
        for (const double done : {0.0, 0.5, 0.2, 1.0}) {
            const double now = overall.at(stage, done).value();
            EXPECT_GE(now, before) << stage;
            before = now;
        }
    EXPECT_EQ(before, 1);
    EXPECT_EQ(overall.at("writing", 0), 1.0) << "a stage without a share keeps the last one";
}

TEST(Overall, KnowsNothingBeforeAStageOfTheTable) {
    tools::Overall overall;
    EXPECT_FALSE(overall.at("subdividing", 0.5));
}

TEST(Overall, CountsPartsThatAreDone) {
    tools::Overall overall;
    overall.startPart(3, 4);
    EXPECT_EQ(overall.at("analysing", 1), 1.0);
    overall.startPart(1, 4);
    EXPECT_EQ(overall.at("reading", 0), 0.25);
}

TEST(ProgressLine, SaysStageShareRateAndTimeLeft) {
    const tools::ProgressFacts facts{"fitting", 0.25, true, 30};
    EXPECT_EQ(tools::plainText(facts), "25 %, fitting, 1:30 left");
    EXPECT_EQ(tools::barText(facts, 100), "[#####---------------]  25 %  fitting  0.83 %/s  1:30 left");
    EXPECT_EQ(tools::barText(facts, 20).size(), 20u);
    EXPECT_EQ(tools::plainText({"fitting", 0.25, true, 1}), "25 %, fitting") << "too early to tell";
    EXPECT_EQ(tools::plainText({"subdividing", 0.25, false, 30}), "25 %, subdividing");
}

// ---- did you mean

TEST(Similar, CountsEdits) {
    EXPECT_EQ(tools::editDistance("", "abc"), 3u);
    EXPECT_EQ(tools::editDistance("lod", "lod"), 0u);
    EXPECT_EQ(tools::editDistance("ldo", "lod"), 1u) << "neighbours swapped";
    EXPECT_EQ(tools::editDistance("kitten", "sitting"), 3u);
    EXPECT_EQ(tools::editDistance("ca", "abc"), 3u) << "no place is edited twice";
}

TEST(Similar, FindsTheWordThatWasMeantOrNone) {
    const std::vector<std::string_view> words{"lod",        "analyse", "compare",
                                              "completion", "curves",  "curve-levels"};
    EXPECT_EQ(tools::similarTo("analyze", words), "analyse");
    EXPECT_EQ(tools::similarTo("comparre", words), "compare");
    EXPECT_EQ(tools::similarTo("compl", words), "completion") << "the only one that begins so";
    EXPECT_EQ(tools::similarTo("c", words), "") << "several begin so";
    EXPECT_EQ(tools::similarTo("banana", words), "");
}

TEST(Suggestion, IsInTheOneLineOfAMistypedCommandOrOption) {
    const Result command = isowave({"analyze", "part.stl"});
    EXPECT_EQ(command.exitCode, 2);
    EXPECT_EQ(command.errorLines(), 1);
    EXPECT_THAT(command.err,
                HasSubstr("there is no subcommand 'analyze'; did you mean analyse? See isowave --help"));
    const Result option = isowave({"lod", "part.stl", "--voxls", "32", "-o", "out"});
    EXPECT_EQ(option.exitCode, 2);
    EXPECT_EQ(option.errorLines(), 1);
    EXPECT_THAT(option.err, HasSubstr("there is no option --voxls of lod; did you mean --voxels?"));
    const Result equals = isowave({"lod", "part.stl", "--tolerence=0.5", "-o", "out"});
    EXPECT_THAT(equals.err, HasSubstr("did you mean --tolerance?"));
    const Result nothing = isowave({"lod", "part.stl", "--banana", "-o", "out"});
    EXPECT_THAT(nothing.err, HasSubstr("there is no option --banana"));
    EXPECT_THAT(nothing.err, Not(HasSubstr("did you mean")));
    EXPECT_THAT(isowave({"help", "anlayse"}).err, HasSubstr("did you mean analyse?"));
}

// ---- progress and stages

TEST(Progress, PlainIsLinesThatNeverFallBack) {
    const Folder folder;
    writeStl(folder / "t.stl", torus(10, 4));
    const Result result = succeed({"lod", (folder / "t.stl").string(), "--voxels", "32", "--quiet",
                                   "--progress", "plain", "-o", (folder / "out").string()});
    std::istringstream lines(result.err);
    int count = 0, before = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        EXPECT_EQ(line.rfind("isowave: ", 0), 0u) << line;
        const int percent = std::stoi(line.substr(9));
        EXPECT_GE(percent, before) << line;
        before = percent;
    }
    EXPECT_GE(count, 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("isowave: 0 %, reading\n"));
    EXPECT_THAT(result.err, Not(HasSubstr("\r")));
}

TEST(Progress, IsNothingOffATerminalUnlessAskedFor) {
    const Folder folder;
    writeStl(folder / "t.stl", torus(10, 4));
    const std::string input = (folder / "t.stl").string(), out = (folder / "out").string();
    EXPECT_EQ(succeed({"lod", input, "--voxels", "24", "--quiet", "-o", out}).err, "");
    const Result bar = succeed({"lod", input, "--voxels", "24", "--quiet", "--progress", "bar", "-o", out});
    EXPECT_THAT(bar.err, HasSubstr("\r\033[K["));
    EXPECT_TRUE(bar.err.ends_with("\r\033[K")) << "the line is taken away in the end";
}

TEST(Verbose, TellsSecondsAndMemoryByStage) {
    const Folder folder;
    writeStl(folder / "t.stl", torus(10, 4));
    const Result result = succeed({"lod", (folder / "t.stl").string(), "--voxels", "48", "--quiet",
                                   "--verbose", "-o", (folder / "out").string()});
    std::istringstream lines(result.err);
    std::map<std::string, double> seconds;
    double sum = 0;
    for (std::string line; std::getline(lines, line);) {
        ASSERT_GT(line.size(), 40u) << line;
        const std::string stage = line.substr(2, line.find("  ", 2) - 2);
        seconds[stage] = std::stod(line.substr(24));
        if (stage != "whole run") sum += seconds[stage];
        EXPECT_THAT(line, HasSubstr("MB")) << line;
    }
    for (const char* stage :
         {"reading", "fitting", "polygonizing", "distances of vertices", "writing", "whole run"})
        EXPECT_TRUE(seconds.count(stage)) << stage << '\n' << result.err;
    EXPECT_NEAR(seconds["whole run"], sum, 0.005 * static_cast<double>(seconds.size()) + 0.01);
}

TEST(Version, VerboseNamesLibrariesThreadsSimdAndAllocator) {
    const std::string text = succeed({"--version", "--verbose"}).out;
    EXPECT_EQ(text.rfind(succeed({"--version"}).out, 0), 0u);
    for (const char* key :
         {"\nlibraries ", "OpenVDB 1", "oneTBB 20", "\nthreads ", "\nSIMD ", "\nallocator ", "\nlicence "})
        EXPECT_THAT(text, HasSubstr(key));
    EXPECT_EQ(isowave({"--verbose"}).exitCode, 2) << "of nothing";
}

// ---- dry run: a tube of known walls

// A box with a box-shaped cavity: walls of 2 in x, 4 in y and z.
SmallMesh hollowBox() {
    SmallMesh mesh;
    const auto add = [&](double x, double y, double z, bool turned) {
        const int first = static_cast<int>(mesh.points.size());
        for (int k = 0; k < 8; ++k) mesh.points.push_back({k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z});
        for (const std::array<int, 4>& q :
             {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4}, std::array{2, 6, 7, 3},
              std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
            for (std::array<int, 3> t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
                if (turned) std::swap(t[1], t[2]);
                mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
            }
    };
    add(20, 20, 20, false);
    add(18, 16, 16, true);
    return mesh;
}

TEST(DryRun, SaysHowThickTheWallsOfAMeshAreAndWritesNothing) {
    const Folder folder;
    writeStl(folder / "box.stl", hollowBox());
    const auto before = folder.snapshot();
    const std::string input = (folder / "box.stl").string();
    const Result result = succeed({"lod", input, "--voxels", "80", "--dry-run", "--quiet"});
    EXPECT_THAT(result.out, HasSubstr("80 x 80 x 80 voxels of 0.5 x 0.5 x 0.5"));
    // Walls of 2 are 4 voxels; those of 4, of which there are more, 8.
    EXPECT_THAT(result.out, HasSubstr("the thinnest 1, 5, 50 % are 4, 4, 8 voxels thick"));
    EXPECT_EQ(folder.snapshot(), before);
    const std::string pyramid = succeed({"analyse", input, "--voxels", "80", "--dry-run", "--quiet"}).out;
    EXPECT_EQ(pyramid.substr(pyramid.find("  levels")), result.out.substr(result.out.find("  levels")));
    EXPECT_THAT(pyramid, HasSubstr("MB for the pyramid (limit"));
    const auto megabytes = [](const std::string& out) {
        return std::stod(out.substr(out.find("memory  about ") + 14));
    };
    EXPECT_LT(megabytes(pyramid), megabytes(result.out));
}

TEST(DryRun, AgreesWithTheRunItself) {
    const Folder folder;
    writeStl(folder / "box.stl", hollowBox());
    const std::string input = (folder / "box.stl").string();
    const std::string text = succeed({"lod", input, "--voxels", "80", "--dry-run", "--quiet"}).out;
    succeed({"lod", input, "--voxels", "80", "--quiet", "-o", (folder / "out").string()});
    const auto report = jsonFile(folder / "out" / "report.json");
    const auto level = text.find("0 to at most ");
    ASSERT_NE(level, std::string::npos) << text;
    EXPECT_GE(std::stoi(text.substr(level + 13)), report.at("levels").back().at("level").get<int>());
    const auto memory = text.find("memory  about ");
    ASSERT_NE(memory, std::string::npos) << text;
    const double said = std::stod(text.substr(memory + 14)) * 1e6,
                 taken = report.at("peak_memory_bytes").get<double>();
    EXPECT_GT(taken, 0.5 * said) << text;
    EXPECT_LT(taken, 2.5 * said) << text;
    EXPECT_NEAR(report.at("levels")[0].at("walls")[0].at("voxels").get<double>(), 4, 0.1);
}

TEST(DryRun, SaysHowThickTheWallsOfAMaskAreAtMost) {
    const Folder folder;
    const Size size{40, 40, 40};
    // A plate of 3 voxels across z, and a block of 20.
    const auto values = sampled<std::uint8_t>(size, [](int x, int y, int z) {
        const bool plate = z >= 2 && z < 5 && x >= 2 && x < 38 && y >= 2 && y < 38;
        const bool block = z >= 10 && z < 30 && x >= 10 && x < 30 && y >= 10 && y < 30;
        return plate || block;
    });
    writeNrrd(folder / "mask.nrrd", size, values);
    const Result result = succeed({"lod", (folder / "mask.nrrd").string(), "--dry-run", "--quiet"});
    EXPECT_THAT(result.out, HasSubstr("mask, 40 x 40 x 40 voxels"));
    EXPECT_THAT(result.out, HasSubstr("the thinnest 1, 5, 50 % are at most 3, 3, 3 voxels thick"));
}

TEST(DryRun, SaysWhenMemoryWouldNotSufficeAndGoesOnAfterAFailure) {
    const Folder folder;
    writeStl(folder / "box.stl", hollowBox());
    const std::string input = (folder / "box.stl").string(), missing = (folder / "none.stl").string();
    EXPECT_THAT(succeed({"lod", input, "--dry-run", "--max-memory", "0.01", "--quiet"}).out,
                HasSubstr("it would be refused"));
    EXPECT_EQ(isowave({"lod", missing, "--dry-run"}).exitCode, 3);
    const Result two = isowave({"lod", missing, input, "--dry-run", "--quiet"});
    EXPECT_EQ(two.exitCode, 3);
    EXPECT_EQ(two.errorLines(), 1) << two.err;
    EXPECT_THAT(two.out, HasSubstr("box.stl: mesh"));
    EXPECT_EQ(isowave({"lod", input, "--dry-run", "--json", "-"}).exitCode, 2);
}

// ---- man pages and completion

TEST(ManPages, HaveEveryCommandAndOptionAndAreReadByMan) {
    const Folder folder;
    succeed({"help", "--man", (folder / "man1").string()});
    const std::string page = contentOf(folder / "man1" / "isowave-lod.1");
    EXPECT_THAT(page, HasSubstr(".TH ISOWAVE\\-LOD 1"));
    EXPECT_THAT(page, HasSubstr(".B \\-\\-voxels N"));
    EXPECT_THAT(contentOf(folder / "man1" / "isowave.1"), HasSubstr("isowave\\-analyse (1)"));
    for (const auto& entry : fs::directory_iterator(folder / "man1")) {
        std::istringstream lines(contentOf(entry.path()));
        for (std::string line; std::getline(lines, line);) {
            if (line.empty() || line[0] != '.') continue;
            EXPECT_THAT(line, ::testing::MatchesRegex("\\.(TH|SH|TP|B|BR|br)( .*)?")) << entry.path();
        }
    }
    if (::system("command -v man > /dev/null") != 0)
        GTEST_SKIP() << "there is no man; apt-get install man-db";
    const std::string out = (folder / "out").string();
    const std::string command = "MANWIDTH=80 LC_ALL=C man --warnings=w -l '" +
                                (folder / "man1" / "isowave-lod.1").string() + "' > '" + out + "' 2> '" +
                                out + ".err'";
    EXPECT_EQ(::system(command.c_str()), 0);
    EXPECT_EQ(contentOf(out + ".err"), "");
    EXPECT_THAT(contentOf(out), HasSubstr("--voxels N"));
}

TEST(Completion, ForZshIsReadByZshAndOffersTheSame) {
    const std::string script = succeed({"completion", "zsh"}).out;
    EXPECT_EQ(script.rfind("#compdef isowave\n", 0), 0u);
    for (const char* part :
         {"'lod:", "--voxels[", "(mask binary distance)", "'(-o --output)'{-o,--output}'["})
        EXPECT_THAT(script, HasSubstr(part));
    EXPECT_EQ(isowave({"completion", "fish"}).exitCode, 2);
    if (::system("command -v zsh > /dev/null") != 0) GTEST_SKIP() << "there is no zsh; apt-get install zsh";
    const Folder folder;
    // Tab in a real zsh, in a pseudo-terminal of its own.
    std::ofstream(folder / "_isowave") << script;
    std::ofstream(folder / "press.zsh") << R"(
zmodload zsh/zpty
zpty -b z 'PS1=READY TERM=dumb zsh -f -i'
zpty -w z "fpath=($1 \$fpath); autoload -U compinit; compinit -u -D; bindkey '^I' complete-word; echo D''ONE"
zpty -r -m z line '*DONE*'
zpty -w -n z $'isowave lod --fit \t'
sleep 2
zpty -w -n z $'\t'
sleep 1
zpty -r z line
while zpty -r -t z more; do line+=$more; done
print -r -- $line
)";
    const std::string out = (folder / "out").string();
    const std::string command = "timeout 60 zsh -f '" + (folder / "press.zsh").string() + "' '" +
                                folder.path().string() + "' > '" + out + "' 2>&1";
    EXPECT_EQ(::system(command.c_str()), 0);
    EXPECT_THAT(contentOf(out),
                ::testing::AnyOf(HasSubstr("distance"), HasSubstr("binary"), HasSubstr("mask")));
}

}  // namespace
}  // namespace isowave::tools_test
