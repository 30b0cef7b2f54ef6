// How the tree hangs together (docs/design.md): arrows between folders point one way, file units make no
// loop, every source has a header of its own name, folders stay small, and CGAL's GPL packages stay where
// they may be. All of it is read off file names and includes. The checkers take names and includes as values,
// so that each is shown a bad tree and has to see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Complaints = std::vector<std::string>;

struct Include {
    std::string name;  // as between the quotes or brackets
    bool quoted;
};

// path: relative to the root, but public headers without their include/: "isowave/error.h", as it is
// included.
struct File {
    std::string path;
    std::vector<Include> includes;
};

bool startsWith(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

// ---- the parts and their arrows

// What each part may include, besides itself and the public headers. A part is a folder with all below it
// that is no part of its own.
std::map<std::string, std::set<std::string>> makeArrows() {
    std::map<std::string, std::set<std::string>> arrows = {{"isowave", {}}, {"base", {}}};
    const std::set<std::string> io = {"io/image", "io/mesh", "io/picture", "io/vector", "io/vtk"};
    const auto add = [&](const std::string& part, std::set<std::string> to) {
        to.insert("base");
        arrows[part] = std::move(to);
    };
    for (const std::string& format : io) add(format, {});
    add("io/image", {"io/picture", "io/vtk"});  // a folder of PNG slices; .vti
    add("io/mesh", {"io/vtk"});                 // .vtp
    // Each of these may use all that the ones before it may.
    std::set<std::string> below = {"io/image", "io/mesh", "io/vtk", "wavelets/interval", "compress/coder"};
    add("compress/coder", {});
    add("wavelets/interval", {});
    add("volume", {"io/image", "io/mesh"});
    for (const std::string part : {"volume", "compress", "wavelets", "polygonize", "hold"}) {
        if (part != "volume") add(part, below);
        below.insert(part);
    }
    add("lod",
        below);  // declares what it needs of simplify/ itself (lod/simplifier.h), so that it does without the GPL
    below.insert("lod");
    add("simplify", below);

    add("curves2d", {"wavelets/interval", "io/picture", "io/vector"});
    const std::set<std::string> kinds = {"subdivision/curves", "subdivision/lattice", "subdivision/meshes"};
    add("subdivision/filters", {});
    std::set<std::string> subdivision = {"subdivision/filters"};
    for (const std::string& kind : kinds) {
        add(kind, {"subdivision/filters", "io/mesh", "io/picture", "io/vector"});
        subdivision.insert(kind);
    }
    add("subdivision", subdivision);      // the files at the top: the schemes of all four, by name
    add("view", {"volume", "curves2d"});  // exact distances to a surface and to curves
    std::set<std::string> all;
    for (const auto& [part, to] : arrows) all.insert(part);
    arrows["tools"] = all;
    all.insert("tools");
    arrows["python"] = all;
    return arrows;
}
const std::map<std::string, std::set<std::string>> kArrows = makeArrows();

// Parts that know no grid. Of the public headers openvdb.h alone does.
const std::set<std::string> kWithoutGrids = {"isowave",
                                             "base",
                                             "io/image",
                                             "io/mesh",
                                             "io/picture",
                                             "io/vector",
                                             "io/vtk",
                                             "wavelets/interval",
                                             "compress/coder",
                                             "curves2d",
                                             "subdivision",
                                             "subdivision/filters",
                                             "subdivision/curves",
                                             "subdivision/lattice",
                                             "subdivision/meshes"};
constexpr const char* kPublicGrids = "isowave/openvdb.h";

// The part that a path like "wavelets/interval/interval.h" belongs to; "" for none.
std::string partOf(const std::string& path) {
    std::string best;
    for (const auto& [part, to] : kArrows)
        if (startsWith(path, part + "/") && part.size() > best.size()) best = part;
    return best;
}

// "" or what is wrong with `path` including `include`.
std::string arrowComplaint(const std::string& path, const Include& include) {
    const std::string from = partOf(path), to = partOf(include.name);
    if (include.quoted && to.empty())
        return path + " includes \"" + include.name + "\"; write it as \"folder/file.h\"";
    if (startsWith(include.name, "openvdb/") && kWithoutGrids.count(from) && path != kPublicGrids)
        return path + " includes <" + include.name + ">, but " + from + " knows no grid";
    if (to.empty() || to == from || to == "isowave" || kArrows.at(from).count(to)) return "";
    return path + " includes " + include.name + ", an arrow from " + from + " to " + to +
           " that the design has not";
}

// ---- licences

bool isGpl(const std::string& header) {
    static const std::vector<std::string> packages = {"CGAL/Polygon_mesh_processing", "CGAL/AABB_",
                                                      "CGAL/Surface_mesh_simplification", "CGAL/alpha_wrap",
                                                      "CGAL/box_intersection_d"};
    for (const std::string& package : packages)
        if (startsWith(header, package)) return true;
    // Any other header of CGAL says so itself.
    if (!startsWith(header, "CGAL/")) return false;
    const fs::path file = fs::path("/usr/include") / header;
    std::ifstream stream(file);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    return text.find("SPDX-License-Identifier: GPL") != std::string::npos;
}

std::string licenceComplaint(const std::string& path, const Include& include) {
    if (startsWith(path, "simplify/") || !isGpl(include.name)) return "";
    return path + " includes <" + include.name + ">, which is under the GPL; only simplify/ may";
}

// ---- file units

// A unit is x.h and x.cpp. A public header is a unit of its own: it is the type that others are written
// against, and what it declares may be defined in several folders.
std::string unitOf(const std::string& path) { return path.substr(0, path.rfind('.')); }

class Units {
  public:
    explicit Units(const std::vector<File>& files) {
        for (const File& file : files) after_[unitOf(file.path)];
        for (const File& file : files)
            for (const Include& include : file.includes) {
                const std::string from = unitOf(file.path), to = unitOf(include.name);
                if (from != to && after_.count(to)) after_[from].insert(to);
            }
    }
    // Each as "a -> b -> a".
    Complaints loops() {
        for (const auto& [unit, to] : after_) visit(unit);
        return loops_;
    }

  private:
    // invariant: way_ leads from where the search began to the unit that is visited.
    void visit(const std::string& unit) {
        if (const auto on = std::find(way_.begin(), way_.end(), unit); on != way_.end()) {
            std::string loop;
            for (auto at = on; at != way_.end(); ++at) loop += *at + " -> ";
            loops_.push_back(loop + unit);
            return;
        }
        if (!seen_.insert(unit).second) return;
        way_.push_back(unit);
        for (const std::string& next : after_[unit]) visit(next);
        way_.pop_back();
    }

    std::map<std::string, std::set<std::string>> after_;
    std::set<std::string> seen_;
    std::vector<std::string> way_;
    Complaints loops_;
};

// Sources without a header of their own name: what they define is declared in a header that lists many of a
// kind.
struct Registry {
    const char* start;  // of their paths
    const char* reason;
};
constexpr const char* kSubcommand = "a subcommand, declared with all others in tools/commands.h";
constexpr const char* kSimplifier =
    "one of two that define lod/simplifier.h: with CGAL's GPL packages, and without";
constexpr Registry kRegistries[] = {
    {"tools/main.cpp", "the program: nobody calls it"},
    {"python/native/module.cpp", "the module: Python calls it"},
    {"tools/help_command.cpp", kSubcommand},
    {"tools/curves/curves.cpp", kSubcommand},
    {"tools/solids/analyse.cpp", kSubcommand},
    {"tools/solids/pack.cpp", kSubcommand},
    {"tools/solids/edit.cpp", kSubcommand},
    {"tools/solids/check.cpp", kSubcommand},
    {"tools/solids/compare.cpp", kSubcommand},
    {"tools/solids/field.cpp", kSubcommand},
    {"tools/solids/info.cpp", kSubcommand},
    {"tools/solids/lod.cpp", kSubcommand},
    {"tools/solids/mesh.cpp", kSubcommand},
    {"tools/subdivision/curve_levels.cpp", kSubcommand},
    {"tools/subdivision/filters.cpp", kSubcommand},
    {"tools/subdivision/rebuild.cpp", kSubcommand},
    {"tools/subdivision/relief.cpp", kSubcommand},
    {"tools/subdivision/reverse.cpp", kSubcommand},
    {"tools/subdivision/subdivide.cpp", kSubcommand},
    {"tools/view/view.cpp", kSubcommand},
    {"simplify/simplifier.cpp", kSimplifier},
    {"lod/without_simplify/simplifier.cpp", kSimplifier},
};

bool isRegistered(const std::string& path) {
    return std::any_of(std::begin(kRegistries), std::end(kRegistries),
                       [&](const Registry& registry) { return startsWith(path, registry.start); });
}

Complaints headerComplaints(const std::vector<File>& files) {
    std::set<std::string> paths;
    for (const File& file : files) paths.insert(file.path);
    Complaints complaints;
    for (const File& file : files) {
        if (!file.path.ends_with(".cpp") || isRegistered(file.path)) continue;
        const std::string header = unitOf(file.path) + ".h";
        const std::string publicHeader = "isowave" + header.substr(header.rfind('/'));
        if (paths.count(header) == 0 && paths.count(publicHeader) == 0)
            complaints.push_back(file.path + " has neither " + header + " nor " + publicHeader);
    }
    return complaints;
}

constexpr int kMostSources = 15;

Complaints sizeComplaints(const std::vector<File>& files) {
    std::map<std::string, int> sources;
    for (const File& file : files) sources[fs::path(file.path).parent_path()] += file.path.ends_with(".cpp");
    Complaints complaints;
    for (const auto& [folder, count] : sources)
        if (count > kMostSources)
            complaints.push_back(folder + " has " + std::to_string(count) + " sources; split it");
    return complaints;
}

// ---- the tree itself

std::vector<Include> includesIn(const std::string& source) {
    static const std::regex line(R"re((^|\n)[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"])re");
    std::vector<Include> found;
    for (std::sregex_iterator it(source.begin(), source.end(), line), end; it != end; ++it)
        found.push_back({(*it)[3], (*it)[2] == "\""});
    return found;
}

