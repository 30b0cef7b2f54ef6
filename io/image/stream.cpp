#include "io/image/stream.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <mutex>

#include "io/image/check.h"
#include "io/image/fill_nan.h"
#include "io/image/open_source.h"
#include "io/image/view.h"

namespace isowave {
using namespace imageio;

namespace {

// Fits into a core's cache, so that voxels are looked at while they are there.
constexpr std::int64_t kSlabBytes = 1 << 20;
// Of voxels whose z is fastest in memory: a line of the cache holds 16 float32 of them.
constexpr std::int64_t kFewestGathered = 16;
// A batch is long enough to keep many threads busy and short enough to be forgotten soon.
constexpr std::int64_t kBatchSlabs = 32;

// As which type voxels are held.
ValueType heldType(const VoxelSource& source) {
    return source.native && sizeOf(source.header.type) <= 2 ? source.header.type : ValueType::float32;
}

Voxels voxelsOf(ValueType type, const void* values, std::int64_t count) {
    const auto as = [&]<class T>(T) -> Voxels {
        return std::span(static_cast<const T*>(values), static_cast<std::size_t>(count));
    };
    switch (type) {
        case ValueType::int8:
            return as(std::int8_t());
        case ValueType::uint8:
            return as(std::uint8_t());
        case ValueType::int16:
            return as(std::int16_t());
        case ValueType::uint16:
            return as(std::uint16_t());
        default:
            return as(float());
    }
}

}  // namespace

struct ImageStream::State {
    // Of one thread.
    struct Buffers {
        std::vector<char> voxels;
        std::vector<std::uint8_t> mask;
    };

    std::string name;
    Image header;                    // of the slices that are shown
    std::int64_t first = 0;          // of these, in the source
    std::array<double, 3> origin{};  // of slice 0 of the source
    std::int64_t depth = 0;          // slices of the source
    std::int64_t wantedSlices = 0;
    SourcePtr source;  // null for an image in memory
    ValueType type = ValueType::float32;
    std::int64_t slabSlices = 1;
    bool keep = false;          // the source is read once and kept
    std::vector<char> kept;     // ... here
    const void* all = nullptr;  // all voxels, when they are in memory
    bool checked = false;       // the first pass is behind
    std::vector<float> inMask;  // ascending; not empty: voxels are 1 where they are one of these
    std::mutex mutex;           // guards what follows
    NotFinite notFinite;
    std::int64_t inexact = 0;

    std::int64_t sliceVoxels() const { return header.size[0] * header.size[1]; }
    std::int64_t sliceBytes() const { return sliceVoxels() * static_cast<std::int64_t>(sizeOf(type)); }
    // Once the header is known.
    void chooseSlab(std::int64_t wanted) {
        wantedSlices = wanted;
        origin = header.indexToWorld.origin;
        depth = header.size[2];
        fitSlab();
    }
    void fitSlab() {
        const std::int64_t wanted = wantedSlices;
        slabSlices = wanted > 0 ? wanted : std::max<std::int64_t>(1, kSlabBytes / sliceBytes());
        slabSlices = std::min(slabSlices, header.size[2]);
    }

    void readInto(std::int64_t z0, std::int64_t z1, void* out) {
        std::int64_t rounded = 0;
        if (source->header.type == type)
            source->native ? source->readNative(z0, z1, out)
                           : void(rounded = source->read(z0, z1, static_cast<float*>(out)));
        else
            rounded = source->read(z0, z1, static_cast<float*>(out));
        if (checked || rounded == 0) return;
        const std::lock_guard lock(mutex);
        inexact += rounded;
    }

    void readAll(const Progress& progress) {
        kept.resize(static_cast<std::size_t>(sliceBytes() * depth));
        for (std::int64_t z = 0, end; z < depth; z = end) {
            progress("reading", static_cast<double>(z) / static_cast<double>(depth));
            end = std::min(z + source->slicesPerRead, depth);
            readInto(z, end, kept.data() + z * sliceBytes());
        }
        source.reset();
        all = kept.data();
    }

    Slab slab(std::int64_t z0, std::int64_t z1, Buffers& buffers) {
        const Slab stored = storedSlab(z0, z1, buffers.voxels);
        return inMask.empty() ? stored : maskOf(stored, buffers.mask);
    }

    Slab maskOf(const Slab& slab, std::vector<std::uint8_t>& mask) const {
        const auto in = [&](float v) { return std::binary_search(inMask.begin(), inMask.end(), v); };
        std::visit(
            [&](auto values) {
                mask.resize(values.size());
                // Neighbours are mostly alike.
                auto last = values[0];
                bool inside = in(static_cast<float>(last));
                for (std::size_t i = 0; i < values.size(); ++i) {
                    if (values[i] != last) inside = in(static_cast<float>(last = values[i]));
                    mask[i] = inside;
                }
            },
            slab.voxels);
        return {slab.z0, slab.z1, std::span<const std::uint8_t>(mask), slab.zero && !in(0)};
    }

