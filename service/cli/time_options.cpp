#include "service/cli/time_options.hpp"

#include <fmt/format.h>

#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli {
namespace {

std::optional<Refusal> read_time(const char* flag, const std::optional<std::string>& text,
                                 storage::Time& time) {
  if (!text) return std::nullopt;
  const auto parsed = parse_moment(*text, utc_now());
  if (!parsed)
    return Refusal{
        fmt::format("{} {} is no time; write it as 2026-03-01T12:00:00Z, now or -2h (before now)",
                    flag, *text)};
  time = *parsed;
  return std::nullopt;
}

}  // namespace

void add_time_options(CLI::App& command, TimeOptions& choice, const std::string& meaning) {
  command.add_option("--from", choice.from, "only " + meaning + " at this time or later");
  command.add_option("--to", choice.to, "only " + meaning + " before this time");
}

std::variant<storage::TimeRange, Refusal> chosen_range(const TimeOptions& choice,
                                                       storage::TimeRange all) {
  if (auto refusal = read_time("--from", choice.from, all.begin)) return *refusal;
  if (auto refusal = read_time("--to", choice.to, all.end)) return *refusal;
  if (all.end <= all.begin) return Refusal{"--to is not after --from; swap them"};
  return all;
}

}  // namespace reident::cli
