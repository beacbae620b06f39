// A known model made to fit new samples, its poles kept.
//
// Where equipment ages or a part of it fails, its gains move more than its time constants, and
// these take longer to tell from samples than the gains. With A and C kept, what is left of the
// output y - y_known is linear in the changes of B, D and y0 and in the initial states:
//
//   y[k] - y_known[k] = C A^k dx0 + sum_{j<k} C A^(k-1-j) dB u[j] + dD u[k] + dy0
//
// in inputs of mean 0 and deviation 1. What the samples do not tell stays as it was, and the gain
// of an input that does not move. A model that was identified from the samples themselves moves to
// the solution of least squares, of least norm where they do not determine it (regression.hpp says
// in which scale). One that other samples have told moves as far as these tell surely
// (response.hpp, fit_change): the gain of a mode that is slow beside the samples follows what
// little else happens in them, and a run that lasts longer than they do would drift away with it.
//
// Currents into a node and out of it add up to nothing but the noise of their sensors. The gain of
// such a sum follows that noise, may have any size and sign, and does harm once one of the sensors
// is off by a little. A principal component of the inputs that is below a twentieth of their
// deviation, and carries on from one sample of its sensors to the next with less than half of its
// variance, is taken for noise, and no gain of it is fitted (principal component regression: I. T.
// Jolliffe, Principal Component Analysis, 2nd ed., Springer 2002, ch. 8).
#pragma once

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// What the known model was identified from. Gains that it has for components of the inputs which
/// show noise alone in the rows are dropped where these very rows told them, and else kept.
enum class KnownFrom { these_rows, other_rows };

/// `known` with B, D and y0 moved to fit its simulated output to the rows. Requires a stable,
/// well-formed model of the record's channels and period, and finite rows, at least one.
StateSpaceModel adapted(const StateSpaceModel& known, const Record& record, RowRange rows,
                        KnownFrom from);

}  // namespace reident::identification
