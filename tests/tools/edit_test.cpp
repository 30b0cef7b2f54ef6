// isowave edit: what it writes and tells, and that it leaves nothing behind where it refuses.
#include <gmock/gmock.h>

#include "tests/tools/inputs.h"
#include "tests/tools/refusal.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class EditedTorus : public ::testing::Test {
  protected:
    EditedTorus() {
        writeStl(folder / "torus.stl", torus(20, 8));
        succeed({"analyse", at("torus.stl"), "--voxels", "40", "-o", at("old.vdb")});
    }
    std::string at(const std::string& name) const { return (folder / name).string(); }
    Json edit(std::vector<std::string> options, const std::string& input, const std::string& name) const {
        options.insert(options.begin(), {"edit", at(input), "-o", at(name), "--json", "-"});
        return succeed(options).json();
    }
    void expectRefused(std::vector<std::string> options, int exitCode, const std::string& text) const {
        options.insert(options.begin(), {"edit", at("old.vdb")});
        tools_test::expectRefused(folder, options, exitCode, text);
    }
    Folder folder;
};

TEST_F(EditedTorus, IsAPyramidThatEverythingTakes) {
    const Json told =
        edit({"--add", "ball:0,0,0,6", "--cut", "18,-3,-3:23,3,3", "--check"}, "old.vdb", "new.vdb");
    EXPECT_EQ(told["edits"].size(), 2U);
    EXPECT_EQ(told["edits"][0]["edit"], "--add ball:0,0,0,6");
    EXPECT_NEAR(told["edits"][0]["volume_change"], told["edits"][0]["tool_volume"],
                0.02 * told["edits"][0]["tool_volume"].get<double>());
    EXPECT_EQ(told["edits"][0]["parts_after"], 2);
    EXPECT_LT(told["edits"][1]["volume_change"], -100);
    EXPECT_EQ(told["steps_closed"], told["steps_checked"]);
    EXPECT_THAT(told["remarks"].dump(), HasSubstr("touches nothing"));
    succeed({"mesh", at("new.vdb"), "--level", "1", "-o", at("level1.ply")});
    EXPECT_EQ(isowave({"check", at("level1.ply")}).exitCode, 0);
    EXPECT_THAT(succeed({"info", at("new.vdb")}).out, HasSubstr("edit.0"));
    edit({"--cut", "ball:20,0,0,3"}, "new.vdb", "packed.iwz");
    succeed({"mesh", at("packed.iwz"), "-o", at("level0.ply")});
}

// Edits stand on the line in the order in which they are made: a cut before an add leaves what is added.
TEST_F(EditedTorus, MakesTheEditsInTheirOrder) {
    const Json addFirst = edit({"--add", "ball:0,0,0,6", "--cut", "ball:0,0,0,4"}, "old.vdb", "a.vdb"),
               cutFirst = edit({"--cut", "ball:20,0,0,4", "--add", "ball:20,0,0,4"}, "old.vdb", "b.vdb");
    EXPECT_EQ(addFirst["edits"][1]["edit"], "--cut ball:0,0,0,4");
    EXPECT_EQ(cutFirst["edits"][0]["edit"], "--cut ball:20,0,0,4");
    EXPECT_NEAR(cutFirst["edits"][0]["volume_change"].get<double>() +
                    cutFirst["edits"][1]["volume_change"].get<double>(),
                0, 5);
}

TEST_F(EditedTorus, IsUndoneByTheOldPyramidToTheByte) {
    edit({"--move", "-30,-30,-10:-5,30,10", "--by", "-4.5,0,0", "--level", "1"}, "old.vdb", "new.vdb");
    edit({"--with", at("old.vdb")}, "new.vdb", "again.vdb");
    EXPECT_EQ(contentOf(folder / "again.vdb"), contentOf(folder / "old.vdb"));
}

TEST_F(EditedTorus, TakesALevelThatWasChanged) {
    succeed({"field", at("old.vdb"), "--level", "1", "-o", at("level1.vdb")});
    expectRefused({"--with", at("level1.vdb"), "--level", "1", "-o", at("x.vdb")}, 3, "nothing would change");
    expectRefused({"--with", at("level1.vdb"), "-o", at("x.vdb")}, 3, "another lattice");
    edit({"--cut", "ball:20,0,0,5"}, "old.vdb", "new.vdb");
    const Json told = edit({"--with", at("level1.vdb"), "--level", "1"}, "new.vdb", "filled.vdb");
    EXPECT_GT(told["edits"][0]["volume_change"], 300);
}

TEST_F(EditedTorus, RefusesWhatMakesNoSense) {
    const std::string out = at("x.vdb");
    expectRefused({"-o", out}, 2, "no edit");
    for (const std::string bad : {"0", "-1", "nan", "x"}) {
        expectRefused({"--cut", "ball:20,0,0,3", "--blend", bad, "-o", out}, 2, "--blend");
        expectRefused({"--cut", "ball:20,0,0," + bad, "-o", out}, 2, "--cut");
    }
    expectRefused({"--cut", "ball:20,0,3", "-o", out}, 2, "ball:X,Y,Z,R");
    expectRefused({"--cut", "1,2,3", "-o", out}, 2, "two opposite corners");
    expectRefused({"--cut", "box:1,2,3", "-o", out}, 2, "box:X,Y,Z,X,Y,Z");
    expectRefused({"--cut", "box:1,2,3:4,5,6", "-o", out}, 2, "'box:1,2,3:4,5,6' is not a box");
    expectRefused({"--cut", "0,0,0:1,0,1", "-o", out}, 2, "no extent along y");
    expectRefused({"--by", "1,0,0", "-o", out}, 2, "--by: stands behind a --move");
    expectRefused({"--move", "0,0,0:9,9,9", "-o", out}, 2, "moves by nothing; --by X,Y,Z");
    expectRefused({"--cut", "ball:500,0,0,3", "-o", out}, 3, "misses the solid");
    expectRefused({"--add", "ball:20,0,0,2", "-o", out}, 3, "lies in the solid altogether");
    expectRefused({"--cut", "ball:0,0,0,60", "-o", out}, 3, "removes all of the solid");
    expectRefused({"--cut", "ball:0,0,0,1e9", "-o", out}, 3, "in the units of the solid?");
    expectRefused({"--add", "ball:0,0,0,1500", "--max-memory", "1", "-o", out}, 3,
                  "--add ball:0,0,0,1500: would take");
    expectRefused({"--add", "ball:0,0,0,6", "--max-memory", "0", "-o", out}, 2, "--max-memory");
    expectRefused({"--cut", at("none.stl"), "-o", out}, 3, "none.stl");
    expectRefused({"--cut", at("torus.stl"), "-o", at("torus.stl")}, 2, "-o");
    expectRefused({"--with", at("old.vdb"), "-o", at("old.vdb")}, 2, "old.vdb");
    expectRefused({"--with", at("torus.stl"), "-o", out}, 3, "torus.stl");
    expectRefused({"--cut", "ball:20,0,0,3", "--level", "99", "-o", out}, 2,
                  "--level: the pyramid has levels 0 to");
    const Result result = isowave({"edit", at("torus.stl"), "--cut", "ball:20,0,0,3", "-o", out});
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_EQ(result.errorLines(), 1) << result.err;
}

}  // namespace
}  // namespace isowave::tools_test
