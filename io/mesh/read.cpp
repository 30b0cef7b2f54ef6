// Mesh files through CGAL's readers (Stream_support, LGPL). CGAL says only yes or no, and yes too often: a
// file whose numbers do not add up is caught before, what came out is checked after, and where CGAL refused,
// mesh_read_problems.h looks for the line.
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/interprocess/streams/bufferstream.hpp>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

#include "isowave/error.h"
#include "base/read_file.h"
#include "volume/mesh_repair.h"
#include "io/mesh/read_problems.h"

namespace isowave {
namespace {

using SoupPoint = CGAL::Simple_cartesian<double>::Point_3;
struct Soup {
    std::vector<SoupPoint> points;
    std::vector<std::vector<std::size_t>> polygons;
};

std::string lowerCase(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

// The word after SPACE= in a comment, as 3D Slicer writes it. E.g. "LPS".
std::string spaceOf(std::string_view head) {
    const std::size_t at = head.find("SPACE=");
    if (at == head.npos) return {};
    std::string space;
    for (const char c : head.substr(at + 6)) {
        if (!std::isalpha(static_cast<unsigned char>(c))) break;
        space += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    return space;
}

// ---- STL ----

constexpr std::size_t kStlHeader = 80, kStlStart = 84, kStlTriangle = 50;

std::uint32_t stlCount(std::string_view bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kStlHeader, 4);  // little-endian, as this machine
    return count;
}

// Many binary files start with "solid", and some count wrong: first the sum of bytes decides, then the words.
bool isBinaryStl(std::string_view bytes) {
    if (bytes.size() >= kStlStart &&
        bytes.size() == kStlStart + kStlTriangle * std::size_t(stlCount(bytes))) {
        return true;
    }
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    const bool solid = first != bytes.npos && lowerCase(std::string(bytes.substr(first, 5))) == "solid";
    return !solid || bytes.substr(0, 1024).find('\0') != bytes.npos;
}

void checkBinaryStl(const std::string& name, std::string_view bytes) {
    if (bytes.size() < kStlStart) {
        throw InputError(
            name, fmt::format("{} bytes are too few for an STL file, and it does not start with 'solid'",
                              bytes.size()));
    }
    const std::size_t promised = stlCount(bytes), held = (bytes.size() - kStlStart) / kStlTriangle;
    if (promised > held) {
        throw InputError(name,
                         fmt::format("the header promises {} triangles ({} bytes) but the file holds {} ({} "
                                     "bytes); it is truncated or no STL",
                                     promised, kStlStart + kStlTriangle * promised, held, bytes.size()));
    }
    if (promised < held) {
        throw InputError(name,
                         fmt::format("the header promises {} triangles but the file has room for {}; the "
                                     "count is wrong: export it again",
                                     promised, held));
    }
    // CGAL finds equal points with a std::map, which a NaN would derail.
    for (std::size_t t = 0; t < held; ++t) {
        float corner[9];
        std::memcpy(corner, bytes.data() + kStlStart + kStlTriangle * t + 12, sizeof corner);
        for (int i = 0; i < 9; ++i) {
            if (!std::isfinite(corner[i])) {
                throw InputError(name, fmt::format("triangle {}, corner {}: coordinate {} is not finite",
                                                   t + 1, i / 3 + 1, corner[i]));
            }
        }
    }
}

// Lower case, since CGAL knows no other; names of solids blanked, since they may hold keywords.
void normaliseAsciiStl(std::string& text) {
    text = lowerCase(std::move(text));
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::size_t word = std::min(text.find_first_not_of(" \t", begin), end);
        for (const std::string_view keyword : {"solid", "endsolid"}) {
            if (text.compare(word, keyword.size(), keyword) == 0) {
                std::fill(text.begin() + std::min(word + keyword.size(), end), text.begin() + end, ' ');
                break;
            }
        }
        begin = end + 1;
    }
}

// ---- OBJ ----

// One line a statement, with spaces only.
void joinObjLines(std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\t' || text[i] == '\r') text[i] = ' ';
        if (text[i] != '\\') continue;
        const std::size_t end = text.find_first_not_of(" \r", i + 1);
        if (end != text.npos && text[end] == '\n') std::fill(text.begin() + i, text.begin() + end + 1, ' ');
    }
}

// Points and faces alone: CGAL's reader gives up at 'l' (polyline) and other words that it does not know.
void keepObjSurface(std::string& text) {
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::size_t word = std::min(text.find_first_not_of(' ', begin), end);
        const std::string_view statement =
            std::string_view(text).substr(word, std::min(text.find(' ', word), end) - word);
        const bool needed = statement == "v" || statement == "f";
        if (!needed) std::fill(text.begin() + begin, text.begin() + end, ' ');
        begin = end + 1;
    }
}

