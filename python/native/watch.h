// Long work, watched from Python: it can be stopped by Ctrl-C, and tells how far it is.
//
// Work runs on a thread of its own, without the GIL. The thread that called waits, and every 50 ms looks for a signal and
// hands on what the work has to say: callbacks are always called by the thread that called, one at a time, so that they may
// draw (tqdm, widgets) and raise.
#pragma once

#include <functional>
#include <optional>
#include <type_traits>

#include "isowave/progress.h"
#include "python/native/pybind.h"

namespace isowave::python {

// watch: None, or an object with `threads` (0: all), `progress(share, stage)` and `remark(line)`.
// A KeyboardInterrupt, or whatever a callback raises, stops the work, and is raised when it has stopped. What the work throws
// is thrown here. REQUIRES: the GIL is held; work() touches no Python object.
void runWatched(const py::object& watch, const std::function<void(const Progress&)>& work);

template <class Work>
auto watched(const py::object& watch, Work&& work) {
    std::optional<std::invoke_result_t<Work, const Progress&>> result;
    runWatched(watch, [&](const Progress& progress) { result.emplace(work(progress)); });
    return std::move(*result);
}

}  // namespace isowave::python
