// slicot_n4sid FILE --order N --horizon S: one identification by SLICOT, as JSON.
#include <cstdio>
#include <dlfcn.h>
#include <exception>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tests/bench/identification/measure.hpp"
#include "tests/bench/identification/slicot.hpp"

namespace {

using namespace reident::bench;
using nlohmann::ordered_json;

/// Arrays of rows from a column-major matrix.
ordered_json rows_of(const std::vector<double>& matrix, int rows, int columns) {
  ordered_json result = ordered_json::array();
  for (int r = 0; r < rows; ++r) {
    ordered_json row = ordered_json::array();
    for (int c = 0; c < columns; ++c) row.push_back(matrix[static_cast<std::size_t>(c * rows + r)]);
    result.push_back(std::move(row));
  }
  return result;
}

/// What multiplies SLICOT's matrices: the loader chooses it, so that it is asked for at run time.
std::string blas() {
  using Description = char* (*)();
  const auto openblas = reinterpret_cast<Description>(dlsym(RTLD_DEFAULT, "openblas_get_config"));
  return openblas ? openblas() : "not OpenBLAS";
}

int run(const std::filesystem::path& file, const SlicotOptions& options, int repeats) {
  Samples samples = read_samples(file);
  std::optional<Slicot> slicot;
  SlicotModel model;
  const Measurement measured = measure(repeats, [&] {
    if (!slicot) slicot.emplace(std::move(samples), options);  // counts as memory, not as time
    model = slicot->identify();
  });
  const ordered_json result = {
      {"order", model.order},
      {"horizon", options.block_rows},
      {"A", rows_of(model.A, model.order, model.order)},
      {"B", rows_of(model.B, model.order, model.inputs)},
      {"C", rows_of(model.C, model.outputs, model.order)},
      {"D", rows_of(model.D, model.outputs, model.inputs)},
      {"K", rows_of(model.K, model.K.empty() ? 0 : model.order, model.outputs)},
      {"x0", model.x0},
      {"singular_values", model.singular_values},
      {"cpu_ms", measured.cpu_ms},
      {"wall_ms", measured.wall_ms},
      {"peak_extra_mib", measured.peak_extra_mib},
      {"blas", blas()}};
  std::printf("%s\n", result.dump().c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("One identification by SLICOT (IB01AD, IB01BD, IB01CD) from a file of samples");
  std::filesystem::path file;
  SlicotOptions options;
  std::string algorithm = "C";
  int repeats = 1;
  app.add_option("file", file, "file of samples")->required();
  app.add_option("--order", options.order, "number of states")->required();
  app.add_option("--horizon", options.block_rows, "block rows")->required();
  app.add_option("--method", options.method, "way to A, B, C and D")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Method>{
          {"n4sid", Method::n4sid}, {"moen4", Method::moen4}, {"moesp", Method::moesp}}));
  app.add_option("--algorithm", algorithm, "compression: C Cholesky, F fast QR, Q QR")
      ->check(CLI::IsMember({"C", "F", "Q"}));
  app.add_option("--batch", options.batch_rows, "rows compressed at once; 0: all");
  app.add_flag("--simulation-b-d", options.simulation_b_d,
               "B, D and x0 by least squares on the simulated output");
  app.add_flag("!--no-kalman-gain", options.kalman_gain, "leave K out");
  app.add_option("--repeats", repeats, "timed repeats")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  options.algorithm = algorithm.front();
  try {
    return run(file, options, repeats);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slicot_n4sid: %s\n", error.what());
    return 1;
  }
}