// ---- all ----

// Runs one of CGAL's readers over bytes in memory, silently. False: refused.
template <class Reader>
bool readSoup(const std::string& bytes, Soup& soup, const Reader& reader) {
    boost::interprocess::ibufferstream stream(bytes.data(), bytes.size());
    try {
        return reader(stream, soup, CGAL::parameters::verbose(false));
    } catch (const std::exception&) {  // a failed CGAL check, bad_alloc for an absurd count
        return false;
    }
}

// Polygons that are no polygons, or refer to points that the file does not hold.
std::optional<std::string> soupProblem(const Soup& soup) {
    for (std::size_t f = 0; f < soup.polygons.size(); ++f) {
        if (soup.polygons[f].size() < 3) {
            return fmt::format("face {} has {} corners; at least 3 are needed", f + 1,
                               soup.polygons[f].size());
        }
        for (const std::size_t corner : soup.polygons[f]) {
            if (corner >= soup.points.size()) {
                return fmt::format("face {} refers to a point that is missing; the file has {} points", f + 1,
                                   soup.points.size());
            }
        }
    }
    return std::nullopt;
}

void checkPoints(const std::string& name, const std::vector<Point>& points, bool float32) {
    double largest = 0, extent = 0;
    for (int axis = 0; axis < 3; ++axis) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double x = points[i][axis];
            if (!std::isfinite(x)) {
                throw InputError(name, fmt::format("point {}: {} = {} is not finite", i + 1, "xyz"[axis], x));
            }
            if (std::abs(x) > 1e15) {
                throw InputError(name,
                                 fmt::format("point {}: {} = {:g}; beyond 1e15 it is no length: damaged, "
                                             "or written in another byte order",
                                             i + 1, "xyz"[axis], x));
            }
            low = std::min(low, x);
            high = std::max(high, x);
        }
        largest = std::max({largest, high, -low});
        extent = std::max(extent, high - low);
    }
    // Numbers in [2^e, 2^(e+1)) lie 2^(e-23) apart in float32, 2^(e-52) in float64.
    const double step = std::ldexp(1.0, std::ilogb(std::max(largest, 1e-300)) - (float32 ? 23 : 52));
    if (extent < kFewestSteps * step) {
        throw InputError(
            name, fmt::format("coordinates of {:g}, where {} has steps of {:.2g}, on a part {:g} across: "
                              "fewer than {} steps are left; move it to the origin and export again",
                              largest, float32 ? "float32" : "float64", step, extent, kFewestSteps));
    }
}

TriangleMesh toMesh(const Soup& soup) {
    TriangleMesh mesh;
    mesh.points.reserve(soup.points.size());
    for (const SoupPoint& p : soup.points) mesh.points.push_back({p.x(), p.y(), p.z()});
    for (const auto& polygon : soup.polygons) {
        for (std::size_t i = 2; i < polygon.size(); ++i) {
            mesh.triangles.push_back({static_cast<std::uint32_t>(polygon[0]),
                                      static_cast<std::uint32_t>(polygon[i - 1]),
                                      static_cast<std::uint32_t>(polygon[i])});
        }
    }
    return mesh;
}

// What one format needs.
struct Parsed {
    Soup soup;
    bool read = false;                   // what CGAL said
    std::optional<std::string> problem;  // looked for only where CGAL refused
    std::string format, space;
    bool float32 = false;
};

bool allFloat32(const std::vector<SoupPoint>& points) {
    const auto isFloat32 = [](double x) { return static_cast<double>(static_cast<float>(x)) == x; };
    return std::all_of(points.begin(), points.end(), [&](const SoupPoint& p) {
        return isFloat32(p.x()) && isFloat32(p.y()) && isFloat32(p.z());
    });
}

