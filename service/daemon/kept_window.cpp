#include "service/daemon/kept_window.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "service/support/floor_divide.hpp"

namespace reident {

using identification::Record;
using identification::TickRange;

KeptWindow::KeptWindow(const WindowRequest& request, identification::Index block_rows)
    : request_(request),
      sums_({static_cast<identification::Index>(request.inputs.size() + request.outputs.size()),
             block_rows, chunk_ticks}) {}

TickRange KeptWindow::ticks_of(storage::TimeRange range) const {
  const auto at_or_after = [this](storage::Time time) {
    return -floor_divide(-time, request_.period);
  };
  return {at_or_after(range.begin), at_or_after(range.end)};
}

Record KeptWindow::read(const storage::Archive& archive, TickRange ticks) {
  ticks_read_ += ticks.end - ticks.begin;
  auto loaded =
      load_window(archive, request_, {ticks.begin * request_.period, ticks.end * request_.period});
  Record record = std::move(std::get<WindowData>(loaded).record);
  for (std::int64_t chunk = -floor_divide(-ticks.begin, chunk_ticks);
       (chunk + 1) * chunk_ticks <= ticks.end; ++chunk)
    chunks_[chunk] = rows_at(record, {chunk * chunk_ticks, (chunk + 1) * chunk_ticks});
  return record;
}

std::variant<WindowData, UnknownParameter> KeptWindow::load(const storage::Archive& archive,
                                                            storage::TimeRange window) {
  auto described = describe_window(archive, request_);
  if (const auto* unknown = std::get_if<UnknownParameter>(&described)) return *unknown;
  WindowData data = std::get<WindowData>(std::move(described));
  std::vector<std::uint32_t> parameters = data.parameters;
  parameters.insert(parameters.end(), data.output_parameters.begin(), data.output_parameters.end());
  if (parameters != parameters_) {
    chunks_.clear();
    sums_ = identification::LagSums(sums_.shape());
    parameters_ = std::move(parameters);
  }

  const TickRange ticks = ticks_of(window);
  const std::int64_t first_chunk = floor_divide(ticks.begin, chunk_ticks);
  chunks_.erase(chunks_.begin(), chunks_.lower_bound(first_chunk));
  sums_.forget({std::numeric_limits<std::int64_t>::min(), first_chunk * chunk_ticks});

  std::map<std::int64_t, Record> fresh;  // by first tick: what was read now
  std::int64_t tick = ticks.begin;
  const auto kept_at = [this, &ticks](std::int64_t at) {
    return at % chunk_ticks == 0 && at + chunk_ticks <= ticks.end &&
           chunks_.contains(floor_divide(at, chunk_ticks));
  };
  std::vector<TickRange> missing;
  while (tick < ticks.end) {
    const std::int64_t next =
        std::min(ticks.end, (floor_divide(tick, chunk_ticks) + 1) * chunk_ticks);
    if (!kept_at(tick)) {
      if (!missing.empty() && missing.back().end == tick)
        missing.back().end = next;
      else
        missing.push_back({tick, next});
    }
    tick = next;
  }
  for (const TickRange& stretch : missing) fresh[stretch.begin] = read(archive, stretch);

  std::vector<const Record*> parts;
  for (tick = ticks.begin; tick < ticks.end;) {
    if (const auto stretch = fresh.find(tick); stretch != fresh.end()) {
      parts.push_back(&stretch->second);
      tick = std::find_if(missing.begin(), missing.end(), [tick](const TickRange& ticks_read) {
               return ticks_read.begin == tick;
             })->end;
    } else {
      parts.push_back(&chunks_.at(floor_divide(tick, chunk_ticks)));
      tick += chunk_ticks;
    }
  }
  data.record = parts.empty() ? std::move(data.record) : joined(parts);
  data.coverage = coverage_of(data.record, window, request_.period);
  return data;
}

void KeptWindow::forget(storage::TimeRange range) {
  // A sample serves the ticks until it is too old.
  const storage::Time latest = std::numeric_limits<storage::Time>::max() - request_.hold;
  const TickRange ticks = ticks_of({range.begin, std::min(range.end, latest) + request_.hold});
  std::erase_if(chunks_, [&ticks](const auto& chunk) {
    return chunk.first * chunk_ticks < ticks.end && ticks.begin < (chunk.first + 1) * chunk_ticks;
  });
  sums_.forget(ticks);
}

}  // namespace reident