    Slab storedSlab(std::int64_t z0, std::int64_t z1, std::vector<char>& buffer) {
        const std::int64_t count = (z1 - z0) * sliceVoxels();
        if (all)
            return {z0, z1,
                    voxelsOf(type, static_cast<const char*>(all) + (first + z0) * sliceBytes(), count)};
        buffer.resize(static_cast<std::size_t>((z1 - z0) * sliceBytes()));
        const bool zero = source->isZero(first + z0, first + z1);
        if (zero)
            std::fill(buffer.begin(), buffer.end(), char(0));
        else
            readInto(first + z0, first + z1, buffer.data());
        return {z0, z1, voxelsOf(type, buffer.data(), count), zero};
    }

    void check(const Slab& slab) {
        const auto* values = std::get_if<std::span<const float>>(&slab.voxels);
        if (!values || slab.zero) return;
        NotFinite here;
        here.countIn(values->data(), static_cast<std::int64_t>(values->size()),
                     (first + slab.z0) * sliceVoxels());
        if (here.count == 0) return;
        const std::lock_guard lock(mutex);
        notFinite.add(here);
    }
    void finishChecks() {
        checkFinite(name, header.size, notFinite);
        if (inexact > 0) header.warnings.push_back(roundedText(inexact, header));
        checked = true;
    }
};

ImageStream::ImageStream(const std::filesystem::path& path, const ImageReadOptions& options,
                         std::int64_t slabSlices)
    : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.name = path.string();
    s.source = openSource(path, options);
    s.header = imageOf(s.source->header);
    s.type = heldType(*s.source);
    s.chooseSlab(slabSlices);
    s.keep = !s.source->plain;
    const bool converts = s.type != s.source->header.type || !s.source->native;
    if (s.keep)
        checkMemory(s.name, *s.source, options, sizeOf(s.type), converts ? sizeOf(s.source->header.type) : 0);
}

ImageStream::ImageStream(const Image& image, std::int64_t slabSlices) : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.name = "image";
    s.header.size = image.size;
    s.header.indexToWorld = image.indexToWorld;
    s.header.componentType = image.componentType;
    s.header.integral = image.integral;
    s.header.format = image.format;
    s.header.space = image.space;
    s.header.unit = image.unit;
    s.header.warnings = image.warnings;
    s.all = image.values.data();
    s.checked = true;
    s.chooseSlab(slabSlices);
}

ImageStream::ImageStream(const VoxelView& view, const ImageReadOptions& options, std::int64_t slabSlices)
    : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.name = kViewName;
    s.source = openView(view);
    if (options.nan) s.source = fillNan(std::move(s.source), *options.nan);
    s.header = imageOf(s.source->header);
    s.type = heldType(*s.source);
    const bool asRead = liesAsRead(view);
    s.chooseSlab(slabSlices > 0 || asRead ? slabSlices
                                          : std::max(kFewestGathered, kSlabBytes / s.sliceBytes()));
    if (!asRead || s.type != s.source->header.type || !s.source->native) return;
    s.source.reset();
    s.all = view.data;
}

ImageStream::~ImageStream() = default;
ImageStream::ImageStream(ImageStream&&) noexcept = default;
ImageStream& ImageStream::operator=(ImageStream&&) noexcept = default;

void ImageStream::takeAsMask(std::vector<float> values) {
    std::sort(values.begin(), values.end());
    state_->inMask = std::move(values);
}

void ImageStream::showSlices(std::int64_t z0, std::int64_t z1) {
    State& s = *state_;
    assert(0 <= z0 && z0 < z1 && z1 <= s.depth);
    s.first = z0;
    s.header.size[2] = z1 - z0;
    for (std::size_t a = 0; a < 3; ++a)
        s.header.indexToWorld.origin[a] =
            s.origin[a] + static_cast<double>(z0) * s.header.indexToWorld.axis[2][a];
    s.fitSlab();
}

const Image& ImageStream::header() const { return state_->header; }
std::int64_t ImageStream::slabSlices() const { return state_->slabSlices; }
bool ImageStream::isInFile() const { return !state_->all && !state_->keep; }
std::int64_t ImageStream::bytesKept() const {
    return state_->keep ? state_->sliceBytes() * state_->depth : 0;
}

void ImageStream::pass(std::string_view stage, const Progress& progress,
                       const std::function<void(const Slab&)>& each,
                       const std::function<void(std::int64_t)>& done) {
    State& s = *state_;
    if (s.keep && !s.all) s.readAll(progress);
    const std::int64_t depth = s.header.size[2], slabs = (depth + s.slabSlices - 1) / s.slabSlices;
    tbb::enumerable_thread_specific<State::Buffers> buffers;
    for (std::int64_t first = 0; first < slabs; first += kBatchSlabs) {
        progress(stage, static_cast<double>(first) / static_cast<double>(slabs));
        const std::int64_t last = std::min(first + kBatchSlabs, slabs);
        tbb::parallel_for(tbb::blocked_range<std::int64_t>(first, last, 1), [&](const auto& range) {
            for (std::int64_t i = range.begin(); i < range.end(); ++i) {
                progress.check();
                const Slab slab =
                    s.slab(i * s.slabSlices, std::min((i + 1) * s.slabSlices, depth), buffers.local());
                if (!s.checked) s.check(slab);
                each(slab);
            }
        });
        if (done) done(std::min(last * s.slabSlices, depth));
    }
    if (!s.checked) s.finishChecks();
    progress(stage, 1);
}

}  // namespace isowave
