#include "io/mesh/xml/three_mf.h"

#include <expat.h>
#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <vector>

#include "base/text.h"
#include "io/mesh/lines.h"
#include "io/mesh/xml/three_mf_units.h"
#include "isowave/error.h"

namespace isowave {
namespace {

constexpr const char* kModel = "3D/3dmodel.model";
constexpr const char* kModelType = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
// A mesh of 100 million triangles is 5 GB of text.
constexpr zip_uint64_t kMostBytes = zip_uint64_t(1) << 34;
// Deflate's best: 1032 to 1.
constexpr zip_uint64_t kBestRatio = 1040;

// ---- zip

class Archive {
  public:
    Archive(std::string_view bytes, const std::string& name) : name_(name), bytes_(bytes.size()) {
        zip_error_t error;
        zip_error_init(&error);
        zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
        zip_ = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr;
        if (zip_) return;
        if (source) zip_source_free(source);
        const std::string what = zip_error_strerror(&error);
        zip_error_fini(&error);
        throw InputError(name,
                         "is no 3MF file, which is a zip archive (" + what + "); it is truncated or damaged");
    }
    ~Archive() { zip_discard(zip_); }
    Archive(const Archive&) = delete;
    Archive& operator=(const Archive&) = delete;

    // Nothing where the archive has no such part. Names have no case in 3MF.
    std::optional<std::string> part(const std::string& path) const {
        const zip_int64_t index = zip_name_locate(zip_, path.c_str(), ZIP_FL_NOCASE);
        zip_stat_t about;
        if (index < 0 || zip_stat_index(zip_, static_cast<zip_uint64_t>(index), 0, &about) != 0)
            return std::nullopt;
        if (!(about.valid & ZIP_STAT_SIZE) || about.size > kMostBytes || about.size / kBestRatio > bytes_)
            throw InputError(
                name_, fmt::format("its part {} is said to have {} bytes; it is damaged", path, about.size));
        std::string text(about.size, '\0');
        zip_file_t* const file = zip_fopen_index(zip_, static_cast<zip_uint64_t>(index), 0);
        const zip_int64_t got = file ? zip_fread(file, text.data(), text.size()) : -1;
        char more = 0;
        // The last read compares the checksum.
        const bool whole = got == static_cast<zip_int64_t>(text.size()) && zip_fread(file, &more, 1) == 0;
        if (file) zip_fclose(file);
        if (!whole) throw InputError(name_, fmt::format("its part {} is damaged or encrypted", path));
        return text;
    }

  private:
    const std::string& name_;
    zip_uint64_t bytes_;
    zip_t* zip_;
};

// ---- the model

// x' = M (x y z 1): rows of the transform attribute, m00 m01 m02 m10 ... m32, which multiplies rows from the right.
struct Transform {
    std::array<double, 12> m{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

    Point operator()(const Point& p) const {
        Point q;
        for (std::size_t a = 0; a < 3; ++a) q[a] = p[0] * m[a] + p[1] * m[3 + a] + p[2] * m[6 + a] + m[9 + a];
        return q;
    }
    bool mirrors() const {
        const double det = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                           m[2] * (m[3] * m[7] - m[4] * m[6]);
        return det < 0;
    }
};

struct Item {
    std::string object;
    Transform transform;
    std::string path = {};  // of the part whose model has the object; empty: the model that has the item
};

struct Object {
    std::vector<Point> points;
    std::vector<Triangle> triangles;
    std::vector<Item> components;
    bool isSupport = false;
};

// "/3D/Objects/a.model" -> "3D/Objects/a.model", as the archive has it.
std::string partOf(std::string_view path) {
    return std::string(path.substr(std::min(path.find_first_not_of('/'), path.size())));
}

// The elements that count, by their names without prefixes, as they come.
class ModelReader {
  public:
    // what  how messages call it: "its model"
    ModelReader(std::string_view text, const std::string& name, const std::string& what)
        : name_(name), what_(what), parser_(XML_ParserCreate(nullptr), &XML_ParserFree) {
        XML_SetUserData(parser_.get(), this);
        XML_SetStartElementHandler(parser_.get(), &ModelReader::onStart);
        for (std::size_t at = 0; at <= text.size(); at += kPiece) {
            const std::string_view piece = text.substr(at, kPiece);
            const bool last = at + kPiece > text.size();
            if (XML_Parse(parser_.get(), piece.data(), static_cast<int>(piece.size()), last) != XML_STATUS_OK)
                refuse();
        }
        if (!isModel_) throw InputError(name_, what_ + " is no model of 3MF");
    }

    const std::string& what() const { return what_; }

    std::map<std::string, Object> objects;
    std::vector<std::string> order;  // of the objects
    std::vector<Item> build;
    double millimetres = 1;
    unsigned dropped = 0;

  private:
    static constexpr std::size_t kPiece = std::size_t(1) << 24;
    using Attributes = const XML_Char**;

