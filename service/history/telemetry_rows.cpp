#include <stdexcept>

#include "service/history/row_values.hpp"
#include "service/history/rows.hpp"

namespace reident::history {
namespace {

template <typename Enum>
Enum read_named(const Json& value, Enum last) {
  const auto& text = value.get_ref<const std::string&>();
  for (int i = 0; i <= static_cast<int>(last); ++i)
    if (storage::name(static_cast<Enum>(i)) == text) return static_cast<Enum>(i);
  throw std::invalid_argument("'" + text + "' is not known here");
}

storage::Origin read_origin(const Json& value) {
  return read_named(value, storage::Origin::simulated);
}

/// One number where all elements are that one.
template <typename T, typename Value>
Json column_value(const std::vector<T>& column, std::size_t first, std::size_t last,
                  const Value& value) {
  const auto begin = column.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = column.begin() + static_cast<std::ptrdiff_t>(last);
  if (begin != end && std::all_of(begin, end, [&](const T& one) { return one == *begin; }))
    return value(*begin);
  Json array = Json::array();
  for (auto one = begin; one != end; ++one) array.push_back(value(*one));
  return array;
}

template <typename T, typename Read>
void append_column(const Json& value, std::size_t size, std::vector<T>& column, const Read& read) {
  if (!value.is_array()) {
    column.insert(column.end(), size, read(value));
    return;
  }
  if (value.size() != size) throw std::invalid_argument("columns of samples differ in length");
  for (const Json& one : value) column.push_back(read(one));
}

}  // namespace

Json row_of(const storage::ParameterDescriptor& parameter) {
  const auto limit = [](const std::optional<double>& value) {
    return value ? number_value(*value) : Json();
  };
  return {{"spacecraft", text_value(parameter.spacecraft)},
          {"parameter", parameter.id},
          {"name", text_value(parameter.name)},
          {"unit", text_value(parameter.unit)},
          {"description", text_value(parameter.description)},
          {"kind", storage::name(parameter.kind)},
          {"low_limit", limit(parameter.low_limit)},
          {"high_limit", limit(parameter.high_limit)}};
}

void read_row(const Json& row, storage::ParameterDescriptor& parameter) {
  const auto limit = [](const Json& value) {
    return value.is_null() ? std::nullopt : std::optional(read_number(value));
  };
  parameter.spacecraft = read_text(row.at("spacecraft"));
  parameter.id = row.at("parameter").get<std::uint32_t>();
  parameter.name = read_text(row.at("name"));
  parameter.unit = read_text(row.at("unit"));
  parameter.description = read_text(row.at("description"));
  parameter.kind = read_named(row.at("kind"), storage::ParameterKind::digital);
  parameter.low_limit = limit(row.at("low_limit"));
  parameter.high_limit = limit(row.at("high_limit"));
}

Json row_of(const storage::SeriesInfo& series) {
  return {{"id", series.id},
          {"spacecraft", text_value(series.spacecraft)},
          {"origin", storage::name(series.origin)},
          {"parameter", series.parameter},
          {"name", text_value(series.name)},
          {"samples", series.samples},
          {"first_ns", series.first},
          {"last_ns", series.last}};
}

void read_row(const Json& row, storage::SeriesInfo& series) {
  series.id = row.at("id").get<std::int64_t>();
  series.spacecraft = read_text(row.at("spacecraft"));
  series.origin = read_origin(row.at("origin"));
  series.parameter = row.at("parameter").get<std::uint32_t>();
  series.name = read_text(row.at("name"));
  series.samples = row.at("samples").get<std::uint64_t>();
  series.first = row.at("first_ns").get<storage::Time>();
  series.last = row.at("last_ns").get<storage::Time>();
}

Json row_of(const std::pair<std::int64_t, std::string>& source) {
  return {{"id", source.first}, {"name", text_value(source.second)}};
}

void read_row(const Json& row, std::pair<std::int64_t, std::string>& source) {
  source = {row.at("id").get<std::int64_t>(), read_text(row.at("name"))};
}

Json row_of(const storage::SequenceGap& gap) {
  return {{"spacecraft", text_value(gap.spacecraft)},
          {"source", text_value(gap.source)},
          {"origin", storage::name(gap.origin)},
          {"first", gap.first},
          {"last", gap.last},
          {"before_ns", gap.before},
          {"after_ns", gap.after}};
}

void read_row(const Json& row, storage::SequenceGap& gap) {
  gap.spacecraft = read_text(row.at("spacecraft"));
  gap.source = read_text(row.at("source"));
  gap.origin = read_origin(row.at("origin"));
  gap.first = row.at("first").get<std::uint64_t>();
  gap.last = row.at("last").get<std::uint64_t>();
  gap.before = row.at("before_ns").get<storage::Time>();
  gap.after = row.at("after_ns").get<storage::Time>();
}

Json row_of(const storage::SampleColumns& samples, std::size_t first, std::size_t last) {
  Json times = Json::array(), values = Json::array();
  for (std::size_t i = first; i < last; ++i) {
    times.push_back(samples.time[i]);
    values.push_back(number_value(samples.value[i]));
  }
  return {{"times_ns", std::move(times)},
          {"values", std::move(values)},
          {"quality", column_value(samples.quality, first, last, storage::wire_value)},
          {"source",
           column_value(samples.source, first, last, [](std::int64_t source) { return source; })}};
}

void read_row(const Json& row, storage::SampleColumns& samples) {
  const Json& times = row.at("times_ns");
  if (!times.is_array()) throw std::invalid_argument("times_ns is not an array");
  const std::size_t size = times.size();
  for (const Json& time : times) samples.time.push_back(time.get<storage::Time>());
  if (!row.at("values").is_array()) throw std::invalid_argument("values is not an array");
  append_column(row["values"], size, samples.value, read_number);
  append_column(row.at("quality"), size, samples.quality, [](const Json& value) {
    if (const auto quality = storage::quality_of_wire(value.get<int>())) return *quality;
    throw std::invalid_argument("a quality is none of 0 to " +
                                std::to_string(storage::quality_table.back().wire));
  });
  append_column(row.at("source"), size, samples.source,
                [](const Json& value) { return value.get<std::int64_t>(); });
}

Json row_of(const CountsRow& row) {
  Json came = Json::array(), missing = Json::array(), gaps = Json::array(), longest = Json::array();
  for (const storage::BinCounts& counts : row.counts) {
    came.push_back(counts.came);
    missing.push_back(counts.missing);
    gaps.push_back(counts.gaps);
    longest.push_back(counts.longest_gap);
  }
  return {{"first_bin", row.first},
          {"came", std::move(came)},
          {"missing", std::move(missing)},
          {"gaps", std::move(gaps)},
          {"longest_gap_ns", std::move(longest)}};
}

void read_row(const Json& row, CountsRow& counts) {
  counts.first = row.at("first_bin").get<std::size_t>();
  const Json &came = row.at("came"), &missing = row.at("missing"), &gaps = row.at("gaps"),
             &longest = row.at("longest_gap_ns");
  if (missing.size() != came.size() || gaps.size() != came.size() || longest.size() != came.size())
    throw std::invalid_argument("columns of counts differ in length");
  for (std::size_t i = 0; i < came.size(); ++i)
    counts.counts.push_back({came[i].get<std::uint64_t>(), missing[i].get<std::uint64_t>(),
                             gaps[i].get<std::uint64_t>(), longest[i].get<storage::Time>()});
}

}  // namespace reident::history
