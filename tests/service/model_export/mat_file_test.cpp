// What a MATLAB file holds: every variable, in its order, with its class, sizes and values.
#include <array>
#include <charconv>
#include <fstream>
#include <matio.h>
#include <memory>

#include <gtest/gtest.h>

#include "service/model_export/model_export.hpp"
#include "tests/service/model/example_model.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test::mat_file_test {
namespace {

std::string described(const matvar_t& variable) {
  const std::size_t count = variable.dims[0] * variable.dims[1];
  std::string text = std::to_string(variable.dims[0]) + "x" + std::to_string(variable.dims[1]);
  if (variable.class_type == MAT_C_CHAR)
    return text + " '" + std::string(static_cast<const char*>(variable.data), count) + "'";
  for (std::size_t i = 0; i < count; ++i) {
    text += ' ';
    if (variable.class_type == MAT_C_CELL) {
      text += described(*static_cast<matvar_t**>(variable.data)[i]);
    } else if (variable.class_type == MAT_C_DOUBLE) {
      std::array<char, 32> digits{};  // so many that the same bits come back
      const double value = static_cast<const double*>(variable.data)[i];
      text.append(digits.data(),
                  std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
    }
  }
  return text;
}

/// One variable a line.
std::string content_of(const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = (folder / "version.mat").string();
  std::ofstream(path, std::ios::binary) << bytes;
  const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                          &Mat_Close);
  std::string text;
  while (file != nullptr) {
    const std::unique_ptr<matvar_t, decltype(&Mat_VarFree)> variable(Mat_VarReadNext(file.get()),
                                                                     &Mat_VarFree);
    if (variable == nullptr) break;
    text += std::string(variable->name) + " " + described(*variable) + "\n";
  }
  return text;
}

TEST(MatFile, HoldsTheVariablesThatItAlwaysHeld) {
  model_export::ExportedVersion exported{example_version(3), "superseded"};
  exported.version.model = full_example_model();
  exported.version.digest = model_digest(exported.version.model);
  EXPECT_EQ(content_of(model_export::mat_file(exported)),
            R"(A 2x2 0.9 -0.2 0.1 0.7
B 2x2 0.5 0.125 0.25 0.3333333333333333
C 1x2 1 -0.5
D 1x2 0.1 0
K 2x1 0.3 0.2
Ts 1x1 1
u0 2x1 2.5 1.5
y0 1x1 4.25
x0 2x1 0 0
input_names 2x1 1x8 'I_BDRIN1' 1x4 'P_IN'
input_units 2x1 1x1 'A' 1x1 'W'
input_expressions 2x1 0x0 '' 1x16 'V_BUS * I_BDRIN2'
output_names 1x1 1x8 'I_BDROUT'
output_units 1x1 1x1 'A'
spacecraft 1x6 'CBERS4'
equipment 1x3 'BDR'
version 1x1 3
digest 1x64 '10128ba884ce968e9f617aaa343c60dba711522cf1a4c03e8b2ea8091a2b3960'
status 1x10 'superseded'
decided 1x30 '1970-01-01T00:00:00.000000042Z'
decided_by 1x4 'gate'
method 1x26 'N4SID, horizon 12, order 2'
tracking_state 2x2 0.5 0.3333333333333333 -1 0
tracking_integral 2x2 0.1 -0.3 0.2 0.7
tracking_error_limit 1x1 2.5
)");
}

TEST(MatFile, OfAModelWithoutGainsHasAnEmptyKAndNoTracking) {
  model_export::ExportedVersion exported{example_version(3), "approved"};
  exported.version.model.dynamics.K.resize(0, 0);
  const std::string content = content_of(model_export::mat_file(exported));
  EXPECT_NE(content.find("\nK 0x0\n"), std::string::npos);
  EXPECT_EQ(content.find("tracking"), std::string::npos);
}

}  // namespace
}  // namespace reident::test::mat_file_test
