#include "base/heap.h"

#include <cstdlib>  // says whether this is glibc

#ifdef ISOWAVE_WITH_MIMALLOC
#include <mimalloc.h>
#elif defined(__GLIBC__)
#include <malloc.h>
#endif

namespace isowave {

void setUpHeap() {
#ifdef ISOWAVE_WITH_MIMALLOC
    constexpr long kMillisecondsKept = 1'000'000;
    mi_option_enable(mi_option_large_os_pages);
    mi_option_set(mi_option_decommit_delay, kMillisecondsKept);
#elif defined(__GLIBC__)
    constexpr int kNever = 2'000'000'000, kGrowBy = 64 << 20;
    constexpr int kLargestOnHeap = 32 << 20;  // the most that glibc takes: DEFAULT_MMAP_THRESHOLD_MAX
    mallopt(M_TRIM_THRESHOLD, kNever);
    mallopt(M_TOP_PAD, kGrowBy);
    mallopt(M_MMAP_THRESHOLD, kLargestOnHeap);
#endif
}

void releaseFreedMemory() {
#ifdef ISOWAVE_WITH_MIMALLOC
    mi_collect(true);
#elif defined(__GLIBC__)
    malloc_trim(0);
#endif
}

}  // namespace isowave
