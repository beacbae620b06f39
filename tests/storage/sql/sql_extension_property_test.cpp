// The virtual table telemetry against a plain table that holds the same rows: any condition, any
// order, operands of any type give the same answer.
#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "storage/types/utc_text.hpp"
#include "tests/storage/fixture.hpp"
#include "tests/storage/sql/sql_user.hpp"

namespace reident::storage::test::sql_extension_property_test {
namespace {

using Texts = std::vector<std::string>;

// Few identities, so that fragments lie over chunks, and values that are hard to keep.
rc::Gen<TelemetryFrame> frames() {
  const auto samples = rc::gen::build<Sample>(
      rc::gen::set(&Sample::parameter, rc::gen::inRange(1U, 5U)),
      rc::gen::set(&Sample::quality, rc::gen::elementOf(qualities)),
      rc::gen::set(&Sample::value, rc::gen::element(0.0, -0.0, 1.0, 2.0, 28.5, -7.25,
                                                    std::numeric_limits<double>::quiet_NaN(),
                                                    std::numeric_limits<double>::infinity(),
                                                    -std::numeric_limits<double>::infinity())));
  return rc::gen::build<TelemetryFrame>(
      rc::gen::set(&TelemetryFrame::spacecraft, rc::gen::element<std::string>("CB4", "CB4A")),
      rc::gen::set(&TelemetryFrame::source, rc::gen::element<std::string>("a", "b")),
      rc::gen::set(&TelemetryFrame::origin,
                   rc::gen::weightedElement<Origin>({{3, Origin::real}, {1, Origin::simulated}})),
      rc::gen::set(&TelemetryFrame::sequence, rc::gen::inRange<std::uint64_t>(0, 20)),
      rc::gen::set(
          &TelemetryFrame::generation_time,
          rc::gen::weightedOneOf<Time>({{8, rc::gen::inRange<Time>(-20, 60)},
                                        {1, rc::gen::element(std::numeric_limits<Time>::min(),
                                                             std::numeric_limits<Time>::max())}})),
      rc::gen::set(&TelemetryFrame::samples,
                   rc::gen::resize(4, rc::gen::container<std::vector<Sample>>(samples))));
}

std::string quoted(const std::string& text) {
  return "'" + text + "'";
}

rc::Gen<std::string> number() {
  return rc::gen::weightedOneOf<std::string>(
      {{5, rc::gen::map(rc::gen::inRange(-25, 65), [](int n) { return std::to_string(n); })},
       {2, rc::gen::map(rc::gen::inRange(-25, 65), [](int n) { return std::to_string(n) + ".5"; })},
       {1, rc::gen::element<std::string>("-0.0", "1e300", "-1e300", "9e999", "-9e999",
                                         "9223372036854775807", "(-9223372036854775807 - 1)",
                                         "9223372036854775808", "-9223372036854775809",
                                         "9223372036854774784.0")}});
}

/// An operand of a condition on a time or a value: what it should be, or anything else.
rc::Gen<std::string> operand() {
  return rc::gen::weightedOneOf<std::string>(
      {{12, number()},
       {1, rc::gen::map(number(), [](const std::string& n) { return quoted(n); })},
       {1, rc::gen::element<std::string>("NULL", "'abc'", "''", "x'31'", "' 7 '", "'1e1'")}});
}

rc::Gen<std::string> utc_operand() {
  return rc::gen::weightedOneOf<std::string>(
      {{5, rc::gen::map(rc::gen::inRange<Time>(-25, 65),
                        [](Time time) { return quoted(utc_text(time)); })},
       {2, rc::gen::element<std::string>(
               "'1970-01-01T00:00:00.00000001'", "'1970'", "'1969-12-31T23:59:59.99999999'",
               "'2262-04-11T23:47:16.854775807Z'", "'2262-04-11T23:47:16.854775807Z '",
               "'1677-09-21T00:12:43.145224192Z'", "'1677'", "'zz'", "''")},
       {1, rc::gen::element<std::string>("NULL", "7", "1970", "1970.5", "x'31'")}});
}

rc::Gen<std::string> text_operand(const Texts& known) {
  return rc::gen::weightedOneOf<std::string>(
      {{8, rc::gen::map(rc::gen::elementOf(known), quoted)},
       {1, rc::gen::element<std::string>("NULL", "'?'", "''", "3", "3.0", "x'33'", "'cb4'")}});
}

rc::Gen<std::string> condition(const std::string& column, const rc::Gen<std::string>& operands,
                               const std::vector<std::string>& operations) {
  return rc::gen::exec([=] {
    const std::string operation = *rc::gen::elementOf(operations);
    if (operation == "IN" || operation == "NOT IN") {
      std::string list;
      for (const std::string& one :
           *rc::gen::resize(4, rc::gen::nonEmpty(rc::gen::container<Texts>(operands))))
        list += (list.empty() ? "" : ", ") + one;
      return column + " " + operation + " (" + list + ")";
    }
    if (operation == "BETWEEN") return column + " BETWEEN " + *operands + " AND " + *operands;
    if (operation == "IS NULL" || operation == "IS NOT NULL") return column + " " + operation;
    return column + " " + operation + " " + *operands;
  });
}

Texts quality_names() {
  Texts names;
  for (const Quality quality : qualities) names.emplace_back(name(quality));
  return names;
}

rc::Gen<std::string> condition() {
  const Texts compared = {"=", "<", "<=", ">", ">=", "<>", "BETWEEN", "IN", "IS", "IS NOT NULL"};
  const Texts named = {"=", "=", "IN", "IN", "<>", "NOT IN", "<", "LIKE", "IS"};
  return rc::gen::weightedOneOf<std::string>(
      {{3, condition("spacecraft", text_operand({"CB4", "CB4A"}), named)},
       {4, condition("parameter", text_operand({"V_BUS", "I_BUS", "3", "4"}), named)},
       {2, condition("origin", text_operand({"real", "simulated"}), named)},
       {2, condition("source", text_operand({"a", "b"}), named)},
       {2, condition("quality", text_operand(quality_names()), named)},
       {6, condition("time", operand(), compared)},
       {3, condition("utc", utc_operand(), compared)},
       {3,
        condition("value", operand(),
                  {"=", "<", "<=", ">", ">=", "<>", "BETWEEN", "IN", "IS NULL", "IS NOT NULL"})}});
}

rc::Gen<std::string> conditions() {
  return rc::gen::exec([] {
    std::string all;
    for (const std::string& one : *rc::gen::resize(5, rc::gen::container<Texts>(condition())))
      all += (all.empty() ? " WHERE " : *rc::gen::inRange(0, 4) == 0 ? " OR " : " AND ") + one;
    return all;
  });
}

rc::Gen<Texts> order_terms() {
  return rc::gen::exec([] {
    Texts terms;
    for (const std::string& column :
         *rc::gen::resize(4, rc::gen::container<Texts>(rc::gen::element<std::string>(
                                 "time", "time", "time", "utc", "spacecraft", "parameter", "origin",
                                 "source", "value"))))
      terms.push_back(column + *rc::gen::element<std::string>("", "", " DESC"));
    return terms;
  });
}

std::string joined(const Texts& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
  return all;
}

class Twins {
 public:
  Twins() {
    const auto describe = [&](std::uint32_t id, const char* name) {
      for (const char* spacecraft : {"CB4", "CB4A"}) {
        ParameterDescriptor descriptor;
        descriptor.spacecraft = spacecraft;
        descriptor.id = id;
        descriptor.name = name;
        archive_.describe(std::span(&descriptor, 1));
      }
    };
    describe(1, "V_BUS");
    describe(2, "I_BUS");
    const auto batches = *rc::gen::resize(
        12, rc::gen::container<std::vector<std::vector<TelemetryFrame>>>(
                rc::gen::resize(12, rc::gen::container<std::vector<TelemetryFrame>>(frames()))));
    for (const auto& batch : batches) archive_.append(batch);
    user_ = std::make_unique<SqlUser>(folder_ / "a.db");
    fill_plain();
  }
  /// Both questions give the same rows, or in any order the same ones.
  void compare(const std::string& question, const std::string& plain_question,
               bool in_order = false) const {
    Texts rows = user_->ask(question), expected = user_->ask(plain_question);
    if (!in_order) {
      std::sort(rows.begin(), rows.end());
      std::sort(expected.begin(), expected.end());
    }
    const std::string last = expected.empty() ? "" : expected.back();
    if (last.starts_with("error")) RC_FAIL(plain_question + ": " + last);
    if (rows == expected) return;
    const auto [row, other] =
        std::mismatch(rows.begin(), rows.end(), expected.begin(), expected.end());
    RC_FAIL(question + ": " + std::to_string(rows.size()) + " rows, expected " +
            std::to_string(expected.size()) +
            "; the first difference: " + (row == rows.end() ? "nothing" : *row) + ", expected " +
            (other == expected.end() ? "nothing" : *other));
  }
  /// Asks both tables one question.
  void ask_both(const std::string& columns, const std::string& after, bool in_order = false) const {
    compare("SELECT " + columns + " FROM telemetry" + after,
            "SELECT " + columns + " FROM plain" + after, in_order);
  }

