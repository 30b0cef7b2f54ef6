#include "compress/packed_file.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "base/atomic_file.h"
#include "base/read_file.h"
#include "base/text.h"
#include "compress/coder/bounded.h"
#include "compress/coder/float_coder.h"
#include "compress/coder/index_coder.h"
#include "compress/coder/mask_coder.h"
#include "compress/field_points.h"
#include "compress/packed_head.h"
#include "compress/sections.h"
#include "isowave/error.h"

namespace isowave::compress {
namespace {

// More chunks cost 2 % each, for their models begin anew; fewer leave threads without work.
constexpr std::size_t kPointsOfChunk = std::size_t{1} << 20;

std::vector<std::int32_t> chunkEndsOf(const Lattice& lattice) {
    const std::size_t wanted = std::max<std::size_t>(1, lattice.pointCount() / kPointsOfChunk);
    std::vector<std::int32_t> ends;
    for (int x = 1; x < lattice.size[0]; ++x)
        if (lattice.firstOf(x) >= (ends.size() + 1) * lattice.pointCount() / wanted &&
            ends.size() + 1 < wanted)
            ends.push_back(x);
    ends.push_back(lattice.size[0]);
    return ends;
}

template <class Chunk>
void forEachChunk(const std::vector<std::int32_t>& ends, const Progress& progress, const Chunk& chunk) {
    tbb::parallel_for(std::size_t(0), ends.size(), [&](std::size_t i) {
        progress.check();
        chunk(i, i == 0 ? 0 : ends[i - 1], ends[i]);
    });
}

// What the indices of a file are coded with; the same for writer and reader.
class Quantised {
  public:
    Quantised(const Head::Quantised& q, const Lattice& lattice, const Weights& weights)
        : quantiser_(q.delta, q.reach),
          model_{lattice, quantiser_, weights,
                 quantiser_.index(static_cast<std::int32_t>(std::min(q.voxelsPerK, q.reach) * kOneVoxel))} {}
    Quantised(const Quantised&) = delete;
    const Quantiser& quantiser() const { return quantiser_; }
    const IndexModel& model() const { return model_; }

  private:
    Quantiser quantiser_;
    IndexModel model_;
};

// ---- signs: the known points whose sign is not that of F, as differences of their numbers, 7 bits a byte

Flags signsOfF(const Lattice& lattice, const std::vector<float>& c, double K) {
    const std::vector<float> F = latticeValues(lattice, c, static_cast<float>(K), nullptr);
    Flags negative(F.size());
    std::transform(F.begin(), F.end(), negative.begin(), [](float f) { return f < 0; });
    return negative;
}

std::string encodeFlips(const Flags& from, const Flags& to) {
    std::string bytes;
    std::size_t last = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        if (from[i] == to[i]) continue;
        std::size_t step = i - last;
        for (; step >= 128; step >>= 7) bytes += static_cast<char>(128 | (step & 127));
        bytes += static_cast<char>(step);
        last = i;
    }
    return bytes;
}

void decodeFlips(std::string_view bytes, Flags& signs) {
    std::size_t at = 0, step = 0;
    int shift = 0;
    for (const char byte : bytes) {
        step |= static_cast<std::size_t>(byte & 127) << shift;
        shift = byte & 128 ? shift + 7 : 0;
        if (shift > 56) throw std::runtime_error("a sign of no point");
        if (shift > 0) continue;
        at += step;
        step = 0;
        if (at >= signs.size()) throw std::runtime_error("a sign of no point");
        signs[at] ^= 1;
    }
}

// ---- writing

class Packer {
  public:
    Packer(const FieldPoints& points, const std::string& name, const PackOptions& options,
           const Progress& progress)
        : points_(points), name_(name), options_(options), progress_(progress) {
        head_.K = points.K;
        head_.origin = points.origin;
        head_.size = points.lattice.size;
        head_.points = points.lattice.pointCount();
        head_.chunkEnds = chunkEndsOf(points.lattice);
        head_.transform = points.transform;
        head_.source = options.source;
        chunks_.resize(head_.chunkEnds.size());
    }

    std::string run(PackFacts& facts) {
        progress_("packing", 0);
        std::vector<float> values = points_.c;
        if (options_.bound)
            values = quantise();
        else
            encodeExactly(values);
        std::vector<Section> sections{
            {SectionKind::head, bytesOf(head_)},
            {SectionKind::nodes, encodeNodes(points_.nodes)},
            {SectionKind::signs, encodeFlips(signsOfF(points_.lattice, values, head_.K), points_.inside)}};
        facts.headBytes = static_cast<std::int64_t>(sections[0].content.size());
        facts.nodeBytes = static_cast<std::int64_t>(sections[1].content.size());
        facts.signBytes = static_cast<std::int64_t>(sections[2].content.size());
        for (std::string& chunk : chunks_) {
            facts.valueBytes += static_cast<std::int64_t>(chunk.size());
            sections.push_back({SectionKind::values, std::move(chunk)});
        }
        facts.chunks = static_cast<int>(chunks_.size());
        facts.points = static_cast<std::int64_t>(head_.points);
        facts.delta = head_.quantised ? head_.quantised->delta : 0;
        return fileOf(kPackedFormat, sections);
    }

