#include "storage/archive/recent_tier.hpp"

#include <algorithm>

#include "storage/archive/damage.hpp"
#include "storage/chunks/fragment.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {

RecentTier::RecentTier(sqlite::Connection& connection) : connection_(connection) {
  load_series();
  load_fragments();
}

void RecentTier::load_series() {
  sqlite::Query row = connection_.query(
      "SELECT id, spacecraft, origin, parameter, samples, first_time, last_time, moved FROM "
      "series");
  while (row.step()) {
    const std::int64_t id = row.integer(0);
    SeriesHead& head = series_[id];
    head.id = id;
    head.samples = row.integer<std::uint64_t>(4);
    if (!row.is_null(5)) head.first = row.integer(5);
    if (!row.is_null(6)) head.last = row.integer(6);
    head.moved = row.integer(7);
    last_batch_ = std::max(last_batch_, head.moved);
    ids_[{row.text(1), row.integer<Origin>(2)}].emplace(row.integer<std::uint32_t>(3), id);
  }
}

void RecentTier::load_fragments() {
  std::vector<std::pair<std::int64_t, std::int64_t>> damaged;
  {
    sqlite::Query row = connection_.query(
        "SELECT batch, series, first_time, last_time, samples, data FROM recent "
        "ORDER BY batch, series");
    while (row.step()) {
      const std::int64_t batch = row.integer(0);
      last_batch_ = std::max(last_batch_, batch);
      ++rows_[batch];
      const auto known = series_.find(row.integer(1));
      if (known == series_.end())
        throw Error(Error::Kind::corrupt,
                    "database " + connection_.path() + " has recent samples of series " +
                        std::to_string(row.integer(1)) +
                        ", which it does not know; restore a backup, or save what can be read "
                        "with 'sqlite3 FILE .recover'");
      SeriesHead& head = known->second;
      if (batch <= head.moved) continue;
      SeriesHead::Fragment fragment{batch, {}};
      if (const auto error = decode_fragment(row.bytes(5), all_times, fragment.samples.target())) {
        set_aside(connection_,
                  {head.id, row.integer(2), row.integer(3), row.integer<std::size_t>(4)},
                  row.bytes(5), *error);
        damaged.emplace_back(batch, head.id);
        continue;
      }
      samples_ += fragment.samples.size();
      head.fragments.push_back(std::move(fragment));
    }
  }
  for (const auto& [batch, series] : damaged) {
    connection_.query("DELETE FROM recent WHERE batch = ? AND series = ?").run(batch, series);
    if (--rows_[batch] == 0) rows_.erase(batch);
  }
}

SeriesHead& RecentTier::series(const std::string& spacecraft, Origin origin,
                               std::uint32_t parameter) {
  auto& ids = ids_[{spacecraft, origin}];
  if (const auto known = ids.find(parameter); known != ids.end()) return series_.at(known->second);
  connection_.query("INSERT INTO series (spacecraft, origin, parameter) VALUES (?, ?, ?)")
      .run(spacecraft, origin, parameter);
  const std::int64_t id = connection_.last_id();
  ids.emplace(parameter, id);
  SeriesHead& head = series_[id];
  head.id = id;
  return head;
}

std::optional<Held> RecentTier::find(const SeriesHead& series, Time time) {
  for (auto fragment = series.fragments.rbegin(); fragment != series.fragments.rend(); ++fragment) {
    const SampleColumns& samples = fragment->samples;
    if (time < samples.time.front() || time > samples.time.back()) continue;
    const auto found = std::lower_bound(samples.time.begin(), samples.time.end(), time);
    if (*found != time) continue;
    const auto at = static_cast<std::size_t>(found - samples.time.begin());
    return Held{samples.value[at], samples.quality[at], samples.source[at]};
  }
  return std::nullopt;
}

void RecentTier::add(SeriesHead& series, std::int64_t batch, SampleColumns&& samples) {
  bytes_.clear();
  encode_fragment(samples.samples(), bytes_);
  connection_
      .query(
          "INSERT INTO recent (batch, series, samples, first_time, last_time, data) "
          "VALUES (?, ?, ?, ?, ?, ?)")
      .run(batch, series.id, samples.size(), samples.time.front(), samples.time.back(),
           std::span<const std::uint8_t>(bytes_));
  last_batch_ = std::max(last_batch_, batch);
  ++rows_[batch];
  samples_ += samples.size();
  series.fragments.push_back({batch, std::move(samples)});
}

std::vector<std::int64_t> RecentTier::waiting() const {
  std::vector<std::int64_t> ids;
  for (const auto& [id, head] : series_)
    if (!head.fragments.empty()) ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

void RecentTier::moved(SeriesHead& series, std::int64_t batch) {
  connection_.query("UPDATE series SET moved = ? WHERE id = ?").run(batch, series.id);
  series.moved = batch;
  const auto kept = std::find_if(
      series.fragments.begin(), series.fragments.end(),
      [batch](const SeriesHead::Fragment& fragment) { return fragment.batch > batch; });
  for (auto fragment = series.fragments.begin(); fragment != kept; ++fragment)
    samples_ -= fragment->samples.size();
  series.fragments.erase(series.fragments.begin(), kept);
}

bool RecentTier::remove_rows(std::int64_t batch, std::size_t rows) {
  std::size_t removed = 0;
  while (!rows_.empty() && rows_.begin()->first <= batch && removed < rows) {
    connection_.query("DELETE FROM recent WHERE batch = ?").run(rows_.begin()->first);
    removed += rows_.begin()->second;
    rows_.erase(rows_.begin());
  }
  return !rows_.empty() && rows_.begin()->first <= batch;
}

}  // namespace reident::storage