 private:
  void fill_plain() {
    user_->ask(
        "CREATE TEMP TABLE plain (spacecraft TEXT, parameter TEXT, source TEXT, time INTEGER, "
        "value, quality TEXT, origin TEXT, utc TEXT)");
    const Texts names = {"", "V_BUS", "I_BUS", "3", "4"};
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(user_->handle(),
                       "INSERT INTO plain VALUES (?, ?, (SELECT name FROM source "
                       "WHERE id = ?), ?, ?, ?, ?, ?)",
                       -1, &insert, nullptr);
    for (const std::string& spacecraft : archive_.spacecraft())
      for (const Origin origin : {Origin::real, Origin::simulated})
        for (std::uint32_t parameter = 1; parameter < 5; ++parameter) {
          const Series series = archive_.read_with_sources(
              spacecraft, origin, parameter,
              {std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()});
          for (std::size_t i = 0; i < series.time.size(); ++i) {
            const auto text = [insert](int index, std::string_view its) {
              sqlite3_bind_text(insert, index, its.data(), static_cast<int>(its.size()),
                                SQLITE_TRANSIENT);
            };
            text(1, spacecraft);
            text(2, names[parameter]);
            sqlite3_bind_int64(insert, 3, series.source[i]);
            sqlite3_bind_int64(insert, 4, series.time[i]);
            sqlite3_bind_double(insert, 5, series.value[i]);
            text(6, name(series.quality[i]));
            text(7, name(origin));
            text(8, utc_text(series.time[i]));
            sqlite3_step(insert);
            sqlite3_reset(insert);
          }
        }
    sqlite3_finalize(insert);
  }

