#include "subdivision/filters/four_point.h"

namespace isowave::subdivision {
namespace {

Node at(int i) { return {i, 0}; }

}  // namespace

Diagram fourPointRow(int n, int i) {
    if (i % 2 == 0) return Diagram::delta(at(i / 2));
    const int j = i / 2;  // the edge from j to j+1
    if (n == 2) return {{at(0), Rational(1, 2)}, {at(1), Rational(1, 2)}};
    if (j == n - 2) return fourPointRow(n, 1).mirrored(at(n - 1));
    if (j == 0 && n == 3) return {{at(0), Rational(3, 8)}, {at(1), Rational(6, 8)}, {at(2), Rational(-1, 8)}};
    if (j == 0) {
        return {{at(0), Rational(5, 16)},
                {at(1), Rational(15, 16)},
                {at(2), Rational(-5, 16)},
                {at(3), Rational(1, 16)}};
    }
    return {{at(j - 1), Rational(-1, 16)},
            {at(j), Rational(9, 16)},
            {at(j + 1), Rational(9, 16)},
            {at(j + 2), Rational(-1, 16)}};
}

}  // namespace isowave::subdivision
