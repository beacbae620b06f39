// Lies as text, and what is wrong with one.
#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "service/satcs/event_time.hpp"
#include "service/satcs/faults/lie_kind.hpp"
#include "service/support/csv.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

using Subject = LieFacts::Subject;
using storage::ParameterDescriptor;

constexpr std::string_view form = "KIND@FROM/TO[:PARAMETER[,OTHER]][*MAGNITUDE][#SEED]";

std::string unknown_parameter(std::string_view name,
                              std::span<const ParameterDescriptor> parameters) {
  std::string known;
  for (const auto& parameter : parameters) known += (known.empty() ? "" : ", ") + parameter.name;
  return fmt::format("names no parameter: '{}'; the parameters are: {}", name, known);
}

const ParameterDescriptor* find(std::string_view name,
                                std::span<const ParameterDescriptor> parameters) {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [name](const auto& one) { return one.name == name; });
  return found == parameters.end() ? nullptr : &*found;
}

std::string wrong_subject(const Lie& lie, std::span<const ParameterDescriptor> parameters) {
  const Subject subject = facts(lie.kind).subject;
  const bool is_named = !lie.parameter.empty();
  const bool two = subject == Subject::two_parameters;
  if (subject == Subject::frames && is_named)
    return fmt::format("is about whole frames; leave out '{}'", lie.parameter);
  if (!two && !lie.other.empty())
    return fmt::format("is about one parameter; leave out '{}'", lie.other);
  if (two && (!is_named || lie.other.empty()))
    return "needs two parameters, such as :V_BAT1,V_BAT2";
  if (subject != Subject::frames && subject != Subject::all_or_one && !is_named)
    return "needs a parameter, such as :V_BUS";
  for (const auto& one : {lie.parameter, lie.other}) {
    if (!one.empty() && find(one, parameters) == nullptr) return unknown_parameter(one, parameters);
  }
  if (two && lie.parameter == lie.other)
    return fmt::format("swaps '{}' with itself; name another one", lie.other);
  if (subject == Subject::analog_parameter &&
      find(lie.parameter, parameters)->kind == storage::ParameterKind::digital)
    return fmt::format("needs an analog parameter; '{}' is digital", lie.parameter);
  return {};
}

std::string wrong_magnitude(const Lie& lie) {
  if (!lie.magnitude) return {};
  const double magnitude = *lie.magnitude;
  using Magnitude = LieFacts::Magnitude;
  switch (facts(lie.kind).magnitude) {
    case Magnitude::none:
      return fmt::format("has no magnitude; leave out '*{}'", magnitude);
    case Magnitude::share:
      return magnitude >= 0 && magnitude <= 1
                 ? ""
                 : fmt::format("takes a share from 0 to 1 as its magnitude; {} is none", magnitude);
    case Magnitude::seconds: {
      constexpr double longest_s = 1e9;
      const bool comes_later = lie.kind == LieKind::backwards_playback ||
                               lie.kind == LieKind::duplicated_day ||
                               lie.kind == LieKind::repeated_day;
      if (std::abs(magnitude) <= longest_s && (!comes_later || magnitude >= 0)) return {};
      return fmt::format("takes seconds from {} to {:g} as its magnitude; {} is out of that range",
                         comes_later ? "0" : "-1e+09", longest_s, magnitude);
    }
    case Magnitude::of_parameter:
    case Magnitude::gain:
      break;
  }
  return std::isfinite(magnitude) ? "" : "needs a finite magnitude";
}

}  // namespace

std::variant<Lie, LieError> parse_lie(std::string_view text, storage::Time start,
                                      std::uint64_t seed) {
  const auto wrong = [text](const std::string& what) {
    return LieError{fmt::format("'{}': {}", text, what)};
  };
  const auto at = text.find('@');
  const auto slash = text.find('/');
  if (at == std::string_view::npos || slash == std::string_view::npos || slash < at)
    return wrong(fmt::format("is not {}, such as stuck@+6h/+8h:V_BUS", form));
  Lie lie;
  const LieFacts* kind = find_facts(text.substr(0, at));
  if (kind == nullptr)
    return wrong(fmt::format("there is no lie '{}'; the lies are: {}", text.substr(0, at),
                             lie_kind_names()));
  lie.kind = kind->kind;
  lie.seed = seed;

  std::string_view to = text.substr(slash + 1);
  if (const auto digits = cut_after_last(to, '#')) {
    const auto [end, error] =
        std::from_chars(digits->data(), digits->data() + digits->size(), lie.seed);
    if (error != std::errc{} || end != digits->data() + digits->size())
      return wrong(fmt::format("'{}' is not a seed, a whole number from 0", *digits));
  }
  if (const auto magnitude = cut_after_last(to, '*')) {
    lie.magnitude = csv::to_number(*magnitude);
    if (!lie.magnitude) return wrong(fmt::format("'{}' is not a number", *magnitude));
  }
  const std::string_view from = text.substr(at + 1, slash - at - 1);
  // Times have colons themselves.
  if (!parse_event_time(to, start)) {
    if (const auto names = cut_after_last(to, ':')) {
      const auto comma = names->find(',');
      lie.parameter = names->substr(0, comma);
      if (comma != std::string_view::npos) lie.other = names->substr(comma + 1);
    }
  }
  for (const auto& [moment, bound] : {std::pair{from, &lie.when.begin}, {to, &lie.when.end}}) {
    const auto time = parse_event_time(moment, start);
    if (!time) return wrong(fmt::format("'{}' is neither {}", moment, event_time_form));
    *bound = *time;
  }
  return lie;
}

std::optional<LieError> obstacle(const Lie& lie, std::span<const ParameterDescriptor> parameters) {
  std::string what;
  if (lie.when.begin >= lie.when.end)
    what = fmt::format("ends at {}, which is not after its beginning at {}",
                       time_text(lie.when.end), time_text(lie.when.begin));
  if (what.empty()) what = wrong_subject(lie, parameters);
  if (what.empty()) what = wrong_magnitude(lie);
  if (what.empty()) return std::nullopt;
  return LieError{fmt::format("the lie {} {}", name(lie.kind), what)};
}

}  // namespace reident::satcs
