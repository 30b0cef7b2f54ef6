// The control points of a planar field as bytes that deflate well, to the bit.
//
// Rows: where control points are known. Runs change little from row to row, so positions are written as differences, 7 bits a
// byte (ByteWriter::varint):
//   rows, then for each row, ascending:  number less that of the row before (the first: itself, signed), runs, then for each run
//     first   of the row's first run less that of the row before (the first row: less 0), signed; of others less the last
//             position of the run before and 2, for one position at least is unknown between them
//     length  less 4, twice, plus 1 where the gap behind the run is inside
//
// Values: a control point is predicted by the parallelogram of its neighbours to the left, above and above to the left, as
// known or ±K as they are, in doubles, rounded to float. Floats in their order are whole numbers; what is written is the
// difference of the two modulo 2^32, signs folded in (0, -1, 1, ... as 0, 1, 2, ...), all lowest bytes first, then the next.
// Where few values occur, as after a binary fit, bytes repeat and the bits of the floats themselves deflate better (plain).
#pragma once

#include <string>
#include <string_view>

#include "curves2d/row_field.h"

namespace isowave::curves2d {

// Known control points lie from -1 up to this position on either axis.
inline constexpr std::int32_t kMostPosition = 1 << 30;

// REQUIRES: rows along x.
std::string encodeRows(const RowField<float>& field);
enum class Coding { predicted, plain };
std::string encodeValues(const RowField<float>& field, Coding coding);

// Rows whose values are all 0. Throws std::runtime_error: not what encodeRows() writes, other than `points` in all, a run
// shorter than 4, positions out of range.
RowField<float> decodeRows(std::string_view bytes, std::uint64_t points);
// REQUIRES: four bytes for each control point; field.K is set. Throws std::runtime_error for a value that is not finite.
void decodeValues(std::string_view bytes, Coding coding, RowField<float>& field);

}  // namespace isowave::curves2d
