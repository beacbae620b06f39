#include "storage/care/verify_series.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "storage/chunks/checksum.hpp"
#include "storage/chunks/fragment.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

constexpr const char* restore_samples =
    "restore these samples from a backup, or import them again with 'reident import'; what is "
    "damaged is set aside when it is next written to";
constexpr const char* restore_shard =
    "put the shard back from a backup; samples of this time that are imported wait until then";
constexpr const char* counts_are_wrong =
    "the samples themselves are sound; report it with the file, a backup from before has right "
    "counts";

std::optional<double> real(const sqlite::Query& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.real(column));
}

bool same(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return std::bit_cast<std::uint64_t>(*a) == std::bit_cast<std::uint64_t>(*b);
}

std::optional<double> bound(const ChunkSummary& summary, double value) {
  return summary.least > summary.greatest ? std::nullopt : std::optional(value);
}

/// Rows of a database and of its shards have numbers of their own.
std::int64_t key_of(ChunkPlace place) {
  constexpr int bits_of_row = 44;
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(place.shard) << bits_of_row) +
         place.data;
}

std::string than(const char* what, std::uint64_t row, std::uint64_t found) {
  return std::string("its row says ") + std::to_string(row) + " " + what + ", there are " +
         std::to_string(found);
}

}  // namespace

void DataReferences::add(std::int64_t id) {
  if (has(id)) repeated_.insert(id);
  seen_[id >> block_bits][static_cast<std::uint64_t>(id) % block] = true;
}

bool DataReferences::has(std::int64_t id) const {
  const auto found = seen_.find(id >> block_bits);
  return found != seen_.end() && found->second[static_cast<std::uint64_t>(id) % block];
}

SeriesVerifier::SeriesVerifier(sqlite::Connection& connection, const VerifyOptions& options,
                               VerifyReport& report, DataReferences& references,
                               std::function<bool(std::uint64_t)> advanced)
    : connection_(connection),
      options_(options),
      report_(report),
      references_(references),
      advanced_(std::move(advanced)),
      bytes_(connection) {}

void SeriesVerifier::add(const char* check, std::optional<Time> first, std::optional<Time> last,
                         std::string what, const char* remedy) {
  report_.add({check, spacecraft_, name_, origin_, first, last, std::move(what), remedy});
}

bool SeriesVerifier::verify(std::int64_t series) {
  const sqlite::ReadTransaction snapshot(connection_);
  if (!begin(series)) return true;
  try {
    report_set_aside(series);
    read_recent(series);
    if (!read_chunks(series)) return false;
    read_revisions(series);
    compare_series();
    compare_gaps(series);
    compare_sources();
  } catch (const Error& error) {
    add("series", first_, last_, std::string("it cannot be read: ") + error.what(),
        restore_samples);
  }
  return true;
}

// False where it is not there any more.
bool SeriesVerifier::begin(std::int64_t series) {
  seen_ = {};
  recent_.clear();
  sqlite::Query row = connection_.query(
      "SELECT series.spacecraft, coalesce(name, CAST(series.parameter AS TEXT)), origin, samples, "
      "first_time, last_time, moved FROM series LEFT JOIN parameter "
      "ON parameter.spacecraft = series.spacecraft AND parameter.id = series.parameter "
      "WHERE series.id = ?",
      series);
  if (!row.step()) return false;
  spacecraft_ = row.text(0);
  name_ = row.text(1);
  origin_ = row.integer<Origin>(2);
  count_ = row.integer<std::uint64_t>(3);
  first_ = row.is_null(4) ? std::nullopt : std::optional(row.integer(4));
  last_ = row.is_null(5) ? std::nullopt : std::optional(row.integer(5));
  moved_ = row.integer(6);
  ++report_.series;
  return true;
}

void SeriesVerifier::report_set_aside(std::int64_t series) {
  set_aside_ = settled_and_postponed(connection_, series);
  sqlite::Query row = connection_.query(
      "SELECT first_time, last_time, samples, reason FROM damaged_chunk WHERE series = ?", series);
  while (row.step()) {
    set_aside_ += row.integer<std::uint64_t>(2);
    add("set aside", row.integer(0), row.integer(1),
        std::to_string(row.integer(2)) +
            " samples could not be decoded and were set aside: " + row.text(3),
        "import them again with 'reident import' or from a backup, then delete their row of the "
        "table damaged_chunk");
  }
}

