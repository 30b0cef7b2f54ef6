// The meshes that `isowave lod INPUT --voxels 64 -o DIR` writes, to the byte: ladder INPUT DIR
#include <isowave/isowave.h>

#include <filesystem>
#include <string>

int main(int, char** argv) {
    const isowave::Ladder ladder = isowave::makeLadder(isowave::open(argv[1], {.voxels = 64}));
    const std::filesystem::path folder = argv[2];
    for (const isowave::Level& level : ladder.levels)
        if (!level.report.vanished())
            isowave::writeMesh(
                folder / (folder.filename().string() + "_L" + std::to_string(*level.report.level) + ".ply"),
                level.mesh, isowave::MeshFormat::ply);
}
