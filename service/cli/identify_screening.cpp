#include "service/cli/identify_screening.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "identification/screening/sensor_screening.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Record;
using identification::SensorFault;
using identification::SensorFaultKind;
using identification::TickRange;

constexpr std::size_t most_told = 6;
constexpr std::size_t digital_values = 10;

std::vector<bool> analog_channels(const Record& record) {
  std::vector<bool> analog;
  for (const auto* channels : {&record.u, &record.y})
    for (Index c = 0; c < channels->cols(); ++c) analog.push_back(is_analog(channels->col(c)));
  return analog;
}

/// Rows of the file, half-open.
TickRange file_rows(const IdentifyData& data, TickRange ticks) {
  const auto row_at = [&](std::int64_t tick) {
    return std::lower_bound(data.file_ticks.begin(), data.file_ticks.end(), tick) -
           data.file_ticks.begin();
  };
  return {row_at(ticks.begin), row_at(ticks.end)};
}

std::string_view what(SensorFaultKind kind) {
  switch (kind) {
    case SensorFaultKind::fill:
      return "holds a value that stands for none";
    case SensorFaultKind::stuck:
      return "stands still";
    case SensorFaultKind::spike:
      return "spikes, which no other column explains,";
    case SensorFaultKind::noise:
      break;
  }
  return "is noisy as it is nowhere else";
}

}  // namespace

bool is_analog(const identification::Vector& column) {
  std::set<double> values;
  for (Index row = 0; row < column.size() && values.size() <= digital_values; ++row)
    values.insert(column(row));
  return values.size() > digital_values;
}

std::vector<LeftOut> leave_out_faults(Record& record, const std::vector<std::string>& columns) {
  std::vector<LeftOut> found;
  std::vector<TickRange> holes;
  for (const SensorFault& fault : sensor_faults(record, analog_channels(record))) {
    const std::string& column = columns[static_cast<std::size_t>(fault.channel)];
    if (found.empty() || found.back().column != column || found.back().fault != name(fault.kind))
      found.push_back({column, name(fault.kind), what(fault.kind), {}});
    found.back().ticks.push_back(fault.ticks);
    holes.push_back(fault.ticks);
  }
  for (LeftOut& one : found) one.ticks = identification::united(std::move(one.ticks));
  if (!holes.empty()) record = without(std::move(record), identification::united(std::move(holes)));
  return found;
}

nlohmann::ordered_json left_out_json(const IdentifyData& data) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const LeftOut& one : data.left_out) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const TickRange& ticks : one.ticks) {
      const TickRange range = file_rows(data, ticks);
      rows.push_back({range.begin, range.end});
    }
    list.push_back({{"column", one.column}, {"fault", one.fault}, {"rows", rows}});
  }
  return list;
}

std::vector<std::string> left_out_sentences(const IdentifyData& data) {
  std::vector<std::string> sentences;
  for (const LeftOut& one : data.left_out) {
    std::string ranges;
    Index rows = 0;
    for (std::size_t i = 0; i < one.ticks.size(); ++i) {
      const TickRange range = file_rows(data, one.ticks[i]);
      rows += range.end - range.begin;
      if (i >= most_told) continue;
      ranges += ranges.empty() ? "" : ", ";
      ranges += range.end - range.begin == 1 ? fmt::format("{}", range.begin)
                                             : fmt::format("{} to {}", range.begin, range.end - 1);
    }
    if (one.ticks.size() > most_told)
      ranges += fmt::format(" and {} more", one.ticks.size() - most_told);
    sentences.push_back(fmt::format("left out: {} {} in {} {} ({})", one.column, one.words, rows,
                                    rows == 1 ? "row" : "rows", ranges));
  }
  if (!sentences.empty()) sentences.push_back("--no-screening keeps these rows");
  return sentences;
}

}  // namespace reident::cli
