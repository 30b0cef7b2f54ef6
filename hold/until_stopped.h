// A parallel loop over work that has parallel loops in it.
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>

#include "isowave/error.h"
#include "isowave/progress.h"

namespace isowave {

// body(i) for 0 <= i < n. Once a stop is asked for no body is begun any more, and those that run come to their end; then it throws
// Cancelled. An exception inside the loop would stop the loops in other bodies, too, which go on with what these have not made.
template <class Body>
void forEachUntilStopped(std::size_t n, const Progress& progress, const Body& body) {
    std::atomic<bool> stopped = false;
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
        if (stopped) return;
        try {
            progress.check();
        } catch (const Cancelled&) {
            stopped = true;
            return;
        }
        body(i);
    });
    progress.check();
    if (stopped) throw Cancelled();
}

}  // namespace isowave
