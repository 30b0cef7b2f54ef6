#include "io/mesh/xml/vtp.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "io/mesh/lines.h"
#include "io/vtk/data_array.h"
#include "isowave/error.h"

namespace isowave {
namespace {

class VtpReader {
  public:
    VtpReader(std::string_view bytes, const std::string& name)
        : bytes_(bytes), name_(name), file_(parsed()) {}

    PolygonSoup read() {
        soup_.format = "VTP";
        soup_.space = spaceIn(bytes_.substr(0, std::min<std::size_t>(bytes_.find("<PolyData"), 1 << 12)));
        soup_.float32 = true;
        for (const XmlElement& piece : file_.dataset().children)
            if (piece.name == "Piece") readPiece(piece);
        return std::move(soup_);
    }

  private:
    vtk::File parsed() const {
        if (auto file = vtk::parse(bytes_, name_, "PolyData")) return std::move(*file);
        throw InputError(name_, "ends within its XML; it is truncated");
    }

    [[noreturn]] void fail(const std::string& what) const { throw InputError(name_, what); }

    std::int64_t countOf(const XmlElement& piece, const char* attribute) const {
        const std::string text = piece.get(attribute);
        if (text.empty()) return 0;
        const auto count = numberIn<std::int64_t>(text);
        if (!count || *count < 0 || *count > std::numeric_limits<std::uint32_t>::max())
            fail(fmt::format("its {} is '{}'; expected a whole number below 2^32", attribute, shown(text)));
        return *count;
    }

    const XmlElement& arrayOf(const XmlElement& piece, const char* part, const char* array) const {
        const XmlElement* const found = piece.child(part);
        if (found)
            for (const XmlElement& child : found->children)
                if (child.name == "DataArray" && (!*array || child.get("Name") == array)) return child;
        fail(fmt::format("has no array '{}' in '{}'; it is damaged", array, part));
    }

    // Numbers of any type as T.
    template <class T>
    std::vector<T> valuesOf(const XmlElement& element, std::int64_t count,
                            std::int64_t components = 1) const {
        const vtk::Array array = vtk::describe(element, name_);
        if (array.components != components)
            fail(fmt::format("its array '{}' has {} components; expected {}", array.name, array.components,
                             components));
        const std::string numbers = vtk::decode(file_, array, bytes_, count * components, name_);
        std::vector<T> values(static_cast<std::size_t>(count * components));
        withType(array.type, [&]<class Stored>(Stored value) {
            for (std::size_t i = 0; i < values.size(); ++i) {
                std::memcpy(&value, numbers.data() + i * sizeof value, sizeof value);
                values[i] = static_cast<T>(value);
            }
        });
        return values;
    }

    void readPiece(const XmlElement& piece) {
        const std::size_t before = soup_.points.size();
        const std::int64_t points = countOf(piece, "NumberOfPoints");
        if (points > 0) {
            const XmlElement& element = arrayOf(piece, "Points", "");
            if (element.get("type") != "Float32") soup_.float32 = false;
            const std::vector<double> values = valuesOf<double>(element, points, 3);
            for (std::size_t i = 0; i < values.size(); i += 3)
                soup_.points.push_back({values[i], values[i + 1], values[i + 2]});
        }
        readCells(piece, "Polys", countOf(piece, "NumberOfPolys"), before);
        readCells(piece, "Strips", countOf(piece, "NumberOfStrips"), before);
        if (countOf(piece, "NumberOfLines") > 0) soup_.drop(Dropped::lines);
        if (countOf(piece, "NumberOfVerts") > 0) soup_.drop(Dropped::other);
        for (const char* part : {"PointData", "CellData"}) noteDropped(piece.child(part));
    }

    void readCells(const XmlElement& piece, const char* part, std::int64_t count, std::size_t firstPoint) {
        if (count == 0) return;
        const auto ends = valuesOf<std::int64_t>(arrayOf(piece, part, "offsets"), count);
        std::int64_t begin = 0;
        for (std::size_t i = 0; i < ends.size(); begin = ends[i++])
            if (ends[i] < begin || ends[i] > std::numeric_limits<std::uint32_t>::max())
                fail(fmt::format("offset {} of its {} is {} after {}; expected one that is not less", i, part,
                                 ends[i], begin));
        const auto corners = valuesOf<std::int64_t>(arrayOf(piece, part, "connectivity"), ends.back());
        begin = 0;
        for (const std::int64_t end : ends) {
            if (part[0] == 'P')
                addPolygon(corners, begin, end, firstPoint);
            else
                addStrip(corners, begin, end, firstPoint);
            begin = end;
        }
    }

    // One that is no point's number comes as one beyond all points.
    std::uint32_t cornerOf(std::int64_t point, std::size_t firstPoint) const {
        const auto points = static_cast<std::int64_t>(soup_.points.size() - firstPoint);
        if (point < 0 || point >= points) return std::numeric_limits<std::uint32_t>::max();
        return static_cast<std::uint32_t>(point + static_cast<std::int64_t>(firstPoint));
    }

    void addPolygon(const std::vector<std::int64_t>& corners, std::int64_t begin, std::int64_t end,
                    std::size_t firstPoint) {
        for (std::int64_t c = begin; c < end; ++c)
            soup_.corners.push_back(cornerOf(corners[static_cast<std::size_t>(c)], firstPoint));
        soup_.endFace();
    }

    // Every second triangle of a strip runs the other way.
    void addStrip(const std::vector<std::int64_t>& corners, std::int64_t begin, std::int64_t end,
                  std::size_t firstPoint) {
        for (std::int64_t c = begin; c + 2 < end; ++c) {
            const std::int64_t odd = (c - begin) % 2;
            for (const std::int64_t k : {c, c + 1 + odd, c + 2 - odd})
                soup_.corners.push_back(cornerOf(corners[static_cast<std::size_t>(k)], firstPoint));
            soup_.endFace();
        }
    }

    void noteDropped(const XmlElement* data) {
        if (!data) return;
        for (const XmlElement& array : data->children)
            soup_.drop(array.get("Name") == data->get("Normals") && !array.get("Name").empty()
                           ? Dropped::normals
                           : Dropped::other);
    }

    std::string_view bytes_;
    const std::string& name_;
    vtk::File file_;
    PolygonSoup soup_;
};

}  // namespace

PolygonSoup readVtp(std::string_view bytes, const std::string& name) { return VtpReader(bytes, name).read(); }

}  // namespace isowave
