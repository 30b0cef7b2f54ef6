#include "io/image/formats/foreign.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <vector>

#include "base/cad_model.h"
#include "base/text.h"
#include "base/value_type.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// ---- formats whose voxels lie in the file as they are, behind a header

// What has to be typed to read a file without its header.
struct RawAdvice {
    std::array<std::int64_t, 3> size{};
    std::string type;
    std::int64_t headerBytes = 0;
    bool bigEndian = false;
    std::optional<std::array<double, 3>> spacing;

    std::string text() const {
        std::string result = fmt::format("give --size {}x{}x{} --type {} --header-bytes {}", size[0], size[1],
                                         size[2], type, headerBytes);
        if (bigEndian) result += " --endian big";
        if (spacing)
            result +=
                fmt::format(" --spacing {:.6g}x{:.6g}x{:.6g}", (*spacing)[0], (*spacing)[1], (*spacing)[2]);
        return result + (spacing ? "" : " --spacing");
    }
    bool sensible() const {
        return !type.empty() && headerBytes >= 0 &&
               std::all_of(size.begin(), size.end(), [](std::int64_t n) { return n > 0; });
    }
};

std::string start(const fs::path& path, std::size_t count) {
    std::string text(count, '\0');
    std::ifstream(path, std::ios::binary).read(text.data(), static_cast<std::streamsize>(count));
    return text;
}

// What stands behind `key` in a header of text, up to one of `ends`.
std::string behind(const std::string& text, const std::string& key, const char* ends) {
    const std::size_t found = text.find(key);
    if (found == std::string::npos) return "";
    const std::size_t begin = found + key.size(), end = text.find_first_of(ends, begin);
    return end == std::string::npos ? "" : text.substr(begin, end - begin);
}

// "#INRIMAGE-4#{", lines such as XDIM=40, TYPE=unsigned fixed, PIXSIZE=16 bits, CPU=decm; 256 bytes or a multiple.
std::optional<RawAdvice> inrAdvice(const fs::path& path) {
    const std::string bytes = start(path, 4096);
    const std::size_t end = bytes.find("##}");
    if (bytes.compare(0, 12, "#INRIMAGE-4#") != 0 || end == std::string::npos) return std::nullopt;
    const auto value = [&](const char* key) { return behind(bytes, std::string("\n") + key + "=", "\n"); };
    RawAdvice advice;
    advice.headerBytes = (static_cast<std::int64_t>(end) + 3 + 255) / 256 * 256;
    std::array<double, 3> spacing{1, 1, 1};
    for (std::size_t a = 0; a < 3; ++a) {
        advice.size[a] = std::atoll(value(a == 0 ? "XDIM" : a == 1 ? "YDIM" : "ZDIM").c_str());
        if (const double s = std::atof(value(a == 0 ? "VX" : a == 1 ? "VY" : "VZ").c_str()); s > 0)
            spacing[a] = s;
    }
    advice.spacing = spacing;
    const std::string type = value("TYPE"), bits = std::to_string(std::atoi(value("PIXSIZE").c_str()));
    const std::string name = (type == "float"                ? "float"
                              : type.starts_with("unsigned") ? "uint"
                                                             : "int") +
                             bits;
    if (valueTypeOf(name)) advice.type = name;
    const std::string cpu = value("CPU");
    advice.bigEndian = cpu == "sun" || cpu == "sgi";
    return advice;
}

// ---- formats that a program has to convert

struct Foreign {
    const char* names;  // extensions, a blank before and behind each
    const char* what;
    const char* remedy;  // {0}: the file; {1}: without its extension
};

