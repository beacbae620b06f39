// Pages of a database: each row once, bounded, and a reason where there is none.
#include "service/history/answer.hpp"

#include <filesystem>
#include <functional>

#include <gmock/gmock.h>

#include "service/history/rows.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::history::answer_test {
namespace {

using ::testing::HasSubstr;

class Answers : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  storage::Database database_{folder_ / "reident.db", storage::Database::Mode::read_write};
  storage::Registry registry_{database_};

  static storage::NewAttempt attempt(storage::Time end, std::size_t evidence_bytes = 10) {
    storage::NewAttempt attempt;
    attempt.spacecraft = "SAT";
    attempt.equipment = end % 2 == 0 ? "EVEN" : "ODD";
    attempt.window = {end - 10, end};
    attempt.time = end;
    attempt.evidence_json = "{\"why\":\"" + std::string(evidence_bytes, 'e') + "\"}";
    return attempt;
  }
  void add(int count) {
    for (int i = 0; i < count; ++i) registry_.record(attempt(++end_));
  }
  static HistoryQuery about(const std::string& subject, std::uint32_t page_size = 1000) {
    HistoryQuery query;
    query.subject = subject;
    query.page_size = page_size;
    return query;
  }
  HistoryPage page(const HistoryQuery& query) {
    auto answered = answer(database_, query);
    if (const auto* bad = std::get_if<BadQuestion>(&answered)) ADD_FAILURE() << bad->reason;
    return std::get<HistoryPage>(std::move(answered));
  }
  std::string refusal(const HistoryQuery& query) {
    const auto answered = answer(database_, query);
    const auto* bad = std::get_if<BadQuestion>(&answered);
    return bad ? bad->reason : "answered";
  }
  /// Every row of a question; `between` runs after each page.
  std::vector<Json> rows(
      HistoryQuery query, const std::function<void()>& between = [] {}) {
    std::vector<Json> all;
    do {
      const HistoryPage one = page(query);
      EXPECT_LE(one.rows.size(), query.page_size);
      for (const std::string& row : one.rows) all.push_back(Json::parse(row));
      query.cursor = one.next_cursor;
      between();
    } while (!query.cursor.empty());
    return all;
  }
  static std::vector<std::int64_t> ids(const std::vector<Json>& rows) {
    std::vector<std::int64_t> ids;
    for (const Json& row : rows) ids.push_back(row["id"].get<std::int64_t>());
    return ids;
  }
  static std::vector<std::int64_t> from_to(std::int64_t first, std::int64_t last) {
    std::vector<std::int64_t> numbers;
    const std::int64_t step = first <= last ? 1 : -1;
    for (std::int64_t i = first; i != last + step; i += step) numbers.push_back(i);
    return numbers;
  }

 private:
  storage::Time end_ = 0;
};

TEST_F(Answers, PagesGiveEachAttemptOnceWhileAttemptsAreAdded) {
  add(25);
  int more = 3;
  const auto all = rows(about("attempts", 4), [&] {
    if (more-- > 0) add(2);
  });
  EXPECT_EQ(ids(all), from_to(1, 31)) << "those added before the last page are on it";
}

TEST_F(Answers, NewestFirstGivesWhatWasThereWhenTheFirstPageWasAskedFor) {
  add(25);
  HistoryQuery query = about("attempts", 4);
  query.newest_first = true;
  EXPECT_EQ(ids(rows(query, [&] { add(1); })), from_to(25, 1));
}

TEST_F(Answers, TheLastPageHasNoCursorAlsoWhereItIsFull) {
  add(8);
  HistoryQuery query = about("attempts", 4);
  query.cursor = page(query).next_cursor;
  const HistoryPage last = page(query);
  EXPECT_EQ(last.rows.size(), 4U);
  EXPECT_EQ(last.next_cursor, "");
}

