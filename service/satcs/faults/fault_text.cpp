// Faults as text, and what is wrong with one.
#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "service/satcs/event_time.hpp"
#include "service/satcs/faults/fault_kind.hpp"
#include "service/support/csv.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

using Subject = FaultFacts::Subject;
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

std::string wrong_subject(const Fault& fault, std::span<const ParameterDescriptor> parameters) {
  const Subject subject = facts(fault.kind).subject;
  const bool is_named = !fault.parameter.empty();
  const bool two = subject == Subject::two_parameters;
  if (subject == Subject::frames && is_named)
    return fmt::format("is about whole frames; leave out '{}'", fault.parameter);
  if (!two && !fault.other.empty())
    return fmt::format("is about one parameter; leave out '{}'", fault.other);
  if (two && (!is_named || fault.other.empty()))
    return "needs two parameters, such as :V_BAT1,V_BAT2";
  if (subject != Subject::frames && subject != Subject::all_or_one && !is_named)
    return "needs a parameter, such as :V_BUS";
  for (const auto& one : {fault.parameter, fault.other}) {
    if (!one.empty() && find(one, parameters) == nullptr) return unknown_parameter(one, parameters);
  }
  if (two && fault.parameter == fault.other)
    return fmt::format("swaps '{}' with itself; name another one", fault.other);
  if (subject == Subject::analog_parameter &&
      find(fault.parameter, parameters)->kind == storage::ParameterKind::digital)
    return fmt::format("needs an analog parameter; '{}' is digital", fault.parameter);
  return {};
}

std::string wrong_magnitude(const Fault& fault) {
  if (!fault.magnitude) return {};
  const double magnitude = *fault.magnitude;
  using Magnitude = FaultFacts::Magnitude;
  switch (facts(fault.kind).magnitude) {
    case Magnitude::none:
      return fmt::format("has no magnitude; leave out '*{}'", magnitude);
    case Magnitude::share:
      return magnitude >= 0 && magnitude <= 1
                 ? ""
                 : fmt::format("takes a share from 0 to 1 as its magnitude; {} is none", magnitude);
    case Magnitude::seconds: {
      constexpr double longest_s = 1e9;
      const bool comes_later = fault.kind == FaultKind::backwards_playback ||
                               fault.kind == FaultKind::duplicated_day ||
                               fault.kind == FaultKind::repeated_day;
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

std::variant<Fault, FaultError> parse_fault(std::string_view text, storage::Time start,
                                            std::uint64_t seed) {
  const auto wrong = [text](const std::string& what) {
    return FaultError{fmt::format("'{}': {}", text, what)};
  };
  const auto at = text.find('@');
  const auto slash = text.find('/');
  if (at == std::string_view::npos || slash == std::string_view::npos || slash < at)
    return wrong(fmt::format("is not {}, such as stuck@+6h/+8h:V_BUS", form));
  Fault fault;
  const FaultFacts* kind = find_facts(text.substr(0, at));
  if (kind == nullptr)
    return wrong(fmt::format("there is no fault '{}'; the faults are: {}", text.substr(0, at),
                             fault_kind_names()));
  fault.kind = kind->kind;
  fault.seed = seed;

  std::string_view to = text.substr(slash + 1);
  if (const auto digits = cut_after_last(to, '#')) {
    const auto [end, error] =
        std::from_chars(digits->data(), digits->data() + digits->size(), fault.seed);
    if (error != std::errc{} || end != digits->data() + digits->size())
      return wrong(fmt::format("'{}' is not a seed, a whole number from 0", *digits));
  }
  if (const auto magnitude = cut_after_last(to, '*')) {
    fault.magnitude = csv::to_number(*magnitude);
    if (!fault.magnitude) return wrong(fmt::format("'{}' is not a number", *magnitude));
  }
  const std::string_view from = text.substr(at + 1, slash - at - 1);
  // Times have colons themselves.
  if (!parse_event_time(to, start)) {
    if (const auto names = cut_after_last(to, ':')) {
      const auto comma = names->find(',');
      fault.parameter = names->substr(0, comma);
      if (comma != std::string_view::npos) fault.other = names->substr(comma + 1);
    }
  }
  for (const auto& [moment, bound] : {std::pair{from, &fault.when.begin}, {to, &fault.when.end}}) {
    const auto time = parse_event_time(moment, start);
    if (!time) return wrong(fmt::format("'{}' is neither {}", moment, event_time_form));
    *bound = *time;
  }
  return fault;
}

std::optional<FaultError> obstacle(const Fault& fault,
                                   std::span<const ParameterDescriptor> parameters) {
  std::string what;
  if (fault.when.begin >= fault.when.end)
    what = fmt::format("ends at {}, which is not after its beginning at {}",
                       time_text(fault.when.end), time_text(fault.when.begin));
  if (what.empty()) what = wrong_subject(fault, parameters);
  if (what.empty()) what = wrong_magnitude(fault);
  if (what.empty()) return std::nullopt;
  return FaultError{fmt::format("the fault {} {}", name(fault.kind), what)};
}

}  // namespace reident::satcs