void SeriesVerifier::read_recent(std::int64_t series) {
  // From batch to batch that there is: a damaged number may be any.
  sqlite::Query next = connection_.query("SELECT min(batch) FROM recent WHERE batch > ?");
  sqlite::Query row = connection_.query(
      "SELECT first_time, last_time, samples, data FROM recent WHERE batch = ? AND series = ?");
  for (std::int64_t batch = moved_; next.bind(batch).step() && !next.is_null(0);) {
    if (next.integer(0) <= batch) connection_.fail_out_of_order("recent");
    batch = next.integer(0);
    if (!row.bind(batch, series).step()) continue;
    const Time first = row.integer(0), last = row.integer(1);
    samples_ = {};
    const auto error = decode_fragment(row.bytes(3), all_times, samples_.target());
    if (error) {
      seen_.undecodable = true;
      add("recent", first, last,
          std::to_string(row.integer(2)) + " recent samples cannot be read: their fragment " +
              error->message,
          restore_samples);
      continue;
    }
    if (samples_.size() != row.integer<std::size_t>(2) || samples_.time.front() != first ||
        samples_.time.back() != last)
      add("recent", first, last, "a row of recent samples says other counts or times than it holds",
          restore_samples);
    look_at_values(first, last);
    recent_.insert(recent_.end(), samples_.time.begin(), samples_.time.end());
  }
  std::sort(recent_.begin(), recent_.end());
  recent_.erase(std::unique(recent_.begin(), recent_.end()), recent_.end());
  seen_.samples = recent_.size();
  if (recent_.empty()) return;
  seen_.first = recent_.front();
  seen_.last = recent_.back();
}

bool SeriesVerifier::read_chunks(std::int64_t series) {
  sqlite::Query chunk = connection_.query(
      "SELECT first_time, last_time, samples, step, gap_limit, least, greatest, shard, data "
      "FROM chunk WHERE series = ? ORDER BY first_time",
      series);
  while (chunk.step()) {
    const Row row{chunk.integer(0),
                  chunk.integer(1),
                  chunk.integer<std::uint64_t>(2),
                  {chunk.integer(3), chunk.integer(4)},
                  real(chunk, 5),
                  real(chunk, 6)};
    ++report_.chunks;
    const ChunkPlace place{chunk.integer(7), chunk.integer(8)};
    if (place.shard == 0) references_.add(place.data);
    if (seen_.previous && row.first <= seen_.previous->last)
      add("chunk", row.first, row.last, "it begins before the chunk before it ends",
          restore_samples);
    if (report_.unreadable_shards.contains(place.shard))
      seen_.undecodable = true;
    else
      look_at_chunk(row, place);
    seen_.samples += row.samples;
    seen_.first = std::min(seen_.first.value_or(row.first), row.first);
    seen_.last = std::max(seen_.last.value_or(row.last), row.last);
    seen_.previous = row;
    if (!advanced_(row.samples)) return false;
  }
  return true;
}

bool SeriesVerifier::is_known(const Row& row, std::int64_t key, std::uint64_t digest) const {
  if (options_.known == nullptr) return false;
  const auto found = options_.known->find(key);
  if (found == options_.known->end() || found->second != digest) return false;
  // What is recent too is counted by the times of its chunk.
  const auto recent = std::ranges::lower_bound(recent_, row.first);
  return recent == recent_.end() || *recent > row.last;
}

void SeriesVerifier::look_at_chunk(const Row& row, ChunkPlace place) {
  const std::uint64_t found_before = report_.found;
  const char* remedy = place.shard == 0 ? restore_samples : restore_shard;
  const std::span<const std::uint8_t> bytes = bytes_.read(place);
  if (bytes.empty()) {
    seen_.undecodable = true;
    add("chunk", row.first, row.last,
        "its data (row " + std::to_string(place.data) + " of chunk_data) are missing", remedy);
    return;
  }
  const auto summary = read_summary(bytes);
  std::optional<ChunkError> error;
  if (const auto* wrong = std::get_if<ChunkError>(&summary)) {
    error = *wrong;
  } else {
    compare_with_summary(row, std::get<ChunkSummary>(summary));
    if (options_.quick) return;
    const std::uint64_t digest = xxh64(bytes);
    if (is_known(row, key_of(place), digest)) {
      seen_.known = true;
      ++report_.known;
      report_.sound.emplace(key_of(place), digest);
      return;
    }
    samples_ = {};
    error = decoder_.decode(bytes, samples_.target());
    if (!error) {
      look_at_samples(row);
      if (report_.found == found_before) report_.sound.emplace(key_of(place), digest);
      return;
    }
  }
  seen_.undecodable = true;
  add("chunk", row.first, row.last,
      std::to_string(row.samples) + " samples cannot be read: their chunk " + error->message,
      error->kind == ChunkError::Kind::newer ? "use a newer reident" : remedy);
}

