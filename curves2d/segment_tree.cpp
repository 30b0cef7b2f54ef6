#include "curves2d/segment_tree.h"

#include <algorithm>
#include <numeric>

namespace isowave::curves2d {

double squaredDistance(Point p, const Box& box) {
    const double dx = std::max({box.low.x - p.x, 0.0, p.x - box.high.x}),
                 dy = std::max({box.low.y - p.y, 0.0, p.y - box.high.y});
    return dx * dx + dy * dy;
}

double squaredDistance(Point p, const Segment& s) {
    const Point along = s.b - s.a, to = p - s.a;
    const double size = dot(along, along);
    const double t = size > 0 ? std::clamp(dot(to, along) / size, 0.0, 1.0) : 0.0;
    const Point off = to - t * along;
    return dot(off, off);
}

SegmentTree::SegmentTree(std::vector<Segment> segments)
    : segments_(std::move(segments)), order_(segments_.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.reserve(segments_.size());
    if (!segments_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

// Halved at the median of the longer side of the box.
std::uint32_t SegmentTree::build(std::uint32_t begin, std::uint32_t end) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    Node node{{}, begin, end};
    for (std::uint32_t i = begin; i < end; ++i) {
        node.box.take(segments_[order_[i]].a);
        node.box.take(segments_[order_[i]].b);
    }
    nodes_.push_back(node);
    if (end - begin <= kLeafSize) return at;
    const int axis = node.box.high.x - node.box.low.x >= node.box.high.y - node.box.low.y ? 0 : 1;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t i, std::uint32_t j) {
                         const double a = segments_[i].a[axis] + segments_[i].b[axis],
                                      b = segments_[j].a[axis] + segments_[j].b[axis];
                         return a < b || (a == b && i < j);
                     });
    build(begin, middle);
    const std::uint32_t right = build(middle, end);
    nodes_[at].right = right;
    return at;
}

double SegmentTree::distance(Point p, double near) const {
    double best = near * near;
    if (!nodes_.empty()) nearest(0, p, best);
    return std::sqrt(best);
}

void SegmentTree::nearest(std::uint32_t at, Point p, double& best) const {
    const Node& node = nodes_[at];
    if (squaredDistance(p, node.box) >= best) return;
    if (!node.right) {
        for (std::uint32_t i = node.begin; i < node.end; ++i)
            best = std::min(best, squaredDistance(p, segments_[order_[i]]));
        return;
    }
    const bool leftFirst =
        squaredDistance(p, nodes_[at + 1].box) <= squaredDistance(p, nodes_[node.right].box);
    nearest(leftFirst ? at + 1 : node.right, p, best);
    nearest(leftFirst ? node.right : at + 1, p, best);
}

}  // namespace isowave::curves2d
