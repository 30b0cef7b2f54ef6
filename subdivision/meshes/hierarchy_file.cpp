#include "subdivision/meshes/hierarchy_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "subdivision/meshes/mesh_schemes.h"

namespace isowave::subdivision {
namespace {

static_assert(std::endian::native == std::endian::little, "sections are written as they lie in memory");
static_assert(sizeof(Vec3) == 24 && sizeof(Crease) == 16);

constexpr char kMagic[8] = {'i', 's', 'o', 'w', 'm', 'e', 's', 'h'};
constexpr std::uint32_t kDense = 1, kSparse = 2;  // versions
constexpr std::uint32_t kLargestHeader = 1 << 20;

struct Prefix {
    char magic[8];
    std::uint32_t version, headerBytes, headerCrc;
};
static_assert(sizeof(Prefix) == 20);

std::uint32_t crcOf(const void* data, std::size_t bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, static_cast<const Bytef*>(data), bytes));
}

std::string detailsName(std::size_t k) { return fmt::format("details-{}", k + 1); }
std::string keptName(std::size_t k) { return fmt::format("kept-{}", k + 1); }

// ---- details without those that are 0: a bit for each says whether it is there ----

struct SparseDetails {
    std::vector<std::uint32_t> kept;  // 32 bits a word, the lowest first
    std::vector<Vec3> details;
};

constexpr std::uint64_t wordsOf(std::uint64_t count) { return count / 32 + (count % 32 > 0); }

// To the bit: -0 is not 0.
bool isZero(const Vec3& d) {
    static constexpr Vec3 zero{};
    return std::memcmp(&d, &zero, sizeof d) == 0;
}

SparseDetails sparse(const std::vector<Vec3>& details) {
    SparseDetails result{std::vector<std::uint32_t>(wordsOf(details.size())), {}};
    for (std::size_t i = 0; i < details.size(); ++i) {
        if (isZero(details[i])) continue;
        result.kept[i / 32] |= std::uint32_t{1} << (i % 32);
        result.details.push_back(details[i]);
    }
    return result;
}

// Nothing where the parts do not make `count` details.
std::optional<std::vector<Vec3>> dense(const SparseDetails& parts, std::uint64_t count) {
    if (parts.kept.size() != wordsOf(count)) return std::nullopt;
    std::vector<Vec3> details(count);
    std::size_t next = 0;
    for (std::size_t i = 0; i < 32 * parts.kept.size(); ++i) {
        if (!(parts.kept[i / 32] >> (i % 32) & 1)) continue;
        if (i >= count || next == parts.details.size()) return std::nullopt;
        details[i] = parts.details[next++];
    }
    if (next != parts.details.size()) return std::nullopt;
    return details;
}

std::size_t bytesOf(const SparseDetails& parts) {
    return parts.kept.size() * sizeof(std::uint32_t) + parts.details.size() * sizeof(Vec3);
}

// ---- writing ----

struct Sections {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    std::vector<std::pair<const void*, std::size_t>> bytes;

    template <class T>
    void add(const std::string& name, const std::vector<T>& values) {
        bytes.emplace_back(values.data(), values.size() * sizeof(T));
        list.push_back(
            {{"name", name}, {"count", values.size()}, {"crc32", crcOf(values.data(), bytes.back().second)}});
    }
    void add(std::size_t k, const SparseDetails& parts, std::size_t count) {
        add(keptName(k), parts.kept);
        add(detailsName(k), parts.details);
        list.back()["of"] = count;
    }
};

// Of every level, where that takes fewer bytes than all details do; else nothing.
std::vector<SparseDetails> sparseWhereSmaller(const Hierarchy& hierarchy) {
    std::vector<SparseDetails> all;
    std::size_t bytes = 0;
    for (const auto& details : hierarchy.details) {
        all.push_back(sparse(details));
        bytes += bytesOf(all.back());
    }
    if (bytes >= detailCount(hierarchy) * sizeof(Vec3)) all.clear();
    return all;
}

}  // namespace

