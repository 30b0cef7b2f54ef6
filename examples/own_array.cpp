// Voxels of your own in, closed meshes out: a ball with a hole drilled through it, 0.5 mm voxels.
#include <isowave/isowave.h>

#include <cmath>
#include <cstdio>

int main() {
    isowave::Image image;
    image.size = {64, 64, 64};
    image.indexToWorld.axis = {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}};
    for (int z = 0; z < 64; ++z)
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const double ball = 24 - std::hypot(x - 31.5, y - 31.5, z - 31.5);  // voxels, positive inside
                const double drill = std::hypot(x - 31.5, y - 31.5) - 4.5;
                image.values.push_back(static_cast<float>(std::min(ball, drill)));
            }
    const isowave::Ladder ladder = isowave::makeLadder(isowave::open(image, {.iso = 0}));
    for (const isowave::Level& level : ladder.levels)
        std::printf("level %d: %zu triangles, %lld handles, volume %.0f mm^3\n", *level.report.level,
                    level.mesh.triangles.size(), static_cast<long long>(level.report.topology.genus),
                    level.report.topology.volume);
}
