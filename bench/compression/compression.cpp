// Packed solids beside other ways to make a field, or its mesh, small: the tables of docs/compression.md.
//
//     compression SOLID...
//
//   SOLID     FILE[:VOXELS], a closed mesh with so many voxels along its longest axis; FILE@ISO, an image as it is; or a function
//             (fidelity/solids.h): plate, plate-turned, gyroid, trabecular, followed by :VOXELS
//
// A row for each coder and bound on the change of F at corners of nodes that the surface passes, in voxels. Packed solids keep it
// and every sign; of the others the coarsest parameter that keeps it is searched, and signs fall as they may. A coder that has no
// mask of its own is charged the bytes that a packed solid's takes. Distances are between the surfaces of level 0 before
// and after, rms and largest found, both ways. Draco codes level 0's mesh: of 8 to 16 bits a coordinate, the fewest
// with which its rms, and with which its largest distance, is not above the packed solid's. Seconds are of CPU,
// all threads together; a packed solid's writing has the search for the step, decoding and both meshes in it.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "compress/packed_file.h"
#include "draco_rival.h"
#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "lod/field_state.h"
#include "measured.h"
#include "solids.h"

namespace isowave::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::array<double, 3> kBounds{0.1, 0.03, 0.01};
constexpr std::array<double, 3> kGoals{1.7, 1.65, 1.4};  // times smaller than the best rival
constexpr double kPyramidGoal = 2.5, kBloscGoal = 1.4;   // lossless
constexpr int kLeastBits = 8, kMostBits = 16;            // of Draco

