// isowave compare where there is nothing to divide by.
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

// A square in the plane z = 0: its volume is 0.
TEST(Compare, HasNoPercentageOfAVolumeThatIsZero) {
    const Folder folder;
    SmallMesh square;
    square.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    writeOff(folder / "flat.off", square);
    writeStl(folder / "ring.stl", torus(10, 4));
    const std::string flat = (folder / "flat.off").string(), ring = (folder / "ring.stl").string();
    for (const std::string& other : {ring, flat}) {
        const std::string text = succeed({"compare", flat, other, "--sampling", "1"}).out;
        EXPECT_NE(text.find("(- %)"), std::string::npos) << text;
    }
    const std::string text = succeed({"compare", ring, flat, "--sampling", "1"}).out;
    EXPECT_NE(text.find("(-100 %)"), std::string::npos) << text;
}

}  // namespace
}  // namespace isowave::tools_test