constexpr Foreign kForeign[] = {
    {" .amf .gltf .fbx .dae .3ds .x3d .blend .ifc .lwo .dxf ", "a 3D model of a format that is not read",
     "convert it: assimp export {0} {1}.stl"},
    {" .wrl .vrml .u3d .ctm ", "a 3D model of a format that is not read",
     "convert it: meshlabserver -i {0} -o {1}.ply"},
    {" .usd .usda .usdc .usdz .3dm .skp .max .c4d ", "a 3D scene",
     "save it as STL in the program that made it"},
    {" .sldprt .sldasm .ipt .iam .prt .f3d .x_t .x_b .dwg .catpart .scad ", "a CAD model",
     "save it as STL in the program that made it"},
    {" .vtu .msh .inp .bdf .med .xdmf .exo .cgns ", "a mesh of a simulation",
     "take its surface as a mesh of triangles: meshio convert {0} {1}.ply"},
    {" .gii .gifti .pial .white .inflated ", "a surface of FreeSurfer or GIFTI",
     "convert it: mris_convert {0} {1}.stl"},
    {" .las .laz .e57 .pcd .pts .ptx .xyz ", "a cloud of points, without a surface",
     "make a closed mesh of it first, for example by Poisson reconstruction in MeshLab"},
    {" .vtk .vts .vtr ", "a file of VTK", "save it as .mha or .ply in ParaView or 3D Slicer"},
    {" .mnc .mnc2 ", "a MINC image", "convert it: mnc2nii {0} {1}.nii"},
    {" .brik .head ", "an AFNI image", "convert it: 3dAFNItoNIFTI -prefix {1}.nii {0}"},
    {" .par .v ", "a scan in a vendor's format", "convert it: dcm2niix {0}"},
    {" .h5 .hdf5 .hdf .he5 .nwb .n5 ", "an HDF5 file",
     "take one array out of it: h5dump -d /NAME -b LE -o {1}.raw {0}, then give --size, --type and "
     "--spacing"},
    {" .am .amiramesh .hx ", "an Amira file", "save it as NRRD in Amira, or as STL if it is a surface"},
    {" .czi .lif .nd2 .ims .oib .oif .lsm .vsi .svs .ndpi .scn .dv ", "a microscope's image",
     "convert it: bfconvert {0} {1}.ome.tif"},
    {" .mat .npz .pkl .pt .rds ", "an archive of arrays",
     "save one array as NRRD, for example by pynrrd's nrrd.write()"},
    {" .inr ", "an INRIMAGE", "convert it to NIfTI or MetaImage"},
    {" .iwc ", "a pyramid of curves", "draw its levels: isowave curves {0} -o {1}"},
    {" .zip ", "an archive", "unpack it first: unzip {0} -d {1}"},
    {" .tar .tgz .tbz .txz ", "an archive", "unpack it first: tar xf {0}"},
    {" .7z .rar ", "an archive", "unpack it first: 7z x {0}"},
    {" .bz2 ", "compressed", "unpack it first: bunzip2 {0}"},
    {" .xz ", "compressed", "unpack it first: unxz {0}"},
    {" .zst ", "compressed", "unpack it first: unzstd {0}"},
    {" .raw .bin .dat .vol .img .data ", "headerless voxels, or a format that is not known",
     "if they are voxels as they are, give --size, --type and --spacing"},
    {" .gif .webp .jp2 .j2k .pgm .ppm .pbm .pnm ", "a picture",
     "give a volume, such as a folder of PNG or TIFF slices"},
};

const Foreign* foreignOf(const std::string& extension) {
    for (const Foreign& f : kForeign)
        if (!extension.empty() &&
            std::string_view(f.names).find(" " + extension + " ") != std::string_view::npos)
            return &f;
    return nullptr;
}

std::optional<std::string> inrText(const fs::path& path) {
    const std::optional<RawAdvice> advice = inrAdvice(path);
    if (!advice || !advice->sensible()) return std::nullopt;
    return "is an INRIMAGE; " + advice->text();
}

// A legacy file of VTK is an image or a mesh.
std::optional<std::string> vtkText(const fs::path& path) {
    const std::string head = start(path, 1024), name = inShell(path.string());
    if (!head.starts_with("# vtk")) return std::nullopt;
    const std::string stem = inShell((path.parent_path() / path.stem()).string());
    if (head.find("STRUCTURED_POINTS") != std::string::npos)
        return fmt::format("is an image of VTK; convert it: c3d {} -o {}.nii", name, stem);
    return fmt::format("is a mesh of VTK; convert it: meshio convert {} {}.ply", name, stem);
}

std::optional<std::string> folderText(const fs::path& folder) {
    std::map<std::string, std::size_t> count;
    std::error_code ignored;
    for (auto entry = fs::directory_iterator(folder, ignored); entry != fs::directory_iterator();
         entry.increment(ignored)) {
        ++count[toLower(entry->path().extension().string())];
    }
    for (const char* extension : {".gif", ".webp", ".jp2", ".j2k", ".pgm", ".ppm", ".pbm", ".pnm"})
        if (const std::size_t n = count[extension]; n > 0)
            return fmt::format(
                "holds {} slices as {}, which are not read; convert them: mogrify -format png {}/*{}", n,
                extension, inShell(folder.string()), extension);
    if (const std::size_t n = count[".gz"]; n > 0)
        return fmt::format("holds {} files compressed by gzip; gunzip them first: gunzip -k {}/*.gz", n,
                           inShell(folder.string()));
    return std::nullopt;
}

}  // namespace

std::optional<std::string> foreignText(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return folderText(path);
    if (const auto text = cadModelText(path)) return text;
    const std::string extension = toLower(path.extension().string());
    const std::string name = inShell(path.string());
    if (extension == ".gz") {
        const std::string inner = toLower(path.stem().extension().string());
        if (inner == ".tar") return "is an archive; unpack it first: tar xf " + name;
        return "is compressed by gzip; gunzip it first: gunzip -k " + name;
    }
    if (extension == ".inr")
        if (const auto text = inrText(path)) return text;
    if (extension == ".vtk")
        if (const auto text = vtkText(path)) return text;
    const Foreign* foreign = foreignOf(extension);
    if (!foreign) return std::nullopt;
    const std::string stem = inShell((path.parent_path() / path.stem()).string());
    return fmt::format("is {}; {}", foreign->what, fmt::format(fmt::runtime(foreign->remedy), name, stem));
}

}  // namespace isowave::imageio
