#include "tests/bench/identification/samples.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace reident::bench {
namespace {

constexpr std::array<char, 8> magic = {'R', 'E', 'I', 'D', 'S', 'M', 'P', '1'};
constexpr std::int64_t max_values = std::int64_t{1} << 32;

struct Header {
  std::array<char, 8> magic;
  std::int64_t rows, inputs, outputs;
};

std::streamsize bytes(const std::vector<double>& values) {
  return static_cast<std::streamsize>(values.size() * sizeof(double));
}

}  // namespace

Samples read_samples(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + " cannot be opened; is the path right?");
  Header header{};
  in.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!in || header.magic != magic)
    throw std::runtime_error(file.string() + " is no file of samples; write one with generate");
  const std::int64_t channels = header.inputs + header.outputs;
  if (header.rows < 0 || header.inputs < 0 || header.outputs < 1 || channels > 1000 ||
      header.rows > max_values / channels)
    throw std::runtime_error(file.string() + " has a damaged header; write it again");
  Samples samples{header.rows, header.inputs, header.outputs, {}};
  samples.values.resize(static_cast<std::size_t>(header.rows * channels));
  in.read(reinterpret_cast<char*>(samples.values.data()), bytes(samples.values));
  if (!in) throw std::runtime_error(file.string() + " ends too early; write it again");
  return samples;
}

void write_samples(const std::filesystem::path& file, const Samples& samples) {
  std::ofstream out(file, std::ios::binary);
  const Header header{magic, samples.rows, samples.inputs, samples.outputs};
  out.write(reinterpret_cast<const char*>(&header), sizeof header);
  out.write(reinterpret_cast<const char*>(samples.values.data()), bytes(samples.values));
  out.close();
  if (!out) throw std::runtime_error(file.string() + " cannot be written; is the disk full?");
}

}  // namespace reident::bench
