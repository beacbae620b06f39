// SLICOT's subspace identification: IB01AD (compression, singular values), IB01BD (A, B, C, D, K)
// and IB01CD (x0, and B, D again where asked for). SLICOT is under the GPL: nothing but the program
// slicot_n4sid links this.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/identification/samples.hpp"

namespace reident::bench {

enum class Method {
  n4sid,
  moen4,  // A and C by MOESP, B and D by N4SID; Octave's moen4
  moesp,
};

struct SlicotOptions {
  Method method = Method::n4sid;
  char algorithm = 'C';         // of the compression: C Cholesky, F fast QR, Q QR
  int order = 0;                // below block_rows
  int block_rows = 0;           // of the past and of the future
  int batch_rows = 0;           // rows given to IB01AD at once; 0: all
  bool simulation_b_d = false;  // B, D and x0 by least squares on the simulated output
  bool kalman_gain = true;
};

/// Matrices column-major, as SLICOT writes them.
struct SlicotModel {
  int order = 0, inputs = 0, outputs = 0;
  std::vector<double> A, B, C, D, K, x0;  // K is empty where it was not asked for
  std::vector<double> singular_values;
};

/// The arrays of the calls, allocated once, so that repeats time the computation alone.
class Slicot {
 public:
  Slicot(Samples samples, const SlicotOptions& options);

  /// Throws std::runtime_error with the routine and its INFO where SLICOT gives no model.
  SlicotModel identify();

 private:
  void compress();
  void estimate_matrices(SlicotModel& model);
  void estimate_initial_state(SlicotModel& model);
  int compression_workspace() const;
  int initial_state_workspace() const;

  Samples samples_;
  SlicotOptions options_;
  int m_, p_, n_, s_, rows_, columns_;
  std::vector<double> R_, singular_values_, work_, inputs_copy_;
  std::vector<int> int_work_, logical_work_;
};

}  // namespace reident::bench
