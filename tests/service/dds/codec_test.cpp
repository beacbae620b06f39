// What a receiver refuses, field by field, from wire samples that no program of ours would send.
#include "service/dds/codec.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <set>

#include <gmock/gmock.h>

#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"
#include "tests/support/every_field.hpp"

namespace reident::test::codec_test {
namespace {

using dds::Codec;
using dds::Fault;
using storage::ParameterDescriptor;
using storage::TelemetryFrame;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
char* const null_text = nullptr;

char* text(const char* literal) {
  return const_cast<char*>(literal);
}

/// A change to a good sample, and what the refusal must say; empty: it is taken.
template <class Wire>
struct Spoil {
  const char* name;
  std::function<void(Wire&)> change;
  std::string says;
};
template <class Wire>
void PrintTo(const Spoil<Wire>& spoil, std::ostream* out) {
  *out << spoil.name;
}

template <class M>
void expect(const M& good, const Spoil<typename Codec<M>::Wire>& spoil) {
  typename Codec<M>::Encoder encode;
  typename Codec<M>::Wire wire = encode(good);
  spoil.change(wire);
  M message;
  const Fault fault = Codec<M>::decode(wire, {.max_frame_samples = 4}, message);
  if (spoil.says.empty()) {
    EXPECT_FALSE(fault) << *fault;
  } else {
    EXPECT_THAT(fault.value_or("taken"), testing::HasSubstr(spoil.says));
  }
}

using FrameSpoil = Spoil<satcs_TelemetryFrame>;
class FrameCodec : public testing::TestWithParam<FrameSpoil> {};
TEST_P(FrameCodec, TakesWhatKeepsTheContractAndNamesWhatBreaksIt) {
  expect(make_frame(1), GetParam());
}

const std::string long_name(256, 'x');

INSTANTIATE_TEST_SUITE_P(
    table, FrameCodec,
    testing::Values(
        FrameSpoil{"nothing", [](auto&) {}, ""},
        FrameSpoil{"not a number", [](auto& f) { f.value._buffer[0] = nan; }, ""},
        FrameSpoil{"infinite", [](auto& f) { f.value._buffer[0] = infinity; }, ""},
        FrameSpoil{"earliest time", [](auto& f) { f.generation_time_ns = INT64_MIN; }, ""},
        FrameSpoil{"no sample",
                   [](auto& f) { f.parameter._length = f.value._length = f.quality._length = 0; },
                   ""},
        FrameSpoil{"null name", [](auto& f) { f.spacecraft = null_text; }, "spacecraft is null"},
        FrameSpoil{"empty name", [](auto& f) { f.source = text(""); }, "source is empty"},
        FrameSpoil{"long name", [](auto& f) { f.source = text(long_name.c_str()); },
                   "longer than 255"},
        FrameSpoil{"broken UTF-8", [](auto& f) { f.source = text("\xc3("); }, "not UTF-8"},
        FrameSpoil{"overlong UTF-8", [](auto& f) { f.source = text("\xc0\x80"); }, "not UTF-8"},
        FrameSpoil{"surrogate", [](auto& f) { f.source = text("\xed\xa0\x80"); }, "not UTF-8"},
        FrameSpoil{"control character", [](auto& f) { f.source = text("a\nb"); },
                   "control character"},
        FrameSpoil{"quality", [](auto& f) { f.quality._buffer[1] = 4; }, "sample 1 has quality 4"},
        FrameSpoil{"largest quality", [](auto& f) { f.quality._buffer[2] = 255; },
                   "sample 2 has quality 255"},
        FrameSpoil{"origin", [](auto& f) { f.origin = 2; }, "origin is 2"},
        FrameSpoil{"values short", [](auto& f) { f.value._length = 2; }, "3 parameters, 2 values"},
        FrameSpoil{"qualities missing", [](auto& f) { f.quality._length = 0; }, "0 qualities"}));

TEST(FrameCodec, RefusesAFrameAboveTheBoundAndTakesOneAtIt) {
  expect(make_frame(1, 4), FrameSpoil{"", [](auto&) {}, ""});
  expect(make_frame(1, 5), FrameSpoil{"", [](auto&) {}, "5 samples and at most 4"});
}

TEST(FrameCodec, TakesEachQualityThatAFrameMayBringAndNoOtherNumber) {
  for (int number = 0; number < 256; ++number) {
    TelemetryFrame sent = make_frame(1), received;
    sent.samples[1].quality = static_cast<storage::Quality>(number);
    Codec<TelemetryFrame>::Encoder encode;
    const Fault fault = Codec<TelemetryFrame>::decode(encode(sent), {}, received);
    const auto known = storage::quality_of_wire(number);
    if (known && facts(*known).is_sent) {
      EXPECT_FALSE(fault) << *fault;
      EXPECT_EQ(received.samples[1].quality, *known);
    } else {
      EXPECT_THAT(fault.value_or("taken"),
                  testing::HasSubstr("sample 1 has quality " + std::to_string(number) + ";"));
    }
  }
}

TEST(FrameCodec, TakesTheQualitiesThatTheIdlNames) {
  std::set<std::string> constants, expected;
  std::ifstream idl(SATCS_IDL);
  for (std::string line; std::getline(idl, line);)
    if (line.starts_with("const octet QUALITY_"))
      constants.insert(line.substr(0, line.find(';') + 1));
  for (const storage::QualityFacts& row : storage::quality_table) {
    std::string constant(row.name);
    std::transform(constant.begin(), constant.end(), constant.begin(), [](unsigned char c) {
      return c == ' ' ? '_' : static_cast<char>(std::toupper(c));
    });
    if (row.is_sent)
      expected.insert("const octet QUALITY_" + constant + " = " + std::to_string(row.wire) + ";");
  }
  EXPECT_EQ(constants, expected);
}

using DescriptorSpoil = Spoil<satcs_ParameterDescriptor>;
class DescriptorCodec : public testing::TestWithParam<DescriptorSpoil> {};
TEST_P(DescriptorCodec, TakesWhatKeepsTheContractAndNamesWhatBreaksIt) {
  const ParameterDescriptor good{
      "CBERS4", 7, "V_BUS", "V", "bus voltage", storage::ParameterKind::analog, 0., 50.};
  expect(good, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    table, DescriptorCodec,
    testing::Values(
        DescriptorSpoil{"nothing", [](auto&) {}, ""},
        DescriptorSpoil{"no unit", [](auto& d) { d.unit = text(""); }, ""},
        DescriptorSpoil{"no limit",
                        [](auto& d) {
                          d.has_low_limit = d.has_high_limit = false;
                          d.low_limit = nan;
                        },
                        ""},
        DescriptorSpoil{"kind", [](auto& d) { d.kind = 2; }, "V_BUS has kind 2"},
        DescriptorSpoil{"limit", [](auto& d) { d.low_limit = nan; }, "not a finite number"},
        DescriptorSpoil{"order of limits", [](auto& d) { d.low_limit = 51; },
                        "low limit above its high"},
        DescriptorSpoil{"null text", [](auto& d) { d.description = null_text; },
                        "description is null"},
        DescriptorSpoil{"empty name", [](auto& d) { d.name = text(""); }, "name is empty"}));

using ModelSpoil = Spoil<reident_ModelVersion>;
class ModelCodec : public testing::TestWithParam<ModelSpoil> {};
TEST_P(ModelCodec, TakesWhatKeepsTheContractAndNamesWhatBreaksIt) {
  expect(example_version(1), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    table, ModelCodec,
    testing::Values(
        ModelSpoil{"nothing", [](auto&) {}, ""},
        ModelSpoil{"no gain", [](auto& v) { v.K._length = 0; }, ""},
        ModelSpoil{"undefined score", [](auto& v) { v.fit_percent._buffer[0] = nan; }, ""},
        ModelSpoil{"order above A", [](auto& v) { v.order = 3; }, "A has 4 numbers; 3 x 3"},
        ModelSpoil{"negative order", [](auto& v) { v.order = static_cast<std::uint32_t>(-1); },
                   "A has 4 numbers; 4294967295 x 4294967295"},
        ModelSpoil{"B", [](auto& v) { v.B._length = 3; }, "B has 3 numbers; 2 x 2"},
        ModelSpoil{"C", [](auto& v) { v.C._length = 0; }, "C has 0 numbers; 1 x 2"},
        ModelSpoil{"D", [](auto& v) { v.D._length = 1; }, "D has 1 numbers; 1 x 2"},
        ModelSpoil{"K", [](auto& v) { v.K._length = 1; }, "K has 1 numbers; 2 x 1"},
        ModelSpoil{"input offset", [](auto& v) { v.input_offset._length = 1; }, "input_offset"},
        ModelSpoil{"output offset", [](auto& v) { v.output_offset._length = 0; }, "output_offset"},
        ModelSpoil{"score", [](auto& v) { v.mrse_percent._length = 0; }, "mrse_percent"},
        ModelSpoil{"infinite A", [](auto& v) { v.A._buffer[3] = infinity; }, "A has a number that"},
        ModelSpoil{"undefined y0", [](auto& v) { v.output_offset._buffer[0] = nan; },
                   "output_offset has a number that"},
        ModelSpoil{"no output", [](auto& v) { v.outputs._length = 0; }, "no output"},
        ModelSpoil{"null signal", [](auto& v) { v.inputs._buffer[0].name = null_text; },
                   "a signal's name is null"},
        ModelSpoil{"range", [](auto& v) { v.inputs._buffer[0].low = 6; }, "range of I_BDRIN1"},
        ModelSpoil{"period", [](auto& v) { v.sample_period_s = 0; }, "sample period"},
        ModelSpoil{"undefined period", [](auto& v) { v.sample_period_s = nan; }, "sample period"},
        ModelSpoil{"hold", [](auto& v) { v.hold_ns = -1; }, "hold"},
        ModelSpoil{"number", [](auto& v) { v.number = 0; }, "number is below 1"},
        ModelSpoil{"window", [](auto& v) { v.identified_end_ns = 0; }, "ends before it begins"},
        ModelSpoil{"phase", [](auto& v) { v.phase_ns = -1; }, "phase"},
        ModelSpoil{"long phase",
                   [](auto& v) { v.phase_ns = std::numeric_limits<std::int64_t>::max(); }, "phase"},
        ModelSpoil{"format", [](auto& v) { v.format = 4; }, "format 4 and this program knows 3"},
        ModelSpoil{"digest", [](auto& v) { v.digest = text(""); }, "digest is empty"}));

class FullModelCodec : public testing::TestWithParam<ModelSpoil> {};
TEST_P(FullModelCodec, TakesWhatKeepsTheContractAndNamesWhatBreaksIt) {
  ModelVersion version = example_version(1);
  version.model = full_example_model();
  expect(version, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    table, FullModelCodec,
    testing::Values(
        ModelSpoil{"nothing", [](auto&) {}, ""},
        ModelSpoil{"undefined score", [](auto& v) { v.tracking_fit_percent._buffer[0] = nan; }, ""},
        ModelSpoil{"no gain",
                   [](auto& v) {
                     v.tracking_state._length = v.tracking_integral._length = 0;
                     v.tracking_error_limit._length = 0;
                   },
                   ""},
        ModelSpoil{"null expression", [](auto& v) { v.inputs._buffer[0].expression = null_text; },
                   "a signal's expression is null"},
        ModelSpoil{"computed output", [](auto& v) { v.outputs._buffer[0].expression = text("a"); },
                   "an output has an expression"},
        ModelSpoil{"state", [](auto& v) { v.tracking_state._length = 0; }, "tracking_state has 0"},
        ModelSpoil{"integral", [](auto& v) { v.tracking_integral._length = 3; },
                   "tracking_integral has 3 numbers; 2 x 2"},
        ModelSpoil{"limit", [](auto& v) { v.tracking_error_limit._length = 0; },
                   "tracking_error_limit has 0"},
        ModelSpoil{"undefined", [](auto& v) { v.tracking_integral._buffer[0] = nan; },
                   "tracking_integral has a number that"},
        ModelSpoil{"score", [](auto& v) { v.tracking_mrse_percent._length = 0; },
                   "tracking_mrse_percent"},
        ModelSpoil{"rows", [](auto& v) { v.tracking_validation_rows = -1; }, "negative"}));

TEST(ModelCodec, StatesTheLowestFormatThatDescribesTheVersion) {
  Codec<ModelVersion>::Encoder encode;
  ModelVersion version = example_version(1);
  EXPECT_EQ(encode(version).format, 1U);
  version.model.tracking = full_example_model().tracking;
  EXPECT_EQ(encode(version).format, 2U);
  version.model = full_example_model();
  version.model.tracking.reset();
  EXPECT_EQ(encode(version).format, 2U);
}

TEST(ModelCodec, CarriesEveryFieldToTheLastBit) {
  const ModelVersion version = distinct_version();
  Codec<ModelVersion>::Encoder encode;
  ModelVersion back;
  const Fault fault = Codec<ModelVersion>::decode(encode(version), {}, back);
  ASSERT_FALSE(fault) << *fault;
  EXPECT_THAT(differing_fields(back, version), testing::IsEmpty());
}

TEST(ReportCodec, RefusesNegativeOrdersAndWindowsThatEndBeforeTheyBegin) {
  IdentificationReport report;
  report.spacecraft = "CBERS4";
  report.equipment = "BDR";
  report.outcome = "approved";
  using S = Spoil<reident_IdentificationReport>;
  expect(report, S{"", [](auto&) {}, ""});
  expect(report, S{"", [](auto& r) { r.order = -1; }, "order is negative"});
  expect(report, S{"", [](auto& r) { r.window_end_ns = -5; }, "ends before it begins"});
  expect(report, S{"", [](auto& r) { r.version = -5; }, "number is negative"});
  expect(report, S{"", [](auto& r) { r.outcome = null_text; }, "outcome is null"});
}

TEST(CommandCodec, RefusesWhatCannotBeAnsweredAndLeavesTheRestToTheAnswer) {
  const CommandRequest good{{"console", 7, "hold", "SAT", "BDR", 0, "Ana", "training"}, "reident"};
  using S = Spoil<reident_Command>;
  expect(good, S{"", [](auto&) {}, ""});
  expect(good, S{"", [](auto& c) { c.requester = text(""); }, "requester is empty"});
  expect(good, S{"", [](auto& c) { c.requester = null_text; }, "requester is null"});
  expect(good, S{"", [](auto& c) { c.reason = text("\xc3("); }, "reason is not UTF-8"});
  expect(good, S{"", [](auto& c) { c.actor = text(""); }, ""});
  expect(good, S{"", [](auto& c) { c.version = -1; }, ""});
  const CommandReply reply{"console", 7, {false, "why"}};
  using R = Spoil<reident_CommandReply>;
  expect(reply, R{"", [](auto&) {}, ""});
  expect(reply, R{"", [](auto& r) { r.requester = text("a\nb"); }, "control character"});
}

using AcknowledgementSpoil = Spoil<reident_ModelAcknowledgement>;
class AcknowledgementCodec : public testing::TestWithParam<AcknowledgementSpoil> {};
TEST_P(AcknowledgementCodec, TakesWhatKeepsTheContractAndNamesWhatBreaksIt) {
  expect(ModelAcknowledgement{"trainer", "CBERS4", "BDR", 3, "ab", true, "", {}, "console", 7, "1"},
         GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    table, AcknowledgementCodec,
    testing::Values(
        AcknowledgementSpoil{"nothing", [](auto&) {}, ""},
        AcknowledgementSpoil{"no error yet", [](auto& a) { a.running_mrse_percent = nan; }, ""},
        AcknowledgementSpoil{"unknown mode", [](auto& a) { a.mode = text("hybrid"); }, ""},
        AcknowledgementSpoil{"empty simulator", [](auto& a) { a.simulator = text(""); },
                             "simulator is empty"},
        AcknowledgementSpoil{"null host", [](auto& a) { a.host = null_text; }, "host is null"},
        AcknowledgementSpoil{"mode", [](auto& a) { a.mode = text("\xff"); }, "mode is not UTF-8"},
        AcknowledgementSpoil{"version", [](auto& a) { a.version = -1; }, "number is negative"},
        AcknowledgementSpoil{"running", [](auto& a) { a.running_version = -1; },
                             "number is negative"},
        AcknowledgementSpoil{"offered", [](auto& a) { a.offered_version = -1; },
                             "number is negative"},
        AcknowledgementSpoil{"transition", [](auto& a) { a.transition_steps = -1; },
                             "transition are negative"}));

}  // namespace
}  // namespace reident::test::codec_test
