#include "service/history/cursor.hpp"

#include <gtest/gtest.h>

namespace reident::history::cursor_test {
namespace {

HistoryQuery question() {
  HistoryQuery query;
  query.subject = "attempts";
  query.spacecraft = "SAT";
  return query;
}

TEST(Cursor, GivesBackItsKeyForTheSameQuestionAndAnySizeOfPage) {
  HistoryQuery query = question();
  const Json key = {INT64_MIN, "a \"name\"", 7};
  query.cursor = cursor_after(query, key);
  query.page_size = 3;
  ASSERT_TRUE(key_of_cursor(query));
  EXPECT_EQ(*key_of_cursor(query), key);
}

TEST(Cursor, IsRefusedWhenAnyOfItsCharactersIsChangedOrMissing) {
  HistoryQuery query = question();
  const std::string cursor = cursor_after(query, Json::array({123456}));
  for (std::size_t i = 0; i < cursor.size(); ++i) {
    query.cursor = cursor;
    query.cursor[i] = query.cursor[i] == '1' ? '2' : '1';
    EXPECT_FALSE(key_of_cursor(query)) << query.cursor;
    query.cursor = cursor.substr(0, i);
    EXPECT_FALSE(key_of_cursor(query)) << query.cursor;
  }
}

TEST(Cursor, IsRefusedForAnotherQuestion) {
  const HistoryQuery asked = question();
  const std::string cursor = cursor_after(asked, Json::array({1}));
  const auto refuses = [&](const auto& change) {
    HistoryQuery other = asked;
    other.cursor = cursor;
    change(other);
    return !key_of_cursor(other).has_value();
  };
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.subject = "decisions"; }));
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.spacecraft = "SAT2"; }));
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.equipment = "BDR"; }));
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.range = {0, 5}; }));
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.version = 1; }));
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.newest_first = true; }));
  EXPECT_TRUE(refuses([](HistoryQuery& q) { q.parameter = 1; }));
}

}  // namespace
}  // namespace reident::history::cursor_test