// Of this process, gone in the end.
class ScratchFolder {
  public:
    ScratchFolder() : path_(fs::temp_directory_path() / fmt::format("isowave_compression_{}", ::getpid())) {
        fs::create_directories(path_);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

// ---- solids

bool isNumber(const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789.-") == std::string::npos;
}

// Cuts what follows the last `mark`, if it is a number, off the text.
std::optional<double> cutNumber(std::string& text, char mark) {
    const auto at = text.rfind(mark);
    if (at == std::string::npos || !isNumber(text.substr(at + 1))) return std::nullopt;
    const double number = std::stod(text.substr(at + 1));
    text.resize(at);
    return number;
}

struct Named {
    std::string name;
    Solid solid;
};

Named solidOf(std::string argument) {
    SolidOptions options;
    if (const auto voxels = cutNumber(argument, ':')) options.voxels = static_cast<std::int64_t>(*voxels);
    options.iso = cutNumber(argument, '@');
    const std::string name = fs::path(argument).stem().string();
    const std::string after = options.voxels ? fmt::format(", {} voxels", *options.voxels) : "";
    if (fs::exists(argument)) return {name + after, open(argument, options)};
    const FidelitySolid function = fidelitySolid(argument, static_cast<int>(options.voxels.value_or(128)));
    return {name + after, open(function.truth, {.voxel = 1.0})};
}

// ---- one solid

class Comparison {
  public:
    Comparison(Named named, fs::path folder) : folder_(std::move(folder)) {
        pack(named.solid, exact());
        const Pyramid pyramid = analyse(named.solid);
        pyramid.save(folder_ / "solid.pyramid.vdb");
        pyramidBytes_ = static_cast<std::int64_t>(fs::file_size(folder_ / "solid.pyramid.vdb"));
        const double halfWidth = named.solid.fit()->halfWidth;
        original_.emplace(named.name, compress::readPacked(exact(), 1e12).field, halfWidth);
    }

    void run() {
        const std::size_t points = original().points().c.size();
        fmt::print("\n### {}\n\n{} control points, {} triangles; mask {} bytes.\n\n", original().name(),
                   points, original().mesh().triangles.size(), original().maskBytes());
        runLossless();
        runBounds();
    }

    std::string lossless, bounded, draco;  // rows of the tables over all solids

  private:
    const Original& original() const { return *original_; }
    fs::path exact() const { return folder_ / "exact.iwz"; }

    Coded packed(std::optional<double> bound) const {
        const fs::path path = folder_ / "packed.iwz";
        PackOptions options;
        if (bound) options.bound = Length{*bound, Length::Unit::voxels};
        Coded coded{.coder = "isowave pack", .bound = bound.value_or(0)};
        const Solid solid = open(exact());
        coded.write = secondsOf([&] { coded.bytes = isowave::pack(solid, path, options).bytes; });
        compress::PackedField back;
        coded.read = secondsOf([&] { back = compress::readPacked(path, 1e12); });
        const FieldPoints points = compress::fieldPointsOf(back.field, "packed", {});
        coded.change = original().changeOf(points.c);
        original().judge(FieldAccess::make(back.field).polygonize(), coded);
        return coded;
    }

    void head() const {
        fmt::print(
            "| bound | coder | kB | bits | change of F | rms | largest | topology | write, s | read, s |\n"
            "|---|---|---|---|---|---|---|---|---|---|\n");
    }
    void print(const Coded& c) const {
        const auto number = [](double value) {
            return std::isnan(value) ? std::string("") : fmt::format("{:.2g}", value);
        };
        fmt::print("| {} | {} | {:.1f} | {:.3f} | {} | {:.4f} | {:.3f} | {} | {} | {} |\n",
                   c.bound > 0 ? fmt::format("{}", c.bound) : "none", c.coder,
                   static_cast<double>(c.bytes) / 1000, original().bitsOf(c.bytes), number(c.change), c.rms,
                   c.max, c.topology, number(c.write), number(c.read));
        std::fflush(stdout);
    }

    void runLossless() {
        head();
        const Coded ours = packed({});
        const Coded blosc =
            original().measured(vdbAndBlosc(original().points(), original().field(), false), 0);
        const Coded planes = original().measured(planesAndXz(original().points()), 0);
        for (const Coded* coded : {&ours, &blosc, &planes}) print(*coded);
        const auto times = [&](std::int64_t bytes) {
            return static_cast<double>(bytes) / static_cast<double>(ours.bytes);
        };
        lossless =
            fmt::format("| {} | {:.0f} | {} | {} | {:.2f} |\n", original().name(),
                        static_cast<double>(ours.bytes) / 1000, judged(times(pyramidBytes_), kPyramidGoal),
                        judged(times(blosc.bytes), kBloscGoal), times(planes.bytes));
    }

    static std::string judged(double value, double goal) {
        return value >= goal ? fmt::format("{:.2f}", value) : fmt::format("**{:.2f}**", value);
    }

    const Coded& dracoOf(int bits) {
        if (const auto found = draco_.find(bits); found != draco_.end()) return found->second;
        Coded coded{.coder = fmt::format("Draco, {} bits", bits)};
        std::string bytes;
        TriangleMesh mesh;
        coded.write = secondsOf([&] { bytes = dracoBytes(original().mesh(), bits); });
        coded.read = secondsOf([&] { mesh = meshOfDraco(bytes); });
        coded.bytes = static_cast<std::int64_t>(bytes.size());
        original().judge(mesh, coded);
        return draco_[bits] = coded;
    }
    // With the fewest bits whose `error` is not above `limit`; by bisection, for errors fall with each bit.
    const Coded* dracoWithin(double Coded::*error, double limit) {
        if (!hasDraco()) return nullptr;
        int low = kLeastBits, high = kMostBits + 1;
        while (low < high) {
            const int middle = (low + high) / 2;
            if (dracoOf(middle).*error <= limit)
                high = middle;
            else
                low = middle + 1;
        }
        return low > kMostBits ? nullptr : &dracoOf(low);
    }

    void runBounds() {
        const FieldPoints& points = original().points();
        const std::vector<FieldRival> adjustable{uniformAndXz(points), zfpBlocks(points, original().field())};
        std::vector<Coded> fixed;
        for (const FieldRival& rival :
             {eightBitsAndXz(points), vdbAndBlosc(points, original().field(), true)})
            fixed.push_back(original().measured(rival, 0));
        bounded = fmt::format("| {} |", original().name());
        draco = bounded;
        for (std::size_t i = 0; i < kBounds.size(); ++i) runBound(kBounds[i], kGoals[i], adjustable, fixed);
        bounded += '\n';
        draco += '\n';
    }

    void runBound(double bound, double goal, const std::vector<FieldRival>& adjustable,
                  const std::vector<Coded>& fixed) {
        const Coded ours = packed(bound);
        print(ours);
        std::vector<Coded> rivals;
        for (const FieldRival& rival : adjustable)
            if (rival.encode) rivals.push_back(original().within(rival, bound));
        for (Coded coded : fixed) {
            coded.bound = bound;
            if (coded.change <= bound) rivals.push_back(coded);
        }
        for (const Coded& coded : rivals) print(coded);
        const auto best = std::min_element(rivals.begin(), rivals.end(),
                                           [](const Coded& a, const Coded& b) { return a.bytes < b.bytes; });
        bounded += fmt::format(
            " {:.3f} | {} | {} |", original().bitsOf(ours.bytes),
            judged(static_cast<double>(best->bytes) / static_cast<double>(ours.bytes), goal), best->coder);
        compareWithDraco(bound, ours);
    }

    void compareWithDraco(double bound, const Coded& ours) {
        for (const auto error : {&Coded::rms, &Coded::max}) {
            const Coded* rival = dracoWithin(error, ours.*error);
            draco += rival ? fmt::format(" {:.2f} |",
                                         static_cast<double>(rival->bytes) / static_cast<double>(ours.bytes))
                           : " |";
            if (!rival) continue;
            Coded row = *rival;
            row.bound = bound;
            row.coder += error == &Coded::rms ? ", by rms" : ", by largest";
            print(row);
        }
    }

    fs::path folder_;
    std::optional<Original> original_;
    std::int64_t pyramidBytes_ = 0;
    std::map<int, Coded> draco_;  // by bits
};

void printSummary(const std::vector<std::string>& lossless, const std::vector<std::string>& bounded,
                  const std::vector<std::string>& draco) {
    fmt::print(
        "\n### Lossless, times smaller (goals {} and {}; bold: missed)\n\n"
        "| solid | kB | than the pyramid's file | than float32 + Blosc | than byte planes + xz "
        "|\n|---|---|---|---|---|\n",
        kPyramidGoal, kBloscGoal);
    for (const std::string& row : lossless) fmt::print("{}", row);
    fmt::print(
        "\n### Within a bound, times smaller than the best rival (goals {} at 0.1, {} at 0.03, {} at 0.01; "
        "bold: missed)\n\n"
        "| solid | bits at 0.1 | times | rival | 0.03 | times | rival | 0.01 | times | rival |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n",
        kGoals[0], kGoals[1], kGoals[2]);
    for (const std::string& row : bounded) fmt::print("{}", row);
    if (!hasDraco()) return;
    fmt::print(
        "\n### Times smaller than Draco's mesh that is as near, by rms and by the largest distance\n\n"
        "| solid | 0.1, rms | largest | 0.03, rms | largest | 0.01, rms | largest "
        "|\n|---|---|---|---|---|---|---|\n");
    for (const std::string& row : draco) fmt::print("{}", row);
}

int run(const std::vector<std::string>& arguments) {
    const ScratchFolder folder;
    std::vector<std::string> lossless, bounded, draco;
    for (const std::string& argument : arguments) {
        Comparison comparison(solidOf(argument), folder.path());
        comparison.run();
        lossless.push_back(comparison.lossless);
        bounded.push_back(comparison.bounded);
        draco.push_back(comparison.draco);
    }
    printSummary(lossless, bounded, draco);
    return 0;
}

}  // namespace
}  // namespace isowave::bench

int main(int count, char** arguments) {
    if (count < 2) {
        fmt::print(stderr, "usage: compression SOLID...\n");
        return 2;
    }
    try {
        return isowave::bench::run({arguments + 1, arguments + count});
    } catch (const std::exception& error) {
        fmt::print(stderr, "compression: {}\n", error.what());
        return 1;
    }
}
