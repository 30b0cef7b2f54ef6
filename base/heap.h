// How the process keeps its memory. For programs, in main(): a library has no say in it, so this is a target
// of its own (isowave_heap) that programs link.
#pragma once

#include <string>

namespace isowave {

// A job makes and drops hundreds of megabytes of leaves of 2 KB a step. Programs that link this allocate with
// mimalloc, which keeps what is freed for the next step, and after this call asks for pages of 2 MB where the
// system lends them (transparent huge pages): memory that is new to a process costs a page fault for each
// page, and one for 4 KB takes 0.1 to 16 us by machine. Built with sanitizers or without mimalloc, it tells
// glibc to keep what is freed.
// What it is worth: bench/results/transform.md, "The allocator".
void setUpHeap();

// Gives freed memory that was kept back to the system: for a stage whose blocks have other sizes than what
// the stages before it freed.
void releaseFreedMemory();

// "mimalloc 2.0.9", "glibc 2.36".
std::string heapName();

}  // namespace isowave