void writeHierarchy(std::ostream& stream, const Hierarchy& hierarchy) {
    std::vector<Index> sizes(hierarchy.base.faceCount());
    for (std::size_t f = 0; f < sizes.size(); ++f) sizes[f] = static_cast<Index>(hierarchy.base.faceSize(f));
    Sections sections;
    sections.add("points", hierarchy.base.points);
    sections.add("faces", sizes);
    sections.add("corners", hierarchy.base.corners);
    sections.add("creases", hierarchy.base.creases);
    sections.add("pinned", hierarchy.base.pinned);
    const std::vector<SparseDetails> kept = sparseWhereSmaller(hierarchy);
    for (std::size_t k = 0; k < hierarchy.details.size(); ++k) {
        if (kept.empty())
            sections.add(detailsName(k), hierarchy.details[k]);
        else
            sections.add(k, kept[k], hierarchy.details[k].size());
    }
    sections.add("order-vertices", hierarchy.order.vertex);
    sections.add("order-corners", hierarchy.order.firstCorner);
    const nlohmann::ordered_json header = {{"scheme", hierarchy.scheme},
                                           {"variant", hierarchy.variant},
                                           {"steps", hierarchy.steps()},
                                           {"sections", sections.list}};
    const std::string text = header.dump();
    Prefix prefix{{},
                  kept.empty() ? kDense : kSparse,
                  static_cast<std::uint32_t>(text.size()),
                  crcOf(text.data(), text.size())};
    std::memcpy(prefix.magic, kMagic, sizeof kMagic);

    const auto write = [&](const void* data, std::size_t bytes) {
        stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
    };
    write(&prefix, sizeof prefix);
    write(text.data(), text.size());
    for (const auto& [data, bytes] : sections.bytes) write(data, bytes);
}

void saveHierarchy(const std::filesystem::path& path, const Hierarchy& hierarchy) {
    AtomicFile file(path);
    try {
        writeHierarchy(file.stream(), hierarchy);
    } catch (const std::ios_base::failure&) {
        throw OperationError(path.string(), "writing failed; is the disk full? Nothing was left behind");
    }
    file.commit();
}

namespace {

// ---- reading ----

class Reader {
  public:
    explicit Reader(const std::filesystem::path& path) : name_(path.string()) {
        std::error_code error;
        if (!std::filesystem::exists(path, error)) throw InputError(name_, "no such file");
        if (std::filesystem::is_directory(path, error))
            throw InputError(name_, "is a folder; expected details of a mesh");
        stream_.open(path, std::ios::binary);
        if (!stream_) throw InputError(name_, "cannot be opened; check its permissions");
        stream_.seekg(0, std::ios::end);
        bytes_ = static_cast<std::uint64_t>(stream_.tellg());
        stream_.seekg(0);
    }

    nlohmann::json header() {
        Prefix prefix{};
        const bool whole = bytes_ >= sizeof prefix;
        if (whole) stream_.read(reinterpret_cast<char*>(&prefix), sizeof prefix);
        if (!whole || std::memcmp(prefix.magic, kMagic, sizeof kMagic) != 0)
            throw InputError(name_, "holds no details of a mesh, as isowave reverse --details writes them");
        if (prefix.version != kDense && prefix.version != kSparse) {
            throw InputError(
                name_, fmt::format("has version {}; this program reads versions {} and {}: take a newer one",
                                   prefix.version, kDense, kSparse));
        }
        version_ = prefix.version;
        if (prefix.headerBytes > kLargestHeader) damaged("header");
        std::string text(prefix.headerBytes, '\0');
        read(text.data(), text.size(), "header");
        if (crcOf(text.data(), text.size()) != prefix.headerCrc) damaged("header");
        return nlohmann::json::parse(text);
    }

    template <class T>
    std::vector<T> section(const nlohmann::json& entry) {
        const auto name = entry.at("name").get<std::string>();
        const auto count = entry.at("count").get<std::uint64_t>();
        if (count > bytes_ / sizeof(T)) truncated(name, count * sizeof(T));
        std::vector<T> values(count);
        read(values.data(), count * sizeof(T), name);
        if (crcOf(values.data(), count * sizeof(T)) != entry.at("crc32").get<std::uint32_t>()) damaged(name);
        return values;
    }

    bool isSparse() const { return version_ == kSparse; }
    // The details of a step. REQUIRES: isSparse().
    std::vector<Vec3> sparseDetails(const nlohmann::json& kept, const nlohmann::json& details) {
        const auto count = details.at("of").get<std::uint64_t>();
        SparseDetails parts;
        parts.kept = section<std::uint32_t>(kept);
        if (parts.kept.size() != wordsOf(count)) damaged(kept.at("name").get<std::string>());
        parts.details = section<Vec3>(details);
        auto all = dense(parts, count);
        if (!all) damaged(details.at("name").get<std::string>());
        return std::move(*all);
    }

