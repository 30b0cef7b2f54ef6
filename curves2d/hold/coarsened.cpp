#include "curves2d/hold/coarsened.h"

#include <tsl/robin_map.h>

#include <cmath>

#include "curves2d/hold/point_grid.h"

namespace isowave::curves2d {
namespace {

// A stretch of a ring between two points on sides of squares.
struct Piece {
    std::size_t ring, from, to;  // points from .. to, around the ring
    GridCell square;
};

bool isWhole(double x, int sampling) { return x / sampling == std::floor(x / sampling); }
bool isOnSide(Point p, int sampling) { return isWhole(p.x, sampling) || isWhole(p.y, sampling); }

// Both on one line of the squares: then the piece between them may leave a square by the side where it entered.
bool shareLine(Point a, Point b, int sampling) {
    return (a.x == b.x && isWhole(a.x, sampling)) || (a.y == b.y && isWhole(a.y, sampling));
}

std::vector<Piece> piecesOf(const Curves& curves, int sampling) {
    std::vector<Piece> pieces;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const Ring& points = curves.rings[r].points;
        std::size_t first = 0;
        while (first < points.size() && !isOnSide(points[first], sampling)) ++first;
        if (first == points.size()) continue;  // inside one square
        for (std::size_t from = first;;) {
            std::size_t to = (from + 1) % points.size();
            const Point middle = 0.5 * (points[from] + points[to]);
            while (!isOnSide(points[to], sampling)) to = (to + 1) % points.size();
            pieces.push_back({r, from, to, GridCell::of(middle, sampling)});
            from = to;
            if (from == first) break;
        }
    }
    return pieces;
}

}  // namespace

Curves coarsened(const Curves& curves, int sampling, const KeepsPoints& keeps) {
    if (sampling == 1) return curves;
    const std::vector<Piece> pieces = piecesOf(curves, sampling);
    tsl::robin_map<std::uint64_t, int> count;
    for (const Piece& piece : pieces) ++count[piece.square.key()];
    std::vector<std::vector<char>> gone(curves.rings.size());
    for (std::size_t r = 0; r < gone.size(); ++r) gone[r].assign(curves.rings[r].points.size(), 0);
    for (const auto& [r, from, to, square] : pieces) {
        const Ring& points = curves.rings[r].points;
        if (count[square.key()] > 1 || keeps(square.x, square.y) ||
            shareLine(points[from], points[to], sampling))
            continue;
        for (std::size_t i = (from + 1) % points.size(); i != to; i = (i + 1) % points.size()) gone[r][i] = 1;
    }
    Curves out = curves;
    for (std::size_t r = 0; r < gone.size(); ++r) {
        Ring& points = out.rings[r].points;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (!gone[r][i]) points[kept++] = points[i];
        points.resize(kept);
    }
    return out;
}

}  // namespace isowave::curves2d
