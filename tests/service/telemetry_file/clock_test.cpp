// Times in every form that people have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/service/telemetry_file/first_time.hpp"

namespace reident::telemetry_file::clock_test {
namespace {

using test::first_time;
using test::in_2026;
using testing::HasSubstr;

TEST(TelemetryClock, ARowWithoutAYearHasNoTime) {
  for (const std::string rest : {",1", ",9", ",059"})
    EXPECT_THAT(first_time("year,doy", {rest, "2024,60", "2024,61"}), HasSubstr("t.csv"));
}

struct FormCase {
  const char* names;
  std::vector<std::string> cells;
  const char* time;
};

TEST(TelemetryClock, ReadsEveryForm) {
  for (const FormCase& c : {
           FormCase{"time", {"2024-02-28T22:00:00.5Z"}, "2024-02-28T22:00:00.5Z"},
           FormCase{"time", {"2024-02-28T23:00:00+01:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-060T22:00:00Z"}, "2024-02-29T22:00:00Z"},
           FormCase{"time", {"2024:060:22:00:00.000"}, "2024-02-29T22:00:00Z"},
           FormCase{"time", {"2024.060.22.00.00.250"}, "2024-02-29T22:00:00.25Z"},
           FormCase{"unix_s", {"0.1709157600D+10"}, "2024-02-28T22:00:00Z"},
           FormCase{"YYYYDDD,SOD", {"2024059,79200.500"}, "2024-02-28T22:00:00.5Z"},
           FormCase{"time", {"24.060.22.00.00.250"}, "2024-02-29T22:00:00.25Z"},
           FormCase{"time", {"\"Feb 28, 2024 @ 22:00:00.250\""}, "2024-02-28T22:00:00.25Z"},
           FormCase{"time",
                    {"2024\u5E7402\u670828\u65E5 22\u664200\u520630\u79D2"},
                    "2024-02-28T22:00:30Z"},
           FormCase{"time", {"2024-W09-3T22:00:00Z"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28.02.2024 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time",
                    {"02/28/2024 10:00:00 PM", "02/28/2024 10:00:10 PM"},
                    "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28-Feb-2024 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"20240228220000", "20240228220010"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2016-12-31T23:59:60Z"}, "2016-12-31T23:59:59.999Z"},
           FormCase{"time", {"1709157600"}, "2024-02-28T22:00:00Z"},
           FormCase{"timeStamp", {"1709157600000"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"1709157600000000"}, "2024-02-28T22:00:00Z"},
           FormCase{"time_ns", {"1709157600000000000"}, "2024-02-28T22:00:00Z"},
           FormCase{"Timestamp", {"133536312000000000"}, "2024-02-28T22:00:00Z"},
           FormCase{"Time", {"45350.9166666667", "45350.9167824074"}, "2024-02-28T22:00:00Z"},
           FormCase{"MJD", {"60368.91666667"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2460369.41666667"}, "2024-02-28T22:00:00Z"},
           FormCase{"gps_s", {"1393192818"}, "2024-02-28T22:00:00Z"},
           FormCase{"week,tow", {"2303,338418"}, "2024-02-28T22:00:00Z"},
           FormCase{"year,doy,sec_of_day", {"2024,059,79200"}, "2024-02-28T22:00:00Z"},
           FormCase{"Year,Month,Day,Hour,Minute,Second",
                    {"2024,2,28,22,0,0.5"},
                    "2024-02-28T22:00:00.5Z"},
           FormCase{"Date,Time", {"2024-02-28,22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"Data,Hora", {"28/02/2024,22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"Jour,Moment", {"28.02.2024,22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"date,time", {"20240229,93000", "20240229,103000"}, "2024-02-29T09:30:00Z"},
           FormCase{"YYYY,MM,DD,HH,MI,SS", {"2024,02,28,22,00,10"}, "2024-02-28T22:00:10Z"},
           FormCase{"year,doy", {"2024,59.91666667"}, "2024-02-28T22:00:00Z"},
           FormCase{"year,doy", {"2024,9.5"}, "2024-01-09T12:00:00Z"},
           FormCase{"GPSWeek,GPSSec", {"2303,338418.000"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"\"1,709,157,600\"", "\"1,709,157,610\""}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024059220010"}, "2024-02-28T22:00:10Z"},
           FormCase{"time", {"24-059T22:00:10"}, "2024-02-28T22:00:10Z"},
           FormCase{"time", {"[2024-02-28 22:00:00]"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"Wed Feb 28 22:00:10 UTC 2024"}, "2024-02-28T22:00:10Z"},
           FormCase{"time", {"28. Februar 2024 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"1 juil. 2024 22:00:00"}, "2024-07-01T22:00:00Z"},
           FormCase{"time", {"28 f\xC3\xA9vr. 2024 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-10-27 02:10:00 CEST"}, "2024-10-27T00:10:00Z"},
           FormCase{"time", {"Mi 28.02.2024 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"mer. 28/02/2024 22h00m30s"}, "2024-02-28T22:00:30Z"},
           FormCase{"time", {"Mar 28 2024 22:00:00"}, "2024-03-28T22:00:00Z"},
           FormCase{"Date,Heure", {"28/02/2024,22h00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28.02.2024 22:00:00 Uhr"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024. 02. 28. 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28/02/2024 10:00:00 p.\u00A0m."}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"02/28/2024 10:00:00\u202FPM"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-02-28 \uC624\uD6C4 10:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024. 2. 28. \uC624\uC804 10:00:00"}, "2024-02-28T10:00:00Z"},
           FormCase{"time", {"2024/02/28 \u4E0B\u5348 10:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28/2/2024 10:00:00 \u03BC\u03BC"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-02-28T23:00:00+01:00[Europe/Berlin]"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-02-28 23:00:00 (CET)"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28FEB2024:22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-02-28_22-00-30"}, "2024-02-28T22:00:30Z"},
           FormCase{"time", {"22:00:30.500 28.02.2024"}, "2024-02-28T22:00:30.5Z"},
           FormCase{"time", {"'2024-02-28 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{
               "Date,Time", {"24-02-28,22:00:00", "24-02-28,22:00:10"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"24/02/28 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"28/02/24 22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"datenum", {"739310.9166666667", "739310.9167824074"}, "2024-02-28T22:00:00Z"},
           FormCase{"JD", {"2460369.416666667", "2460369.416782407"}, "2024-02-28T22:00:00Z"},
           FormCase{"time_ticks", {"638447544000000000"}, "2024-02-28T22:00:00Z"},
           FormCase{"Zeit (MEZ)", {"28.02.2024 23:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time_CEST", {"2024-02-29T00:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"Time [UTC+01:00]", {"2024-02-28 23:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time [Europe/Berlin]", {"2024-07-01 00:00:00"}, "2024-06-30T22:00:00Z"},
           FormCase{"datum,zeit,zone", {"28.02.2024,23:00:00,MEZ"}, "2024-02-28T22:00:00Z"},
           FormCase{
               "Local time,UTC", {"2024-02-28 23:00,2024-02-28 22:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time,zone", {"2024-07-01 00:00,Europe/Berlin"}, "2024-06-30T22:00:00Z"},
           FormCase{"time,utc_offset", {"2024-02-28 23:00:00,+01:00"}, "2024-02-28T22:00:00Z"},
       })
    EXPECT_EQ(first_time(c.names, c.cells), c.time) << c.cells[0];
}

TEST(TelemetryClock, ReadsTheFormsOfPrograms) {
  for (const FormCase& c : {
           FormCase{"date,time,ms",
                    {"2024-02-28,22:00:00,7", "2024-02-28,22:00:00,507"},
                    "2024-02-28T22:00:00.007Z"},
           FormCase{"time_s,usec", {"1709157600,250000"}, "2024-02-28T22:00:00.25Z"},
           FormCase{"time (CET)", {"2024-02-28 23:00:00+02:00"}, "2024-02-28T21:00:00Z"},
           FormCase{"(PDH-CSV 4.0) (W. Europe Standard Time)(-60)",
                    {"02/28/2024 23:00:00.000"},
                    "2024-02-28T22:00:00Z"},
           FormCase{"time", {"2024-02-29 07:00:00 JST"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"240228220010", "240228220020"}, "2024-02-28T22:00:10Z"},
           FormCase{"time", {"202402282210", "202402282220"}, "2024-02-28T22:10:00Z"},
           FormCase{"header.stamp.secs,header.stamp.nsecs",
                    {"1709157600,500000000", "1709157601,0"},
                    "2024-02-28T22:00:00.5Z"},
           FormCase{"sec,nanosec", {"1709157600,500000000"}, "2024-02-28T22:00:00.5Z"},
           FormCase{"Date,Time", {"2024-02-28 00:00:00,22:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"Date,Time,sec",
                    {"2024-02-28,22:00:10,0.250", "2024-02-28,22:00:20,0.500"},
                    "2024-02-28T22:00:10.25Z"},
           FormCase{"year,doy,hhmm,sec", {"2024,59,2200,10"}, "2024-02-28T22:00:10Z"},
           FormCase{"EPOCH_TIME", {"28-02-2024 22:00:10.250.000.000"}, "2024-02-28T22:00:10.25Z"},
           FormCase{"time", {"28/02/24:22:00:10"}, "2024-02-28T22:00:10Z"},
           FormCase{"GPS Week,Seconds of Week", {"2303,338418"}, "2024-02-28T22:00:00Z"},
           FormCase{"time_cet", {"2024-02-28 23:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"Zeit/MEZ", {"28.02.2024 23:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time (+0100)", {"2024-02-28 23:00:00"}, "2024-02-28T22:00:00Z"},
           FormCase{"time", {"\"=\"\"2024-02-28 22:00:00\"\"\""}, "2024-02-28T22:00:00Z"},
           FormCase{"date,h,m,s", {"2024-02-28,22,0,10"}, "2024-02-28T22:00:10Z"},
           FormCase{"Date,Hour,Minute", {"28.02.2024,22,30"}, "2024-02-28T22:30:00Z"},
           FormCase{"year,doy,hhmm", {"2024,059,930", "2024,059,2200"}, "2024-02-28T09:30:00Z"},
           FormCase{"YYYY,MM,DD,hh,mm,ss", {"2024,2,28,22,0,10"}, "2024-02-28T22:00:10Z"},
           FormCase{"time", {"\"28.2.2024, 22:00:00\""}, "2024-02-28T22:00:00Z"},
       })
    EXPECT_EQ(first_time(c.names, c.cells), c.time) << c.cells[0];
}

TEST(TelemetryClock, ReadsWhatIsSaidOfIt) {
  TimeOptions year_first;
  year_first.order = DateOrder::year_first;
  EXPECT_EQ(first_time("time", {"21-02-23 22:00"}, year_first), "2021-02-23T22:00:00Z");
  TimeOptions epoch;
  epoch.epoch_ns = parse_time("2024-02-01T00:00:00Z");
  EXPECT_EQ(first_time("met_s", {"2412000.5"}, epoch), "2024-02-28T22:00:00.5Z");
  EXPECT_EQ(first_time("met_ms", {"2412000500"}, epoch), "2024-02-28T22:00:00.5Z");
  TimeOptions ms;
  ms.unit_ns = 1'000'000;
  EXPECT_EQ(first_time("time", {"1709157600000"}, ms), "2024-02-28T22:00:00Z");
  TimeOptions order;
  order.format = TimeFormat::text;
  order.order = DateOrder::month_first;
  EXPECT_EQ(first_time("time", {"03/04/2024 22:00"}, order), "2024-03-04T22:00:00Z");
  TimeOptions columns;
  columns.column = "a,b";
  EXPECT_EQ(first_time("a,b", {"2024-02-28,22:00"}, columns), "2024-02-28T22:00:00Z");
  EXPECT_EQ(first_time("a,b", {"2024061,43200", "2024061,43260"}, columns), "2024-03-01T12:00:00Z");
  EXPECT_EQ(first_time("a,b", {"2024061,120000", "2024061,120010"}, columns),
            "2024-03-01T12:00:00Z");
  TimeOptions named;
  named.column = "tnum";
  EXPECT_EQ(first_time("tnum", {"739310.9166666666"}, named), "2024-02-28T22:00:00Z");
  columns.column = "day,sod";
  EXPECT_EQ(first_time("day,sod", {"2024061,43200.5"}, columns), "2024-03-01T12:00:00.5Z");
}

TEST(TelemetryClock, ReadsTimesThatHavePassedAsTheyAreWritten) {
  TimeOptions epoch;
  epoch.epoch_ns = parse_time("2024-02-28T00:00:00Z");
  for (const auto& [name, cell, time] : {std::tuple("MET", "001/02:00:10", "2024-02-29T02:00:10Z"),
                                         {"elapsed", "1 02:00:10", "2024-02-29T02:00:10Z"},
                                         {"t", "01:02:00:10", "2024-02-29T02:00:10Z"},
                                         {"t", "26:00:10", "2024-02-29T02:00:10Z"},
                                         {"Time", "59:10.5", "2024-02-28T00:59:10.5Z"},
                                         {"Time", "10 sec", "2024-02-28T00:00:10Z"},
                                         {"Elapsed (mm:ss)", "03:52", "2024-02-28T00:03:52Z"},
                                         {"Time", "1 days 02:00:10.5", "2024-02-29T02:00:10.5Z"},
                                         {"X_Value", "0.500000", "2024-02-28T00:00:00.5Z"},
                                         {"t (min)", "0.166667", "2024-02-28T00:00:10Z"},
                                         {"Time [h]", "0.00277778", "2024-02-28T00:00:10Z"}})
    EXPECT_EQ(first_time(name, {cell}, epoch), time) << cell;
}

TEST(TelemetryClock, BeginsDaysOfTheYearWithTheFirst) {
  TimeOptions epoch;
  epoch.epoch_ns = parse_time("2024-01-01T00:00:00Z");
  EXPECT_EQ(first_time("doy_time", {"059:22:00:00"}, epoch), "2024-02-28T22:00:00Z");
  epoch.column = "doy";
  EXPECT_EQ(first_time("doy", {"59.91666667"}, epoch), "2024-02-28T22:00:00Z");
}

TEST(TelemetryClock, IsInTheZoneThatALineAboveTheHeaderSays) {
  const auto time = [](const std::string& above, const TimeOptions& options = {}) {
    return first_time("time,y", {"2024-07-01 00:00:00,1", "2024-07-01 00:00:10,1"}, options, above);
  };
  for (const char* above :
       {"Timezone,Europe/Berlin\n", "# Zeitzone: Europe/Berlin\n",
        "Device,EPS\nAll times are CEST (UTC+2),\n", "Time zone,+02:00\n", "Zone,CEST\n",
        "Zone,CEST,\n", "GMT+2\n", "# UTC+02:00\n", "CEST,,\n", "(UTC+02:00)\n"})
    EXPECT_EQ(time(above), "2024-06-30T22:00:00Z") << above;
  for (const char* above : {"Exported at 2024-07-02 10:00 CEST,\n", "# Time zone: UTC\n"})
    EXPECT_EQ(time(above), "2024-07-01T00:00:00Z") << above;
  EXPECT_EQ(time("Time zone: (UTC+05:30)\n"), "2024-06-30T18:30:00Z");
  for (const char* above : {"Zone,IST,\n", "# Zone: IST\n", "\"(UTC+01:00) Amsterdam, Berlin\"\n",
                            "Time zone: (UTC+01:00) Berlin\n"})
    EXPECT_THAT(time(above), AllOf(HasSubstr("by line 1"), HasSubstr("--time-zone"))) << above;
  for (const char* above : {"# zone 3 heater\n", "Report of WEST\n"})
    EXPECT_EQ(time(above), "2024-07-01T00:00:00Z") << above;
  const std::string unknown = "# Time zone: W. Europe Standard Time\n";
  EXPECT_THAT(time(unknown), AllOf(HasSubstr("by line 1"), HasSubstr("--time-zone")));
  for (const char* zone : {"Europe/Berlin", "+02:00"}) {
    TimeOptions given;
    given.zone = zone;
    EXPECT_EQ(time(unknown, given), "2024-06-30T22:00:00Z");
  }
}

TEST(TelemetryClock, AsksWhereRowsAreOfSeveralClocksOrSpacecraft) {
  EXPECT_THAT(first_time("time_a,a,time_b", {"2024-02-28T22:00:00Z,1,2024-02-28T22:00:03Z",
                                             "2024-02-28T22:00:10Z,1,2024-02-28T22:00:13Z"}),
              HasSubstr("'time_a' and 'time_b'"));
  EXPECT_EQ(first_time("time_a,a,time_b", {"2024-02-28T22:00:00Z,1,2024-02-28T22:00:00Z",
                                           "2024-02-28T22:00:10Z,1,2024-02-28T22:00:10Z"}),
            "2024-02-28T22:00:00Z");
  const std::vector<std::string> numbers = {"2024-02-28T22:00:00Z,41", "2024-02-28T22:00:03Z,42"};
  for (const char* name : {"satellite_id", "Spacecraft ID", "norad_id"})
    EXPECT_THAT(first_time(std::string("time,") + name, numbers), HasSubstr("t.csv:3"));
  EXPECT_THAT(first_time("time,satellite", {"2024-02-28T22:00:00Z,A", "2024-02-28T22:00:03Z,B"}),
              HasSubstr("t.csv:3"));
  EXPECT_EQ(first_time("time,sat", numbers), "2024-02-28T22:00:00Z") << "satellites in view";
}

TEST(TelemetryClock, AsksWhereManyRowsHaveTheTimeOfTheRowBefore) {
  ReadingOptions options;
  options.latest_ns = in_2026;
  const std::string text =
      "time,x\n28.02.2024 22:00,1.5\n28.02.2024 22:00,1.6\n28.02.2024 22:00,1.7\n";
  const auto refused = [&](const std::string& of) {
    auto opened = TelemetryFile::of_text(of, "t.csv", options);
    const auto error = std::get<TelemetryFile>(opened).find_time();
    return error ? error->message : std::string();
  };
  EXPECT_THAT(refused(text),
              HasSubstr("t.csv:3: '28.02.2024 22:00' in column 'time' is the time of"));
  EXPECT_EQ(refused("time,x,y\n2024-02-28T22:00:00Z,1,\n2024-02-28T22:00:00Z,,2\n"), "")
      << "columns that take turns";
  EXPECT_EQ(refused("time,x\n2024-02-28T22:00:00Z,1\n2024-02-28T22:00:00Z,1\n"), "")
      << "rows that are there twice";
  options.force_times = true;
  EXPECT_EQ(refused(text), "");
}

TEST(TelemetryClock, TakesAShortYearFirstWhereTheRowsAreThenNearEachOther) {
  EXPECT_EQ(first_time("time", {"24-03-01 10:00", "24-03-02 10:00"}), "2024-03-01T10:00:00Z");
  EXPECT_EQ(first_time("Date,Time", {"24/03/01,10:00", "24/03/02,10:00"}), "2024-03-01T10:00:00Z");
  EXPECT_EQ(first_time("time", {"10-03-24", "11-03-24", "12-03-24"}), "2024-03-10T00:00:00Z");
  EXPECT_EQ(first_time("time", {"28-02-24 10:00"}), "2024-02-28T10:00:00Z");
  EXPECT_THAT(first_time("time", {"24-03-01 10:00", "24-03-01 10:10"}), HasSubstr("ymd, dmy"));
}

TEST(TelemetryClock, CountsInTheUnitAndSinceTheTimeThatTheNameSays) {
  TimeOptions from;
  from.epoch_ns = parse_time("2024-02-28T00:00:00Z");
  for (const char* name : {"Time (hr)", "time_hours", "Time [hrs]"})
    EXPECT_EQ(first_time(name, {"2", "3"}, from), "2024-02-28T02:00:00Z") << name;
  EXPECT_EQ(first_time("t (mins)", {"2"}, from), "2024-02-28T00:02:00Z");
  EXPECT_EQ(first_time("time (weeks)", {"1"}, from), "2024-03-06T00:00:00Z");
  EXPECT_EQ(first_time("time (seconds since 2000-01-01 00:00:00)", {"762429600"}),
            "2024-02-28T10:00:00Z");
  for (const char* name : {"Time (10 ms)", "time (orbits)", "Time [hl]", "time (ticks)"}) {
    EXPECT_THAT(first_time(name, {"2"}, from), HasSubstr("--time-unit")) << name;
    TimeOptions said = from;
    said.unit_ns = parse_time_unit("10ms");
    EXPECT_EQ(first_time(name, {"200"}, said), "2024-02-28T00:00:02Z") << name;
  }
  EXPECT_EQ(first_time("sec_since_2000", {"762429600"}), "2024-02-28T10:00:00Z");
  EXPECT_EQ(first_time("seconds since 1970", {"1709157600"}), "2024-02-28T22:00:00Z");
  for (const char* name : {"MJD2000", "time_mjd2000"})
    EXPECT_EQ(first_time(name, {"8824.91666667"}), "2024-02-28T22:00:00Z") << name;
}

TEST(TelemetryClock, AsksWhereItMayBeTwoThings) {
  EXPECT_THAT(first_time("OBT", {"762472800.0"}), HasSubstr("--epoch"));
  EXPECT_THAT(first_time("year,day", {"2024,28", "2024,29"}), HasSubstr("no column looks like"));
  EXPECT_THAT(first_time("time", {"03/04/2024 22:00", "03/04/2024 22:10"}),
              HasSubstr("--time-format dmy or mdy"));
  EXPECT_THAT(first_time("time_s", {"1709157600000"}), HasSubstr("--time-unit"));
  for (const char* name : {"Local time", "time [IST]", "Time (Pacific Time)", "Heure locale"})
    EXPECT_THAT(first_time(name, {"2024-02-28 23:00:00"}), HasSubstr("--time-zone")) << name;
  EXPECT_THAT(first_time("time", {"Mar 14 09:26:53"}), HasSubstr("has no year"));
  EXPECT_THAT(first_time("time,tz_offset_min", {"2024-02-28 23:00:00,60"}),
              HasSubstr("--time-zone"));
  EXPECT_THAT(first_time("tow_ms", {"338418.0"}),
              HasSubstr("t.csv:2: '338418.0' in column 'tow_ms' would be"));
  EXPECT_THAT(first_time("time", {"2030-01-01T00:00:00Z"}), HasSubstr("later than tomorrow"));
  TimeOptions named;
  named.column = "time";
  EXPECT_THAT(first_time("year,doy,sec_of_day", {"2024,059,79200"}, named),
              HasSubstr("--time year,doy,sec_of_day"));
  EXPECT_THAT(first_time("time", {"2024-02-28 22:00:00 IST"}), HasSubstr("+05:30"));
  named.zone = "Mars/Olympus";
  EXPECT_THAT(first_time("time", {"2024-02-28"}, named), HasSubstr("Europe/Berlin"));
}

TEST(TelemetryClock, OfHourlyRowsMayHaveTheNewestFirst) {
  const std::vector<std::string> cells = {"2024-07-01 05:00", "2024-07-01 04:00",
                                          "2024-07-01 03:00"};
  EXPECT_EQ(first_time("time", cells), "2024-07-01T05:00:00Z");
  ClockWatch watch(1'000'000'000, std::nullopt, true, true);
  for (const char* time : {"2024-07-01 05:00:00", "2024-07-01 04:00:00", "2024-07-01 03:00:00"})
    EXPECT_FALSE(watch.next(*parse_time(time), 2));
  for (const char* time : {"2024-10-27 02:00:10", "2024-10-27 02:00:00"})
    EXPECT_FALSE(watch.next(*parse_time(time), 3));
  const auto step = watch.next(*parse_time("2024-10-27 02:59:50"), 4);
  ASSERT_TRUE(step);
  EXPECT_EQ(step->kind, ClockStep::Kind::hour);
}

TEST(TelemetryClock, KnowsTheHourThatComesTwice) {
  auto zone = TimeZone::named("Europe/Berlin");
  ASSERT_TRUE(zone);
  const auto utc = [&](const char* local) {
    return time_text(zone->to_utc(*parse_time(local)).value_or(0));
  };
  EXPECT_EQ(utc("2024-10-27T02:45:00"), "2024-10-27T00:45:00Z");
  EXPECT_EQ(utc("2024-10-27T02:59:50"), "2024-10-27T00:59:50Z");
  EXPECT_EQ(utc("2024-10-27T02:00:00"), "2024-10-27T01:00:00Z");
  EXPECT_EQ(utc("2024-10-27T03:00:00"), "2024-10-27T02:00:00Z");
  EXPECT_EQ(utc("2024-07-01T12:00:00"), "2024-07-01T10:00:00Z");
  EXPECT_FALSE(zone->to_utc(*parse_time("2024-03-31T02:30:00"))) << "the hour that is left out";
  for (const char* local : {"2024-10-27T01:59:50", "2024-10-27T02:00:00", "2024-10-27T02:00:00",
                            "2024-10-27T02:00:20", "2024-10-27T02:00:10"})
    EXPECT_EQ(zone->to_utc(*parse_time(local)), *parse_time(local) - 7200 * 1'000'000'000LL)
        << "rows of one time, and out of order";
  zone = TimeZone::named("Europe/Berlin");
  zone->put_newest_first();
  EXPECT_EQ(utc("2024-10-27T03:00:00"), "2024-10-27T02:00:00Z");
  EXPECT_EQ(utc("2024-10-27T02:30:00"), "2024-10-27T01:30:00Z");
  EXPECT_EQ(utc("2024-10-27T02:00:00"), "2024-10-27T01:00:00Z");
  EXPECT_EQ(utc("2024-10-27T02:30:00"), "2024-10-27T00:30:00Z");
}

TEST(TelemetryClock, SubtractsTheLeapSecondsOfGps) {
  constexpr std::int64_t s = 1'000'000'000;
  EXPECT_EQ(utc_of_gps(0), *parse_time("1980-01-06T00:00:00Z"));
  // 2017-01-01 was 18 s behind GPS, the second before it 17.
  EXPECT_EQ(utc_of_gps(1'167'264'018 * s), *parse_time("2017-01-01T00:00:00Z"));
  EXPECT_EQ(utc_of_gps(1'167'264'016 * s), *parse_time("2016-12-31T23:59:59Z"));
}

TEST(TelemetryClockWatch, NotesAnHourThatIsLeftOutInTheNight) {
  const auto line_of = [](std::vector<const char*> times) {
    ClockWatch watch(1'000'000'000, std::nullopt, true);
    for (std::size_t i = 0; i < times.size(); ++i) watch.next(*parse_time(times[i]), i + 2);
    return watch.hour_ahead_line();
  };
  EXPECT_EQ(line_of({"2024-03-31 01:59:40", "2024-03-31 01:59:50", "2024-03-31 03:00:00"}), 4U);
  EXPECT_EQ(line_of({"2024-03-31 01:59:40", "2024-03-31 01:59:50", "2024-03-31 03:30:00"}), 0U);
  EXPECT_EQ(line_of({"2024-03-31 13:59:40", "2024-03-31 13:59:50", "2024-03-31 15:00:00"}), 0U);
}

TEST(TelemetryClockWatch, TakesTimesThatAreCenturiesApart) {
  ClockWatch watch(1'000'000'000, std::nullopt, true);
  const std::int64_t far = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t time : {-far, far, far - 1, std::int64_t{0}, far - 10, far, -far})
    watch.next(time, 2);
  EXPECT_EQ(watch.hour_ahead_line(), 0U);
}

TEST(TelemetryClockWatch, SaysWhatAStepBackLooksLike) {
  constexpr std::int64_t s = 1'000'000'000;
  struct Case {
    std::optional<std::int64_t> since_s;
    bool may_be_local;
    std::vector<std::int64_t> times_s;
    ClockStep::Kind kind;
  };
  for (const Case& c : {
           Case{{}, true, {10'000, 10'010, 6'420}, ClockStep::Kind::hour},
           Case{{}, true, {262'800, 266'400, 266'400}, ClockStep::Kind::hour},  // a Sunday at 2
           Case{{}, true, {46'780, 46'790, 3'600}, ClockStep::Kind::half_day},
           Case{{}, false, {10'000, 10'010, 6'420}, ClockStep::Kind::out_of_order},
           Case{0, false, {65'520, 65'530, 4}, ClockStep::Kind::wrap},
           Case{0, false, {604'780, 604'790, 0}, ClockStep::Kind::wrap},
           Case{0, false, {5'000, 5'010, 0}, ClockStep::Kind::restart},
           Case{1'000'000, false, {1'065'520, 1'065'530, 1'000'004}, ClockStep::Kind::wrap},
           Case{1'000'000, false, {1'005'000, 1'005'010, 1'000'000}, ClockStep::Kind::restart},
           Case{1'000'000, true, {1'086'380, 1'086'390, 1'000'000}, ClockStep::Kind::wrap},
           Case{{}, true, {10'000, 10'010, 10'005}, ClockStep::Kind::out_of_order},
       }) {
    std::optional<std::int64_t> since;
    if (c.since_s) since = *c.since_s * s;
    ClockWatch watch(s, since, c.may_be_local);
    EXPECT_FALSE(watch.next(c.times_s[0] * s, 2));
    EXPECT_FALSE(watch.next(c.times_s[1] * s, 3));
    const auto step = watch.next(c.times_s[2] * s, 4);
    ASSERT_TRUE(step);
    EXPECT_EQ(step->kind, c.kind) << c.times_s[2];
    EXPECT_EQ(step->line, 4U);
    EXPECT_EQ(step->back_ns, (c.times_s[1] - c.times_s[2]) * s);
  }
}

}  // namespace
}  // namespace reident::telemetry_file::clock_test
