// The one compression of the data: the triangular factor of the block-Hankel rows.
#pragma once

#include <optional>

#include "identification/numerics/matrix.hpp"
#include "identification/samples/record.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "identification/subspace/normalise.hpp"

namespace reident::identification {

/// With z = [u; y] normalised, the Hankel matrix H has the columns [z[t]; ...; z[t+2s-1]] for all t
/// at which these lie in one segment, s the horizon. Of its rows, in the order
///   1, U_f (m s), W_p = [U_p; Y_p] ((m + p) s), Y_f (p s)
/// with p the block rows 0 to s - 1 and f those from s on, L is the lower triangular factor:
/// H H' = L L'. The row of ones makes every later projection one of centred signals.
struct HankelFactor {
  Index inputs = 0;        // m
  Index outputs = 0;       // p
  Index horizon = 0;       // s
  Index columns = 0;       // of H
  Matrix L;                // square, 1 + 2 s (m + p)
  double least_share = 0;  // of a row of H, squared, that those before it leave; for the condition
};

/// Columns of the Hankel matrix with `block_rows` block rows over the segments.
Index hankel_columns(const std::vector<Segment>& segments, Index block_rows);

/// From sums of at least 2 * horizon block rows. Absent where they have lost too many digits
/// (noise-free data, inputs that nearly foretell each other): then the rows have to be factored.
std::optional<HankelFactor> factor_of_sums(const StretchSums& sums,
                                           const Normalisation& normalisation, Index horizon);

/// The same to full accuracy from the rows of a normalised record, by orthogonal transformations in
/// batches, so that memory does not follow the rows.
HankelFactor factor_of_rows(const Record& normalised, const std::vector<Segment>& segments,
                            Index horizon);

/// The factor of the sums where these keep their digits, and of the rows that they are of where
/// not.
HankelFactor compress(const StretchSums& sums, const Normalisation& normalisation,
                      const Record& normalised, const std::vector<Segment>& segments,
                      Index horizon);

}  // namespace reident::identification
