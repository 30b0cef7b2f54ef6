// Runs the real program and catches what comes out of it.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace isowave::tools_test {

namespace fs = std::filesystem;

inline std::string contentOf(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

// A folder of its own for each test, gone afterwards.
class Folder {
  public:
    Folder() {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string(info->test_suite_name()) + "." + info->name();
        std::replace(name.begin(), name.end(), '/', '_');
        path_ = fs::temp_directory_path() / ("isowave_" + name + "_" + std::to_string(::getpid()));
        fs::remove_all(path_);
        fs::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    fs::path operator/(const std::string& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }
    // Every file and folder below, with its content.
    std::map<std::string, std::string> snapshot() const {
        std::map<std::string, std::string> result;
        for (const auto& entry : fs::recursive_directory_iterator(path_))
            result[entry.path().lexically_relative(path_).string()] =
                entry.is_directory() ? "(folder)" : contentOf(entry.path());
        return result;
    }

  private:
    fs::path path_;
};

struct Result {
    int exitCode = -1;  // 128 + n when signal n killed it
    std::string out, err;
    nlohmann::json json() const { return nlohmann::json::parse(out); }
    int errorLines() const { return static_cast<int>(std::count(err.begin(), err.end(), '\n')); }
};

struct RunOptions {
    std::optional<rlim_t> largestFile = std::nullopt;  // bytes; a write beyond fails, as on a full disk
    std::optional<rlim_t> mostMemory =
        std::nullopt;                 // bytes of address space, of which the program itself takes 150 MB
    std::string standardOutput = {};  // goes there; empty: is caught
    std::function<bool(pid_t)> interruptWhen = {};  // of the program; SIGINT as soon as this is true
    rlim_t mostSeconds = 240;  // of CPU, which a busy machine does not use up; then killed
    std::optional<std::pair<int, double>> signalAfter = {};  // this signal, so many seconds after the start
    bool asNobody = false;  // without the rights of root, where the test has them
};

inline Result isowave(const std::vector<std::string>& arguments, const RunOptions& options = {}) {
    static int count = 0;
    const fs::path base = fs::temp_directory_path() /
                          ("isowave_run_" + std::to_string(::getpid()) + "_" + std::to_string(++count));
    const std::string outFile = base.string() + ".out", errFile = base.string() + ".err";
    std::vector<char*> argv{const_cast<char*>(ISOWAVE_BINARY)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);

    const pid_t child = ::fork();
    if (child == 0) {
        const int out = ::open((options.standardOutput.empty() ? outFile : options.standardOutput).c_str(),
                               O_CREAT | O_TRUNC | O_WRONLY, 0600);
        const int err = ::open(errFile.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
        ::dup2(out, STDOUT_FILENO);
        ::dup2(err, STDERR_FILENO);
        const auto restrict = [](auto resource, rlim_t most) {
            const rlimit limit{most, most};
            ::setrlimit(resource, &limit);
        };
        if (options.largestFile) restrict(RLIMIT_FSIZE, *options.largestFile);
        if (options.mostMemory) restrict(RLIMIT_AS, *options.mostMemory);
        restrict(RLIMIT_CPU, options.mostSeconds);
        if (options.asNobody && ::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(127);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    int status = 0;
    bool interrupted = false;
    if (options.signalAfter) {
        std::this_thread::sleep_for(std::chrono::duration<double>(options.signalAfter->second));
        ::kill(child, options.signalAfter->first);  // which the child is until somebody has waited for it
    }
    while (::waitpid(child, &status, WNOHANG) == 0) {
        if (!interrupted && options.interruptWhen && options.interruptWhen(child)) {
            ::kill(child, SIGINT);
            interrupted = true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    Result result;
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = contentOf(outFile);
    result.err = contentOf(errFile);
    fs::remove(outFile);
    fs::remove(errFile);
    return result;
}

// Runs and expects success.
inline Result succeed(const std::vector<std::string>& arguments) {
    Result result = isowave(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result;
}

inline nlohmann::json jsonFile(const fs::path& file) { return nlohmann::json::parse(contentOf(file)); }

}  // namespace isowave::tools_test
