// The promises of base/cad_model.h.
#include "base/cad_model.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/temp_folder.h"

namespace isowave {
namespace {

using test::TempFolder;
using testing::HasSubstr;

std::string textOf(const TempFolder& folder, const char* name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return cadModelText(folder / name).value_or("");
}

std::string igesLine() { return std::string(72, ' ') + "S      1\n" + std::string(72, ' ') + "G      1\n"; }

TEST(CadModel, IsToldByItsFirstBytesWhateverItsName) {
    const TempFolder folder;
    const std::string gmsh =
        "gmsh " + (folder / "a.step").string() + " -2 -clcurv 12 -o " + (folder / "a.stl").string();
    EXPECT_EQ(textOf(folder, "a.step", "ISO-10303-21;\nHEADER;\n"),
              "is a CAD model in STEP; make a mesh of it: " + gmsh);
    EXPECT_EQ(textOf(folder, "a.stl", "\xEF\xBB\xBF\r\nISO-10303-21;\n"),
              "is a CAD model in STEP; name it " + (folder / "a.step").string() +
                  " and make a mesh of it: " + gmsh);
    EXPECT_THAT(textOf(folder, "a.igs", igesLine()), HasSubstr("in IGES; make a mesh of it: gmsh"));
    EXPECT_THAT(textOf(folder, "a.dat", igesLine()), HasSubstr("in IGES; name it"));
    EXPECT_THAT(textOf(folder, "a.brep", "\nDBRep_DrawableShape\n"),
                HasSubstr("BREP; make a mesh of it: gmsh"));
    const std::string zip = std::string("PK\3\4") + std::string(26, '\0') + "Document.xml";
    EXPECT_THAT(textOf(folder, "a.FCStd", zip), HasSubstr("is a FreeCAD document; export its part"));
}

TEST(CadModel, IsToldByItsNameWhereTheBytesSayNothing) {
    const TempFolder folder;
    EXPECT_THAT(textOf(folder, "a.STP", "?"), HasSubstr("is a CAD model in STEP"));
    EXPECT_THAT(cadModelText(folder / "missing.iges").value_or(""), HasSubstr("is a CAD model in IGES"));
    EXPECT_THAT(textOf(folder, "my part.step", ""), HasSubstr("my part.stl'"));
}

TEST(CadModel, IsNoOtherFile) {
    const TempFolder folder;
    EXPECT_EQ(textOf(folder, "a.stl", "solid part\n"), "");
    EXPECT_EQ(textOf(folder, "a", ""), "");
    EXPECT_EQ(textOf(folder, "a.zip", "PK\3\4"), "");
    EXPECT_EQ(textOf(folder, "a.zip", std::string("PK\3\4") + std::string(26, '\0') + "other.xml"), "");
    EXPECT_EQ(textOf(folder, "a.txt", std::string(72, ' ') + "S      2\n"), "");
    EXPECT_EQ(cadModelText(folder.path()), std::nullopt);
}

}  // namespace
}  // namespace isowave
