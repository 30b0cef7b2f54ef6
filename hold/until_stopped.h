// A parallel loop over work that has parallel loops in it.
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>
#include <exception>

#include "isowave/progress.h"

namespace isowave {

// body(i) for 0 <= i < n. Once a stop is asked for, or a body has thrown, no body is begun any more, and those that run come to their
// end; then it throws Cancelled, or what the first one threw. An exception that left the loop would end the loops in other bodies,
// too, which go on with what these have not made.
template <class Body>
void forEachUntilStopped(std::size_t n, const Progress& progress, const Body& body) {
    std::atomic<bool> stopped = false;
    std::exception_ptr thrown;
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
        if (stopped) return;
        try {
            progress.check();
            body(i);
        } catch (...) {
            if (!stopped.exchange(true)) thrown = std::current_exception();
        }
    });
    if (thrown) std::rethrow_exception(thrown);
    progress.check();
}

}  // namespace isowave
