#include "volume/repair/turn.h"

#include <numeric>
#include <utility>

namespace isowave::repair {
namespace {

// Neighbours across edges with two triangles, as a graph in compressed rows.
struct Neighbours {
    std::vector<std::size_t> start;               // triangle t: start[t] .. start[t + 1]
    std::vector<std::pair<Index, bool>> entries;  // neighbour, and whether the two agree as they are
};

Neighbours neighboursOf(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
    Neighbours graph;
    graph.start.assign(mesh.triangles.size() + 1, 0);
    const auto forEachPair = [&](const auto& visit) {
        forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
            if (count != 2) return;
            const bool agree = use[0].forward != use[1].forward;
            visit(use[0].triangle, use[1].triangle, agree);
            visit(use[1].triangle, use[0].triangle, agree);
        });
    };
    forEachPair([&](Index t, Index, bool) { ++graph.start[t + 1]; });
    std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
    graph.entries.resize(graph.start.back());
    std::vector<std::size_t> cursor(graph.start.begin(), graph.start.end() - 1);
    forEachPair([&](Index t, Index other, bool agree) { graph.entries[cursor[t]++] = {other, agree}; });
    return graph;
}

}  // namespace

bool turnToAgree(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, std::int64_t& turnedCount,
                 const Progress& progress) {
    const Neighbours graph = neighboursOf(mesh, uses);
    enum : char { unseen, kept, turned };
    std::vector<char> state(mesh.triangles.size(), unseen);
    std::vector<Index> component;
    std::size_t components = 0, walked = 0;
    bool clear = true;
    for (Index seed = 0; seed < mesh.triangles.size(); ++seed) {
        if (state[seed] != unseen) continue;
        ++components;
        component.assign(1, seed);
        state[seed] = kept;
        std::size_t turns = 0;
        for (std::size_t i = 0; i < component.size(); ++i) {
            const Index t = component[i];
            checkNowAndThen(progress, ++walked);
            for (std::size_t e = graph.start[t]; e < graph.start[t + 1]; ++e) {
                const auto [other, agree] = graph.entries[e];
                if (state[other] != unseen) continue;
                state[other] = agree == (state[t] == kept) ? kept : turned;
                turns += state[other] == turned;
                component.push_back(other);
            }
        }
        const bool majorityTurned = 2 * turns > component.size();
        const std::size_t flips = majorityTurned ? component.size() - turns : turns;
        for (const Index t : component) {
            if ((state[t] == turned) != majorityTurned) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        }
        turnedCount += static_cast<std::int64_t>(flips);
        clear = clear && 4 * flips <= component.size();
    }
    return clear || components == 1;
}

}  // namespace isowave::repair