std::vector<File> readTree() {
    std::vector<File> files;
    const fs::path root = ISOWAVE_SOURCE_DIR;
    std::set<std::string> tops;
    for (const auto& [part, to] : kArrows) tops.insert(part.substr(0, part.find('/')));
    for (const std::string& top : tops) {
        const fs::path from = top == "isowave" ? root / "include" : root;
        if (!fs::exists(from / top)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(from / top)) {
            const std::string extension = entry.path().extension();
            if (extension != ".h" && extension != ".cpp") continue;
            std::ifstream stream(entry.path());
            const std::string text(std::istreambuf_iterator<char>(stream), {});
            files.push_back({fs::relative(entry.path(), from).string(), includesIn(text)});
        }
    }
    return files;
}

template <class Complain>
Complaints complaintsAboutIncludes(const Complain& complain) {
    Complaints complaints;
    for (const File& file : readTree())
        for (const Include& include : file.includes)
            if (std::string what = complain(file.path, include); !what.empty())
                complaints.push_back(std::move(what));
    return complaints;
}

TEST(Layout, NoArrowBetweenFoldersPointsBack) {
    EXPECT_THAT(complaintsAboutIncludes(arrowComplaint), IsEmpty());
}

TEST(Layout, GplPackagesStayInSimplify) { EXPECT_THAT(complaintsAboutIncludes(licenceComplaint), IsEmpty()); }

