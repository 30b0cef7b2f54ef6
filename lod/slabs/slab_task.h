// A task of a job in slabs as a text (JSON), so that any process that sees the folder and the image can run it; and what it tells,
// as a text. A task that has been run leaves what it told beside its files, under a name that is a hash of its text: run again, it
// reads that and does nothing, so that a job that was interrupted goes on where it was.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lod/slabs/slab_fit.h"
#include "lod/slabs/slab_steps.h"

namespace isowave::lod {

// What all tasks of a job have in common.
struct SlabJob {
    std::filesystem::path folder;
    std::string image;        // size and time of the file, and how it is read
    std::vector<float> mask;  // values that are inside, as ImageStream::takeAsMask() has them
};

// What tells jobs apart whose files have the same names.
std::string jobText(const SlabJob& job, const SlabFitPlan& plan);

std::string fitTask(const SlabJob& job, const SlabFitPlan& plan, int slab, int passes);
std::string halveTask(const SlabJob& job, const SlabHalving& halving, int slab);

// Throws OperationError where fewer or other texts came back.
std::vector<SlabFitted> fittedOf(const std::vector<std::string>& told, std::size_t wanted);
std::vector<SlabHalved> halvedOf(const std::vector<std::string>& told, std::size_t wanted);

// options: of the image, as the job has them. Throws as ImageStream and the fit do, InputError for a text that is no task.
std::string runSlabTask(const std::filesystem::path& path, const ImageReadOptions& options,
                        const std::string& task, const Progress& progress);

}  // namespace isowave::lod
