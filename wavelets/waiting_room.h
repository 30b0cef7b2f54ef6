// Where intervals wait until there are as many of their length as a batch has lanes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "wavelets/interval/batch.h"

namespace isowave::wavelets {

// Batch: AnalysisBatch or SynthesisBatch. Memory does not go with the length of intervals: those whose lengths are a multiple
// of kSlots apart share a place, which only the one length has at a time.
template <class Batch>
class WaitingRoom {
  public:
    static constexpr int kSlots = 256;  // few intervals are longer

    // put(batch, lane) writes the interval's lines there. Calls run(batch) for a batch that is full, or has to make room for
    // another length.
    template <class Put, class Run>
    ISOWAVE_INLINE void add(int n, const Put& put, const Run& run) {
        Batch& batch = batches_[static_cast<std::size_t>(n) % kSlots];
        if (batch.lanes == 0) {
            taken_.push_back(n % kSlots);
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

    // Calls run(batch) for all that wait.
    template <class Run>
    void runAll(const Run& run) {
        for (const int slot : taken_)
            if (Batch& batch = batches_[static_cast<std::size_t>(slot)]; batch.lanes > 0) {
                run(batch);
                batch.lanes = 0;
            }
        taken_.clear();
    }

  private:
    std::array<Batch, kSlots> batches_{};
    std::vector<int> taken_;
};

}  // namespace isowave::wavelets
