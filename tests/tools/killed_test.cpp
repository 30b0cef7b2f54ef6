// A run that is stopped at any moment, or that finds no room: what was there before stays whole, and under a final name
// there is never half a file.
//
// ISOWAVE_EVERY_MOMENT=1 in the environment tries 50 moments of each signal for each command instead of 6.
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdlib>
#include <random>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Arguments = std::vector<std::string>;
using Files = std::map<std::string, std::string>;
using testing::HasSubstr;

// A command that writes below OUT, in two ways, so that an earlier result is told from a later one.
struct Job {
    const char* name;
    Arguments earlier, later;  // IN, OUT: folders
};

const std::vector<Job>& jobs() {
    static const std::vector<Job> all{
        {"ladder",
         {"lod", "IN/a.nrrd", "--iso", "0", "-o", "OUT/part"},
         {"lod", "IN/a.nrrd", "--iso", "30", "-o", "OUT/part"}},
        {"pyramid",
         {"analyse", "IN/a.nrrd", "--iso", "0", "-o", "OUT/a.vdb"},
         {"analyse", "IN/a.nrrd", "--iso", "30", "-o", "OUT/a.vdb"}},
        {"mesh",
         {"mesh", "IN/a.nrrd", "--iso", "0", "-o", "OUT/a.stl"},
         {"mesh", "IN/a.nrrd", "--iso", "30", "-o", "OUT/a.stl"}},
        {"field",
         {"field", "IN/a.nrrd", "--iso", "0", "-o", "OUT/a.vdb"},
         {"field", "IN/a.nrrd", "--iso", "30", "-o", "OUT/a.vdb"}},
        {"curves",
         {"curves", "IN/a.txt", "--pixels", "200", "-o", "OUT/part"},
         {"curves", "IN/a.txt", "--pixels", "300", "-o", "OUT/part"}},
        {"subdivide",
         {"subdivide", "IN/a.off", "--scheme", "loop", "--depth", "2", "-o", "OUT/a.ply"},
         {"subdivide", "IN/a.off", "--scheme", "loop", "--depth", "3", "-o", "OUT/a.ply"}},
        {"reverse",
         {"reverse", "IN/fine.off", "--scheme", "loop", "--depth", "1", "-o", "OUT/a.ply", "--details",
          "OUT/a.d"},
         {"reverse", "IN/fine.off", "--scheme", "loop", "--depth", "2", "-o", "OUT/a.ply", "--details",
          "OUT/a.d"}}};
    return all;
}

class Stopped : public testing::TestWithParam<Job> {
  protected:
    Stopped() {
        fs::create_directories(folder / "in");
        fs::create_directories(folder / "out");
        writeNrrd(folder / "in/a.nrrd", {64, 64, 64}, greyBall({64, 64, 64}, 24));
        std::ofstream rings(folder / "in/a.txt");
        for (int k = 0; k < 4000; ++k) {
            const double a = 6.28318530717958 * k / 4000, r = 10 + std::sin(40 * a);
            rings << r * std::cos(a) << ' ' << r * std::sin(a) << '\n';
        }
        writeOff(folder / "in/a.off", torus(20, 8));
        succeed({"subdivide", (folder / "in/a.off").string(), "--scheme", "loop", "--depth", "2", "-o",
                 (folder / "in/fine.off").string()});
    }
    Arguments filled(Arguments arguments) const {
        for (std::string& a : arguments) {
            if (a.starts_with("IN/")) a = (folder / "in").string() + a.substr(2);
            if (a.starts_with("OUT/")) a = out().string() + a.substr(3);
        }
        return arguments;
    }
    virtual fs::path out() const { return folder / "out"; }
    // Every file below out(), with its content.
    Files files() const {
        Files result;
        for (const auto& entry : fs::recursive_directory_iterator(out()))
            if (entry.is_regular_file())
                result[entry.path().lexically_relative(out()).string()] = contentOf(entry.path());
        return result;
    }
    void put(const Files& all) const {
        for (const auto& entry : fs::directory_iterator(out())) fs::remove_all(entry.path());
        for (const auto& [name, bytes] : all) {
            fs::create_directories((out() / name).parent_path());
            std::ofstream(out() / name, std::ios::binary) << bytes;
        }
    }
    Files resultOf(const Arguments& arguments) {
        put({});
        const Result result = isowave(filled(arguments));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return files();
    }
    Folder folder;
};

