// OutputFolder: all files change, or none.
#include "tools/output.h"
#include "isowave/error.h"
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

// A folder with an earlier result in it.
class EarlierResult : public ::testing::Test {
  protected:
    EarlierResult() {
        fs::create_directories(folder / "out");
        for (const char* name : {"a", "b", "c", "mine"})
            write(folder / "out" / name, std::string("old ") + name);
    }
    Folder folder;
};

TEST_F(EarlierResult, IsReplacedFileByFile) {
    tools::OutputFolder out(folder / "out");
    for (const char* name : {"a", "c", "new"}) write(out.place(name), std::string("new ") + name);
    out.commit();
    EXPECT_EQ(folder.snapshot(), (std::map<std::string, std::string>{{"out", "(folder)"},
                                                                     {"out/a", "new a"},
                                                                     {"out/b", "old b"},
                                                                     {"out/c", "new c"},
                                                                     {"out/mine", "old mine"},
                                                                     {"out/new", "new new"}}));
}

TEST(OutputFolder, IsNotMadeBehindALinkToNothing) {
    const Folder folder;
    fs::create_directory_symlink("none", folder / "out");
    EXPECT_THROW(tools::OutputFolder(folder / "out"), OperationError);
    fs::create_directory(folder / "none");
    tools::OutputFolder out(folder / "out");
    write(out.place("a"), "new a");
    out.commit();
    EXPECT_EQ(contentOf(folder / "none/a"), "new a");
}

// A file that was promised but never written is one that cannot be renamed.
TEST_F(EarlierResult, ComesBackWhenARenamingHalfWayFails) {
    const auto before = folder.snapshot();
    {
        tools::OutputFolder out(folder / "out");
        for (const char* name : {"a", "new"}) write(out.place(name), std::string("new ") + name);
        out.place("b");
        write(out.place("c"), "new c");
        EXPECT_THROW(out.commit(), OperationError);
    }
    EXPECT_EQ(folder.snapshot(), before);
}

// Coarser levels than before, or fewer: the others are still there, and are named once.
TEST(LadderFolder, NamesMeshesOfAnEarlierRun) {
    const Folder folder;
    writeNrrd(folder / "a.nrrd", {32, 32, 32}, greyBall({32, 32, 32}, 10));
    const auto lod = [&](const std::string& levels) {
        return isowave({"lod", (folder / "a.nrrd").string(), "--iso", "0", "--levels", levels, "-o",
                        (folder / "out").string()});
    };
    EXPECT_EQ(lod("0..2").err.find("earlier run"), std::string::npos);
    const Result fewer = lod("1");
    EXPECT_EQ(fewer.exitCode, 0);
    EXPECT_NE(fewer.err.find("out: out_L0.ply, out_L2.ply of an earlier run stay there"), std::string::npos)
        << fewer.err;
    EXPECT_TRUE(fs::exists(folder / "out/out_L2.ply"));
    EXPECT_EQ(lod("1").err.find("earlier run"), std::string::npos) << "the report names what is there";
    write(folder / "out/report.json", "no report");
    EXPECT_EQ(lod("1").exitCode, 0);
}

}  // namespace
}  // namespace isowave::tools_test
