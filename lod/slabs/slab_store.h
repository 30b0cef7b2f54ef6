// The files of a job in slabs, all in one folder, which every task reads and writes: each appears whole or not at all, and a task
// that runs again writes the same bytes.
//
//   fit_I.vdb        a slab's part of the field of step 0, at its place in the image
//   field_S_I_J.vdb  the field of step S between cuts: slab I of z, slab J of y
//   told_HASH.json   what a task told (slab_task.h)
//   job.json         which job that is
//   step_S_I.vdb     shape and details of step S in the slab I that its task worked on
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "volume/field.h"
#include "wavelets/direction.h"

namespace isowave::lod {

class SlabStore {
  public:
    // Makes the folder where it is not there. Throws OperationError.
    explicit SlabStore(std::filesystem::path folder);

    const std::filesystem::path& folder() const { return folder_; }

    // Of tasks that are not run again (slab_task.h): what those of another job have told is forgotten, since files have the same
    // names. job: what tells jobs apart.
    void begin(const std::string& job) const;
    // Where a task leaves what it told.
    std::filesystem::path toldPath(const std::string& task) const;

    // Throw OperationError where there is no space, InputError for a file that is missing or damaged.
    void putFitted(int slab, const BSplineField& part) const;
    BSplineField fitted(int slab) const;
    void putField(int step, int row, int column, const BSplineField& part) const;
    BSplineField field(int step, int row, int column) const;
    void putStep(int step, int slab, const Shape::Ptr& shape, const wavelets::DetailGrid::Ptr& details) const;
    Shape::Ptr shape(int step, int slab) const;
    wavelets::DetailGrid::Ptr details(int step, int slab) const;

    void forgetField(int step, int row, int column) const;

  private:
    std::filesystem::path fittedPath(int slab) const;
    std::filesystem::path fieldPath(int step, int row, int column) const;
    std::filesystem::path stepPath(int step, int slab) const;

    std::filesystem::path folder_;
};

}  // namespace isowave::lod
