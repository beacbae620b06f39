#include <array>
#include <cstdint>
#include <cstdio>
#include <fcntl.h>
#include <map>
#include <matio.h>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/mman.h>

#include "service/model/model_fields.hpp"
#include "service/model_export/model_export.hpp"
#include "service/model_export/version_head.hpp"

namespace reident::model_export {
namespace {

using identification::Matrix;

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

Variable checked(matvar_t* variable) {
  if (variable == nullptr) throw std::bad_alloc();
  return {variable, &Mat_VarFree};
}

// The library copies what it is given.
Variable variable(const char* name, Matrix values) {
  std::array<std::size_t, 2> sizes = {static_cast<std::size_t>(values.rows()),
                                      static_cast<std::size_t>(values.cols())};
  return checked(
      Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(), values.data(), 0));
}

Variable variable(const char* name, double value) {
  return variable(name, Matrix(Matrix::Constant(1, 1, value)));
}

Variable variable(const char* name, std::int64_t value) {
  return variable(name, static_cast<double>(value));
}

Variable variable(const char* name, std::string value) {
  std::array<std::size_t, 2> sizes = {value.empty() ? 0U : 1U, value.size()};
  return checked(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, sizes.data(), value.data(), 0));
}

/// A column of texts.
Variable column(const char* name, const std::vector<Signal>& signals, std::string Signal::*member) {
  std::array<std::size_t, 2> sizes = {signals.size(), 1};
  Variable cells =
      checked(Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, sizes.data(), nullptr, 0));
  for (std::size_t i = 0; i < signals.size(); ++i)
    Mat_VarSetCell(cells.get(), static_cast<int>(i),
                   variable(nullptr, signals[i].*member).release());
  return cells;
}

Variable column(const char* name, const std::vector<Signal>& signals, double Signal::*member) {
  Matrix values(static_cast<identification::Index>(signals.size()), 1);
  for (identification::Index i = 0; i < values.rows(); ++i)
    values(i) = signals[static_cast<std::size_t>(i)].*member;
  return variable(name, std::move(values));
}

/// The order of variables in a file. Those of one rank stand in the order of the model's fields.
enum class Rank { matrix, number, vector, signals, head, other, optional };

template <class Value>
constexpr Rank rank_of = Rank::other;
template <>
constexpr Rank rank_of<Matrix> = Rank::matrix;
template <>
constexpr Rank rank_of<double> = Rank::number;
template <>
constexpr Rank rank_of<identification::Vector> = Rank::vector;

using Variables = std::multimap<Rank, Variable>;

/// Adds the variables of each field that it visits.
class VariableMaker {
 public:
  explicit VariableMaker(Variables& variables, std::string prefix = "", bool is_optional = false)
      : variables_(variables), prefix_(std::move(prefix)), is_optional_(is_optional) {}

  template <class Member>
  void operator()(const Field& field, const Member& member) const {
    const bool is_optional = is_optional_ || field.presence == Presence::optional;
    if (field.mat.empty() || (field.presence == Presence::optional && is_absent(member))) return;
    const std::string name = prefix_ + std::string(field.mat);
    if constexpr (requires { variable("", member); })
      variables_.emplace(is_optional ? Rank::optional : rank_of<Member>,
                         variable(name.c_str(), member));
    else if constexpr (requires { *member; })
      VariableMaker(variables_, prefix_, true)(field, *member);
    else if constexpr (std::is_same_v<Member, std::vector<Signal>>)
      add_columns(name, member);
    else
      visit_fields(member, VariableMaker(variables_, name, is_optional));
  }

 private:
  void add_columns(const std::string& prefix, const std::vector<Signal>& signals) const {
    visit_signal_members([&](const Field& field, const auto member) {
      const bool of_inputs_alone = field.presence == Presence::optional;
      if (field.mat.empty() || (of_inputs_alone && prefix != "input_")) return;
      const std::string name = prefix + std::string(field.mat);
      variables_.emplace(Rank::signals, column(name.c_str(), signals, member));
    });
  }

  Variables& variables_;
  std::string prefix_;
  bool is_optional_;
};

Variables variables_of(const ExportedVersion& exported) {
  Variables variables;
  visit_fields(exported.version.model, VariableMaker(variables));
  visit_head(exported, [&variables](const char* name, const auto& value) {
    variables.emplace(Rank::head, variable(name, value));
  });
  const identification::Index order = exported.version.model.dynamics.order();
  variables.emplace(Rank::vector,
                    variable("x0", Matrix(exported.start ? exported.start->x
                                                         : identification::Vector::Zero(order))));
  return variables;
}

/// A file in memory, for a library that writes to a path alone.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("reident-mat", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error("no file can be made in memory");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }
  std::string content() const {
    const off_t size = ::lseek(descriptor_, 0, SEEK_END);
    std::string bytes(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
    if (::pread(descriptor_, bytes.data(), bytes.size(), 0) != size)
      throw std::runtime_error("a file in memory cannot be read");
    return bytes;
  }

 private:
  int descriptor_;
};

}  // namespace

std::string mat_file(const ExportedVersion& exported) {
  const ModelVersion& version = exported.version;
  const std::string header =
      fmt::format("MATLAB 5.0 MAT-file, written by reident: version {}", version.number);
  const MemoryFile file;
  std::unique_ptr<mat_t, decltype(&Mat_Close)> mat(
      Mat_CreateVer(file.path().c_str(), header.c_str(), MAT_FT_MAT5), &Mat_Close);
  if (mat == nullptr) throw std::runtime_error("the MATLAB file cannot be begun in memory");
  for (const auto& [rank, variable] : variables_of(exported))
    if (Mat_VarWrite(mat.get(), variable.get(), MAT_COMPRESSION_NONE) != 0)
      throw std::runtime_error(
          fmt::format("the variable {} of the MATLAB file cannot be written", variable->name));
  if (Mat_Close(mat.release()) != 0) throw std::runtime_error("the MATLAB file cannot be ended");
  return file.content();
}

}  // namespace reident::model_export
