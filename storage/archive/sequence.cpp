#include "storage/archive/sequence.hpp"

namespace reident::storage {

// The gap between two frames that came, if there is one.
void SequenceTracker::add_gap(sqlite::Connection& connection, Mark before, Mark after) {
  if (after.sequence - before.sequence <= 1) return;
  connection
      .query(
          "INSERT INTO sequence_gap (source, run, first, last, time_before, time_after) "
          "VALUES (?, ?, ?, ?, ?, ?)")
      .run(source, restarts, to_column(before.sequence + 1), to_column(after.sequence - 1),
           before.time, after.time);
  missing += after.sequence - before.sequence - 1;
}

bool SequenceTracker::fill_gap(sqlite::Connection& connection, Mark frame) {
  Mark before, after;
  {
    sqlite::Query gap = connection.query(
        "SELECT first, last, time_before, time_after FROM sequence_gap "
        "WHERE source = ? AND run = ? AND first <= ? ORDER BY first DESC LIMIT 1",
        source, restarts, to_column(frame.sequence));
    if (!gap.step() || from_column(gap.integer(1)) < frame.sequence) return false;
    before = {from_column(gap.integer(0)) - 1, gap.integer(2)};
    after = {from_column(gap.integer(1)) + 1, gap.integer(3)};
  }
  connection.query("DELETE FROM sequence_gap WHERE source = ? AND run = ? AND first = ?")
      .run(source, restarts, to_column(before.sequence + 1));
  missing -= after.sequence - before.sequence - 1;
  add_gap(connection, before, frame);
  add_gap(connection, frame, after);
  return true;
}

void SequenceTracker::begin_run(sqlite::Connection& connection, Mark frame, std::uint64_t first) {
  lowest = highest = frame;
  if (first == 0 || first >= frame.sequence) return;
  lowest.sequence = first;
  add_gap(connection, {first - 1, frame.time}, frame);
}

bool SequenceTracker::observe(sqlite::Connection& connection, Mark frame, std::uint64_t first,
                              bool brings_new) {
  if (lowest.sequence > highest.sequence) {
    begin_run(connection, frame, first);
    return true;
  }
  if (frame.sequence > highest.sequence) {
    add_gap(connection, highest, frame);
    highest = frame;
    return false;
  }
  ++out_of_order;
  if (frame.sequence < lowest.sequence && lowest.sequence - frame.sequence <= reorder_limit) {
    add_gap(connection, frame, lowest);
    lowest = frame;
    return false;
  }
  if (fill_gap(connection, frame) || !brings_new) return false;
  ++restarts;
  begin_run(connection, frame, first);
  return true;
}

}  // namespace reident::storage
