// Which fields of a version the exported files carry, and why not the others.
#include "tests/support/every_field.hpp"

#include <functional>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "service/model_export/fmu_text.hpp"

namespace reident::test::every_field_test {
namespace {

using model_export::ExportedVersion;

/// The fields that a file does not carry, each with its reason.
using NotCarried = std::map<std::string, std::string>;

/// The fields of which some change does not change the file.
std::set<std::string> fields_not_in(
    const std::function<std::string(const ExportedVersion&)>& write) {
  std::set<std::string> fields;
  const ModelVersion version = distinct_version();
  const std::string file = write({version, "approved"});
  for_each_change(version, [&](const std::string& path, const Field&, const ModelVersion& changed) {
    if (write({changed, "approved"}) == file) fields.insert(without_places(path));
  });
  return fields;
}

void expect_all_but(const NotCarried& not_carried,
                    const std::function<std::string(const ExportedVersion&)>& write) {
  std::set<std::string> expected;
  for (const auto& [field, reason] : not_carried) expected.insert(field);
  EXPECT_EQ(fields_not_in(write), expected);
}

TEST(ExportedJson, HasEveryFieldOrAReasonNotTo) {
  expect_all_but({{"rollback", "says how simulators are to take the version, not what it is"}},
                 model_export::json_file);
}

TEST(ExportedMatFile, HasEveryFieldOrAReasonNotTo) {
  const std::string of_the_window = "says from which telemetry the model comes: it is in the JSON";
  const std::string for_the_gate = "says how good the model is: it is in the JSON";
  const std::string for_flags = "simulators flag inputs by it; a run does not need it";
  expect_all_but(
      {
          {"rollback", "says how simulators are to take the version, not what it is"},
          {"program_version", "is of interest for reproduction: it is in the JSON"},
          {"hold_ns", "is about telemetry, which MATLAB has not"},
          {"phase_ns", "is about telemetry too"},
          {"inputs.low", for_flags},
          {"inputs.high", for_flags},
          {"outputs.low", for_flags},
          {"outputs.high", for_flags},
          {"identified_from.begin_ns", of_the_window},
          {"identified_from.end_ns", of_the_window},
          {"validated_on.begin_ns", of_the_window},
          {"validated_on.end_ns", of_the_window},
          {"validation.mrse_percent", for_the_gate},
          {"validation.fit_percent", for_the_gate},
          {"validation.rows", for_the_gate},
          {"tracking.validation.mrse_percent", for_the_gate},
          {"tracking.validation.fit_percent", for_the_gate},
          {"tracking.validation.rows", for_the_gate},
      },
      model_export::mat_file);
}

// The rest of an FMU is for people and hosts; documentation/model.json in it is the JSON file.
TEST(FmuResources, HaveEveryFieldOrAReasonNotTo) {
  const std::string for_hosts = "the binary does not need it: it is in modelDescription.xml";
  const std::string for_people = "the binary does not need it: it is in documentation/model.json";
  const std::string free_run = "an FMU is the free run, from inputs alone";
  expect_all_but(
      {
          {"number", for_hosts},
          {"decided_ns", for_hosts},
          {"decided_by", for_hosts},
          {"rollback", "says how simulators are to take the version, not what it is"},
          {"program_version", for_people},
          {"spacecraft", for_hosts},
          {"equipment", for_hosts},
          {"inputs.name", "inputs have places, in the order of modelDescription.xml"},
          {"inputs.unit", for_hosts},
          {"inputs.low", for_hosts},
          {"inputs.high", for_hosts},
          {"outputs.name", for_hosts},
          {"outputs.unit", for_hosts},
          {"outputs.low", for_hosts},
          {"outputs.high", for_hosts},
          {"hold_ns", "a host sets inputs; how long a sample of telemetry serves is its affair"},
          {"phase_ns", "is about telemetry too"},
          {"K", free_run},
          {"identified_from.begin_ns", for_people},
          {"identified_from.end_ns", for_people},
          {"validated_on.begin_ns", for_people},
          {"validated_on.end_ns", for_people},
          {"validation.mrse_percent", for_people},
          {"validation.fit_percent", for_people},
          {"validation.rows", for_people},
          {"method", for_hosts},
          {"tracking.state", free_run},
          {"tracking.integral", free_run},
          {"tracking.error_limit", free_run},
          {"tracking.validation.mrse_percent", free_run},
          {"tracking.validation.fit_percent", free_run},
          {"tracking.validation.rows", free_run},
      },
      [](const ExportedVersion& exported) {
        return model_export::fmu_resources(exported.version,
                                           model_export::fmu_variables(exported.version.model));
      });
}

}  // namespace
}  // namespace reident::test::every_field_test