TEST_F(Answers, APageIsBoundedInBytesAndALargerRowIsAPageAlone) {
  for (int i = 0; i < 6; ++i) registry_.record(attempt(2, 100'000));
  registry_.record(attempt(2, 1'000'000));
  registry_.record(attempt(2, 100));
  HistoryQuery query = about("attempts");
  std::vector<std::size_t> sizes;
  do {
    const HistoryPage one = page(query);
    sizes.push_back(one.rows.size());
    query.cursor = one.next_cursor;
  } while (!query.cursor.empty());
  EXPECT_THAT(sizes, testing::ElementsAre(2, 2, 2, 1, 1));
}

TEST_F(Answers, FiltersSelectByEquipmentTimeAndVersion) {
  add(10);
  const auto version = [&](storage::Time end) {
    return registry_.record(attempt(end), {R"({"order":2})", "d"},
                            {storage::DecisionKind::reject, "gate", "because"});
  };
  version(100);
  version(102);
  HistoryQuery query = about("attempts");
  query.equipment = "ODD";
  EXPECT_EQ(rows(query).size(), 5U);
  query = about("attempts");
  query.range = {5, 6};  // windows (t - 10, t] overlap it from t = 6 on
  EXPECT_EQ(ids(rows(query)), from_to(6, 10));
  query = about("model");
  query.equipment = "EVEN";
  query.version = 2;
  const auto models = rows(query);
  ASSERT_EQ(models.size(), 1U);
  EXPECT_EQ(models[0]["model"]["order"], 2);
  EXPECT_EQ(models[0]["status"], "rejected");
  query.version = 3;
  EXPECT_TRUE(rows(query).empty());
  EXPECT_EQ(rows(about("versions")).size(), 2U);
  query = about("decisions", 1);
  query.range = {101, 200};
  EXPECT_EQ(rows(query).size(), 1U);
}

TEST_F(Answers, TheChampionIsThatOfTheEndOfTheRange) {
  for (const storage::Time time : {100, 200})
    registry_.record(attempt(time), {"{}", "d"},
                     {storage::DecisionKind::approve, "gate", "because"});
  const auto champion = [&](storage::TimeRange range) {
    HistoryQuery query = about("champion", 1);
    query.range = range;
    const Json decision = rows(query).at(0)["decision"];
    return decision.is_null() ? 0 : decision["version"].get<int>();
  };
  EXPECT_EQ(champion({}), 2);
  EXPECT_EQ(champion({99, 100}), 0);
  EXPECT_EQ(champion({100, 101}), 1);
  EXPECT_EQ(champion({199, 200}), 1);
  EXPECT_EQ(champion({200, 201}), 2);
  EXPECT_EQ(champion({0, INT64_MAX}), 2);
}

TEST_F(Answers, EquipmentGoesOnBehindTheNameThatThePageEndedWith) {
  add(2);
  const auto all = rows(about("equipment", 1));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0]["equipment"], "EVEN");
  EXPECT_EQ(all[1]["equipment"], "ODD");
  EXPECT_TRUE(all[1]["hold"].is_null());
}

TEST_F(Answers, AQuestionThatCannotBeAnsweredGetsAReasonAndARemedy) {
  add(2);
  EXPECT_THAT(refusal(about("weather")),
              HasSubstr("there is no subject 'weather'; ask for one of equipment, attempts, "));
  EXPECT_EQ(refusal(about("attempts", 0)), "page_size is 0; ask for 1 to 10000 rows a page");
  EXPECT_THAT(refusal(about("attempts", 4'000'000'000)), HasSubstr("ask for 1 to 10000 rows"));
  HistoryQuery query = about("attempts");
  query.equipment = "NONE";
  EXPECT_EQ(refusal(query), "nothing is known about (any)/NONE; the service has SAT/EVEN, SAT/ODD");
  query.equipment = "two\nlines";
  EXPECT_THAT(refusal(query), HasSubstr("equipment has a control character"));
  query.equipment = std::string(256, 'x');
  EXPECT_THAT(refusal(query), HasSubstr("a name has at most 255"));
  query = about("attempts");
  query.range = {5, 4};
  EXPECT_THAT(refusal(query), HasSubstr("swap begin_ns and end_ns"));
  query = about("attempts");
  query.version = -1;
  EXPECT_THAT(refusal(query), HasSubstr("versions count from 1"));
  for (const char* cursor : {"x", "0123456789abcdef[1]", "not a cursor at all, but long enough"}) {
    query = about("attempts");
    query.cursor = cursor;
    EXPECT_THAT(refusal(query), HasSubstr("begin again with an empty one")) << cursor;
  }
  query = about("samples");
  EXPECT_THAT(refusal(query), HasSubstr("name its spacecraft"));
  query = about("completeness");
  EXPECT_THAT(refusal(query), HasSubstr("give step_ns above 0"));
  query.range = {0, INT64_MAX};
  query.step = 1;
  EXPECT_THAT(refusal(query), HasSubstr("ask for at most 100000"));
}

TEST_F(Answers, SamplesComeInOrderOfTimeEachOnce) {
  storage::Archive archive(database_);
  constexpr int count = 30'000;
  std::vector<storage::TelemetryFrame> frames;
  for (int i = 0; i < count; ++i)
    frames.push_back({"SAT",
                      "station",
                      storage::Origin::real,
                      static_cast<std::uint64_t>(i),
                      i,
                      i,
                      {{3, storage::Quality::good, 0.1 * i}}});
  archive.append(frames);
  HistoryQuery query = about("samples", 7);
  query.spacecraft = "SAT";
  query.parameter = 3;
  query.range = {10, count - 10};
  storage::Time next = 10;
  for (const Json& row : rows(query))
    for (const Json& time : row["times_ns"]) {
      EXPECT_EQ(time.get<storage::Time>(), next);
      ++next;
    }
  EXPECT_EQ(next, count - 10);
}

}  // namespace
}  // namespace reident::history::answer_test
