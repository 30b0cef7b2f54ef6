// Intervals queued by length, so that as many of one length as a batch has lanes are transformed together.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "wavelets/interval/batch.h"

namespace isowave::wavelets {

// Intervals are queued by length and transformed eight at a time, one per SIMD lane. A queue is flushed when
// it is full, when its slot is needed, or at the end: lengths that differ by a multiple of kSlots share a
// slot, which one length has at a time, so memory does not grow with the length of intervals. Batch:
// AnalysisBatch or SynthesisBatch.
template <class Batch>
class BatchQueue {
  public:
    static constexpr int kSlots = 256;  // few intervals are longer

    // Queues an interval of n coarse intervals: put(batch, lane) sets that lane's lines. Calls run(batch) for
    // a batch that is full, or that has to make room for another length.
    template <class Put, class Run>
    ISOWAVE_INLINE void add(int n, const Put& put, const Run& run) {
        Batch& batch = batches_[static_cast<std::size_t>(n) % kSlots];
        if (batch.lanes == 0) {
            used_.push_back(n % kSlots);
        } else if (batch.n != n) {
            run(batch);
            batch.lanes = 0;
        }
        batch.n = n;
        put(batch, batch.lanes);
        if (++batch.lanes < kLanes) return;
        run(batch);
        batch.lanes = 0;
    }

    // Calls run(batch) for all batches that are not empty.
    template <class Run>
    void flush(const Run& run) {
        for (const int slot : used_)
            if (Batch& batch = batches_[static_cast<std::size_t>(slot)]; batch.lanes > 0) {
                run(batch);
                batch.lanes = 0;
            }
        used_.clear();
    }

  private:
    std::array<Batch, kSlots> batches_{};
    std::vector<int> used_;  // slots
};

}  // namespace isowave::wavelets