// Reports hold times, which differ from run to run.
bool isReport(const std::string& name) { return name.ends_with(".json"); }

// A temporary name, which only a program that was killed leaves behind.
bool isTemporary(const std::string& name) { return name.find(".part-") != std::string::npos; }

// What is wrong with `found` after a run that replaces `before` by `after` and was stopped; "" where nothing is.
std::string faultOf(const Files& found, const Files& before, const Files& after) {
    for (const auto& [name, bytes] : before)
        if (!found.contains(name)) return name + " is gone";
    for (const auto& [name, bytes] : found) {
        if (isTemporary(name)) continue;
        const auto old = before.find(name), now = after.find(name);
        if (old != before.end() && bytes == old->second) continue;
        if (now == after.end()) return name + " is of neither run";
        if (isReport(name) ? !nlohmann::json::accept(bytes) : bytes != now->second)
            return name + " is not whole";
    }
    return "";
}

int momentsEach() { return std::getenv("ISOWAVE_EVERY_MOMENT") ? 50 : 6; }

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TEST_P(Stopped, LeavesWhatWasThereOrTheWholeResult) {
    const Files before = resultOf(GetParam().earlier);
    const double start = seconds();
    const Files after = resultOf(GetParam().later);
    const double whole = seconds() - start;
    ASSERT_FALSE(before == after);
    std::mt19937 random(1);
    int finished = 0, stopped = 0;
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        for (int moment = 0; moment < momentsEach(); ++moment) {
            put(before);
            const double when = whole * std::uniform_real_distribution<double>(0, 1.05)(random);
            const Result result = isowave(filled(GetParam().later), {.signalAfter = {{signal, when}}});
            SCOPED_TRACE("signal " + std::to_string(signal) + " after " + std::to_string(when) + " s of " +
                         std::to_string(whole) + ": code " + std::to_string(result.exitCode) + ", " +
                         result.err);
            EXPECT_EQ(faultOf(files(), before, after), "");
            // 128 + signal: before the program's first line could run, or by SIGKILL.
            if (result.exitCode == 0) {
                ++finished;
                continue;
            }
            ++stopped;
            EXPECT_TRUE(result.exitCode == 130 || result.exitCode == 128 + signal);
            if (signal == SIGKILL) {  // remarks are shown when all is done
                if (files() == before) {
                    EXPECT_EQ(result.errorLines(), 0);
                }
                continue;
            }
            EXPECT_LE(result.errorLines(), 1);
            EXPECT_TRUE(files() == before);
        }
    }
    std::cout << GetParam().name << ": " << stopped << " runs stopped, " << finished << " were done before\n";
    EXPECT_GT(stopped, 0);
}

// ---- no room

class NoRoom : public Stopped {
  protected:
    // The run that finds no room fails in one line, and nothing has changed. Returns how many did.
    void expectRefusals(const std::function<Result(std::size_t bytes)>& run) {
        const Files before = files(), after = later_;
        std::size_t largest = 0;
        for (const auto& [name, bytes] : after) largest = std::max(largest, bytes.size());
        for (const int share : {0, 5, 40, 80, 99}) {
            // Standard error is a file, too, and has its line.
            const Result result =
                run(std::max<std::size_t>(1000, largest * static_cast<std::size_t>(share) / 100));
            SCOPED_TRACE(std::to_string(share) + " %: " + result.err);
            EXPECT_EQ(result.exitCode, 1);
            EXPECT_EQ(result.errorLines(), 1);
            EXPECT_TRUE(files() == before);
        }
    }
    Files later_;
};

