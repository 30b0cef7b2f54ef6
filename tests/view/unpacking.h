// Reads the streams of view/mesh_packing.h, from what that header says of them, as page/unpack.js does.
#pragma once

#include <cstdint>
#include <vector>

#include "view/mesh_packing.h"

namespace isowave::view {

class Varints {
  public:
    Varints(const Bytes& bytes, std::size_t at) : bytes_(bytes), at_(at) {}
    std::uint64_t next() {
        std::uint64_t value = 0;
        for (int shift = 0;; shift += 7) {
            const std::uint8_t byte = bytes_.at(at_++);
            value |= static_cast<std::uint64_t>(byte & 127) << shift;
            if (byte < 128) return value;
        }
    }
    std::int64_t nextSigned() {
        const std::uint64_t code = next();
        return static_cast<std::int64_t>(code >> 1) ^ -static_cast<std::int64_t>(code & 1);
    }
    bool atEnd() const { return at_ == bytes_.size(); }

  private:
    const Bytes& bytes_;
    std::size_t at_;
};

inline int signedOf(std::uint8_t low, std::uint8_t high) {
    const int code = low | high << 8;
    return code >> 1 ^ -(code & 1);
}

// `packed` as a mesh, in the order of the packed one. Throws std::out_of_range where the streams are too short.
class Unpacker {
  public:
    explicit Unpacker(const PackedMesh& packed)
        : packed_(packed),
          names_(packed.bytes, static_cast<std::size_t>(packed.triangles + 6 * packed.vertices)) {
        for (std::int64_t t = 0; t < packed.triangles; ++t) triangle(packed.bytes.at(std::size_t(t)));
    }
    TriangleMesh mesh;
    bool usedAll() const { return names_.atEnd() && gates_.empty(); }

  private:
    struct Gate {
        std::size_t a, b, d;
    };

    void triangle(std::uint8_t kind) {
        Gate g;
        if (gates_.empty()) {
            g.a = named(lattice_.size() - 1);
            g.b = named(g.a);
            g.d = g.a;
            behind_.at(g.b) = g.a;
            before_.at(g.a) = g.b;
        } else {
            g = gates_.back();
            gates_.pop_back();
        }
        const int which = kind & 3;
        const std::size_t c = which == 0   ? put(g.a, g.b, g.d)
                              : which == 1 ? before_.at(g.a)
                              : which == 2 ? behind_.at(g.b)
                                           : lattice_.size() - names_.next();
        if (which != 1 && !(kind & 32)) behind_.at(g.a) = c, before_.at(c) = g.a;
        if (which != 2 && !(kind & 16)) behind_.at(c) = g.b, before_.at(g.b) = c;
        if (kind & 8) gates_.push_back({g.a, c, g.b});
        if (kind & 4) gates_.push_back({c, g.b, g.a});
        mesh.triangles.push_back({std::uint32_t(g.a), std::uint32_t(g.b), std::uint32_t(c)});
    }
    std::size_t named(std::size_t near) {
        const std::uint64_t name = names_.next();
        return name > 0 ? lattice_.size() - name : put(near, near, near);
    }
    std::size_t put(std::size_t a, std::size_t b, std::size_t d) {
        const std::size_t at = lattice_.size();
        std::array<int, 3> place{};
        Point point{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int guess = at == 0 ? 0 : lattice_[a][axis] + lattice_[b][axis] - lattice_[d][axis];
            place[axis] = (guess + signedOf(plane(2 * axis, at), plane(2 * axis + 1, at))) & 0xffff;
            point[axis] = packed_.low[axis] + packed_.step * place[axis];
        }
        lattice_.push_back(place);
        mesh.points.push_back(point);
        before_.push_back(~std::size_t{0});
        behind_.push_back(~std::size_t{0});
        return at;
    }
    std::uint8_t plane(std::size_t which, std::size_t at) const {
        return packed_.bytes.at(static_cast<std::size_t>(packed_.triangles) +
                                which * static_cast<std::size_t>(packed_.vertices) + at);
    }

    const PackedMesh& packed_;
    Varints names_;
    std::vector<std::array<int, 3>> lattice_;
    std::vector<std::size_t> before_, behind_;
    std::vector<Gate> gates_;
};

}  // namespace isowave::view