  TemporaryFolder folder_;
  Database database_{folder_ / "a.db", Database::Mode::read_write};
  Archive archive_{
      database_,
      *rc::gen::build<ArchiveOptions>(
          rc::gen::set(&ArchiveOptions::chunk_samples, rc::gen::inRange<std::size_t>(16, 24)),
          rc::gen::set(&ArchiveOptions::recent_samples, rc::gen::inRange<std::size_t>(1, 200)),
          rc::gen::set(&ArchiveOptions::recent_batches, rc::gen::inRange<std::size_t>(1, 8)))};
  std::unique_ptr<SqlUser> user_;
};

constexpr const char* all_columns =
    "spacecraft, parameter, source, time, value, quality, origin, utc, typeof(value)";

// Neither 0.0 nor -0.0 is the greater one, and either may be given as such.
const std::string size = "value + 0.0";

RC_GTEST_PROP(SqlExtensionProperty, AnyConditionGivesTheRowsOfAPlainTable, ()) {
  const Twins twins;
  for (int i = 0; i < 20; ++i) twins.ask_both(all_columns, *conditions());
}

RC_GTEST_PROP(SqlExtensionProperty, AnyOrderIsThatOfAPlainTable, ()) {
  const Twins twins;
  for (int i = 0; i < 20; ++i) {
    Texts terms = *order_terms();
    if (terms.empty()) terms.push_back("time");
    Texts columns = terms;
    for (std::string& column : columns) column = column.substr(0, column.find(' '));
    std::replace(columns.begin(), columns.end(), std::string("value"), size);
    const std::string keys = joined(columns);
    const std::string order = *conditions() + " ORDER BY " + joined(terms);
    twins.ask_both(keys, order, true);  // rows of one key may come in any order
    twins.ask_both(all_columns, order);
    const int limit = *rc::gen::inRange(0, 9), offset = *rc::gen::inRange(0, 5);
    twins.ask_both(keys,
                   order + " LIMIT " + std::to_string(limit) + " OFFSET " + std::to_string(offset),
                   true);
  }
}

RC_GTEST_PROP(SqlExtensionProperty, GroupsAndJoinsAreThoseOfAPlainTable, ()) {
  const Twins twins;
  for (int i = 0; i < 10; ++i) {
    const std::string where = *conditions();
    const std::string by = *rc::gen::element<std::string>(
        "parameter", "spacecraft, parameter", "origin", "parameter, origin, spacecraft", "time",
        "quality", "utc", "time, parameter");
    twins.ask_both(by + ", count(*), count(value), min(time), max(" + size + ")",
                   where + " GROUP BY " + by);
    twins.ask_both("DISTINCT " + by, where);
    twins.ask_both(all_columns,
                   " JOIN (SELECT column1 AS name, column2 AS first, column3 AS last FROM (VALUES "
                   "('V_BUS', -5, 20), ('3', 10.5, 30), ('3', NULL, 9), ('I_BUS', '3', 50))) "
                   "ON parameter = name AND time >= first AND time < last" +
                       where);
  }
}

RC_GTEST_PROP(SqlExtensionProperty, SummariesAreThoseOfAPlainTable, ()) {
  const Twins twins;
  for (int i = 0; i < 10; ++i) {
    const std::string begin = std::to_string(*rc::gen::inRange(-25, 65));
    const std::string end = std::to_string(*rc::gen::inRange(-25, 65));
    const std::string step = std::to_string(*rc::gen::inRange(1, 50));
    const std::string quality = *rc::gen::element<std::string>("", "good", "invalid");
    const std::string summary = " FROM telemetry_summary(" + begin + ", " + end + ", " + step +
                                (quality.empty() ? ")" : ", '" + quality + "')");
    const std::string where = " WHERE time >= " + begin + " AND time < " + end +
                              (quality.empty() ? "" : " AND quality = '" + quality + "'");
    // Floor division, which SQL does not have.
    const std::string bucket = "(time - (time % " + step + " + " + step + ") % " + step + ")";
    const std::string keys = "SELECT spacecraft, parameter, origin, ";
    const std::string group = where + " GROUP BY spacecraft, parameter, origin, " + bucket;
    twins.compare(
        keys + "bucket, samples, first_time, last_time, least + 0.0, greatest + 0.0, mean" +
            summary,
        keys + bucket + ", count(*), min(time), max(time), min(" + size + "), max(" + size +
            "), "
            "avg(value) FROM plain" +
            group);
    twins.compare(
        keys + "bucket, samples, least + 0.0, greatest + 0.0" + summary,
        keys + bucket + ", count(*), min(" + size + "), max(" + size + ") FROM plain" + group);
    twins.compare(keys + "first_value, last_value" + summary,
                  keys +
                      "(SELECT value FROM plain AS p WHERE p.time = first AND p.spacecraft = "
                      "g.spacecraft AND p.parameter = g.parameter AND p.origin = g.origin), "
                      "(SELECT value FROM plain AS p WHERE p.time = last AND p.spacecraft = "
                      "g.spacecraft AND p.parameter = g.parameter AND p.origin = g.origin) FROM "
                      "(SELECT *, min(time) AS first, max(time) AS last FROM plain" +
                      group + ") AS g");
  }
}

}  // namespace
}  // namespace reident::storage::test::sql_extension_property_test
