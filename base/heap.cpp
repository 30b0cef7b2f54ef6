#include "base/heap.h"

#include <cstdlib>  // says whether this is glibc

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace isowave {

void keepFreedMemory() {
#ifdef __GLIBC__
    constexpr int kNever = 2'000'000'000, kGrowBy = 64 << 20;
    constexpr int kLargestOnHeap = 32 << 20;  // the most that glibc takes: DEFAULT_MMAP_THRESHOLD_MAX
    mallopt(M_TRIM_THRESHOLD, kNever);
    mallopt(M_TOP_PAD, kGrowBy);
    mallopt(M_MMAP_THRESHOLD, kLargestOnHeap);
#endif
}

void releaseFreedMemory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

}  // namespace isowave
