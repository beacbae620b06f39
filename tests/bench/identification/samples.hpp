// The file of samples that the programs of the comparison share:
//
//   | bytes            | what                                                              |
//   |------------------|-------------------------------------------------------------------|
//   | 8                | "REIDSMP1"                                                        |
//   | 3 x 8            | rows N >= 0, inputs m >= 0, outputs p >= 1, signed integers       |
//   | 8 N (m + p)      | doubles: input 1 of all rows, ..., input m, output 1, ..., output p |
//
// in the byte order of the machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace reident::bench {

struct Samples {
  std::int64_t rows = 0;
  std::int64_t inputs = 0;
  std::int64_t outputs = 0;
  std::vector<double> values;  // column-major, rows x (inputs + outputs)
};

/// Throws std::runtime_error that names the file and what is wrong with it.
Samples read_samples(const std::filesystem::path& file);
void write_samples(const std::filesystem::path& file, const Samples& samples);

}  // namespace reident::bench
