#include "tests/bench/identification/slicot.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

// Fortran: every argument by address, the lengths of the character arguments at the end.
extern "C" {
void ib01ad_(const char* METH, const char* ALG, const char* JOBD, const char* BATCH,
             const char* CONCT, const char* CTRL, const int* NOBR, const int* M, const int* L,
             const int* NSMP, const double* U, const int* LDU, const double* Y, const int* LDY,
             int* N, double* R, const int* LDR, double* SV, const double* RCOND, const double* TOL,
             int* IWORK, double* DWORK, const int* LDWORK, int* IWARN, int* INFO, std::size_t,
             std::size_t, std::size_t, std::size_t, std::size_t, std::size_t);
void ib01bd_(const char* METH, const char* JOB, const char* JOBCK, const int* NOBR, const int* N,
             const int* M, const int* L, const int* NSMPL, double* R, const int* LDR, double* A,
             const int* LDA, double* C, const int* LDC, double* B, const int* LDB, double* D,
             const int* LDD, double* Q, const int* LDQ, double* RY, const int* LDRY, double* S,
             const int* LDS, double* K, const int* LDK, const double* TOL, int* IWORK,
             double* DWORK, const int* LDWORK, int* BWORK, int* IWARN, int* INFO, std::size_t,
             std::size_t, std::size_t);
void ib01cd_(const char* JOBX0, const char* COMUSE, const char* JOB, const int* N, const int* M,
             const int* L, const int* NSMP, const double* A, const int* LDA, double* B,
             const int* LDB, const double* C, const int* LDC, double* D, const int* LDD, double* U,
             const int* LDU, const double* Y, const int* LDY, double* X0, double* V, const int* LDV,
             const double* TOL, int* IWORK, double* DWORK, const int* LDWORK, int* IWARN, int* INFO,
             std::size_t, std::size_t, std::size_t);
}

namespace reident::bench {
namespace {

// Rows that the QR algorithm factors at once: the block stays in the second-level cache, and the
// memory does not follow the rows.
constexpr int qr_rows = 1000;
// Rows of the factorisations of IB01CD.
constexpr int initial_state_rows = 2000;

void check(const char* routine, int info) {
  if (info != 0)
    throw std::runtime_error(std::string(routine) +
                             " gives no model: INFO = " + std::to_string(info));
}

std::size_t size(int rows, int columns) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
}

}  // namespace

Slicot::Slicot(Samples samples, const SlicotOptions& options)
    : samples_(std::move(samples)),
      options_(options),
      m_(static_cast<int>(samples_.inputs)),
      p_(static_cast<int>(samples_.outputs)),
      n_(options.order),
      s_(options.block_rows),
      rows_(static_cast<int>(samples_.rows)),
      columns_(2 * (m_ + p_) * s_) {
  const int leading = std::max(columns_, 3 * m_ * s_);
  R_.resize(size(leading, columns_));
  singular_values_.resize(size(p_, s_));
  // IB01BD needs little compared with IB01AD but for METH = N or C, where its bound is the product
  // of the sizes below.
  const int matrices = p_ * s_ * n_ + m_ * s_ * (n_ + p_) * (m_ * (n_ + p_) + 1) +
                       std::max((n_ + p_) * (n_ + p_), 4 * m_ * (n_ + p_) + 1) +
                       4 * p_ * s_ * (n_ + p_ * s_ + m_ * s_) + 20 * (n_ + p_) * (n_ + p_) + 100;
  work_.resize(static_cast<std::size_t>(
      std::max({compression_workspace(), matrices, initial_state_workspace()})));
  int_work_.resize(size(m_ + p_ + n_, s_ + n_ + p_) + size(n_, n_ + m_ + p_) + 3);
  logical_work_.resize(size(2, n_));
}

int Slicot::compression_workspace() const {
  const int channels = m_ + p_;
  const int least =
      channels * 4 * s_ * (channels + 4) + 5 * channels * s_ + 1 + 4 * (s_ + 1) * channels * s_;
  return options_.algorithm == 'Q' ? least + (qr_rows + 4) * columns_ : least;
}