TEST(Layout, NoFileUnitsIncludeEachOtherInALoop) { EXPECT_THAT(Units(readTree()).loops(), IsEmpty()); }

TEST(Layout, EverySourceHasAHeaderOfItsName) { EXPECT_THAT(headerComplaints(readTree()), IsEmpty()); }

TEST(Layout, NoFolderHoldsMoreThanFifteenSources) { EXPECT_THAT(sizeComplaints(readTree()), IsEmpty()); }

TEST(Layout, TheTreeIsReallyRead) {
    std::set<std::string> arrows;
    for (const File& file : readTree())
        for (const Include& include : file.includes)
            arrows.insert(partOf(file.path) + " -> " + partOf(include.name));
    for (const char* arrow : {"wavelets -> volume", "polygonize -> volume", "io/image -> isowave",
                              "isowave -> isowave", "subdivision/meshes -> subdivision/filters"})
        EXPECT_TRUE(arrows.count(arrow)) << arrow;
}

// ---- the checkers can fail

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

TEST(Layout, TheArrowCheckerCanFail) {
    const auto wrong = [](const char* path, const char* included, const char* word) {
        EXPECT_THAT(arrowComplaint(path, {included, true}), HasSubstr(word));
    };
    wrong("volume/fit.cpp", "wavelets/pyramid.h", "from volume to wavelets");
    wrong("base/text.h", "volume/field.h", "from base to volume");
    wrong("isowave/error.h", "base/text.h", "from isowave to base");
    wrong("io/image/source.h", "io/mesh/read.h", "from io/image to io/mesh");
    wrong("wavelets/pyramid.cpp", "polygonize/polygonize.h", "polygonize");
    wrong("wavelets/interval/interval.cpp", "wavelets/direction.h", "from wavelets/interval to wavelets");
    wrong("polygonize/topology.h", "simplify/distance.h", "from polygonize to simplify");
    wrong("polygonize/refit.cpp", "hold/solid_limits.h", "from polygonize to hold");
    wrong("hold/solid_limits.cpp", "lod/steps.h", "from hold to lod");
    wrong("lod/ladder.cpp", "simplify/collapse.h", "from lod to simplify");
    wrong("lod/ladder.h", "tools/commands.h", "from lod to tools");
    wrong("tools/command.h", "python/native/watch.h", "from tools to python");
    wrong("lod/ladder.h", "curves2d/rows.h", "from lod to curves2d");
    wrong("curves2d/rows.h", "wavelets/pyramid.h", "from curves2d to wavelets");
    wrong("curves2d/rows.h", "io/image/source.h", "from curves2d to io/image");
    wrong("subdivision/filters/mask.h", "wavelets/interval/interval.h", "subdivision/filters");
    wrong("subdivision/filters/mask.h", "subdivision/curves/curve.h", "to subdivision/curves");
    wrong("subdivision/curves/curve.h", "subdivision/meshes/mesh.h", "to subdivision/meshes");
    wrong("subdivision/meshes/mesh.h", "subdivision/catalogue.h", "from subdivision/meshes to subdivision");
    wrong("view/page.h", "lod/ladder.h", "from view to lod");
    wrong("lod/ladder.h", "view/page.h", "from lod to view");
    wrong("volume/fit.cpp", "fit.h", "folder/file.h");
    EXPECT_THAT(arrowComplaint("wavelets/interval/interval.h", {"openvdb/openvdb.h", false}),
                HasSubstr("no grid"));
    EXPECT_THAT(arrowComplaint("isowave/field.h", {"openvdb/openvdb.h", false}), HasSubstr("no grid"));
}

