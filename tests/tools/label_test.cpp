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

}  // namespace
}  // namespace isowave::tools_test