void SeriesVerifier::compare_with_summary(const Row& row, const ChunkSummary& summary) {
  if (row.samples != summary.count)
    add("chunk", row.first, row.last, than("samples", row.samples, summary.count), restore_samples);
  if (row.first != summary.first_time || row.last != summary.last_time)
    add("chunk", row.first, row.last, "its row says other times than it holds", restore_samples);
  if (!same(row.least, bound(summary, summary.least)) ||
      !same(row.greatest, bound(summary, summary.greatest)))
    add("chunk", row.first, row.last, "its row says other least and greatest values than it holds",
        restore_samples);
}

void SeriesVerifier::look_at_samples(const Row& row) {
  if (samples_.empty()) return;
  look_at_values(row.first, row.last);
  const Sampling sampling = meter_.measure(samples_.time);
  if (!(sampling == row.sampling))
    add("chunk", row.first, row.last, "its row says another step than its times have",
        counts_are_wrong);
  if (seen_.previous)
    if (const auto gap = gap_between(seen_.previous->last, seen_.previous->sampling,
                                     samples_.time.front(), row.sampling))
      seen_.gaps.push_back(*gap);
  append_gaps(samples_.time, row.sampling, seen_.gaps);
  // What is recent too was counted with the recent ones.
  const auto from = std::lower_bound(recent_.begin(), recent_.end(), samples_.time.front());
  for (auto at = from; at != recent_.end() && *at <= samples_.time.back(); ++at)
    if (std::binary_search(samples_.time.begin(), samples_.time.end(), *at)) --seen_.samples;
}

void SeriesVerifier::look_at_values(Time first, Time last) {
  report_.samples += samples_.size();
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (!std::isfinite(samples_.value[i]) && samples_.quality[i] != Quality::invalid) {
      add("samples", first, last, "a value that is not finite is not of quality invalid",
          restore_samples);
      break;
    }
  seen_.sources.insert(samples_.source.begin(), samples_.source.end());
}

void SeriesVerifier::read_revisions(std::int64_t series) {
  sqlite::Query row = connection_.query(
      "SELECT first_time, last_time, landed, replaced FROM revision WHERE series = ?", series);
  while (row.step()) {
    const Time first = row.integer(0), last = row.integer(1);
    std::optional<Time> from, to;
    std::optional<ChunkError> error;
    for (const int column : {2, 3}) {
      if (row.is_null(column) || error) continue;
      samples_ = {};
      error = decoder_.decode(row.bytes(column), samples_.target());
      if (error || samples_.empty()) continue;
      from = std::min(from.value_or(samples_.time.front()), samples_.time.front());
      to = std::max(to.value_or(samples_.time.back()), samples_.time.back());
    }
    if (error || from != first || to != last)
      add("revision", first, last,
          "what a late change replaced cannot be read: " +
              (error ? "its chunk " + error->message : "its row says other times than it holds"),
          "the samples of now are sound; versions identified before that change cannot be "
          "reproduced, unless a backup has this row of the table revision");
  }
}

void SeriesVerifier::compare_series() {
  if (options_.quick || seen_.undecodable) return;
  // What was set aside is still counted, unless it was archived again.
  if (count_ < seen_.samples || count_ > seen_.samples + set_aside_)
    add("series", first_, last_, than("samples", count_, seen_.samples), counts_are_wrong);
  if (set_aside_ == 0 && (first_ != seen_.first || last_ != seen_.last))
    add("series", first_, last_, "its row says other first and last times than its samples have",
        counts_are_wrong);
}

void SeriesVerifier::compare_gaps(std::int64_t series) {
  if (options_.quick || seen_.undecodable || seen_.known) return;
  constexpr const char* remedy =
      "the samples themselves are sound; the list of gaps is wrong: report it with the file";
  std::vector<SampleGap> stored;
  sqlite::Query row = connection_.query(
      "SELECT begin_time, end_time FROM sample_gap WHERE series = ? ORDER BY begin_time", series);
  while (row.step()) stored.push_back({row.integer(0), row.integer(1)});
  const auto [a, b] =
      std::mismatch(stored.begin(), stored.end(), seen_.gaps.begin(), seen_.gaps.end());
  if (a == stored.end() && b == seen_.gaps.end()) return;
  const SampleGap& at =
      b == seen_.gaps.end() || (a != stored.end() && a->begin < b->begin) ? *a : *b;
  add("gaps", at.begin, at.end,
      "the list of its gaps (" + std::to_string(stored.size()) +
          ") is not the one of its samples (" + std::to_string(seen_.gaps.size()) +
          "); they differ from here on",
      remedy);
}

void SeriesVerifier::compare_sources() {
  sqlite::Query row =
      connection_.query("SELECT 1 FROM source WHERE id = ? AND spacecraft = ? AND origin = ?");
  for (const std::int64_t source : seen_.sources)
    if (!row.bind(source, spacecraft_, origin_).step())
      add("samples", first_, last_,
          "samples name the source " + std::to_string(source) + ", which does not exist",
          "restore the table source from a backup");
}

}  // namespace reident::storage
