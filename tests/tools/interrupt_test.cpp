// Ctrl-C in commands that only read: at once, wherever the work is.
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

// True once the program catches SIGINT and has computed for half a second.
bool isAtWork(pid_t program) {
    const std::string process = "/proc/" + std::to_string(program);
    const std::string status = contentOf(process + "/status");
    const std::size_t caught = status.find("SigCgt:");
    if (caught == std::string::npos) return false;
    const unsigned long long mask = std::stoull(status.substr(caught + 7), nullptr, 16);
    if ((mask >> (SIGINT - 1) & 1) == 0) return false;

    // The name, in parentheses, is field 2; user time is field 14, in ticks.
    const std::string stat = contentOf(process + "/stat");
    std::istringstream fields(stat.substr(stat.rfind(')') + 1));
    std::string skipped;
    for (int field = 3; field < 14; ++field) fields >> skipped;
    long ticks = 0;
    return fields >> ticks && 2 * ticks > ::sysconf(_SC_CLK_TCK);
}

// Few large triangles and a fine sampling: hours within one triangle.
TEST(Interrupt, StopsCompareWhileItSamplesATriangle) {
    const Folder folder;
    writeStl(folder / "a.stl", torus(10, 4, 12, 6));
    writeStl(folder / "b.stl", torus(10, 4.5, 12, 6));
    const auto before = folder.snapshot();
    const std::vector<std::string> command{"compare", (folder / "a.stl").string(),
                                           (folder / "b.stl").string(), "--sampling", "0.0005"};
    EXPECT_EQ(isowave(command, {.mostSeconds = 1}).exitCode, 137) << "alone it goes on";
    const Result result = isowave(command, {.interruptWhen = isAtWork, .mostSeconds = 60});
    EXPECT_EQ(result.exitCode, 130) << result.err;  // 137: it did not stop
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(folder.snapshot(), before);
}

// All triangles of a fan through one axis meet: millions of pairs.
TEST(Interrupt, StopsCheckWhileItCountsIntersections) {
    const Folder folder;
    SmallMesh fan;
    for (int i = 0; i < 30000; ++i) {
        const double u = 1e-4 * i, x = std::cos(u), y = std::sin(u);
        for (const std::array<double, 3>& p :
             {std::array{x, y, 0.0}, std::array{-x, -y, 0.1}, std::array{0.0, 0.0, 1 + 1e-5 * i}}) {
            fan.points.push_back(p);
        }
        fan.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    writeStl(folder / "fan.stl", fan);
    const Result result = isowave({"check", (folder / "fan.stl").string(), "--self-intersections"},
                                  {.interruptWhen = isAtWork, .mostSeconds = 60});
    EXPECT_EQ(result.exitCode, 130) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_EQ(result.out, "");
}

}  // namespace
}  // namespace isowave::tools_test