  private:
    void encodeExactly(std::vector<float>& values) {
        const auto K = static_cast<float>(head_.K);
        head_.weights = fitFloatWeights(points_.lattice, values, K);
        const FloatModel model{points_.lattice, head_.weights, K};
        forEachChunk(head_.chunkEnds, progress_, [&](std::size_t i, int begin, int end) {
            chunks_[i] = encodeFloats(model, begin, end, values);
        });
    }

    // Returns what the indices stand for.
    std::vector<float> quantise() {
        const BoundedInput input{points_.lattice, points_.c, points_.inside, static_cast<float>(head_.K),
                                 options_.voxelsPerK};
        if (reachOf(input) > Quantiser::kMostReach)
            throw InputError(
                name_,
                fmt::format("has control points of {:.4g} voxels, beyond the {} that a bound can be kept "
                            "for; pack it without --bound",
                            reachOf(input), Quantiser::kMostReach));
        auto bounded = boundIndices(input, *options_.bound, progress_);
        if (!bounded)
            throw OperationError(
                name_, fmt::format("cannot keep every sign and a bound of {:g} voxels with any step down to "
                                   "{} voxels; take a larger bound, or pack it without --bound",
                                   *options_.bound, Quantiser::kLeastDelta));
        head_.quantised =
            Head::Quantised{*options_.bound, bounded->delta, reachOf(input), options_.voxelsPerK};
        fitIndexWeights(bounded->indices);
        const Quantised quantised(*head_.quantised, points_.lattice, head_.weights);
        forEachChunk(head_.chunkEnds, progress_, [&](std::size_t i, int begin, int end) {
            chunks_[i] = encodeIndices(quantised.model(), begin, end, bounded->indices);
        });
        return valuesOf(bounded->indices, quantised.quantiser(), head_.K, options_.voxelsPerK);
    }
    // An error of u is one of t / (1 + (t / T)^2), T = 2.5 voxels (quantiser.h).
    void fitIndexWeights(const std::vector<std::int32_t>& indices) {
        const Quantised quantised(*head_.quantised, points_.lattice, head_.weights);
        std::vector<std::int32_t> values(indices.size());
        std::vector<float> importance(indices.size());
        for (std::size_t i = 0; i < indices.size(); ++i) {
            values[i] = quantised.quantiser().value(indices[i]);
            const float t = static_cast<float>(values[i]) / kOneVoxel / 2.5f;
            importance[i] = 1 / (1 + t * t);
        }
        head_.weights = fitWeights(points_.lattice, values,
                                   quantised.quantiser().value(quantised.model().outside), importance);
    }