int Slicot::initial_state_workspace() const {
  const int unknowns = n_ * m_ + n_;
  const int at_once = std::min(rows_, initial_state_rows);
  const int least = (p_ * m_ + unknowns) * (unknowns + 1) + n_ * n_ * (m_ + 4) + p_ * n_ +
                    8 * unknowns + 3 * m_ * m_ + 7 * m_ + n_ * (n_ + m_ + p_) + 10;
  const int block = options_.simulation_b_d
                        ? (p_ * m_ + unknowns * p_ + at_once * p_) * (unknowns + 1)
                        : at_once * p_ * (n_ + 1);
  return least + block;
}

SlicotModel Slicot::identify() {
  compress();
  SlicotModel model;
  model.order = n_;
  model.inputs = m_;
  model.outputs = p_;
  model.singular_values = singular_values_;
  estimate_matrices(model);
  estimate_initial_state(model);
  return model;
}

void Slicot::compress() {
  const char* method = options_.method == Method::n4sid ? "N" : "M";
  const char* later = options_.method == Method::moesp ? "M" : "N";
  const double* U = samples_.values.data();
  const double* Y = U + size(rows_, m_);
  const int leading = static_cast<int>(R_.size()) / columns_;
  const int workspace = static_cast<int>(work_.size());
  const double automatic = 0;
  const int batch = options_.batch_rows > 0 ? options_.batch_rows : rows_;
  for (int begin = 0; begin < rows_;) {
    // The last batch takes a remainder that is too short for one of its own.
    const bool last = rows_ - begin < 2 * batch;
    const int count = last ? rows_ - begin : batch;
    const char* part = last ? (begin == 0 ? "O" : "L") : (begin == 0 ? "F" : "I");
    int suggested_order = 0, warning = 0, info = 0;
    ib01ad_(method, &options_.algorithm, later, part, "C", "N", &s_, &m_, &p_, &count, U + begin,
            &rows_, Y + begin, &rows_, &suggested_order, R_.data(), &leading,
            singular_values_.data(), &automatic, &automatic, int_work_.data(), work_.data(),
            &workspace, &warning, &info, 1, 1, 1, 1, 1, 1);
    check("IB01AD", info);
    begin += count;
  }
}

void Slicot::estimate_matrices(SlicotModel& model) {
  const char* method = options_.method == Method::n4sid   ? "N"
                       : options_.method == Method::moen4 ? "C"
                                                          : "M";
  const char* gain = options_.kalman_gain ? "K" : "N";
  const int leading = static_cast<int>(R_.size()) / columns_;
  const int workspace = static_cast<int>(work_.size());
  const double automatic = 0;
  model.A.resize(size(n_, n_));
  model.B.resize(size(n_, m_));
  model.C.resize(size(p_, n_));
  model.D.resize(size(p_, m_));
  model.K.resize(options_.kalman_gain ? size(n_, p_) : 0);
  std::vector<double> Q(size(n_, n_)), Ry(size(p_, p_)), S(size(n_, p_));
  int warning = 0, info = 0;
  ib01bd_(method, "A", gain, &s_, &n_, &m_, &p_, &rows_, R_.data(), &leading, model.A.data(), &n_,
          model.C.data(), &p_, model.B.data(), &n_, model.D.data(), &p_, Q.data(), &n_, Ry.data(),
          &p_, S.data(), &n_, model.K.data(), &n_, &automatic, int_work_.data(), work_.data(),
          &workspace, logical_work_.data(), &warning, &info, 1, 1, 1);
  check("IB01BD", info);
}

void Slicot::estimate_initial_state(SlicotModel& model) {
  double* U = samples_.values.data();
  const double* Y = U + size(rows_, m_);
  if (options_.simulation_b_d) {  // IB01CD then overwrites the inputs
    inputs_copy_.assign(U, U + size(rows_, m_));
    U = inputs_copy_.data();
  }
  const int workspace = static_cast<int>(work_.size());
  const double automatic = 0;
  std::vector<double> V(size(n_, n_));
  model.x0.resize(static_cast<std::size_t>(n_));
  int warning = 0, info = 0;
  ib01cd_("X", options_.simulation_b_d ? "C" : "U", "D", &n_, &m_, &p_, &rows_, model.A.data(), &n_,
          model.B.data(), &n_, model.C.data(), &p_, model.D.data(), &p_, U, &rows_, Y, &rows_,
          model.x0.data(), V.data(), &n_, &automatic, int_work_.data(), work_.data(), &workspace,
          &warning, &info, 1, 1, 1);
  check("IB01CD", info);
}

}  // namespace reident::bench