TEST(Layout, TheArrowCheckerAllowsWhatTheDesignHas) {
    const auto right = [](const char* path, const char* included) {
        EXPECT_EQ(arrowComplaint(path, {included, true}), "");
    };
    right("base/text.h", "isowave/error.h");
    right("isowave/image.h", "isowave/progress.h");
    right("curves2d/rows.h", "wavelets/interval/interval.h");
    right("wavelets/direction.cpp", "wavelets/interval/interval.h");
    right("subdivision/catalogue.h", "subdivision/meshes/mesh.h");
    right("subdivision/meshes/mesh.cpp", "io/mesh/read.h");
    right("simplify/collapse.cpp", "volume/field.h");
    right("lod/ladder.cpp", "polygonize/polygonize.h");
    right("lod/level_mesher.cpp", "hold/solid_limits.h");
    right("hold/solid_limits.cpp", "polygonize/specks.h");
    right("simplify/simplifier.cpp", "lod/simplifier.h");
    right("tools/solids/lod.cpp", "simplify/distance.h");
    right("python/native/options.cpp", "tools/command.h");
    EXPECT_EQ(arrowComplaint(kPublicGrids, {"openvdb/openvdb.h", false}), "");
}

TEST(Layout, TheLicenceCheckerCanFail) {
    EXPECT_NE(licenceComplaint("volume/repair.cpp", {"CGAL/Polygon_mesh_processing/orientation.h", false}),
              "");
    EXPECT_NE(licenceComplaint("tools/solids/check.cpp", {"CGAL/AABB_tree.h", false}), "");
    EXPECT_NE(licenceComplaint("volume/a.cpp", {"CGAL/Search_traits_3.h", false}),
              "");  // by the header's own words
    EXPECT_EQ(licenceComplaint("simplify/distance.cpp", {"CGAL/AABB_tree.h", false}), "");
    EXPECT_EQ(licenceComplaint("io/mesh/read.cpp", {"CGAL/Simple_cartesian.h", false}), "");
}

