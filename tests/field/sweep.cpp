#include "tests/field/sweep.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <random>
#include <vector>

#include "isowave/error.h"

namespace isowave::test {

namespace fs = std::filesystem;

namespace {

// A prefix, or the whole with one byte changed.
struct Damage {
    std::size_t at = 0;
    int value = -1;  // -1: the first `at` bytes

    bool isPrefix() const { return value < 0; }
    std::string of(const std::string& whole) const {
        if (isPrefix()) return whole.substr(0, at);
        std::string changed = whole;
        changed[at] = static_cast<char>(value);
        return changed;
    }
    std::string text() const {
        return isPrefix() ? fmt::format("the first {} bytes", at) : fmt::format("byte {} = {}", at, value);
    }
};

// ISOWAVE_EVERY_CORRUPTION=1 in the environment: the numbers of the files that are read fast, for all.
Extent extentOf(Extent quick) { return std::getenv("ISOWAVE_EVERY_CORRUPTION") ? Extent{} : quick; }

std::vector<Damage> damages(std::size_t size, const Extent& extent) {
    std::vector<Damage> all;
    const std::size_t prefixes = std::min(size, extent.prefixes);
    for (std::size_t i = 0; i < prefixes; ++i) all.push_back({size * i / prefixes});
    std::mt19937 random(static_cast<unsigned>(size));
    for (std::size_t i = 0; i < extent.flips; ++i) {
        const std::size_t at = random() % size;
        all.push_back({at, static_cast<int>(random() % 256)});
    }
    return all;
}

// What a child tells its parent, in memory that both see.
struct Shared {
    Outcome seen;
    std::size_t next = 0;      // the copy after the one at work
    char complaint[600] = {};  // about the copy at work, when it broke a rule without dying
};

// Removed first: ext4 takes a file that is cut to nothing and written again for one worth flushing to the disk.
void put(const fs::path& file, const std::string& bytes) {
    fs::remove(file);
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// "" or what is wrong with the message; `folder` is where all files of the sweep are.
std::string faultOf(const std::string& message, const fs::path& folder) {
    if (message.find('\n') != message.npos) return "several lines: " + message;
    const std::size_t name = message.find(folder.string());
    if (name != 0) return "does not begin with a file's name: " + message;
    return message.size() > folder.string().size() + 12 ? "" : "says nothing: " + message;
}

// Reads one copy; what is wrong with how that went.
std::string readOne(const fs::path& file, const Read& read, bool& wasRead) {
    try {
        read(file);
        wasRead = true;
        return "";
    } catch (const InputError& error) {
        return faultOf(error.what(), file.parent_path());
    } catch (const std::exception& error) {
        return std::string("another exception: ") + error.what();
    }
}

double seconds() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

void count(const Damage& damage, bool wasRead, double took, Outcome& seen) {
    ++(damage.isPrefix() ? seen.prefixes : seen.flips);
    if (wasRead) ++(damage.isPrefix() ? seen.prefixesRead : seen.flipsRead);
    seen.mostSeconds = std::max(seen.mostSeconds, took);
}

[[noreturn]] void child(const fs::path& file, const std::string& whole, const std::vector<Damage>& all,
                        const Read& read, Shared& shared) {
    while (shared.next < all.size()) {
        const Damage& damage = all[shared.next];
        put(file, damage.of(whole));
        const off_t printedBefore = ::lseek(STDOUT_FILENO, 0, SEEK_END);
        const double start = seconds();
        bool wasRead = false;
        ::alarm(kMostSeconds);
        std::string wrong = readOne(file, read, wasRead);
        ::alarm(0);
        std::cout.flush();
        std::fflush(nullptr);
        if (::lseek(STDOUT_FILENO, 0, SEEK_END) > printedBefore && wrong.empty())
            wrong = "something was printed";
        count(damage, wasRead, seconds() - start, shared.seen);
        ++shared.next;
        if (wrong.empty()) continue;
        std::strncpy(shared.complaint, wrong.c_str(), sizeof shared.complaint - 1);
        ::_exit(1);
    }
    ::_exit(0);
}

// Memory that a wrong length asks for is refused by the system at twice what is allowed, before it is touched.
void limitMemory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const rlimit limit{2UL * kMostBytes, 2UL * kMostBytes};
    ::setrlimit(RLIMIT_AS, &limit);
#endif
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
}

void reopenOutputs(const fs::path& printed) {
    const int file = ::open(printed.c_str(), O_CREAT | O_WRONLY | O_APPEND, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
}

// What became of the child after which shared.next is the next copy; "" when it came to the end.
std::string complaintOf(int status, const std::vector<Damage>& all, Shared& shared) {
    if (WIFSIGNALED(status)) {
        const Damage& damage = all[shared.next];
        ++shared.next;
        const char* slow = WTERMSIG(status) == SIGALRM ? ": too slow" : "";
        return fmt::format("{}: ended by signal {}{}", damage.text(), WTERMSIG(status), slow);
    }
    if (WEXITSTATUS(status) == 0) return "";
    return fmt::format("{}: {}", all[shared.next - 1].text(), shared.complaint);
}

}  // namespace

std::string textOf(const Outcome& o, const std::string& name) {
    return fmt::format("{}: {} prefixes, {} read; {} changed bytes, {} read; at most {} MB, {:.2f} s", name,
                       o.prefixes, o.prefixesRead, o.flips, o.flipsRead, o.mostBytes >> 20, o.mostSeconds);
}

Outcome sweep(const fs::path& file, const std::string& bytes, const Read& read, Extent quick) {
    const std::vector<Damage> all = damages(bytes.size(), extentOf(quick));
    void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    auto& shared = *new (memory) Shared;
    const fs::path printed = file.parent_path().string() + ".printed";
    int complaints = 0;
    while (shared.next < all.size() && complaints < 20) {
        shared.complaint[0] = 0;
        std::fflush(nullptr);
        const pid_t pid = ::fork();
        if (pid == 0) {
            limitMemory();
            reopenOutputs(printed);
            child(file, bytes, all, read, shared);
        }
        int status = 0;
        rusage used{};
        ::wait4(pid, &status, 0, &used);
        shared.seen.mostBytes = std::max(shared.seen.mostBytes, used.ru_maxrss * 1024);
        const std::string complaint = complaintOf(status, all, shared);
        if (complaint.empty()) continue;
        ++complaints;
        ADD_FAILURE() << file.filename() << ", " << complaint;
    }
    const Outcome seen = shared.seen;
    ::munmap(memory, sizeof(Shared));
    EXPECT_EQ(contentOf(printed).substr(0, 500), "");
    EXPECT_LT(seen.mostBytes, kMostBytes);
    fs::remove(printed);
    std::cout << textOf(seen, file.filename().string()) << std::endl;
    return seen;
}

void inAChild(const std::function<void()>& make) {
    std::fflush(nullptr);
    const pid_t pid = ::fork();
    if (pid == 0) {
        try {
            make();
        } catch (const std::exception& error) {
            std::cerr << error.what() << std::endl;
            ::_exit(1);
        }
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(pid, &status, 0);
    ASSERT_EQ(status, 0);
}

std::string contentOf(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace isowave::test
