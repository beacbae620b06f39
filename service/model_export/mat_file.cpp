#include <array>
#include <cstdint>
#include <cstdio>
#include <fcntl.h>
#include <functional>
#include <matio.h>
#include <memory>
#include <stdexcept>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/mman.h>

#include "service/model_export/model_export.hpp"
#include "service/support/time_text.hpp"

namespace reident::model_export {
namespace {

using identification::Matrix;

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

Variable checked(matvar_t* variable) {
  if (variable == nullptr) throw std::bad_alloc();
  return {variable, &Mat_VarFree};
}

// The library copies what it is given.
Variable matrix(const char* name, Matrix values) {
  std::array<std::size_t, 2> sizes = {static_cast<std::size_t>(values.rows()),
                                      static_cast<std::size_t>(values.cols())};
  return checked(
      Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(), values.data(), 0));
}

Variable number(const char* name, double value) {
  return matrix(name, Matrix::Constant(1, 1, value));
}

Variable text(const char* name, std::string value) {
  std::array<std::size_t, 2> sizes = {value.empty() ? 0U : 1U, value.size()};
  return checked(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, sizes.data(), value.data(), 0));
}

/// A column of texts.
Variable texts(const char* name, const std::vector<Signal>& signals, std::string Signal::*member) {
  std::array<std::size_t, 2> sizes = {signals.size(), 1};
  Variable cells =
      checked(Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, sizes.data(), nullptr, 0));
  for (std::size_t i = 0; i < signals.size(); ++i)
    Mat_VarSetCell(cells.get(), static_cast<int>(i), text(nullptr, signals[i].*member).release());
  return cells;
}

std::vector<Variable> variables_of(const ExportedVersion& exported) {
  const ModelVersion& version = exported.version;
  const EquipmentModel& model = version.model;
  const identification::StateSpaceModel& dynamics = model.dynamics;
  std::vector<Variable> list;
  list.push_back(matrix("A", dynamics.A));
  list.push_back(matrix("B", dynamics.B));
  list.push_back(matrix("C", dynamics.C));
  list.push_back(matrix("D", dynamics.D));
  list.push_back(matrix("K", dynamics.K));
  list.push_back(number("Ts", dynamics.period_s));
  list.push_back(matrix("u0", dynamics.u0));
  list.push_back(matrix("y0", dynamics.y0));
  list.push_back(texts("input_names", model.inputs, &Signal::name));
  list.push_back(texts("input_units", model.inputs, &Signal::unit));
  list.push_back(texts("input_expressions", model.inputs, &Signal::expression));
  list.push_back(texts("output_names", model.outputs, &Signal::name));
  list.push_back(texts("output_units", model.outputs, &Signal::unit));
  list.push_back(text("spacecraft", model.spacecraft));
  list.push_back(text("equipment", model.equipment));
  list.push_back(number("version", static_cast<double>(version.number)));
  list.push_back(text("digest", version.digest));
  list.push_back(text("status", exported.status));
  list.push_back(text("decided", time_text(version.decided)));
  list.push_back(text("decided_by", version.decided_by));
  list.push_back(text("method", model.method));
  if (model.tracking) {
    list.push_back(matrix("tracking_state", model.tracking->gain.state));
    list.push_back(matrix("tracking_integral", model.tracking->gain.integral));
    list.push_back(matrix("tracking_error_limit", model.tracking->gain.error_limit));
  }
  return list;
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
  for (const Variable& variable : variables_of(exported))
    if (Mat_VarWrite(mat.get(), variable.get(), MAT_COMPRESSION_NONE) != 0)
      throw std::runtime_error(
          fmt::format("the variable {} of the MATLAB file cannot be written", variable->name));
  if (Mat_Close(mat.release()) != 0) throw std::runtime_error("the MATLAB file cannot be ended");
  return file.content();
}

}  // namespace reident::model_export