// `ulimit -f`: as on a full disk, every write beyond it fails.
TEST_P(NoRoom, UnderALimitOfFileSizesIsSaidInOneLine) {
    later_ = resultOf(GetParam().later);
    put(resultOf(GetParam().earlier));
    expectRefusals(
        [&](std::size_t bytes) { return isowave(filled(GetParam().later), {.largestFile = bytes}); });
}

// A file system in memory of its own, where the test may mount one.
class FullFileSystem : public NoRoom {
  protected:
    void TearDown() override {
        if (mounted_) ::umount2(out().c_str(), MNT_DETACH);
    }
    bool mount(const std::string& options) {
        if (mounted_) ::umount2(out().c_str(), MNT_DETACH);
        mounted_ = ::mount("isowave_test", out().c_str(), "tmpfs", 0, options.c_str()) == 0;
        return mounted_;
    }
    bool mounted_ = false;
};

TEST_P(FullFileSystem, IsSaidInOneLineAndKeepsWhatWasThere) {
    const Files before = resultOf(GetParam().earlier);
    later_ = resultOf(GetParam().later);
    put({});
    if (!mount("size=64m")) GTEST_SKIP() << "no file system may be mounted here";
    put(before);
    expectRefusals([&](std::size_t bytes) {
        std::size_t all = 0;
        const auto inPages = [](std::size_t size) { return (size + 4095) / 4096 * 4096; };
        for (const auto& [name, content] : before) all += inPages(content.size());
        EXPECT_TRUE(mount("size=" + std::to_string(all + bytes / 4096 * 4096)));
        put(before);
        return isowave(filled(GetParam().later));
    });
}

TEST_P(NoRoom, InAFolderThatMayNotBeWrittenIsSaidInOneLine) {
    put(resultOf(GetParam().earlier));
    const Files before = files();
    // Nobody may look into the folder of this test, and may write nowhere.
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
        fs::permissions(entry.path(), static_cast<fs::perms>(entry.is_directory() ? 0555 : 0444));
    const Result result = isowave(filled(GetParam().later), {.asNobody = true});
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
        if (entry.is_directory()) fs::permissions(entry.path(), static_cast<fs::perms>(0755));
    if (result.exitCode == 127) GTEST_SKIP() << "nobody may run the program here";
    EXPECT_EQ(result.exitCode, 1) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("cannot write here"));
    EXPECT_TRUE(files() == before);
}

// `ulimit -v`: it ends well, or memory does not suffice.
TEST_P(NoRoom, OfMemoryIsSaidInOneLine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers need terabytes of address space";
#endif
    const Files before = resultOf(GetParam().earlier);
    const Files after = resultOf(GetParam().later);
    for (const rlim_t megabytes : {170, 190, 210, 240, 280, 340, 420}) {
        put(before);
        const Result result = isowave(filled(GetParam().later), {.mostMemory = megabytes << 20});
        SCOPED_TRACE(std::to_string(megabytes) + " MB: code " + std::to_string(result.exitCode) + ", " +
                     result.err);
        if (result.exitCode == 0) {
            EXPECT_EQ(faultOf(files(), before, after), "");
            continue;
        }
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_EQ(result.errorLines(), 1);
        EXPECT_TRUE(files() == before);
    }
}

std::string nameOfJob(const testing::TestParamInfo<Job>& job) { return job.param.name; }
INSTANTIATE_TEST_SUITE_P(, Stopped, testing::ValuesIn(jobs()), nameOfJob);
INSTANTIATE_TEST_SUITE_P(, NoRoom, testing::ValuesIn(jobs()), nameOfJob);
INSTANTIATE_TEST_SUITE_P(, FullFileSystem, testing::ValuesIn(jobs()), nameOfJob);

}  // namespace
}  // namespace isowave::tools_test
