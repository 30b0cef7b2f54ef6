// The field of an image that was fitted in slabs and lies in a folder, slab by slab.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isowave/pyramid.h"
#include "lod/slabs/slab_fit.h"
#include "lod/slabs/slab_steps.h"
#include "lod/slabs/slab_workers.h"
#include "wavelets/pyramid_file.h"

namespace isowave::lod {

// A folder for a job's slabs, hidden, of a name that no other job has; it goes with everything in it.
class SlabFolder {
  public:
    // in: the folder that it lies in. Throws OperationError where none can be made there.
    explicit SlabFolder(const std::filesystem::path& in);
    ~SlabFolder();
    SlabFolder(const SlabFolder&) = delete;
    SlabFolder& operator=(const SlabFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

// Where slabs lie, and who works on them.
struct SlabWork {
    std::filesystem::path
        folder;  // of in-turn work the folder that a hidden one is made in; else the one that all workers see
    SlabMap map = {};              // none: one slab after the other
    std::vector<float> mask = {};  // values that the stream takes as inside
    std::string name = {};         // of the image
    std::string image = {};        // whatever changes when the image or the way to read it does
    std::function<void(std::int64_t latticePoints)> allowWhole =
        {};  // throws where step 0 may not be one field
};

class SlabbedField {
  public:
    // Fits all slabs; as many lie along y between phases. Throws as the fit of the whole does.
    SlabbedField(ImageStream stream, const SlabFitPlan& plan, const SlabWork& work, const Progress& progress);

    const FitReport& report() const { return report_; }
    std::int64_t inside() const { return inside_; }  // lattice points
    bool hasSurface() const;
    double K() const { return K_; }
    // Of step 0.
    const openvdb::math::Transform& transform() const { return *transform_; }
    const wavelets::FieldExtent& extent() const { return extent_; }
    int slabs() const { return plan_.cuts.count(); }

    // Step 0, joined.
    BSplineField whole() const;

    // Comes down in slabs, then, when little is left, with the whole. onStep: is called for the steps that are asked for, and for all
    // those that the whole makes.
    wavelets::Descent descend(const wavelets::AnalyseOptions& options,
                              const std::function<bool(int step)>& isAskedFor,
                              const std::function<void(int step, const BSplineField&)>& onStep,
                              const Progress& progress) const;
    wavelets::Pyramid analyse(const StepOrder& order, const Progress& progress) const;
    // The same into a file, of which one grid is in memory at a time.
    PyramidCounts analyseTo(const std::filesystem::path& path, const StepOrder& order,
                            std::map<std::string, std::string> source, const Progress& progress) const;

  private:
    // All of them, and cuts them thinner where they lack memory.
    std::vector<SlabFitted> fitSlabs(int passes, const std::string& image, const Progress& progress);
    BSplineField part(int slab) const;
    struct Reached;  // how far slabs came down
    struct Apart {
        wavelets::Pyramid pyramid;  // its finest steps lie in the folder
        std::vector<int> slabs;     // of each of these
        std::int64_t stored = 0;    // coefficients of all steps
    };
    Apart takeApart(const StepOrder& order, const Progress& progress) const;
    // Those that lie in the folder. apart outlives it.
    wavelets::StepSource stepsOf(const Apart& apart) const;
    void forget(int step, const SlabGrid& grid) const;
    Reached descendInSlabs(const wavelets::AnalyseOptions& options,
                           const std::function<bool(int)>& isAskedFor,
                           const std::function<void(int, const BSplineField&)>& onStep, bool keep,
                           const Progress& progress) const;

    SlabFitPlan plan_;
    std::optional<SlabFolder> hidden_;
    SlabStore store_;
    std::unique_ptr<SlabWorkers> workers_;
    FitReport report_;
    std::int64_t inside_ = 0;
    bool outside_ = false;
    double K_ = 1;
    std::function<void(std::int64_t)> allowWhole_;
    SlabOrigin origin_;
    openvdb::math::Transform::Ptr transform_;
    wavelets::FieldExtent extent_;
    SlabGrid grid_;  // of step 0
};

}  // namespace isowave::lod
