#include "io/mesh/xml/three_mf_writer.h"

#include <fmt/format.h>
#include <zip.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "io/mesh/float32.h"
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
constexpr std::string_view kColours[] = {"#E69F00", "#56B4E9", "#009E73", "#F0E442",
                                         "#0072B2", "#D55E00", "#CC79A7", "#999999"};

class ModelText {
  public:
    ModelText(const MeshView& mesh, const std::string& title)
        : mesh_(mesh),
          title_(escaped(title)),
          scale_(scaleFor(mesh.metresPerUnit)),
          wide_(needsFloat64(mesh)),
          parts_(solidParts(mesh.points, mesh.triangles)),
          number_(mesh.points.size(), kNone) {}

    std::string make() {
        begin();
        materials();
        for (std::size_t i = 0; i < parts_.size(); ++i) object(i);
        out_.text("</resources>\n<build>\n");
        for (std::size_t i = 0; i < parts_.size(); ++i)
            out_.text(fmt::format("<item objectid=\"{}\"/>\n", idOf(i)));
        out_.text("</build>\n</model>\n");
        return out_.take();
    }

  private:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr int kMaterials = 1;  // their id; objects follow

    static std::size_t idOf(std::size_t part) { return kMaterials + 1 + part; }
    std::string nameOf(std::size_t part) const {
        return parts_.size() == 1 ? title_ : fmt::format("{} {}", title_, part + 1);
    }

    void begin() {
        out_.text(
            fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{}\" xml:lang=\"en-US\" "
                        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
                        "<metadata name=\"Title\">{}</metadata>\n"
                        "<metadata name=\"Application\">isowave</metadata>\n",
                        scale_.unit, title_));
        if (mesh_.space != Space::unspecified)
            out_.text("<metadata name=\"Description\">" + mesh_.comments().back() + "</metadata>\n");
        out_.text("<resources>\n");
    }

    void materials() {
        if (parts_.empty()) return;
        out_.text(fmt::format("<basematerials id=\"{}\">\n", kMaterials));
        for (std::size_t i = 0; i < parts_.size(); ++i)
            out_.text(fmt::format("<base name=\"{}\" displaycolor=\"{}\"/>\n", nameOf(i),
                                  kColours[i % std::size(kColours)]));
        out_.text("</basematerials>\n");
    }

    void object(std::size_t part) {
        out_.text(fmt::format(
            "<object id=\"{}\" type=\"model\" name=\"{}\" pid=\"{}\" pindex=\"{}\">\n<mesh>\n<vertices>\n",
            idOf(part), nameOf(part), kMaterials, part));
        std::uint32_t count = 0;
        for (const Triangle& t : parts_[part])
            for (const std::uint32_t v : t)
                if (number_[v] == kNone) {
                    number_[v] = count++;
                    vertex(mesh_.points[v]);
                }
        out_.text("</vertices>\n<triangles>\n");
        for (const Triangle& t : parts_[part]) {
            out_.number("<triangle v1=\"", number_[t[0]]);
            out_.number("\" v2=\"", number_[t[1]]);
            out_.number("\" v3=\"", number_[t[2]]);
            out_.text("\"/>\n");
        }
        out_.text("</triangles>\n</mesh>\n</object>\n");
    }

    // A number is float32 or float64, whichever is printed; 3MF's ST_Number has exponents.
    void vertex(const Point& p) {
        constexpr const char* kBefore[] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
        for (std::size_t a = 0; a < 3; ++a) {
            const double x = scale_.factor * p[a];
            if (wide_)
                out_.number(kBefore[a], x);
            else
                out_.number(kBefore[a], static_cast<float>(x));
        }
        out_.text("\"/>\n");
    }

    const MeshView& mesh_;
    std::string title_;
    Scale scale_;
    bool wide_;
    std::vector<std::vector<Triangle>> parts_;
    std::vector<std::uint32_t> number_;  // of a point in its object; parts share none
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

}  // namespace

void writeThreeMf(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title) {
    const std::string model = ModelText(mesh, title).make();
    Packing packing(name);
    packing.add("[Content_Types].xml", kTypes);
    packing.add("_rels/.rels", kRelations);
    packing.add(kModel, model);
    sink.text(packing.bytes());
}

}  // namespace isowave
