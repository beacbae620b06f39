// The one compression of the data: the triangular factor of the block-Hankel rows.
#pragma once

#include "identification/record.hpp"
#include "identification/state_space.hpp"

namespace reident::identification {

/// Rows of the Hankel matrix are 1 and z[t], z[t+1], ..., z[t+L-1] with z = [u; y] and L block
/// rows; its columns are all t at which these lie in one segment. With H that matrix,
/// R is upper triangular and H H' = R' R. The factor of fewer block rows is the upper left part of
/// this one.
struct HankelFactor {
  Index inputs = 0;
  Index outputs = 0;
  Index block_rows = 0;  // L
  Index columns = 0;     // of H
  Matrix R;              // square, 1 + L (m + p)
};

/// Columns of the Hankel matrix with `block_rows` block rows over the segments.
Index hankel_columns(const std::vector<Segment>& segments, Index block_rows);

/// From the sums of lag products; where these would lose too many digits (noise-free data, inputs
/// that nearly foretell each other), from a QR of the rows.
HankelFactor compress(const Record& record, RowRange rows, Index block_rows);

}  // namespace reident::identification
