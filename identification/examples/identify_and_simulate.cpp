// Identifies a model from arrays of samples, and simulates it on samples that it has not seen.
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "identification/search/identify.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"

using namespace reident::identification;

int main() {
  // The samples of a battery, every 10 s: heater power [W], current [A] and temperature [degC].
  constexpr Index rows = 3000, seen = 2000;
  std::vector<double> inputs(2 * rows), outputs(rows);
  std::mt19937_64 generator(1);
  const auto uniform = [&generator] { return double(generator() >> 11) * 0x1p-53; };
  double heater = 0, fast = 0, slow = 0;
  for (Index k = 0; k < rows; ++k) {
    if (k % 40 == 0) heater = 25 * uniform();
    const double current = 4 + uniform();
    inputs[std::size_t(k)] = heater;  // column after column, as Eigen stores them
    inputs[std::size_t(rows + k)] = current;
    outputs[std::size_t(k)] = 10 + fast + slow + 0.1 * (uniform() - 0.5);
    fast = 0.6 * fast + 0.02 * heater;
    slow = 0.97 * slow + 0.01 * heater + 0.05 * current;
  }
  const Record record = contiguous_record(10, Eigen::Map<Matrix>(inputs.data(), rows, 2),
                                          Eigen::Map<Matrix>(outputs.data(), rows, 1));

  IdentifyOptions options;
  options.input_names = {"heater power", "current"};
  options.output_names = {"temperature"};
  const IdentifyResult result = identify(record, {0, seen}, options);
  if (const auto* verdict = std::get_if<Verdict>(&result)) {
    std::fprintf(stderr, "no model: %s\n", verdict->reason.c_str());
    return 1;
  }
  const auto& found = std::get<Identified>(result);
  for (const std::string& warning : found.warnings) std::printf("warning: %s\n", warning.c_str());
  std::printf("order %d, horizon %d, weighting %s\n", found.recipe.order, found.recipe.horizon,
              std::string(name(found.recipe.weighting)).c_str());
  std::printf("slowest time constant %.0f s (true: %.0f s)\n", slowest_time_constant_s(found.model),
              -10 / std::log(0.97));

  // A run over all rows from the state at the first one, on the inputs alone.
  const Matrix y_hat = free_run(found.model, record, record.all(), found.x0);
  for (const Index k : {seen, seen + 500, rows - 1})
    std::printf("row %td: measured %.2f degC, simulated %.2f degC\n", k, record.y(k, 0),
                y_hat(k, 0));
  const Score unseen = score_free_run(found.model, record, record.all(), {seen, rows}, found.x0);
  std::printf("error on unseen rows %.2f %%, fit %.1f %%\n", unseen.mrse(), unseen.fit());
}