    const FieldPoints& points_;
    const std::string& name_;
    const PackOptions& options_;
    const Progress& progress_;
    Head head_;
    std::vector<std::string> chunks_;
};

// ---- reading

struct Unpacked {
    Head head;
    FieldPoints points;
};

const std::string& contentOf(const std::vector<Section>& sections, std::size_t at, SectionKind kind) {
    if (at >= sections.size() || sections[at].kind != kind)
        throw std::runtime_error(
            fmt::format("section {} is not there; the file is truncated or damaged", at));
    return sections[at].content;
}

void decodeValues(const Head& head, const std::vector<Section>& sections, std::size_t first,
                  FieldPoints& points, const Progress& progress) {
    const Lattice& lattice = points.lattice;
    const auto content = [&](std::size_t i) -> const std::string& {
        return contentOf(sections, first + i, SectionKind::values);
    };
    points.c.resize(lattice.pointCount());
    if (!head.quantised) {
        const FloatModel model{lattice, head.weights, static_cast<float>(head.K)};
        forEachChunk(head.chunkEnds, progress, [&](std::size_t i, int begin, int end) {
            decodeFloats(model, begin, end, content(i), points.c);
        });
        return;
    }
    std::vector<std::int32_t> indices(lattice.pointCount());
    const Quantised quantised(*head.quantised, lattice, head.weights);
    forEachChunk(head.chunkEnds, progress, [&](std::size_t i, int begin, int end) {
        decodeIndices(quantised.model(), begin, end, content(i), indices);
    });
    points.c = valuesOf(indices, quantised.quantiser(), head.K, head.quantised->voxelsPerK);
}

Unpacked unpackPoints(std::string_view bytes, double mostPoints, const Progress& progress) {
    const std::vector<Section> sections = sectionsOf(kPackedFormat, bytes);
    Unpacked u{headOf(contentOf(sections, 0, SectionKind::head)), {}};
    const Head& head = u.head;
    if (static_cast<double>(head.points) > mostPoints)
        throw std::runtime_error(
            fmt::format("holds {} control points, and memory suffices for {:.0f}; see --max-memory",
                        head.points, mostPoints));
    if (sections.size() != 3 + head.chunkEnds.size())
        throw std::runtime_error(fmt::format("has {} sections, expected {}; it is truncated or damaged",
                                             sections.size(), 3 + head.chunkEnds.size()));
    u.points.origin = head.origin;
    u.points.K = head.K;
    u.points.transform = head.transform;
    u.points.nodes = decodeNodes(contentOf(sections, 1, SectionKind::nodes),
                                 {head.size[0] - 3, head.size[1] - 3, head.size[2] - 3});
    const BitBox known = pointsOf(u.points.nodes);
    if (known.count() != head.points)
        throw std::runtime_error("its nodes are not those of its head; the file is damaged");
    u.points.lattice = Lattice(known);
    decodeValues(head, sections, 3, u.points, progress);
    u.points.inside = signsOfF(u.points.lattice, u.points.c, head.K);
    decodeFlips(contentOf(sections, 2, SectionKind::signs), u.points.inside);
    return u;
}

// ---- the promise

void requireSame(const FieldPoints& points, const FieldPoints& decoded, const std::string& name) {
    const bool same = points.origin == decoded.origin && points.nodes == decoded.nodes &&
                      points.inside == decoded.inside && points.c.size() == decoded.c.size();
    if (!same)
        throw OperationError(name, "did not come back from packing as it went in; nothing was written");
}

void requirePromise(const FieldPoints& points, const FieldPoints& decoded, const std::string& name,
                    const PackOptions& options, PackFacts& facts) {
    requireSame(points, decoded, name);
    if (!options.bound) {
        if (std::memcmp(points.c.data(), decoded.c.data(), points.c.size() * sizeof(float)) != 0)
            throw OperationError(name, "did not come back from packing to the bit; nothing was written");
        return;
    }
    const Change change =
        changeNear(points.lattice, points.c, decoded.c, static_cast<float>(points.K), points.inside);
    facts.largest = change.largest * options.voxelsPerK;
    facts.rms = change.rms * options.voxelsPerK;
    if (facts.largest > *options.bound)
        throw OperationError(
            name, fmt::format("would change by {:g} voxels, above the bound of {:g}; nothing was written",
                              facts.largest, *options.bound));
}

PackedField packedFieldOf(const Unpacked& u) {
    PackedField packed{fieldOf(u.points), u.head.source, {}};
    if (u.head.quantised) packed.bound = u.head.quantised->bound;
    return packed;
}

}  // namespace

PackedBytes pack(const BSplineField& field, const std::string& name, const PackOptions& options,
                 const Progress& progress) {
    const FieldPoints points = fieldPointsOf(field, name, progress);
    PackedBytes packed;
    packed.bytes = Packer(points, name, options, progress).run(packed.facts);
    packed.facts.bytes = static_cast<std::int64_t>(packed.bytes.size());
    progress("checking", 0);
    const Unpacked back = unpackPoints(packed.bytes, static_cast<double>(points.c.size()), progress);
    requirePromise(points, back.points, name, options, packed.facts);
    packed.decoded = packedFieldOf(back);
    progress("packing", 1);
    return packed;
}

PackedField unpack(std::string_view bytes, const std::string& name, double mostPoints,
                   const Progress& progress) {
    try {
        return packedFieldOf(unpackPoints(bytes, mostPoints, progress));
    } catch (const std::runtime_error& error) {
        throw InputError(name, error.what());
    }
}

void writeFile(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    try {
        file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    } catch (const std::ios_base::failure& error) {
        throw OperationError(path.string(), fmt::format("cannot be written: {}", error.what()));
    }
    file.commit();
}

PackedField readPacked(const std::filesystem::path& path, double mostPoints, const Progress& progress) {
    return unpack(readFile(path, "a packed solid"), path.string(), mostPoints, progress);
}

double measuredVoxelsPerK(const BSplineField& field, const std::string& name, const Progress& progress) {
    const FieldPoints points = fieldPointsOf(field, name, progress);
    const double slope = medianSlope(points.lattice, points.c, static_cast<float>(points.K), points.inside);
    return std::clamp(points.K / slope, 0.01, 256.0);
}

bool isPackedPath(const std::filesystem::path& path) { return toLower(path.extension().string()) == ".iwz"; }

}  // namespace isowave::compress
