#include "io/image/fill_nan.h"

#include <cmath>

namespace isowave::imageio {
namespace {

class FilledSource : public VoxelSource {
  public:
    FilledSource(SourcePtr source, float value) : source_(std::move(source)), value_(value) {
        header = source_->header;
        header.storedType = header.storedType.value_or(header.type);
        header.type = ValueType::float32;
        slicesPerRead = source_->slicesPerRead;
        plain = source_->plain;
    }

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        const std::int64_t inexact = source_->read(z0, z1, out), count = (z1 - z0) * header.sliceVoxels();
        for (std::int64_t i = 0; i < count; ++i)
            if (std::isnan(out[i])) out[i] = value_;
        return inexact;
    }

    bool isZero(std::int64_t z0, std::int64_t z1) override { return source_->isZero(z0, z1); }

  private:
    SourcePtr source_;
    float value_;
};

}  // namespace

SourcePtr fillNan(SourcePtr source, float value) {
    if (isIntegral(source->header.type)) return source;
    return std::make_unique<FilledSource>(std::move(source), value);
}

}  // namespace isowave::imageio
