#include "io/mesh/xml/three_mf_writer.h"

#include <fmt/format.h>
#include <zip.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "io/mesh/float32.h"
#include "io/mesh/place.h"
#include "io/mesh/xml/solid_parts.h"
#include "io/mesh/xml/three_mf_units.h"
#include "isowave/error.h"

namespace isowave {
namespace {

// Of a text as the value of an attribute; characters that XML 1.0 has not become '?'.
std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += static_cast<unsigned char>(c) < ' ' ? '?' : c;
    }
    return out;
}

struct Scale {
    std::string_view unit;
    double factor;  // from the mesh's unit
};

Scale scaleFor(double metresPerUnit) {
    for (const ThreeMfUnit& unit : kThreeMfUnits)
        if (std::abs(unit.millimetres / (1000 * metresPerUnit) - 1) < 1e-12) return {unit.name, 1};
    return {"millimeter", 1000 * metresPerUnit};
}

// Okabe and Ito's colours, which the colour-blind tell apart, without black (jfly.uni-koeln.de/color).
constexpr ModelColour kColours[] = {{0xE6, 0x9F, 0x00}, {0x56, 0xB4, 0xE9}, {0x00, 0x9E, 0x73},
                                    {0xF0, 0xE4, 0x42}, {0x00, 0x72, 0xB2}, {0xD5, 0x5E, 0x00},
                                    {0xCC, 0x79, 0xA7}, {0x99, 0x99, 0x99}};

// An object of the model: triangles of a mesh, with the points that they use.
struct Piece {
    std::string name;  // escaped
    ModelColour colour;
    std::span<const Point> points;
    std::span<const Triangle> triangles;
    bool wide;  // float64
};

class ModelText {
  public:
    ModelText(const std::vector<Piece>& pieces, const std::string& title, Space space, double metresPerUnit)
        : pieces_(pieces), title_(escaped(title)), space_(space), scale_(scaleFor(metresPerUnit)) {}

    std::string make() {
        begin();
        materials();
        for (std::size_t i = 0; i < pieces_.size(); ++i) object(i);
        out_.text("</resources>\n<build>\n");
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            out_.text(fmt::format("<item objectid=\"{}\"/>\n", idOf(i)));
        out_.text("</build>\n</model>\n");
        return out_.take();
    }

  private:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr int kMaterials = 1;  // their id; objects follow

    static std::size_t idOf(std::size_t piece) { return kMaterials + 1 + piece; }

    void begin() {
        out_.text(
            fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{}\" xml:lang=\"en-US\" "
                        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
                        "<metadata name=\"Title\">{}</metadata>\n"
                        "<metadata name=\"Application\">isowave</metadata>\n",
                        scale_.unit, title_));
        if (space_ != Space::unspecified)
            out_.text(fmt::format("<metadata name=\"Description\">SPACE={}</metadata>\n",
                                  space_ == Space::lps ? "LPS" : "RAS"));
        out_.text("<resources>\n");
    }

    void materials() {
        if (pieces_.empty()) return;
        out_.text(fmt::format("<basematerials id=\"{}\">\n", kMaterials));
        for (const Piece& piece : pieces_)
            out_.text(
                fmt::format("<base name=\"{}\" displaycolor=\"{}\"/>\n", piece.name, textOf(piece.colour)));
        out_.text("</basematerials>\n");
    }

    void object(std::size_t i) {
        const Piece& piece = pieces_[i];
        out_.text(fmt::format(
            "<object id=\"{}\" type=\"model\" name=\"{}\" pid=\"{}\" pindex=\"{}\">\n<mesh>\n<vertices>\n",
            idOf(i), piece.name, kMaterials, i));
        if (i == 0 || piece.points.data() != pieces_[i - 1].points.data())
            number_.assign(piece.points.size(), kNone);  // pieces of one mesh share no points
        std::uint32_t count = 0;
        for (const Triangle& t : piece.triangles)
            for (const std::uint32_t v : t)
                if (number_[v] == kNone) {
                    number_[v] = count++;
                    vertex(piece.points[v], piece.wide);
                }
        out_.text("</vertices>\n<triangles>\n");
        for (const Triangle& t : piece.triangles) {
            out_.number("<triangle v1=\"", number_[t[0]]);
            out_.number("\" v2=\"", number_[t[1]]);
            out_.number("\" v3=\"", number_[t[2]]);
            out_.text("\"/>\n");
        }
        out_.text("</triangles>\n</mesh>\n</object>\n");
    }

    // A number is float32 or float64, whichever is printed; 3MF's ST_Number has exponents.
    void vertex(const Point& p, bool wide) {
        constexpr const char* kBefore[] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
        for (std::size_t a = 0; a < 3; ++a) {
            const double x = scale_.factor * p[a];
            if (wide)
                out_.number(kBefore[a], x);
            else
                out_.number(kBefore[a], static_cast<float>(x));
        }
        out_.text("\"/>\n");
    }

    const std::vector<Piece>& pieces_;
    std::string title_;
    Space space_;
    Scale scale_;
    std::vector<std::uint32_t> number_;  // of a point in its object
    Sink out_;
};