TEST(Layout, TheLoopFinderCanFail) {
    // b.cpp defines what a.h declares: no header includes the other, yet neither unit can be had without the
    // other.
    const std::vector<File> loop = {{"volume/a.h", {}},
                                    {"volume/a.cpp", {{"volume/a.h", true}, {"volume/b.h", true}}},
                                    {"volume/b.h", {}},
                                    {"volume/b.cpp", {{"volume/b.h", true}, {"volume/c.h", true}}},
                                    {"volume/c.h", {{"volume/a.h", true}, {"vector", false}}}};
    EXPECT_THAT(Units(loop).loops(), ElementsAre("volume/a -> volume/b -> volume/c -> volume/a"));
    EXPECT_THAT(Units({loop.begin(), loop.end() - 1}).loops(), IsEmpty());
}

TEST(Layout, TheHeaderCheckerCanFail) {
    EXPECT_THAT(headerComplaints({{"volume/a.cpp", {}}, {"volume/b.h", {}}}),
                ElementsAre(HasSubstr("volume/a.cpp has neither volume/a.h nor isowave/a.h")));
    EXPECT_THAT(headerComplaints({{"volume/a.cpp", {}}, {"volume/a.h", {}}}), IsEmpty());
    EXPECT_THAT(headerComplaints({{"io/image/image.cpp", {}}, {"isowave/image.h", {}}}), IsEmpty());
    EXPECT_THAT(headerComplaints({{"tools/solids/lod.cpp", {}}}), IsEmpty());
    EXPECT_THAT(headerComplaints({{"tools/input.cpp", {}}}), SizeIs(1));
}

TEST(Layout, TheSizeCheckerCanFail) {
    std::vector<File> files;
    for (int i = 0; i < kMostSources; ++i) files.push_back({"volume/" + std::to_string(i) + ".cpp", {}});
    files.push_back({"volume/header.h", {}});
    files.push_back({"volume/deeper/one_more.cpp", {}});
    EXPECT_THAT(sizeComplaints(files), IsEmpty());
    files.push_back({"volume/one_more.cpp", {}});
    EXPECT_THAT(sizeComplaints(files), Contains(HasSubstr("volume has 16 sources")));
}

}  // namespace
}  // namespace isowave
