// Where a shape is thin: chords of lattice lines whose ends face away from each other, at any angle to the lattice.
#pragma once

#include <vector>

#include "curves2d/hold/outline.h"

namespace isowave::curves2d {

// Places and lengths as the outline has them.
struct ThinSample {
    Point at;          // in the middle
    Point normal;      // unit, across
    double thickness;  // length of the chord times |cosine| to the normal
    double part;       // area of the part that it belongs to
};

// Every chord of either axis whose normals at the ends enclose an angle with cosine <= -0.7, however long it is.
std::vector<ThinSample> thinSamples(const Outline& outline);

// Those that a level of pixel H is held at: not thicker than 1.5 H, and in a part that covers a pixel of the level, or in
// the largest part.
std::vector<ThinSample> samplesOfLevel(const std::vector<ThinSample>& all, const Outline& outline, double H);

std::vector<Point> placesOf(const std::vector<ThinSample>& samples);

}  // namespace isowave::curves2d
