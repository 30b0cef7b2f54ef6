// Arrows between folders point one way (docs/design.md), and CGAL's GPL packages stay where they may be. Both
// are read off the includes. A checker takes (file, includes), so a bad file can be made up to prove that it
// fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace isowave {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

struct Include {
    std::string name;  // as between the quotes or brackets
    bool quoted;
};

// What each folder may include, besides itself. `interval` stands for wavelets/interval*: the algebra without
// grids.
const std::map<std::string, std::set<std::string>> kArrows = {
    {"base", {}},
    {"volume", {"base"}},
    {"interval", {"base"}},
    {"wavelets", {"interval", "volume", "base"}},
    {"polygonize", {"wavelets", "interval", "volume", "base"}},
    {"curves2d", {"interval", "base"}},
    {"subdivision", {"base"}},
    {"tools", {"polygonize", "curves2d", "subdivision", "wavelets", "interval", "volume", "base"}},
};

// Parts that know no grid.
const std::set<std::string> kWithoutGrids = {"base", "interval", "curves2d", "subdivision"};

bool startsWith(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

// The part of the project that a path like "wavelets/interval/interval.h" belongs to; "" for none.
std::string partOf(const std::string& path) {
    const std::string folder = path.substr(0, path.find('/'));
    if (folder == "wavelets" && startsWith(path, "wavelets/interval")) return "interval";
    return kArrows.count(folder) ? folder : "";
}

std::string readText(const fs::path& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<Include> includesIn(const std::string& source) {
    static const std::regex line(R"re((^|\n)[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"])re");
    std::vector<Include> found;
    for (std::sregex_iterator it(source.begin(), source.end(), line), end; it != end; ++it)
        found.push_back({(*it)[3], (*it)[2] == "\""});
    return found;
}

// "" or what is wrong with `path` (relative to the root) including `include`.
std::string arrowComplaint(const std::string& path, const Include& include) {
    const std::string from = partOf(path), to = partOf(include.name);
    if (include.quoted && to.empty())
        return path + " includes \"" + include.name + "\"; write it as \"folder/file.h\"";
    if (startsWith(include.name, "openvdb/") && kWithoutGrids.count(from))
        return path + " includes <" + include.name + ">, but " + from + " knows no grid";
    if (to.empty() || to == from || kArrows.at(from).count(to)) return "";
    return path + " includes " + include.name + ", an arrow from " + from + " to " + to +
           " that the design has not";
}

bool mayUseGpl(const std::string& path) {
    return startsWith(path, "polygonize/measure") || startsWith(path, "polygonize/collapse");
}

bool isGpl(const std::string& header) {
    static const std::vector<std::string> packages = {"CGAL/Polygon_mesh_processing", "CGAL/AABB_",
                                                      "CGAL/Surface_mesh_simplification", "CGAL/alpha_wrap",
                                                      "CGAL/box_intersection_d"};
    for (const std::string& package : packages)
        if (startsWith(header, package)) return true;
    // Any other header of CGAL says so itself.
    if (!startsWith(header, "CGAL/")) return false;
    const fs::path file = fs::path("/usr/include") / header;
    return fs::exists(file) && readText(file).find("SPDX-License-Identifier: GPL") != std::string::npos;
}

std::string licenceComplaint(const std::string& path, const Include& include) {
    if (mayUseGpl(path) || !isGpl(include.name)) return "";
    return path + " includes <" + include.name + ">, which is under the GPL; only isowave_measure may";
}

template <class Complaint>
std::vector<std::string> complaintsAboutTheTree(const Complaint& complaint) {
    std::vector<std::string> complaints;
    const fs::path root = ISOWAVE_SOURCE_DIR;
    for (const auto& [part, arrows] : kArrows) {
        if (!fs::exists(root / part)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
            const std::string extension = entry.path().extension();
            if (extension != ".h" && extension != ".cpp") continue;
            for (const Include& include : includesIn(readText(entry.path()))) {
                const std::string what = complaint(fs::relative(entry.path(), root).string(), include);
                if (!what.empty()) complaints.push_back(what);
            }
        }
    }
    return complaints;
}

TEST(Layout, NoArrowBetweenFoldersPointsBack) {
    EXPECT_THAT(complaintsAboutTheTree(arrowComplaint), IsEmpty());
}

TEST(Layout, GplPackagesStayInMeasureAndCollapse) {
    EXPECT_THAT(complaintsAboutTheTree(licenceComplaint), IsEmpty());
}

TEST(Layout, TheTreeIsReallyRead) {
    std::set<std::string> parts;
    complaintsAboutTheTree([&](const std::string& path, const Include& include) {
        parts.insert(partOf(path) + "->" + partOf(include.name));
        return std::string();
    });
    EXPECT_TRUE(parts.count("wavelets->volume"));
    EXPECT_TRUE(parts.count("polygonize->base"));
}

TEST(Layout, FindsIncludesHoweverTheyAreWritten) {
    const std::vector<Include> found = includesIn(
        "#include \"isowave/error.h\"\n  #  include <vector>\n// #include <no>\n"
        "int x;\n#include\t<CGAL/AABB_tree.h> // why\n");
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].name, "isowave/error.h");
    EXPECT_TRUE(found[0].quoted);
    EXPECT_EQ(found[1].name, "vector");
    EXPECT_EQ(found[2].name, "CGAL/AABB_tree.h");
}