constexpr const char* kModel = "3D/3dmodel.model";
constexpr std::string_view kTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types "
    "xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" "
    "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr std::string_view kRelations =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships "
    "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
    "Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

// A zip archive in memory.
class Packing {
  public:
    explicit Packing(const std::string& name) : name_(name) {
        zip_error_t error;
        zip_error_init(&error);
        out_ = zip_source_buffer_create(nullptr, 0, 0, &error);
        zip_ = out_ ? zip_open_from_source(out_, ZIP_TRUNCATE, &error) : nullptr;
        if (!zip_) {
            if (out_) zip_source_free(out_);
            fail(zip_error_strerror(&error));
        }
        zip_source_keep(out_);
    }
    ~Packing() {
        if (zip_) zip_discard(zip_);
        zip_source_free(out_);
    }
    Packing(const Packing&) = delete;
    Packing& operator=(const Packing&) = delete;

    // REQUIRES: text outlives bytes().
    void add(const char* part, std::string_view text) {
        zip_source_t* const source = zip_source_buffer(zip_, text.data(), text.size(), 0);
        const zip_int64_t index = source ? zip_file_add(zip_, part, source, ZIP_FL_ENC_UTF_8) : -1;
        if (index < 0) {
            if (source) zip_source_free(source);
            fail(zip_strerror(zip_));
        }
        constexpr int kLevel = 6;
        constexpr zip_uint16_t kMidnight = 0, kFirstOf1980 = 0x21;
        zip_set_file_compression(zip_, static_cast<zip_uint64_t>(index), ZIP_CM_DEFLATE, kLevel);
        zip_file_set_dostime(zip_, static_cast<zip_uint64_t>(index), kMidnight, kFirstOf1980, 0);
    }

    std::string bytes() {
        if (zip_close(zip_) != 0) fail(zip_strerror(zip_));
        zip_ = nullptr;
        zip_stat_t about;
        if (zip_source_stat(out_, &about) != 0 || zip_source_open(out_) != 0)
            fail("its bytes cannot be read");
        std::string packed(about.size, '\0');
        const zip_int64_t got = zip_source_read(out_, packed.data(), packed.size());
        zip_source_close(out_);
        if (got != static_cast<zip_int64_t>(packed.size())) fail("its bytes cannot be read");
        return packed;
    }

  private:
    [[noreturn]] void fail(const char* why) const {
        throw OperationError(name_, std::string("cannot be packed as 3MF: ") + why);
    }

    const std::string& name_;
    zip_source_t* out_ = nullptr;
    zip_t* zip_ = nullptr;
};

void pack(Sink& sink, const std::string& model, const std::string& name) {
    Packing packing(name);
    packing.add("[Content_Types].xml", kTypes);
    packing.add("_rels/.rels", kRelations);
    packing.add(kModel, model);
    sink.text(packing.bytes());
}

}  // namespace

ModelColour modelColour(std::size_t i) { return kColours[i % std::size(kColours)]; }

std::string textOf(const ModelColour& colour) {
    return fmt::format("#{:02X}{:02X}{:02X}", colour[0], colour[1], colour[2]);
}

void writeThreeMf(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title) {
    const std::vector<std::vector<Triangle>> parts = solidParts(mesh.points, mesh.triangles);
    const std::string only = escaped(title);
    const bool wide = needsFloat64(mesh);
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < parts.size(); ++i)
        pieces.push_back({parts.size() == 1 ? only : fmt::format("{} {}", only, i + 1), modelColour(i),
                          mesh.points, parts[i], wide});
    pack(sink, ModelText(pieces, title, mesh.space, mesh.metresPerUnit).make(), name);
}

void writeThreeMfObjects(const std::filesystem::path& path, const std::vector<ModelObject>& objects,
                         const MeshWriteOptions& options) {
    std::vector<TriangleMesh> placed;
    for (const ModelObject& object : objects)
        placeFor(MeshFormat::threeMf, options, placed.emplace_back(TriangleMesh{object.mesh.points, {}, {}}));
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        MeshView view;
        view.points = placed[i].points;
        view.triangles = objects[i].mesh.triangles;
        pieces.push_back(
            {escaped(objects[i].name), objects[i].colour, view.points, view.triangles, needsFloat64(view)});
    }
    Sink sink(path);
    pack(sink, ModelText(pieces, path.stem().string(), options.space, options.metresPerUnit).make(),
         path.string());
    sink.finish();
}

}  // namespace isowave
