#include "view/mesh_packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace isowave::view {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint8_t kNew = 0, kBefore = 1, kBehind = 2, kNamed = 3, kThroughBc = 4, kThroughCa = 8,
                       kWalkedBc = 16, kWalkedCa = 32;

using Lattice = std::array<std::int32_t, 3>;

// Half-edge 3t + k runs from corner k of triangle t to the next one. twins()[h]: a half-edge of another triangle that runs the
// opposite way, no two half-edges having the same one; kNone where there is none.
std::vector<std::uint32_t> twins(const TriangleMesh& mesh) {
    const auto from = [&](std::size_t h) { return mesh.triangles[h / 3][h % 3]; };
    const auto to = [&](std::size_t h) { return mesh.triangles[h / 3][(h % 3 + 1) % 3]; };
    const std::size_t count = 3 * mesh.triangles.size();
    // Half-edges by where they start: those of vertex v are of[begin[v]] .. of[begin[v + 1] - 1].
    std::vector<std::uint32_t> begin(mesh.points.size() + 1, 0), of(count), twin(count, kNone);
    for (std::size_t h = 0; h < count; ++h) ++begin[from(h) + 1];
    for (std::size_t v = 0; v < mesh.points.size(); ++v) begin[v + 1] += begin[v];
    std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
    for (std::size_t h = 0; h < count; ++h) of[at[from(h)]++] = static_cast<std::uint32_t>(h);
    for (std::size_t h = 0; h < count; ++h) {
        if (twin[h] != kNone) continue;
        for (std::uint32_t i = begin[to(h)]; i < begin[to(h) + 1]; ++i)
            if (const std::uint32_t g = of[i]; to(g) == from(h) && twin[g] == kNone && g / 3 != h / 3) {
                twin[h] = g;
                twin[g] = static_cast<std::uint32_t>(h);
                break;
            }
    }
    return twin;
}

// A triangle of the walk: which, and the corner that is a. first: of its component, not entered through an edge.
struct Visit {
    std::uint32_t halfEdge = 0;  // a -> b
    bool first = false, throughBc = false, throughCa = false;
};

std::uint32_t nextInTriangle(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }

// All triangles, each once, depth first, through b-c before c-a.
class Walk {
  public:
    Walk(std::size_t triangles, const std::vector<std::uint32_t>& twin)
        : twin_(twin), visited_(triangles, false) {
        visits_.reserve(triangles);
        for (std::uint32_t t = 0; t < triangles; ++t)
            if (!visited_[t]) component(3 * t);
    }
    std::vector<Visit> take() { return std::move(visits_); }

  private:
    // An edge that the walk may leave a triangle through: into half-edge `into`, out of visit `of`.
    struct Gate {
        std::uint32_t into, of;
        bool isBc;
    };

    void component(std::uint32_t start) {
        enter(start, true);
        while (!gates_.empty()) {
            const Gate gate = gates_.back();
            gates_.pop_back();
            if (visited_[gate.into / 3]) continue;
            (gate.isBc ? visits_[gate.of].throughBc : visits_[gate.of].throughCa) = true;
            enter(gate.into, false);
        }
    }

    void enter(std::uint32_t halfEdge, bool first) {
        visited_[halfEdge / 3] = true;
        const auto of = static_cast<std::uint32_t>(visits_.size());
        visits_.push_back({halfEdge, first, false, false});
        const std::uint32_t bc = nextInTriangle(halfEdge), ca = nextInTriangle(bc);
        if (twin_[ca] != kNone) gates_.push_back({twin_[ca], of, false});
        if (twin_[bc] != kNone) gates_.push_back({twin_[bc], of, true});
    }

    const std::vector<std::uint32_t>& twin_;
    std::vector<bool> visited_;
    std::vector<Visit> visits_;
    std::vector<Gate> gates_;
};

// Turns the walk into the three streams. What it knows while it writes is what a reader knows while it reads.
class Writer {
  public:
    Writer(const TriangleMesh& mesh, const std::vector<std::uint32_t>& twin, PackedMesh& packed)
        : mesh_(mesh),
          twin_(twin),
          packed_(packed),
          number_(mesh.points.size(), kNone),
          written_(mesh.triangles.size(), false) {}

    void write(const std::vector<Visit>& visits) {
        for (const Visit& visit : visits) triangle(visit);
        packed_.vertices = static_cast<std::int64_t>(packed_.order.size());
        packed_.triangles = static_cast<std::int64_t>(visits.size());
        join();
    }

  private:
    struct Gate {
        std::uint32_t a, b, d;
    };

    void triangle(const Visit& visit) {
        const Triangle& t = mesh_.triangles[visit.halfEdge / 3];
        const std::uint32_t k = visit.halfEdge % 3;
        Gate gate;
        if (visit.first) {
            gate.a = named(t[k], lastLattice());
            gate.b = named(t[(k + 1) % 3], lattice_[gate.a]);
            gate.d = gate.a;
            behind_[gate.b] = gate.a, before_[gate.a] = gate.b;
        } else {
            gate = gates_.back();
            gates_.pop_back();
        }
        const std::uint32_t bc = nextInTriangle(visit.halfEdge);
        const Sides walked{isWalked(bc), isWalked(nextInTriangle(bc))};
        const std::uint8_t kind = corner(gate, t[(k + 2) % 3], walked);
        const std::uint32_t c = number_[t[(k + 2) % 3]];
        setRim(gate, c, kind);
        written_[visit.halfEdge / 3] = true;
        if (visit.throughCa) gates_.push_back({gate.a, c, gate.b});
        if (visit.throughBc) gates_.push_back({c, gate.b, gate.a});
        kinds_.push_back(static_cast<std::uint8_t>(kind + (visit.throughBc ? kThroughBc : 0) +
                                                   (visit.throughCa ? kThroughCa : 0)));
    }

