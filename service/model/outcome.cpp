#include "service/model/outcome.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace reident {
namespace {

constexpr std::array names{
    std::pair{Outcome::approved, std::string_view("approved")},
    std::pair{Outcome::waiting, std::string_view("waiting")},
    std::pair{Outcome::unvouched, std::string_view("unvouched")},
    std::pair{Outcome::held, std::string_view("held")},
    std::pair{Outcome::on_probation, std::string_view("on_probation")},
    std::pair{Outcome::unknown_parameter, std::string_view("unknown_parameter")},
    std::pair{Outcome::telemetry_damaged, std::string_view("telemetry_damaged")},
    std::pair{Outcome::low_coverage, std::string_view("low_coverage")},
    std::pair{Outcome::implausible, std::string_view("implausible")},
    std::pair{Outcome::validation_says_nothing, std::string_view("validation_says_nothing")},
    std::pair{Outcome::not_finite, std::string_view("not_finite")},
    std::pair{Outcome::unstable, std::string_view("unstable")},
    std::pair{Outcome::slower_than_window, std::string_view("slower_than_window")},
    std::pair{Outcome::error_above_limit, std::string_view("error_above_limit")},
    std::pair{Outcome::fit_below_limit, std::string_view("fit_below_limit")},
    std::pair{Outcome::residual_out_of_range, std::string_view("residual_out_of_range")},
    std::pair{Outcome::inputs_out_of_range, std::string_view("inputs_out_of_range")},
    std::pair{Outcome::not_better_than_baseline, std::string_view("not_better_than_baseline")},
    std::pair{Outcome::older_than_champion, std::string_view("older_than_champion")},
    std::pair{Outcome::telemetry_in_doubt, std::string_view("telemetry_in_doubt")},
    std::pair{Outcome::comparison_says_nothing, std::string_view("comparison_says_nothing")},
    std::pair{Outcome::not_better_than_champion, std::string_view("not_better_than_champion")},
    std::pair{Outcome::disagrees_with_champion, std::string_view("disagrees_with_champion")},
    std::pair{Outcome::too_soon, std::string_view("too_soon")},
};

}  // namespace

std::string_view name(Outcome outcome) {
  return names[static_cast<std::size_t>(outcome)].second;
}

}  // namespace reident
