// Labels that info shows can be given back to --label; how they are compared is tested in tests/lod.
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

void writeScaled(const fs::path& file, float slope, float intercept) {
    const Size size{24, 24, 16};
    const auto labels = ringAndBall(size, 7, 3, true);  // 1 the ring, 2 the ball
    writeNifti(file, size, std::vector<std::int16_t>(labels.begin(), labels.end()));
    std::fstream header(file, std::ios::in | std::ios::out | std::ios::binary);
    header.seekp(112);
    header.write(reinterpret_cast<const char*>(&slope), 4);
    header.write(reinterpret_cast<const char*>(&intercept), 4);
}

TEST(Label, ThatInfoShowsIsFound) {
    const Folder folder;
    writeScaled(folder / "plain.nii", 1, 0);
    const auto meshOf = [&](const std::string& name, const std::string& label) {
        const std::string out = (folder / (name + ".off")).string();
        succeed({"mesh", (folder / (name + ".nii")).string(), "--label", label, "-o", out});
        return contentOf(out);
    };
    const std::string ring = meshOf("plain", "1"), ball = meshOf("plain", "2");
    EXPECT_NE(ring, ball);
    // A step that is small beside the labels: what is shown can be given back.
    writeScaled(folder / "fine.nii", 0.31f, 1697.6661f);
    const std::string shown = succeed({"info", (folder / "fine.nii").string()}).out;
    std::istringstream line(shown.substr(shown.find("\ndistinct") + 9));
    std::string background, first, second;
    line >> background >> first >> second;
    EXPECT_EQ(meshOf("fine", first), ring) << shown;
    EXPECT_EQ(meshOf("fine", second), ball) << shown;
}

// ---- --each-label

const Size kSize{24, 24, 16};

void writeSegmentation(const fs::path& file) {
    writeNrrd(file, kSize, ringAndBall(kSize, 7, 3, true),
              "spacings: 1 1 1\nSegment0_Name:=the ring\nSegment0_LabelValue:=1\nSegment0_Color:=1 0.5 0\n"
              "Segment1_Name:=ball\nSegment1_LabelValue:=2\n");
}

std::vector<std::string> forLevels(const fs::path& input, const fs::path& out,
                                   std::vector<std::string> more) {
    std::vector<std::string> all{"lod",      input.string(), "--levels", "0..1",
                                 "--format", "3mf",          "-o",       out.string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

nlohmann::json checked(const fs::path& mesh) {
    return nlohmann::json::parse(succeed({"check", mesh.string(), "--json", "-"}).out);
}

TEST(EachLabel, IsASolidAndAnObjectOfItsOwnInTheOneFileOfALevel) {
    const Folder folder;
    writeSegmentation(folder / "s.nrrd");
    succeed(forLevels(folder / "s.nrrd", folder / "all", {"--each-label"}));
    const nlohmann::json report = jsonFile(folder / "all/report.json");
    EXPECT_EQ(report["files"], (nlohmann::json{"all_L0.3mf", "all_L1.3mf"}));
    ASSERT_EQ(report["labels"].size(), 2u);
    EXPECT_EQ(report["labels"][0]["name"], "the ring");
    EXPECT_EQ(report["labels"][0]["colour"], "#FF8000");
    EXPECT_EQ(report["labels"][1]["name"], "ball");
    EXPECT_EQ(report["labels"][1]["colour"], "#56B4E9");  // the file gives none: the second of eight
    std::int64_t triangles = 0;
    for (const int label : {1, 2}) {
        const std::string name = std::to_string(label);
        succeed(forLevels(folder / "s.nrrd", folder / name, {"--label", name}));
        const nlohmann::json& entry = report["labels"][static_cast<std::size_t>(label - 1)];
        EXPECT_EQ(entry["label"], label);
        nlohmann::json alone = jsonFile(folder / name / "report.json")["levels"][0],
                       here = entry["report"]["levels"][0];
        for (nlohmann::json* level : {&alone, &here})
            for (const char* key : {"file", "seconds"}) level->erase(key);
        EXPECT_EQ(here, alone);
        triangles += alone["triangles"].get<std::int64_t>();
    }
    const nlohmann::json mesh = checked(folder / "all/all_L0.3mf");
    EXPECT_EQ(mesh["triangles"], triangles);
    EXPECT_EQ(mesh["components"], 2);
    std::vector<std::string> remarks = report["remarks"];
    EXPECT_EQ(
        std::count_if(remarks.begin(), remarks.end(),
                      [](const std::string& line) { return line.find("labels, mask fit") != line.npos; }),
        1);
    EXPECT_TRUE(std::any_of(remarks.begin(), remarks.end(),
                            [](const std::string& line) { return line.starts_with("the ring: "); }));
    EXPECT_EQ(mesh["genus"], 1);
}

TEST(EachLabel, TakesTheLabelsThatAreAskedForInTheirOrder) {
    const Folder folder;
    writeSegmentation(folder / "s.nrrd");
    succeed(forLevels(folder / "s.nrrd", folder / "some", {"--each-label", "--label", "2,1"}));
    const nlohmann::json report = jsonFile(folder / "some/report.json");
    ASSERT_EQ(report["labels"].size(), 2u);
    EXPECT_EQ(report["labels"][0]["label"], 2);
    writeScaled(folder / "plain.nii", 1, 0);
    succeed(forLevels(folder / "plain.nii", folder / "one", {"--each-label", "--label", "2"}));
    const nlohmann::json one = jsonFile(folder / "one/report.json");
    ASSERT_EQ(one["labels"].size(), 1u);
    EXPECT_EQ(one["labels"][0]["name"], "label 2");
}

TEST(EachLabel, IsRefusedInOneLineWhereItHasNoMeaning) {
    const Folder folder;
    writeSegmentation(folder / "s.nrrd");
    writeNrrd(folder / "grey.nrrd", kSize, greyBall(kSize, 6));
    const auto expectRefused = [&](const std::string& input, int code, const std::vector<std::string>& more,
                                   const std::string& words) {
        std::vector<std::string> all{"lod", (folder / input).string(), "--each-label", "-o",
                                     (folder / "no").string()};
        all.insert(all.end(), more.begin(), more.end());
        const Result result = isowave(all);
        EXPECT_EQ(result.exitCode, code) << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
        EXPECT_FALSE(fs::exists(folder / "no"));
    };
    expectRefused("s.nrrd", 2, {}, "give --format 3mf");
    expectRefused("s.nrrd", 2, {"--format", "3mf", "--triangles", "500"}, "--each-label and budgets");
    expectRefused("s.nrrd", 2, {"--format", "3mf", "--tiles", "3d-tiles"}, "--tiles shows one solid");
    expectRefused("grey.nrrd", 3, {"--format", "3mf", "--quiet"}, "is no label image");
    expectRefused("s.nrrd", 3, {"--format", "3mf", "--label", "7", "--quiet"}, "no voxel has the label 7");
}

}  // namespace
}  // namespace isowave::tools_test
