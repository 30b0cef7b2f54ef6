#include "python/native/watch.h"

#include <tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace isowave::python {
namespace {

constexpr auto kLook = std::chrono::milliseconds(50);

// What the work says, until the caller's thread hands it on.
struct Mailbox {
    std::mutex mutex;
    std::condition_variable changed;
    bool finished = false, news = false;
    std::string stage;
    double share = 0;
    std::vector<std::string> remarks;
    std::exception_ptr failure;
    std::atomic<bool> stop{false};

    void report(std::string_view newStage, double newShare) {
        // Whoever comes while another one writes has nothing to add.
        const std::unique_lock lock(mutex, std::try_to_lock);
        if (!lock.owns_lock()) return;
        if (stage != newStage) stage = newStage;
        share = newShare;
        news = true;
    }
    void remark(std::string_view line) {
        const std::lock_guard lock(mutex);
        remarks.emplace_back(line);
    }
    Progress progress() {
        return {.report = [this](std::string_view s, double done) { report(s, done); },
                .stopRequested = [this] { return stop.load(std::memory_order_relaxed); },
                .remark = [this](std::string_view line) { remark(line); }};
    }
    void finish(std::exception_ptr why) {
        const std::lock_guard lock(mutex);
        failure = std::move(why);
        finished = true;
        changed.notify_all();
    }
    bool waitUntilFinished() {
        const py::gil_scoped_release release;
        std::unique_lock lock(mutex);
        return changed.wait_for(lock, kLook, [this] { return finished; });
    }
};

void work(Mailbox& mailbox, std::size_t threads, const std::function<void(const Progress&)>& job) {
    std::exception_ptr failure;
    try {
        std::optional<tbb::global_control> limit;
        if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, threads);
        job(mailbox.progress());
    } catch (...) {
        failure = std::current_exception();
    }
    mailbox.finish(std::move(failure));
}

// Throws what a callback or a signal handler raises.
void handOn(const py::object& watch, Mailbox& mailbox) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    std::vector<std::string> remarks;
    std::string stage;
    double share = 0;
    bool news = false;
    {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mailbox.mutex);
        remarks.swap(mailbox.remarks);
        std::swap(news, mailbox.news);
        stage = mailbox.stage;
        share = mailbox.share;
    }
    if (watch.is_none()) return;
    for (const std::string& line : remarks) watch.attr("remark")(line);
    if (news) watch.attr("progress")(share, stage);
}

}  // namespace

void runWatched(const py::object& watch, const std::function<void(const Progress&)>& job) {
    const auto threads = watch.is_none() ? 0 : watch.attr("threads").cast<std::size_t>();
    Mailbox mailbox;
    std::thread worker(work, std::ref(mailbox), threads, std::cref(job));
    const auto join = [&] {
        const py::gil_scoped_release release;
        worker.join();
    };
    try {
        while (!mailbox.waitUntilFinished()) handOn(watch, mailbox);
        handOn(watch, mailbox);
    } catch (...) {
        mailbox.stop = true;
        join();
        throw;
    }
    join();
    if (mailbox.failure) std::rethrow_exception(mailbox.failure);
}

}  // namespace isowave::python
