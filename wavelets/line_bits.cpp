#include "wavelets/line_bits.h"

#include <cstring>

namespace isowave::wavelets {

// Words -> lines. z: word x is bytes y already. y: each word transposed. x: byte y of the eight words, side by side and
// transposed, is the eight lines of that y.
LeafLines linesOf(const LeafWords& words, int axis) {
    LeafWords rows = words;
    if (axis == 1)
        for (Word& w : rows) w = transposed8x8(w);
    if (axis == 0)
        for (int y = 0; y < kLeafDim; ++y) {
            Word w = 0;
            for (int x = 0; x < kLeafDim; ++x) w |= (words[x] >> 8 * y & 0xFF) << 8 * x;
            rows[y] = transposed8x8(w);
        }
    LeafLines lines;
    std::memcpy(lines.data(), rows.data(), lines.size());
    return lines;
}

LeafWords wordsOfLines(const LeafLines& lines, int axis) {
    LeafWords rows, words;
    std::memcpy(rows.data(), lines.data(), lines.size());
    if (axis == 2) return rows;
    for (Word& w : rows) w = transposed8x8(w);
    if (axis == 1) return rows;
    for (int x = 0; x < kLeafDim; ++x) {
        words[x] = 0;
        for (int y = 0; y < kLeafDim; ++y) words[x] |= (rows[y] >> 8 * x & 0xFF) << 8 * y;
    }
    return words;
}

}  // namespace isowave::wavelets
