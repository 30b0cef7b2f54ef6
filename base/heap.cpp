#include "base/heap.h"

#include <atomic>
#include <cstdlib>  // says whether this is glibc
#include <new>

#ifdef ISOWAVE_WITH_MIMALLOC
#include <mimalloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <memory>
#elif defined(__GLIBC__)
#include <gnu/libc-version.h>
#include <malloc.h>
#endif

#ifdef ISOWAVE_WITH_MIMALLOC
// mimalloc is C: its own operator new ends the program where memory does not suffice. These throw; the other
// forms of new and all of delete are its own.
namespace {

// Let go of at the first failure: a tree of OpenVDB is destroyed by tasks, and they need memory too.
std::atomic<void*> reserve{nullptr};
constexpr std::size_t kReserveBytes = 32 << 20;

void* orThrow(void* memory) {
    if (memory == nullptr) {
        mi_free(reserve.exchange(nullptr));
        throw std::bad_alloc();
    }
    return memory;
}

// Address space as large as the machine's memory, of which only what is written to takes any. mimalloc unmaps a large block when it is
// freed, and the next one is zeroed by the system page by page: but blocks of this.
void lendAddressSpace() {
    constexpr std::size_t kAlignment = std::size_t{32} << 20;  // of mimalloc's arenas
    const long pages = sysconf(_SC_PHYS_PAGES), bytesOfPage = sysconf(_SC_PAGESIZE);
    if (pages <= 0 || bytesOfPage <= 0) return;
    const std::size_t size =
        static_cast<std::size_t>(pages) * static_cast<std::size_t>(bytesOfPage) / kAlignment * kAlignment;
    void* const mapped = mmap(nullptr, size + kAlignment, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (mapped == MAP_FAILED) return;  // as under ulimit -v
    void* start = mapped;
    std::size_t space = size + kAlignment;
    std::align(kAlignment, size, start, space);
    madvise(start, size, MADV_HUGEPAGE);
    mi_manage_os_memory(start, size, true, false, true, -1);
}

}  // namespace

void* operator new(std::size_t size) { return orThrow(mi_malloc(size)); }
void* operator new[](std::size_t size) { return orThrow(mi_malloc(size)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return orThrow(mi_malloc_aligned(size, static_cast<std::size_t>(alignment)));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return orThrow(mi_malloc_aligned(size, static_cast<std::size_t>(alignment)));
}
#endif

namespace isowave {

void setUpHeap() {
#ifdef ISOWAVE_WITH_MIMALLOC
    constexpr long kMillisecondsKept = 1'000'000;
    mi_option_enable(mi_option_large_os_pages);
    mi_option_set(mi_option_decommit_delay, kMillisecondsKept);
    lendAddressSpace();
    reserve = mi_malloc(kReserveBytes);
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

std::string heapName() {
#ifdef ISOWAVE_WITH_MIMALLOC
    const int version = mi_version();  // 209: 2.0.9
    return "mimalloc " + std::to_string(version / 100) + "." + std::to_string(version / 10 % 10) + "." +
           std::to_string(version % 10);
#elif defined(__GLIBC__)
    return std::string("glibc ") + gnu_get_libc_version();
#else
    return "the system's";
#endif
}

}  // namespace isowave
