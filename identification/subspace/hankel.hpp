// The one compression of the data: the triangular factor of the block-Hankel rows (METHOD.md,
// section 4). Nothing here throws.
#pragma once

#include <optional>

#include "identification/numerics/matrix.hpp"
#include "identification/samples/record.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "identification/subspace/normalise.hpp"

namespace reident::identification {

/// With z = [u; y] normalised, the Hankel matrix H has the columns [z[t]; ...; z[t+2s-1]] for all t
/// at which these are in one segment, s the horizon. Its rows in the order
///   1, U_f (m s), W_p = [U_p; Y_p] ((m + p) s), Y_f (p s)
/// have the lower triangular factor L: H H' = L L'. p are the block rows 0 to s - 1, f those from
/// s.
struct HankelFactor {
  Index inputs = 0;        // m
  Index outputs = 0;       // p
  Index horizon = 0;       // s
  Index columns = 0;       // of H
  Matrix L;                // square, 1 + 2 s (m + p)
  double least_share = 0;  // of a row's square that is left once the rows before it are known
};

/// Returns the columns of the Hankel matrix with `block_rows` block rows over the segments.
Index hankel_columns(const std::vector<Segment>& segments, Index block_rows);

/// Returns the factor from sums of at least 2 * horizon block rows. Absent where they have lost too
/// many digits (noise-free data, nearly predictable inputs): then the rows have to be factored.
std::optional<HankelFactor> factor_of_sums(const RangeSums& sums,
                                           const Normalisation& normalisation, Index horizon);

/// Returns the factor to full accuracy from the rows of a normalised record, by orthogonal
/// transformations in batches, so that memory does not follow the rows.
HankelFactor factor_of_rows(const Record& normalised, const std::vector<Segment>& segments,
                            Index horizon);

/// Returns the factor of the sums where these keep their digits, else that of the rows, which have
/// to be those summed.
HankelFactor compress(const RangeSums& sums, const Normalisation& normalisation,
                      const Record& normalised, const std::vector<Segment>& segments,
                      Index horizon);

}  // namespace reident::identification
