// Reasons: a code and figures, of which the catalogue makes the sentence and the JSON.
//
//   because<ReasonCode::unstable>(1.25)
//   sentences  "The model is unstable: its spectral radius is 1.250000."
//   to_json    [{"code": "unstable", "spectral_radius": 1.25}]
//
// A code without a row in the catalogue, and figures that are not those of its sentence, are not
// compiled.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "service/model/reason_catalogue.hpp"

namespace reident {

/// What a sentence shows at one place; which type, its format says (reason_catalogue.hpp).
using Figure = std::variant<double, std::int64_t, std::string>;

/// Made by because(), which checks the figures when it is compiled.
struct Reason {
  ReasonCode code;
  std::vector<Figure> figures;  // in the order of the sentence
  bool operator==(const Reason&) const = default;
};

/// Where a sentence has a figure: {name:format}.
struct FigurePlace {
  std::size_t begin, end;
  std::string_view name;
  std::string_view format;
};

/// Returns the first figure of the sentence at `from` or behind it; absent where none is left.
/// Requires each bracket to be closed.
constexpr std::optional<FigurePlace> next_figure(std::string_view sentence, std::size_t from) {
  const std::size_t begin = sentence.find('{', from);
  if (begin == std::string_view::npos) return std::nullopt;
  const std::size_t end = sentence.find('}', begin) + 1;
  const std::string_view inside = sentence.substr(begin + 1, end - begin - 2);
  const std::size_t name_end = std::min(inside.find(':'), inside.size());
  return FigurePlace{begin, end, inside.substr(0, name_end),
                     name_end < inside.size() ? inside.substr(name_end + 1) : ""};
}

/// Returns the code's row. Throws std::logic_error where there is none; a constant expression is
/// not compiled then.
constexpr const ReasonRow& row_of(ReasonCode code) {
  for (const ReasonRow& row : Catalogue::reasons)
    if (row.code == code) return row;
  throw std::logic_error("a reason that the catalogue does not have");
}

/// The type of Figure that a value becomes: real, integer or text.
template <typename Value>
using FigureOf =
    std::conditional_t<std::is_floating_point_v<Value>, double,
                       std::conditional_t<std::is_integral_v<Value>, std::int64_t, std::string>>;

/// Whether figures of this type are written in this format.
template <typename Type>
constexpr bool has_format(std::string_view format) {
  if (std::is_same_v<Type, double>) return format.ends_with('f') || format.ends_with('g');
  if (std::is_same_v<Type, std::int64_t>)
    return format == "d" || format == "time" || format == "duration";
  return format.empty();
}

/// Whether figures of these types, in this order, are all that the sentence has.
template <typename... Types>
constexpr bool are_figures_of(std::string_view sentence) {
  std::size_t at = 0;
  [[maybe_unused]] const auto is_next = [&]<typename Type>(std::type_identity<Type>) {
    const auto place = next_figure(sentence, at);
    if (place) at = place->end;
    return place && has_format<Type>(place->format);
  };
  return (is_next(std::type_identity<Types>()) && ...) && !next_figure(sentence, at);
}

/// Returns a reason with its figures in the order of its sentence.
template <ReasonCode code, typename... Values>
Reason because(Values&&... values) {
  static_assert(are_figures_of<FigureOf<std::remove_cvref_t<Values>>...>(row_of(code).sentence),
                "the figures are not those of the sentence");
  return {code, {FigureOf<std::remove_cvref_t<Values>>(std::forward<Values>(values))...}};
}

/// Returns the name that JSON, the registry and the topics have.
std::string_view name(Outcome outcome);
std::string_view name(ReasonCode code);

/// The first decision about a version of an attempt with this outcome. Throws std::logic_error for
/// an outcome that gives no version.
storage::DecisionKind kind_of(Outcome outcome);

/// What the attempt comes to: the outcome of the last reason. Throws std::logic_error where that
/// has none.
Outcome outcome_of(const std::vector<Reason>& reasons);

/// Returns the sentence with its figures, in the formats of the catalogue.
std::string sentence(const Reason& reason);
/// Returns all sentences, one after the other; empty without reasons.
std::string sentences(const std::vector<Reason>& reasons);

/// Returns what was done to the version, for sentences, such as "rolled back to".
std::string_view past(storage::DecisionKind kind);

/// The code of the last reason of a decision; empty where it holds none.
std::string last_code(const storage::Decision& decision);
/// When the equipment had changed last, as the decision found it; INT64_MIN: never. Absent where
/// the decision does not say, as an operator's.
std::optional<storage::Time> changed_in(const storage::Decision& decision);

/// The end of the telemetry that a decision of the league looked at; absent for other decisions.
std::optional<storage::Time> judged_until(const storage::Decision& decision);

/// Whether a version, about which this is the last decision, waits for an operator rather than for
/// telemetry: for an approval or for the end of a hold.
bool waits_for_operator(const storage::Decision& last);

/// Returns an array of objects: `code`, and each figure under its name. Figures keep all their
/// digits; times are nanoseconds.
nlohmann::ordered_json to_json(const std::vector<Reason>& reasons);

}  // namespace reident