    void requireEnd() {
        const auto at = static_cast<std::uint64_t>(stream_.tellg());
        if (at != bytes_)
            throw InputError(name_, fmt::format("has {} bytes behind its end; it is damaged", bytes_ - at));
    }
    [[noreturn]] void damaged(const std::string& part) const {
        throw InputError(
            name_,
            fmt::format("its part '{}' is damaged (the checksum does not agree); copy it again", part));
    }

  private:
    void read(void* data, std::size_t bytes, const std::string& part) {
        if (bytes > bytes_ - static_cast<std::uint64_t>(stream_.tellg())) truncated(part, bytes);
        stream_.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes));
        if (!stream_) throw InputError(name_, "cannot be read; check the disk");
    }
    [[noreturn]] void truncated(const std::string& part, std::uint64_t bytes) const {
        throw InputError(
            name_,
            fmt::format("its part '{}' needs {} bytes, but the file ends before, after {} in all; it is "
                        "truncated",
                        part, bytes, bytes_));
    }

    std::string name_;
    std::ifstream stream_;
    std::uint64_t bytes_ = 0;
    std::uint32_t version_ = kDense;
};

bool isPermutation(const std::vector<Index>& order) {
    std::vector<bool> seen(order.size(), false);
    for (const Index i : order) {
        if (i >= order.size() || seen[i]) return false;
        seen[i] = true;
    }
    return true;
}

// The order names every vertex once, and every face once: its first corners, divided by the faces' common size.
bool isOrder(const FinestOrder& order, std::size_t points) {
    if (order.empty()) return order.firstCorner.empty();
    if (order.vertex.size() != points || order.firstCorner.empty() || !isPermutation(order.vertex))
        return false;
    const Index largest = *std::max_element(order.firstCorner.begin(), order.firstCorner.end());
    const auto size = largest / order.firstCorner.size() + 1;
    std::vector<Index> faces(order.firstCorner.size());
    for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<Index>(order.firstCorner[f] / size);
    return isPermutation(faces);
}

PolygonMesh readBase(Reader& reader, const nlohmann::json& sections) {
    PolygonMesh base;
    base.points = reader.section<Vec3>(sections.at(0));
    const auto sizes = reader.section<Index>(sections.at(1));
    base.corners = reader.section<Index>(sections.at(2));
    base.creases = reader.section<Crease>(sections.at(3));
    base.pinned = reader.section<Index>(sections.at(4));
    for (const Index size : sizes) base.faceBegin.push_back(base.faceBegin.back() + size);
    if (base.faceBegin.back() != base.corners.size()) reader.damaged("faces");
    return base;
}

constexpr std::size_t kBaseSections = 5;

void requireVariant(const Hierarchy& hierarchy, const std::string& name) {
    try {
        meshVariant(meshScheme(hierarchy.scheme), hierarchy.variant);
    } catch (const InputError& e) {
        throw InputError(name, e.what());
    }
}

}  // namespace

Hierarchy loadHierarchy(const std::filesystem::path& path, int steps) {
    Reader reader(path);
    try {
        const auto header = reader.header();
        const auto& sections = header.at("sections");
        const int there = header.at("steps").get<int>();
        const std::size_t each = reader.isSparse() ? 2 : 1;  // sections of a step
        if (there < 0 || sections.size() != kBaseSections + each * static_cast<std::size_t>(there) + 2)
            reader.damaged("header");
        const std::size_t behind = sections.size() - 2;
        if (steps > there) {
            throw InputError(path.string(),
                             fmt::format("holds details for {} levels, but {} were asked for", there, steps));
        }
        const int count = steps == kAllLevels ? there : steps;
        Hierarchy result;
        result.scheme = header.at("scheme");
        result.variant = header.at("variant");
        requireVariant(result, path.string());
        result.base = readBase(reader, sections);
        requireManifold(result.base, path.string());
        std::size_t points = result.base.vertexCount();
        for (int k = 0; k < count; ++k) {
            const std::size_t at = kBaseSections + each * static_cast<std::size_t>(k);
            result.details.push_back(reader.isSparse()
                                         ? reader.sparseDetails(sections.at(at), sections.at(at + 1))
                                         : reader.section<Vec3>(sections.at(at)));
            points += result.details.back().size();
        }
        result.truncated = count < there;
        if (result.truncated) return result;
        result.order.vertex = reader.section<Index>(sections.at(behind));
        result.order.firstCorner = reader.section<Index>(sections.at(behind + 1));
        reader.requireEnd();
        if (!isOrder(result.order, points)) reader.damaged("order-vertices");
        return result;
    } catch (const nlohmann::json::exception&) {
        reader.damaged("header");
    }
}

}  // namespace isowave::subdivision
