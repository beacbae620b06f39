#include "service/cli/output/dynamics_panels.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "identification/numerics/decompositions.hpp"
#include "service/cli/model_comparison.hpp"
#include "service/cli/output/axis.hpp"

namespace reident::cli {
namespace {

std::string duration_words(double seconds) {
  if (seconds < 10'000) return fmt::format("{:.3g} s", seconds);
  if (seconds < 200'000) return fmt::format("{:.3g} h", seconds / 3600);
  return seconds < 1e10 ? fmt::format("{:.3g} d", seconds / 86400) : "never decays";
}

void draw_pole_list(Svg& svg, const identification::StateSpaceModel& dynamics, double x, double y) {
  constexpr std::size_t most = 10;
  const std::vector<Pole> poles = poles_of(dynamics);
  svg.text({x, y}, "time constants", "heading");
  for (std::size_t i = 0; i < std::min(most, poles.size()); ++i) {
    std::string words = duration_words(poles[i].time_constant_s);
    if (poles[i].frequency_hz > 0) words += fmt::format(", {:.3g} Hz", poles[i].frequency_hz);
    svg.text({x, y + 18 + 16 * static_cast<double>(i)}, words, "small");
  }
  if (poles.size() > most)
    svg.text({x, y + 18 + 16 * static_cast<double>(most)},
             fmt::format("and {} more", poles.size() - most), "small");
}

}  // namespace

void draw_singular_values(Svg& svg, const std::vector<double>& singular_values,
                          identification::Index chosen_order, const Box& box) {
  svg.text({box.x, box.y - 7}, "singular values", "heading");
  std::vector<double> values;  // that have a logarithm
  for (const double value : singular_values)
    if (value > 0 && values.size() < 60) values.push_back(value);
  if (values.empty()) {
    svg.text({box.x, box.y + 16}, "not recorded", "small");
    return;
  }
  svg.begin_group("singular-values");
  const double most = std::floor(std::log10(values.front()) + 0.1) + 1;  // room above
  const double least = std::floor(std::log10(values.back()));
  const Scale y{least, most, box.bottom(), box.y};
  const Scale x{0.5, static_cast<double>(values.size()) + 0.5, box.x, box.right()};
  const double step = std::max(1.0, std::ceil((most - least) / 6));
  for (double power = least; power <= most; power += step) {
    svg.line({box.x, y(power)}, {box.right(), y(power)}, "grid");
    svg.text({box.x - 6, y(power) + 4}, fmt::format("1e{:.0f}", power), "small", "end");
  }
  for (const Tick& tick : ticks_of(x, 10))
    if (tick.value == std::floor(tick.value))
      svg.text({x(tick.value), box.bottom() + 16}, fmt::format("{:.0f}", tick.value), "small",
               "middle");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Point at{x(static_cast<double>(i + 1)), y(std::log10(values[i]))};
    svg.line({at.x, box.bottom()}, at, "stem");
    svg.circle(at, 3, "value");
  }
  svg.rectangle(box, "frame");
  svg.end_group();
  const double order = x(static_cast<double>(chosen_order) + 0.5);
  svg.line({order, box.y}, {order, box.bottom()}, "order");
  svg.text({order + 6, box.y + 16}, fmt::format("order {}", chosen_order), "small");
  svg.text({box.x + box.width / 2, box.bottom() + 34}, "number", "small", "middle");
}

void draw_poles(Svg& svg, const identification::StateSpaceModel& dynamics, const Box& box) {
  svg.text({box.x, box.y - 7}, "poles in the unit circle", "heading");
  const double reach = 1.15 * std::max(1.0, spectral_radius(dynamics));
  const Scale x{-reach, reach, box.x, box.right()}, y{-reach, reach, box.bottom(), box.y};
  for (const double mark : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    svg.line({x(mark), box.y}, {x(mark), box.bottom()}, "grid");
    svg.line({box.x, y(mark)}, {box.right(), y(mark)}, "grid");
    svg.text({x(mark), box.bottom() + 16}, fmt::format("{:g}", mark), "small", "middle");
    svg.text({box.x - 6, y(mark) + 4}, fmt::format("{:g}", mark), "small", "end");
  }
  svg.rectangle(box, "frame");
  svg.circle({x(0), y(0)}, x(1) - x(0), "circle");
  svg.text({box.x + box.width / 2, box.bottom() + 34}, "real part", "small", "middle");
  svg.turned_text({box.x - 38, box.y + box.height / 2}, "imaginary part", "small");
  svg.begin_group("poles");
  if (dynamics.order() > 0)
    for (const std::complex<double>& pole : identification::eigenvalues(dynamics.A))
      svg.cross({x(pole.real()), y(pole.imag())}, 5, "pole");
  svg.end_group();
  draw_pole_list(svg, dynamics, box.right() + 16, box.y + 10);
}

}  // namespace reident::cli