    // Of the edges b-c and c-a: whether the triangle on the other side has been walked.
    struct Sides {
        bool bc, ca;
    };
    bool isWalked(std::uint32_t halfEdge) const {
        return twin_[halfEdge] != kNone && written_[twin_[halfEdge] / 3];
    }

    std::uint8_t corner(const Gate& gate, std::uint32_t vertex, const Sides& walked) {
        const std::uint32_t c = number_[vertex];
        if (c == kNone) {
            Lattice guess;
            for (std::size_t axis = 0; axis < 3; ++axis)
                guess[axis] = lattice_[gate.a][axis] + lattice_[gate.b][axis] - lattice_[gate.d][axis];
            put(vertex, guess);
            return kNew;
        }
        if (walked.ca && c == before_[gate.a]) return kBefore;
        if (walked.bc && c == behind_[gate.b]) return kBehind;
        putVarint(names_, packed_.order.size() - c);
        return static_cast<std::uint8_t>(kNamed + (walked.bc ? kWalkedBc : 0) + (walked.ca ? kWalkedCa : 0));
    }

    // The rim had a -> b, and has a -> c -> b, but for edges whose other side was walked: those are inside now.
    void setRim(const Gate& gate, std::uint32_t c, std::uint8_t kind) {
        const int which = kind & kNamed;
        if (which != kBefore && !(kind & kWalkedCa)) behind_[gate.a] = c, before_[c] = gate.a;
        if (which != kBehind && !(kind & kWalkedBc)) behind_[c] = gate.b, before_[gate.b] = c;
    }

    std::uint32_t named(std::uint32_t vertex, const Lattice& guess) {
        const std::uint32_t known = number_[vertex];
        putVarint(names_, known == kNone ? 0 : packed_.order.size() - known);
        if (known == kNone) put(vertex, guess);
        return number_[vertex];
    }

    Lattice lastLattice() const { return lattice_.empty() ? Lattice{} : lattice_.back(); }

    void put(std::uint32_t vertex, const Lattice& guess) {
        number_[vertex] = static_cast<std::uint32_t>(packed_.order.size());
        packed_.order.push_back(vertex);
        behind_.push_back(kNone);
        before_.push_back(kNone);
        Lattice at;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] = static_cast<std::int32_t>(
                std::lround((mesh_.points[vertex][axis] - packed_.low[axis]) / packed_.step));
            const auto difference = static_cast<std::int16_t>(at[axis] - guess[axis]);
            const auto code = static_cast<std::uint16_t>(zigzag(difference));
            planes_[2 * axis].push_back(static_cast<std::uint8_t>(code & 255));
            planes_[2 * axis + 1].push_back(static_cast<std::uint8_t>(code >> 8));
        }
        lattice_.push_back(at);
    }

    void join() {
        Bytes& all = packed_.bytes;
        all = std::move(kinds_);
        for (const Bytes& plane : planes_) all.insert(all.end(), plane.begin(), plane.end());
        all.insert(all.end(), names_.begin(), names_.end());
    }

    const TriangleMesh& mesh_;
    const std::vector<std::uint32_t>& twin_;
    PackedMesh& packed_;
    std::vector<std::uint32_t> number_;  // of the mesh's vertices, in the order of the walk
    std::vector<bool> written_;          // of the mesh's triangles
    std::vector<Lattice> lattice_;       // from here on by that number
    std::vector<std::uint32_t> before_, behind_;
    std::vector<Gate> gates_;
    Bytes kinds_, names_;
    std::array<Bytes, 6> planes_;
};

void putLattice(const TriangleMesh& mesh, PackedMesh& packed) {
    Point& high = packed.high;
    packed.low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                packed.low[axis] = std::min(packed.low[axis], mesh.points[v][axis]);
                high[axis] = std::max(high[axis], mesh.points[v][axis]);
            }
    double longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, high[axis] - packed.low[axis]);
    packed.step = longest > 0 ? longest / kSteps : 1;
}

}  // namespace

PackedMesh packed(const TriangleMesh& mesh) {
    PackedMesh result;
    if (mesh.triangles.empty()) return result;
    putLattice(mesh, result);
    const std::vector<std::uint32_t> twin = twins(mesh);
    Writer(mesh, twin, result).write(Walk(mesh.triangles.size(), twin).take());
    return result;
}

Bytes packedValues(const std::vector<float>& ofVertex, const std::vector<std::uint32_t>& order,
                   double largest) {
    Bytes bytes(2 * order.size());
    std::int64_t before = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::int64_t at = largest > 0 ? std::lround(ofVertex[order[i]] / largest * kSteps) : 0;
        const auto code = static_cast<std::uint16_t>(zigzag(static_cast<std::int16_t>(at - before)));
        bytes[i] = static_cast<std::uint8_t>(code & 255);
        bytes[order.size() + i] = static_cast<std::uint8_t>(code >> 8);
        before = at;
    }
    return bytes;
}

}  // namespace isowave::view
