// curves_only PICTURE: how many rings the outline has at each level.
#include <isowave/curves.h>

#include <cstdio>

int main(int, char** argv) {
    using namespace isowave::curves2d;
    makeLadder(readInput(argv[1]), {}, [](const LadderStep& step) {
        if (step.level()) std::printf("level %d: %zu rings\n", *step.level(), step.curves().rings.size());
    });
}
