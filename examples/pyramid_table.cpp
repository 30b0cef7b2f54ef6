// What is in a pyramid, step by step: pyramid_table part.pyramid.vdb
#include <isowave/isowave.h>

#include <cstdio>

int main(int, char** argv) {
    try {
        const isowave::Pyramid pyramid = isowave::Pyramid::open(argv[1]);
        std::printf("step  voxel x      control points     details\n");
        for (const isowave::StepFacts& step : pyramid.steps())
            std::printf("%4d  %-10.4g %16lld %11lld\n", step.step, step.spacing[0],
                        static_cast<long long>(step.controlPoints), static_cast<long long>(step.details));
    } catch (const isowave::InputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 3;
    }
}
