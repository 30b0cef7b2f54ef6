#include "io/mesh/off.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/mesh/lines.h"
#include "isowave/error.h"

namespace isowave {
namespace {

class OffReader {
  public:
    OffReader(std::string_view text, const std::string& name, Lines::Break lineBreak)
        : lines_(text, name, lineBreak), byLine_(lineBreak == Lines::Break::statement), text_(text) {}

    PolygonSoup read() {
        takeKeyword();
        takeCounts();
        takePoints();
        takeFaces();
        if (byLine_)
            while (lines_.next()) {
            }  // for its comments
        else if (const auto word = lines_.word(); !word.empty())
            lines_.fail(fmt::format("'{}' behind the last face", shown(word)));
        soup_.tags = lines_.takeTags();
        soup_.digits = lines_.mostDigits();
        return std::move(soup_);
    }

  private:
    // To where the next point or face begins; false at the end of the file.
    bool nextRow() {
        if (byLine_) return lines_.nextFilled();
        if (!isWrapped_ && !lines_.isLineDone()) lines_.fail("expected nothing more here");
        return true;
    }

    void takeKeyword() {
        std::string_view word = nextRow() ? lines_.word() : std::string_view();
        for (const std::string_view prefix : {"ST", "C", "N", "4"}) {
            if (word == "OFF" || !word.starts_with(prefix)) continue;
            word.remove_prefix(prefix.size());
            noteBesides(prefix);
            isHomogeneous_ = prefix == "4";
        }
        // "OFF8 6 0": the blank is missing.
        if (word.starts_with("OFF") && word.find_first_not_of("0123456789", 3) == word.npos) {
            pointsWord_ = word.substr(3);
            word = word.substr(0, 3);
        }
        if (word != "OFF") lines_.fail("an OFF file starts with 'OFF'");
    }

    // What stands behind the coordinates of every point: Geomview's manual gives the numbers.
    void noteBesides(std::string_view prefix) {
        if (prefix == "ST") soup_.drop(Dropped::textureCoordinates), besides_ += 2;
        if (prefix == "C") soup_.drop(Dropped::colours), besides_ += 4;
        if (prefix == "N") soup_.drop(Dropped::normals), besides_ += 3;
    }

    void takeCounts() {
        std::string_view word = pointsWord_.empty() ? lines_.word() : pointsWord_;
        if (word.empty() && nextRow()) word = lines_.word();
        if (word == "BINARY")
            throw InputError(lines_.name(), "binary OFF is not read; save it as PLY or as ASCII OFF");
        const auto points = numberIn<std::int64_t>(word), faces = numberIn<std::int64_t>(lines_.word());
        if (!points || !faces || *points < 0 || *faces < 0)
            lines_.fail("expected the numbers of points, faces and edges");
        lines_.word();  // the number of edges, which nobody needs
        if (*points == 0 || *faces == 0)
            throw InputError(lines_.name(), fmt::format("{} points and {} faces", *points, *faces));
        points_ = *points;
        faces_ = *faces;
        isWrapped_ = static_cast<double>(std::ranges::count(text_, '\n')) <
                     static_cast<double>(points_) + static_cast<double>(faces_);
    }

    void takePoints() {
        // A point takes 6 bytes at least.
        soup_.points.reserve(std::min<std::size_t>(points_, text_.size() / 6 + 1));
        for (std::int64_t i = 0; i < points_; ++i) {
            if (!nextRow()) failTruncated(points_, "points", i);
            Point p = lines_.point();
            if (isHomogeneous_) divide(p);
            // By lines, what else stands on the line is passed over.
            for (int k = 0; k < besides_ && !byLine_; ++k) lines_.word();
            soup_.points.push_back(p);
        }
    }
    void divide(Point& p) {
        const std::string_view word = lines_.word();
        const auto w = numberIn<double>(word);
        if (!w || *w == 0)
            lines_.fail(fmt::format("a point of 4OFF needs a fourth coordinate that is not 0, found '{}'",
                                    shown(word)));
        for (double& x : p) x /= *w;
    }

    void takeFaces() {
        for (std::int64_t i = 0; i < faces_; ++i) {
            if (!nextRow()) failTruncated(faces_, "faces", i);
            takeFace();
        }
    }
    void takeFace() {
        const std::string_view word = lines_.word();
        const auto corners = numberIn<std::int64_t>(word);
        if (!corners || *corners < 3)
            lines_.fail(
                fmt::format("a face starts with its number of corners, at least 3; found '{}'", shown(word)));
        for (std::int64_t c = 0; c < *corners; ++c) takeCorner(c, *corners);
        soup_.endFace();
        if (byLine_ && !lines_.isLineDone()) soup_.drop(Dropped::colours);
    }
    void takeCorner(std::int64_t c, std::int64_t corners) {
        const std::string_view word = lines_.word();
        if (word.empty())
            lines_.fail(
                fmt::format("the face promises {} corners but lists {}; the file is truncated", corners, c));
        const auto index = numberIn<std::int64_t>(word);
        if (!index || *index < 0 || *index >= points_)
            lines_.fail(fmt::format("a face refers to point '{}'; there are points 0 to {}", shown(word),
                                    points_ - 1));
        soup_.corners.push_back(static_cast<std::uint32_t>(*index));
    }

    [[noreturn]] void failTruncated(std::int64_t promised, const char* what, std::int64_t found) const {
        throw InputError(lines_.name(),
                         fmt::format("the header promises {} {} but the file ends after {}; it is truncated",
                                     promised, what, found));
    }

    Lines lines_;
    bool byLine_, isHomogeneous_ = false;
    bool isWrapped_ =
        true;  // fewer lines than points and faces: they begin anywhere, not only where a line does
    std::string_view text_, pointsWord_;  // the number of points, where it stands in the keyword
    int besides_ = 0;                     // words behind each point
    std::int64_t points_ = 0, faces_ = 0;
    PolygonSoup soup_;
};

PolygonSoup readEitherWay(std::string_view text, const std::string& name) {
    try {
        return OffReader(text, name, Lines::Break::statement).read();
    } catch (const InputError& byLine) {
        try {
            return OffReader(text, name, Lines::Break::blank).read();
        } catch (const InputError&) {
            throw byLine;
        }
    }
}

}  // namespace

PolygonSoup readOff(std::string_view text, const std::string& name) {
    PolygonSoup soup = readEitherWay(text, name);
    soup.format = "OFF";
    soup.space = spaceIn(text.substr(0, 4096));
    return soup;
}

void writeOff(Sink& sink, const MeshView& mesh) {
    sink.text("OFF\n");
    for (const std::string& comment : mesh.comments())
        if (comment.starts_with("SPACE")) sink.text("# " + comment + "\n");
    sink.text(fmt::format("{} {} 0\n", mesh.points.size(), mesh.faceCount()));
    for (const Point& p : mesh.points) {
        sink.point(p, mesh.isPolygons());
        sink.text("\n");
    }
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        sink.text(std::to_string(face.size()));
        for (const std::uint32_t v : face) sink.number(' ', v);
        sink.text("\n");
    }
    for (const std::string& tag : mesh.tags) sink.text("# t " + tag + "\n");
}

}  // namespace isowave
