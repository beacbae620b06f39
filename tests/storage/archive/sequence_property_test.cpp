// Sequence gaps against the plain set of numbers that came.
#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "storage/archive/sequence.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::sequence_property_test {
namespace {

RC_GTEST_PROP(SequenceProperty, GapsAreWhatDidNotComeWhateverTheOrder, ()) {
  // All within the reordering that is tolerated at a start; a number that comes twice comes with
  // the same frame.
  const auto base = *rc::gen::element<std::uint64_t>(0, 1000, (std::uint64_t{1} << 63) - 30,
                                                     ~std::uint64_t{0} - reorder_limit);
  const auto numbers = *rc::gen::container<std::vector<std::uint64_t>>(
      rc::gen::inRange<std::uint64_t>(0, reorder_limit + 1));
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database);
  std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
  std::vector<TelemetryFrame> batch;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Time time = static_cast<Time>(numbers[i]);
    batch.push_back(frame(base + numbers[i], time, {{1, Quality::good, 1}}));
    if (random() % 3 != 0 && i + 1 < numbers.size()) continue;
    archive.append(batch);
    batch.clear();
  }

  std::set<std::uint64_t> came;
  for (const std::uint64_t number : numbers) came.insert(base + number);
  std::set<std::uint64_t> missing;
  if (!came.empty())
    for (std::uint64_t n = *came.begin(); n != *came.rbegin(); ++n)
      if (!came.contains(n)) missing.insert(n);
  std::set<std::uint64_t> reported;
  for (const SequenceGap& gap : archive.sequence_gaps()) {
    RC_ASSERT(gap.first <= gap.last);
    RC_ASSERT(!came.empty() && came.contains(gap.first - 1) && came.contains(gap.last + 1));
    RC_ASSERT(gap.before == static_cast<Time>(gap.first - 1 - base));
    RC_ASSERT(gap.after == static_cast<Time>(gap.last + 1 - base));
    for (std::uint64_t n = gap.first; n <= gap.last; ++n) reported.insert(n);
  }
  RC_ASSERT(reported == missing);
  if (came.empty()) return;
  const SourceCounts source = archive.sources().at(0);
  RC_ASSERT(source.missing == missing.size());
  RC_ASSERT(source.last_sequence == *came.rbegin());
  RC_ASSERT(source.restarts == 0U);
}

}  // namespace
}  // namespace reident::storage::test::sequence_property_test