Parsed readStl(const std::string& name, std::string& bytes) {
    Parsed parsed;
    const bool binary = isBinaryStl(bytes);
    parsed.format = binary ? "binary STL" : "ASCII STL";
    parsed.space = spaceOf(std::string_view(bytes).substr(0, binary ? kStlHeader : bytes.find('\n')));
    if (binary) {
        checkBinaryStl(name, bytes);
        bytes.replace(0, 5, "bytes");  // CGAL takes "solid" for ASCII
    } else {
        normaliseAsciiStl(bytes);
    }
    parsed.read = readSoup(bytes, parsed.soup, [](std::istream& is, Soup& soup, const auto& parameters) {
        return CGAL::IO::read_STL(is, soup.points, soup.polygons, parameters);
    });
    if (!parsed.read && !binary) parsed.problem = asciiStlProblem(bytes);
    // Text may have more digits than float32, as a CAD system that computes in float64 writes them.
    parsed.float32 = binary || allFloat32(parsed.soup.points);
    return parsed;
}

Parsed readObj(std::string& bytes) {
    Parsed parsed;
    parsed.format = "OBJ";
    parsed.space = spaceOf(std::string_view(bytes).substr(0, 4096));
    joinObjLines(bytes);
    parsed.problem = objProblem(bytes);  // first: CGAL takes "f 0 1 2", and cuts a face at a tab
    if (parsed.problem) return parsed;
    keepObjSurface(bytes);
    parsed.read = readSoup(bytes, parsed.soup, [](std::istream& is, Soup& soup, const auto& parameters) {
        return CGAL::IO::read_OBJ(is, soup.points, soup.polygons, parameters);
    });
    return parsed;
}

Parsed readOff(const std::string& bytes) {
    Parsed parsed;
    parsed.format = "OFF";
    parsed.space = spaceOf(std::string_view(bytes).substr(0, 4096));
    parsed.problem = offProblem(bytes);  // first: CGAL makes room for whatever the header promises
    if (parsed.problem) return parsed;
    parsed.read = readSoup(bytes, parsed.soup, [](std::istream& is, Soup& soup, const auto& parameters) {
        return CGAL::IO::read_OFF(is, soup.points, soup.polygons, parameters);
    });
    return parsed;
}

Parsed readPly(const std::string& bytes) {
    Parsed parsed;
    const std::string_view header = std::string_view(bytes).substr(0, bytes.find("end_header"));
    parsed.format = header.find("format ascii") == header.npos ? "binary PLY" : "ASCII PLY";
    parsed.space = spaceOf(header);
    parsed.float32 = header.find(" double x") == header.npos && header.find(" float64 x") == header.npos;
    parsed.problem =
        plyProblem(bytes);  // first: CGAL's reader crashes on a property that belongs to no element
    if (parsed.problem) return parsed;
    parsed.read = readSoup(bytes, parsed.soup, [](std::istream& is, Soup& soup, const auto& parameters) {
        return CGAL::IO::read_PLY(is, soup.points, soup.polygons, parameters);
    });
    return parsed;
}

}  // namespace

bool isMeshPath(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    return extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".off";
}

TriangleMesh readMesh(const std::filesystem::path& path, MeshFileInfo* info, const Progress& progress) {
    const std::string name = path.string(), extension = lowerCase(path.extension().string());
    if (extension == ".gz") throw InputError(name, "is compressed by gzip; gunzip it first");
    if (!isMeshPath(path)) {
        throw InputError(name,
                         fmt::format("'{}' is no mesh format that is read: .stl .obj .ply .off", extension));
    }
    progress("reading", 0.0);
    std::string bytes = readFile(path, "a mesh file");
    progress("reading", 0.2);
    Parsed parsed = extension == ".stl"   ? readStl(name, bytes)
                    : extension == ".obj" ? readObj(bytes)
                    : extension == ".ply" ? readPly(bytes)
                                          : readOff(bytes);
    progress("reading", 0.8);
    if (parsed.problem) throw InputError(name, *parsed.problem);
    if (!parsed.read) {
        throw InputError(name, fmt::format("is not a valid {} file; export it again", parsed.format));
    }
    if (parsed.soup.polygons.empty()) throw InputError(name, "no triangles");
    if (const auto problem = soupProblem(parsed.soup)) throw InputError(name, *problem);
    TriangleMesh mesh = toMesh(parsed.soup);
    checkPoints(name, mesh.points, parsed.float32);
    if (info) {
        *info = {parsed.format, parsed.space, static_cast<std::int64_t>(parsed.soup.polygons.size())};
    }
    progress("reading", 1.0);
    return mesh;
}

}  // namespace isowave