TEST(Layout, TheCheckerCanFail) {
    EXPECT_THAT(arrowComplaint("volume/fit.cpp", {"wavelets/pyramid.h", true}),
                HasSubstr("from volume to wavelets"));
    EXPECT_THAT(arrowComplaint("isowave/error.h", {"volume/field.h", true}), HasSubstr("from base to volume"));
    EXPECT_THAT(arrowComplaint("wavelets/pyramid.cpp", {"polygonize/polygonize.h", true}),
                HasSubstr("polygonize"));
    EXPECT_THAT(arrowComplaint("wavelets/interval.cpp", {"wavelets/direction.h", true}),
                HasSubstr("interval"));
    EXPECT_THAT(arrowComplaint("wavelets/interval/interval.h", {"openvdb/openvdb.h", false}), HasSubstr("no grid"));
    EXPECT_THAT(arrowComplaint("curves2d/rows.h", {"wavelets/pyramid.h", true}), HasSubstr("curves2d"));
    EXPECT_THAT(arrowComplaint("subdivision/mask.h", {"wavelets/interval/interval.h", true}),
                HasSubstr("subdivision"));
    EXPECT_THAT(arrowComplaint("polygonize/topology.h", {"tools/commands.h", true}), HasSubstr("tools"));
    EXPECT_THAT(arrowComplaint("volume/fit.cpp", {"fit.h", true}), HasSubstr("folder/file.h"));

    EXPECT_EQ(arrowComplaint("curves2d/rows.h", {"wavelets/interval/interval.h", true}), "");
    EXPECT_EQ(arrowComplaint("wavelets/direction.cpp", {"wavelets/interval/interval.h", true}), "");
    EXPECT_EQ(arrowComplaint("tools/cmd_lod.cpp", {"simplify/measure.h", true}), "");
}

TEST(Layout, TheLicenceCheckerCanFail) {
    EXPECT_NE(licenceComplaint("volume/repair.cpp", {"CGAL/Polygon_mesh_processing/orientation.h", false}),
              "");
    EXPECT_NE(licenceComplaint("tools/cmd_check.cpp", {"CGAL/AABB_tree.h", false}), "");
    EXPECT_NE(licenceComplaint("volume/a.cpp", {"CGAL/Search_traits_3.h", false}),
              "");  // by the header's own words
    EXPECT_EQ(licenceComplaint("polygonize/measure_distance.cpp", {"CGAL/AABB_tree.h", false}), "");
    EXPECT_EQ(licenceComplaint("volume/mesh_input.cpp", {"CGAL/Simple_cartesian.h", false}), "");
}

}  // namespace
}  // namespace isowave
