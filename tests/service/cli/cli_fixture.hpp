// The real program, run in a folder of the test's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"

namespace reident::cli::test {

struct Ran {
  int status = -1;  // exit status, or 128 + the signal that ended it
  std::string out;
  std::string err;
};

class CliTest : public ::testing::Test {
 protected:
  /// Runs reident with the folder as the current one.
  Ran reident(const std::vector<std::string>& arguments) const;
  /// Runs it with a terminal of so many columns as its output and its standard error. The lines
  /// that it shows there, without colours.
  std::vector<std::string> lines_on_terminal(const std::vector<std::string>& arguments,
                                             unsigned short columns) const;
  /// Runs it and expects exit status 0; its output as JSON.
  nlohmann::json json_of(std::vector<std::string> arguments) const;
  /// Runs it and expects exit status 2 with one line on standard error; the line.
  std::string refusal_of(const std::vector<std::string>& arguments) const;

  void write(const std::string& name, const std::string& text) const;
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  const reident::test::TemporaryFolder folder_;
};

}  // namespace reident::cli::test
