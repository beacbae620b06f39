#include "storage/sql/ordered_rows.hpp"

#include <algorithm>
#include <utility>

namespace reident::storage::sql {
namespace {

/// Negative where `a` comes before `b`.
int compare(const SeriesName& a, const SeriesName& b, const std::vector<OrderTerm>& terms) {
  for (const OrderTerm& term : terms) {
    int order = 0;
    if (term.column == Column::spacecraft) order = a.spacecraft.compare(b.spacecraft);
    if (term.column == Column::parameter) order = a.parameter.compare(b.parameter);
    if (term.column == Column::origin) order = name(a.origin).compare(name(b.origin));
    if (order != 0) return term.descending ? -order : order;
  }
  return 0;
}

}  // namespace

OrderedRows::OrderedRows(ArchiveFile& file, Plan plan) : file_(file), plan_(std::move(plan)) {
  if (plan_.selection.time.empty()) return;
  series_ = file_.find(plan_.selection);
  std::stable_sort(series_.begin(), series_.end(), [this](const auto& a, const auto& b) {
    return compare(a, b, plan_.order.before) < 0;
  });
}

bool OrderedRows::is_behind(const Head& a, const Head& b) const {
  if (a.time() != b.time()) return (a.time() > b.time()) != plan_.order.descending;
  return a.rank > b.rank;
}

// Series that only time puts in order among themselves; without an order in time a single one.
void OrderedRows::start_group() {
  auto end = started_ + 1;
  while (plan_.order.by_time && end < series_.size() &&
         compare(series_[started_], series_[end], plan_.order.before) == 0)
    ++end;
  std::vector<SeriesName> group(series_.begin() + static_cast<std::ptrdiff_t>(started_),
                                series_.begin() + static_cast<std::ptrdiff_t>(end));
  started_ = end;
  std::stable_sort(group.begin(), group.end(), [this](const auto& a, const auto& b) {
    return compare(a, b, plan_.order.after) < 0;
  });

  SeriesBlocks::Options options{.wanted = plan_.wanted, .descending = plan_.order.descending};
  if (group.size() > 1)
    options.most_rows = std::clamp<std::size_t>(merged_rows / group.size(), 64, most_samples);
  for (std::size_t rank = 0; rank < group.size(); ++rank) {
    auto blocks = std::make_unique<SeriesBlocks>(file_, group[rank], plan_.selection, options);
    if (blocks->next()) heap_.push_back({std::move(blocks), 0, rank});
  }
  std::make_heap(heap_.begin(), heap_.end(),
                 [this](const Head& a, const Head& b) { return is_behind(a, b); });
}

std::size_t OrderedRows::end_of_range(const Head& head) const {
  const std::vector<Time>& time = head.blocks->block().time;
  if (heap_.empty()) return time.size();
  const Head& other = heap_.front();
  const Time until = other.time();
  std::size_t end = head.row + 1;  // the head itself comes before the other
  while (end < time.size() && time[end] != until && (time[end] < until) != plan_.order.descending)
    ++end;
  if (end < time.size() && time[end] == until && head.rank < other.rank) ++end;
  return end;
}

std::optional<OrderedRows::Range> OrderedRows::next() {
  const auto behind = [this](const Head& a, const Head& b) { return is_behind(a, b); };
  if (current_) {
    if (current_->row == current_->blocks->block().time.size()) {
      current_->row = 0;
      if (!current_->blocks->next()) current_.reset();
    }
    if (current_) {
      heap_.push_back(std::move(*current_));
      std::push_heap(heap_.begin(), heap_.end(), behind);
      current_.reset();
    }
  }
  while (heap_.empty()) {
    if (started_ == series_.size()) return std::nullopt;
    start_group();
  }
  std::pop_heap(heap_.begin(), heap_.end(), behind);
  current_ = std::move(heap_.back());
  heap_.pop_back();
  const Range range{&current_->blocks->series(), &current_->blocks->block(), current_->row,
                    end_of_range(*current_)};
  current_->row = range.end;
  return range;
}

}  // namespace reident::storage::sql
