#include "io/mesh/obj.h"

#include <fmt/format.h>

#include "io/mesh/lines.h"
#include "isowave/error.h"

namespace isowave {
namespace {

class ObjReader {
  public:
    ObjReader(std::string_view text, const std::string& name) : lines_(text, name, Lines::Break::backslash) {}

    PolygonSoup read() {
        while (lines_.next()) {
            const std::string_view key = lines_.word();
            if (key == "v")
                takePoint();
            else if (key == "f")
                takeFace();
            else
                noteDropped(key);
            if (key == "t") soup_.tags.push_back({std::string(lines_.restOfLine()), lines_.number()});
        }
        checkAhead();
        const std::size_t points = soup_.points.size();
        if (points == 0) throw InputError(lines_.name(), "no points ('v' lines)");
        if (soup_.faceCount() == 0)
            throw InputError(lines_.name(),
                             fmt::format("{} points but no faces ('f' lines); it is a point cloud", points));
        soup_.digits = lines_.mostDigits();
        return std::move(soup_);
    }

  private:
    // x y z, and behind them nothing, a weight, or a colour.
    void takePoint() {
        soup_.points.push_back(lines_.point());
        if (lines_.isLineDone()) return;
        int more = 0;
        while (!lines_.word().empty()) ++more;
        if (more >= 3) soup_.drop(Dropped::colours);
    }
    void noteDropped(std::string_view key) {
        if (key == "vt") soup_.drop(Dropped::textureCoordinates);
        if (key == "vn") soup_.drop(Dropped::normals);
        if (key == "usemtl" || key == "mtllib") soup_.drop(Dropped::materials);
        if (key == "g" || key == "o") soup_.drop(Dropped::groups);
        if (key == "l" || key == "p") soup_.drop(Dropped::lines);
        if (key == "curv" || key == "curv2" || key == "surf") soup_.drop(Dropped::other);
    }
    void takeFace() {
        for (auto word = lines_.word(); !word.empty(); word = lines_.word()) takeCorner(word);
        soup_.endFace();
        if (const auto corners = soup_.faceSize(soup_.faceCount() - 1); corners < 3)
            lines_.fail(fmt::format("a face needs three corners, found {}", corners));
    }
    // "7", "7/1/3", or "-2", which counts back from the last point so far.
    void takeCorner(std::string_view word) {
        const auto points = static_cast<std::int64_t>(soup_.points.size());
        const auto number = numberIn<std::int64_t>(word.substr(0, word.find('/')));
        if (!number) lines_.fail(fmt::format("corner '{}' is not a point's number", shown(word)));
        if (*number == 0) lines_.fail("a face refers to point 0; OBJ counts from 1");
        if (*number < -points)
            lines_.fail(
                fmt::format("a face refers to point {}, but only {} points come before", *number, points));
        if (*number > points && (ahead_.empty() || *number > ahead_.back().number))
            ahead_.push_back({*number, lines_.number()});
        soup_.corners.push_back(static_cast<std::uint32_t>(*number > 0 ? *number - 1 : points + *number));
    }
    // Faces may come before their points.
    void checkAhead() const {
        const auto points = static_cast<std::int64_t>(soup_.points.size());
        for (const auto& [number, line] : ahead_)
            if (number > points)
                lines_.failAt(line,
                              fmt::format("a face refers to point {}, but the file has only {} points; it "
                                          "is truncated or damaged",
                                          number, points));
    }

    struct Reference {
        std::int64_t number;
        std::size_t line;
    };
    Lines lines_;
    PolygonSoup soup_;
    std::vector<Reference> ahead_;  // to points that had not come yet: each larger than the ones before
};

}  // namespace

PolygonSoup readObj(std::string_view text, const std::string& name) {
    PolygonSoup soup = ObjReader(text, name).read();
    soup.format = "OBJ";
    soup.space = spaceIn(text.substr(0, 4096));
    return soup;
}

void writeObj(Sink& sink, const MeshView& mesh) {
    for (const std::string& comment : mesh.comments()) sink.text("# " + comment + "\n");
    for (const Point& p : mesh.points) {
        sink.text("v ");
        sink.point(p, mesh.isPolygons());
        sink.text("\n");
    }
    for (const auto& n : mesh.normals) {
        sink.text("vn");
        for (const float x : n) sink.number(' ', x);
        sink.text("\n");
    }
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        sink.text("f");
        for (const std::uint32_t v : mesh.face(f)) {
            sink.number(' ', std::uint64_t{v} + 1);
            if (mesh.normals.empty()) continue;
            sink.text("/");
            sink.number('/', std::uint64_t{v} + 1);
        }
        sink.text("\n");
    }
    for (const std::string& tag : mesh.tags) sink.text("t " + tag + "\n");
}

}  // namespace isowave
