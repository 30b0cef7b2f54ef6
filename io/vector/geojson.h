// Lines and rings in GeoJSON, and in TopoJSON, which stores shared borders once. What cannot be read in a geometry is
// told, not refused: whoever asked knows whether it matters, and in which words to say so.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/polyline.h"

namespace isowave {

struct GeoFault {
    enum class Kind {
        noList,          // a list that this kind of object has is not there: `found` is its key
        notAList,        // of lines, of rings or of positions
        notAPosition,    // a list of numbers, as many as are wanted
        notANumber,      // in a position
        otherDimension,  // another number of coordinates than the position before: `found` is how many
        noArc            // TopoJSON: there are fewer: `found` is "arc 7 of 3"
    };
    Kind kind;
    std::string
        pointer;        // of what is wrong, as JSON pointers are written: /features/0/geometry/coordinates/1
    std::string found;  // otherwise what is there, as JSON, its first 40 bytes
    std::size_t vertex = 0;  // where it is about a position
};

struct GeoLine {
    Polyline
        points;  // as they are stored: a ring's last one is a copy of its first. Up to the fault, if there is one
    std::string pointer;  // of the list of positions
    std::optional<GeoFault> fault;
};

// LineString, MultiLineString, Polygon: with their lines. MultiPolygon: one for each of its polygons. Others have none.
struct GeoGeometry {
    std::string type;  // "nothing": it does not say
    std::string pointer;
    std::vector<GeoLine> lines;
    std::optional<GeoFault> fault;

    bool isPolygon() const { return type == "Polygon" || type == "MultiPolygon"; }
};

class GeoJson {
  public:
    enum class Positions {
        plane,  // x and y; what follows them is passed over
        space   // two or three numbers, in a line always as many
    };
    // `name` stands in messages. Throws InputError for collections that nest more than 100 deep, and for a broken list
    // of arcs. `text` that is no JSON: complaint().
    GeoJson(const std::string& text, Positions positions, const std::string& name);

    const std::optional<std::string>& complaint() const {
        return complaint_;
    }  // with the line and what was found there
    const std::optional<std::string>& type() const { return type_; }  // of the whole document
    // As they stand in the document; those of a topology by the names of its objects.
    const std::vector<GeoGeometry>& geometries() const { return geometries_; }

    // The document with other points in the lines at these pointers. REQUIRES: no topology; as many lines as pointers.
    std::string with(const std::vector<std::string>& pointers, const std::vector<Polyline>& lines) const;

  private:
    struct Document;
    std::shared_ptr<const Document> document_;
    std::optional<std::string> complaint_, type_;
    std::vector<GeoGeometry> geometries_;
};

}  // namespace isowave