    // An exception must not pass through expat.
    static void onStart(void* self, const XML_Char* name, Attributes attributes) {
        auto& reader = *static_cast<ModelReader*>(self);
        const char* const colon = std::strrchr(name, ':');
        try {
            reader.start(colon ? colon + 1 : name, attributes);
        } catch (const InputError& error) {
            reader.failure_ = error.what();
            XML_StopParser(reader.parser_.get(), XML_FALSE);
        }
    }

    [[noreturn]] void refuse() const {
        if (!failure_.empty()) throw InputError(failure_);
        throw InputError(
            name_, fmt::format("line {} of {} is no XML: {}", XML_GetCurrentLineNumber(parser_.get()), what_,
                               XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(
            name_, fmt::format("line {} of {}: {}", XML_GetCurrentLineNumber(parser_.get()), what_, what));
    }

    static const char* find(Attributes attributes, std::string_view wanted) {
        for (; *attributes; attributes += 2)
            if (attributes[0] == wanted) return attributes[1];
        return nullptr;
    }
    std::string text(Attributes attributes, const char* wanted) const {
        const char* const found = find(attributes, wanted);
        return found ? found : "";
    }
    template <class Number>
    Number number(Attributes attributes, const char* wanted) const {
        const char* const found = find(attributes, wanted);
        const auto value = found ? numberIn<Number>(found) : std::nullopt;
        if (!value) fail(fmt::format("{} is '{}'; expected a number", wanted, shown(found ? found : "")));
        return *value;
    }

    Transform transformOf(Attributes attributes) const {
        Transform transform;
        const char* const found = find(attributes, "transform");
        if (!found) return transform;
        std::size_t at = 0, count = 0;
        const std::string_view numbers = found;
        while (count < 12) {
            at = std::min(numbers.find_first_not_of(" \t\r\n", at), numbers.size());
            const auto value = takeNumber(numbers, at);
            if (!value || !std::isfinite(*value)) break;
            transform.m[count++] = *value;
        }
        if (count < 12 || numbers.find_first_not_of(" \t\r\n", at) != std::string_view::npos)
            fail(fmt::format("a transform is '{}'; expected 12 numbers", shown(found)));
        return transform;
    }

    Item itemOf(Attributes attributes) const {
        Item item{text(attributes, "objectid"), transformOf(attributes)};
        for (Attributes a = attributes; *a; a += 2)
            if (std::string_view(a[0]).ends_with(":path")) item.path = partOf(a[1]);
        return item;
    }

    void startModel(Attributes attributes) {
        isModel_ = true;
        const std::string unit = text(attributes, "unit");
        const auto* const known = std::find_if(std::begin(kThreeMfUnits), std::end(kThreeMfUnits),
                                               [&](const ThreeMfUnit& u) { return u.name == unit; });
        if (known == std::end(kThreeMfUnits) && !unit.empty())
            fail("its unit is '" + shown(unit) + "', which 3MF has not");
        millimetres = unit.empty() ? 1 : known->millimetres;
        requireKnown(attributes);
    }

    // Who does not know an extension that a model requires must not read it: its triangles are not all of the shape.
    void requireKnown(Attributes attributes) const {
        std::istringstream required(text(attributes, "requiredextensions"));
        for (std::string prefix; required >> prefix;) {
            const std::string space = text(attributes, ("xmlns:" + prefix).c_str());
            const bool known = space.find("/production/") != std::string::npos ||
                               space.find("/material/") != std::string::npos;
            if (!known)
                fail(fmt::format(
                    "it needs 3MF's extension '{}', which is not read; export it without, as triangles",
                    (space.empty() ? prefix : space).substr(0, 100)));
        }
    }

    void startObject(Attributes attributes) {
        const std::string id = text(attributes, "id"), type = text(attributes, "type");
        if (objects.contains(id)) fail("there is a second object " + shown(id));
        order.push_back(id);
        object_ = &objects[id];
        object_->isSupport = type == "support" || type == "other";
        if (find(attributes, "pid")) drop(Dropped::materials);
    }

    void start(std::string_view element, Attributes attributes) {
        if (element == "vertex" && object_) {
            object_->points.push_back({number<double>(attributes, "x"), number<double>(attributes, "y"),
                                       number<double>(attributes, "z")});
        } else if (element == "triangle" && object_) {
            object_->triangles.push_back({number<std::uint32_t>(attributes, "v1"),
                                          number<std::uint32_t>(attributes, "v2"),
                                          number<std::uint32_t>(attributes, "v3")});
            if (find(attributes, "pid") || find(attributes, "p1")) drop(Dropped::materials);
        } else if (element == "component" && object_) {
            object_->components.push_back(itemOf(attributes));
        } else if (element == "beam" || element == "slicestack") {
            fail(fmt::format("holds a '{}', which is not read; export it as triangles", element));
        } else if (element == "object") {
            startObject(attributes);
        } else if (element == "item") {
            build.push_back(itemOf(attributes));
        } else if (element == "model") {
            startModel(attributes);
        }
    }

    void drop(Dropped what) { dropped |= 1u << static_cast<unsigned>(what); }

    const std::string& name_;
    const std::string what_;
    std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser_;
    std::string failure_;
    bool isModel_ = false;
    Object* object_ = nullptr;
};

// The models of a file: one, or by the production extension more, each in a part of its own, read when it is first wanted.
class Models {
  public:
    Models(const Archive& archive, std::string_view rootText, const std::string& name)
        : archive_(archive), name_(name), root_(rootText, name, "its model") {}

    const ModelReader& root() const { return root_; }
    const ModelReader& at(const std::string& part) {
        auto& model = others_[part];
        if (model) return *model;
        const auto text = archive_.part(part);
        if (!text) throw InputError(name_, "has no part '" + shown(part) + "', which its model refers to");
        model = std::make_unique<ModelReader>(*text, name_, "its part '" + shown(part) + "'");
        return *model;
    }
    unsigned dropped() const {
        unsigned all = root_.dropped;
        for (const auto& [part, model] : others_) all |= model->dropped;
        return all;
    }

  private:
    const Archive& archive_;
    const std::string& name_;
    const ModelReader root_;
    std::map<std::string, std::unique_ptr<const ModelReader>> others_;
};

// Objects of the build as polygons, moved by all transforms on the way to them.
class Assembly {
  public:
    Assembly(Models& models, const std::string& name) : models_(models), name_(name) {}

    PolygonSoup make() {
        const ModelReader& root = models_.root();
        std::vector<Item> items = root.build;
        if (items.empty())
            for (const std::string& id : root.order)
                if (!root.objects.at(id).isSupport) items.push_back({id, {}});
        for (const Item& item : items) add(item, root, 0);
        for (Point& p : soup_.points)
            for (double& x : p) x *= root.millimetres;
        soup_.format = "3MF";
        soup_.dropped = models_.dropped();
        return std::move(soup_);
    }

  private:
    static constexpr int kDeepest = 32;
    // Components of components multiply.
    static constexpr std::size_t kMost = std::size_t(1) << 28;

    // The unit of points in the end is that of the root.
    void add(const Item& item, const ModelReader& from, int depth) {
        const ModelReader& model = item.path.empty() ? from : models_.at(item.path);
        const auto found = model.objects.find(item.object);
        if (found == model.objects.end())
            throw InputError(
                name_, model.what() + " has no object '" + shown(item.object) + "', which an item refers to");
        if (depth > kDeepest || ++added_ > 1'000'000)
            throw InputError(name_, "its objects hold each other without end");
        const Object& object = found->second;
        const std::size_t firstPoint = soup_.points.size(), firstCorner = soup_.corners.size();
        addMesh(object, firstPoint);
        for (const Item& component : object.components) add(component, model, depth + 1);
        if (std::max(soup_.corners.size(), soup_.points.size()) > kMost)
            throw InputError(name_, "its objects have more than 2^28 points or corners in all");
        const double unit = model.millimetres / from.millimetres;
        for (std::size_t i = firstPoint; i < soup_.points.size(); ++i) {
            for (double& x : soup_.points[i]) x *= unit;
            soup_.points[i] = item.transform(soup_.points[i]);
        }
        if (!item.transform.mirrors()) return;
        for (std::size_t c = firstCorner; c + 2 < soup_.corners.size(); c += 3)
            std::swap(soup_.corners[c + 1], soup_.corners[c + 2]);
    }

    void addMesh(const Object& object, std::size_t firstPoint) {
        soup_.points.insert(soup_.points.end(), object.points.begin(), object.points.end());
        for (const Triangle& t : object.triangles) {
            for (const std::uint32_t v : t)
                soup_.corners.push_back(v < object.points.size() ? static_cast<std::uint32_t>(firstPoint + v)
                                                                 : std::numeric_limits<std::uint32_t>::max());
            soup_.endFace();
        }
    }

    Models& models_;
    const std::string& name_;
    PolygonSoup soup_;
    int added_ = 0;
};

}  // namespace

PolygonSoup readThreeMf(std::string_view bytes, const std::string& name) {
    const Archive archive(bytes, name);
    std::string path = kModel;
    if (const auto relations = archive.part("_rels/.rels")) {
        const std::size_t type = relations->find(kModelType);
        const std::size_t begin = relations->rfind('<', type), end = relations->find('>', type);
        const std::size_t target = type == std::string::npos ? type : relations->find("Target=\"", begin);
        if (target != std::string::npos && target < end) {
            const std::size_t from = target + 8, to = relations->find('"', from);
            path = partOf(std::string_view(*relations).substr(from, to - from));
        }
    }
    const auto text = archive.part(path);
    if (!text) throw InputError(name, "has no part '" + shown(path) + "', the model of a 3MF file");
    Models models(archive, *text, name);
    PolygonSoup soup = Assembly(models, name).make();
    soup.space = spaceIn(std::string_view(*text).substr(0, text->find("<resources")));  // in its description
    return soup;
}

}  // namespace isowave
