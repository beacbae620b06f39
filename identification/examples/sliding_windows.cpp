// Identifies a model again at each position of a sliding window. The sums of the samples that were
// in the window before are kept: a window reads its new samples alone, and gives the same bits as
// one that reads them all.
#include <cstdio>
#include <random>
#include <variant>

#include "identification/correction/pole_placement_search.hpp"
#include "identification/samples/tick_ranges.hpp"
#include "identification/search/identify.hpp"

using namespace reident::identification;

int main() {
  // A converter whose gain falls as it ages, every second for four hours. Frames are lost in the
  // second hour.
  constexpr Index seconds = 4 * 3600, window = 3600, slide = 1200;
  const auto gain_at = [](double second) { return 2 - 0.5 * second / double(seconds); };
  std::mt19937_64 generator(2);
  const auto uniform = [&generator] { return double(generator() >> 11) * 0x1p-53; };
  Matrix u(seconds, 1), y(seconds, 1);
  double state = 0;
  for (Index k = 0; k < seconds; ++k) {
    u(k, 0) = k % 15 == 0 ? 10 * uniform() : u(k - 1, 0);
    y(k, 0) = state + 0.1 * (uniform() - 0.5);
    state = 0.9 * state + 0.1 * gain_at(double(k)) * u(k, 0);
  }
  const Record record = without(contiguous_record(1, u, y), {{5000, 5090}});

  IdentifyOptions options;
  options.order = 1;  // a second one would take the slow change for a mode of the converter
  const LagSums::Shape shape{2, block_rows_needed(options), slide};
  LagSums kept(shape);
  for (Index end = window; end <= seconds; end += slide) {
    const TickRange ticks{end - window, end};
    Index read = 0;
    for (const TickRange& missing : kept.missing(ticks)) read += missing.end - missing.begin;
    const RowRange rows{first_row_at(record, ticks.begin), first_row_at(record, ticks.end)};
    const IdentifyResult result = identify(record, rows, options, &kept);
    kept.forget({ticks.begin, ticks.begin + slide});  // no later window needs these
    if (const auto* verdict = std::get_if<Verdict>(&result)) {
      std::printf("window to %5td s: no model: %s\n", end, verdict->reason.c_str());
      continue;
    }
    const auto& found = std::get<Identified>(result);
    LagSums nothing(shape);
    const auto again = std::get<Identified>(identify(record, rows, options, &nothing));
    const auto gain = static_gain(found.model);
    std::printf("window to %5td s: %4td s read, gain %.3f (true: %.3f), %s\n", end, read,
                gain ? (*gain)(0, 0) : 0.0, gain_at(double(end) - window / 2.0),
                again.model.A == found.model.A ? "the bits of all samples" : "other bits");
  }
}
