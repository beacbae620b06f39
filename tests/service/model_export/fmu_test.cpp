// The binary of an FMU compared with the library that simulators link, its states, and its answers
// to bad calls.
#include <cstdio>
#include <limits>

#include <gmock/gmock.h>

#include "tests/service/model_export/hosted_fmu.hpp"

namespace reident::test::fmu_test {
namespace {

using model_export::ExportedVersion;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class FmuAgrees : public ::testing::TestWithParam<ModelKind> {};

TEST_P(FmuAgrees, WithTheRunnerOfTheLibraryAlsoWhenItsSourcesAreCompiled) {
  const Hosted any(random_version(GetParam(), 0));
  const FmuBinary compiled(any.fmu.compiled());
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Hosted run(random_version(GetParam(), seed));
    const auto other = run.another(compiled);
    ASSERT_NE(run.instance->component, nullptr) << run.instance->logged();
    ASSERT_NE(other->component, nullptr) << other->logged();
    run.instance->start();
    other->start(1e6);
    Noise noise(100 + seed);
    Distance packed, own;
    for (int k = 0; k < 500; ++k) {
      const std::vector<double> u = run.inputs(noise);
      const std::vector<double>& expected = run.reference.step(u);
      for (FmuInstance* one : {run.instance.get(), other.get()}) EXPECT_EQ(one->set(u), fmi2OK);
      packed.add(run.instance->outputs(), expected);
      own.add(other->outputs(), expected);
      for (FmuInstance* one : {run.instance.get(), other.get()})
        EXPECT_LE(one->step(GetParam().period_s), fmi2Warning);
    }
    EXPECT_LE(packed.largest, 1e-12);
    EXPECT_LE(own.largest, 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(sizes, FmuAgrees,
                         ::testing::Values(ModelKind{1, 1, 1}, ModelKind{6, 4, 1},
                                           ModelKind{4, 2, 3, false, 0.1}, ModelKind{20, 7, 5},
                                           ModelKind{2, 1, 1, true, 1.0 / 3}, with_expressions));

TEST(Fmu, BeginsInTheStateThatIsSetAndShowsTheStateOfNow) {
  Hosted run(random_version({3, 2, 1}, 23));
  run.instance->start();
  Noise noise(24);
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(run.instance->set(run.inputs(noise)), fmi2OK);
    EXPECT_EQ(run.instance->step(1), fmi2OK);
  }
  const fmi2ValueReference states[] = {3, 4, 5};
  double x[3];
  ASSERT_EQ(run.binary.get_real(run.instance->component, states, 3, x), fmi2OK);
  EXPECT_EQ(run.binary.set_real(run.instance->component, states, 3, x), fmi2Error);
  EXPECT_THAT(run.instance->logged(), HasSubstr("can be set before the first step alone"));

  const auto second = run.another();
  ASSERT_EQ(run.binary.set_real(second->component, states, 3, x), fmi2OK);
  second->start(100);
  for (int k = 0; k < 40; ++k) {
    const std::vector<double> u = run.inputs(noise);
    for (FmuInstance* one : {run.instance.get(), second.get()}) {
      EXPECT_EQ(one->set(u), fmi2OK);
      EXPECT_EQ(one->step(1), fmi2OK);
    }
    EXPECT_EQ(second->outputs(), run.instance->outputs()) << "to the last bit";
  }
}

TEST(Fmu, BeginsInTheStateThatItWasExportedWithAlsoAfterAReset) {
  ExportedVersion exported = random_version({2, 1, 1}, 25);
  exported.start.emplace();
  exported.start->x = identification::Vector::LinSpaced(2, 0.5, -2);
  const Hosted run(exported);
  EXPECT_THAT(run.fmu.text("modelDescription.xml"), HasSubstr("start=\"-2\""));
  const std::vector<double> u0 = {run.version.model.dynamics.u0(0)};
  for (int round = 0; round < 2; ++round) {
    run.instance->start();
    EXPECT_EQ(run.instance->set(u0), fmi2OK);
    Distance distance;
    distance.add(run.instance->outputs(), outputs_of(run.version, exported.start->x, u0));
    EXPECT_LE(distance.largest, 1e-12);
    EXPECT_EQ(run.instance->step(7), fmi2OK);
    EXPECT_EQ(run.binary.reset(run.instance->component), fmi2OK);
  }
}

/// Steps of one period with inputs from `seed`; the outputs of the last.
std::vector<double> after_steps(const Hosted& run, FmuInstance& instance, int steps,
                                std::uint64_t seed) {
  Noise noise(seed);
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(instance.set(run.inputs(noise)), fmi2OK);
    EXPECT_LE(instance.step(0.5), fmi2Warning);
  }
  return instance.outputs();
}

TEST(Fmu, GoesOnFromAStateThatWasKeptAlsoInAnotherInstance) {
  const Hosted run(random_version(with_expressions, 9));
  const auto& [binary, first] = std::tie(run.binary, *run.instance);
  run.instance->start();
  after_steps(run, *run.instance, 33, 1);
  fmi2FMUstate state = nullptr;
  ASSERT_EQ(binary.get_state(first.component, &state), fmi2OK);
  const double time = first.time;
  const std::vector<double> expected = after_steps(run, *run.instance, 21, 2);

  ASSERT_EQ(binary.set_state(first.component, state), fmi2OK);
  run.instance->time = time;
  EXPECT_EQ(after_steps(run, *run.instance, 21, 2), expected) << "to the last bit";

  std::size_t size = 0;
  ASSERT_EQ(binary.serialized_size(first.component, state, &size), fmi2OK);
  std::vector<char> bytes(size);
  ASSERT_EQ(binary.serialize(first.component, state, bytes.data(), size), fmi2OK);
  const auto second = run.another();
  fmi2FMUstate taken = nullptr;
  ASSERT_EQ(binary.deserialize(second->component, bytes.data(), size, &taken), fmi2OK);
  ASSERT_EQ(binary.set_state(second->component, taken), fmi2OK);
  second->time = time;
  EXPECT_EQ(after_steps(run, *second, 21, 2), expected);
  EXPECT_EQ(binary.free_state(second->component, &taken), fmi2OK);
  EXPECT_EQ(binary.free_state(first.component, &state), fmi2OK);
  EXPECT_EQ(state, nullptr);
}

TEST(Fmu, RunsFromTheStartAfterAResetAndBesideOtherInstances) {
  const Hosted run(random_version({4, 2, 1}, 10));
  const auto second = run.another();
  run.instance->start();
  second->start();
  const std::vector<double> expected = after_steps(run, *run.instance, 40, 3);
  after_steps(run, *second, 17, 4);
  ASSERT_EQ(run.binary.reset(run.instance->component), fmi2OK);
  run.instance->start();
  EXPECT_EQ(after_steps(run, *run.instance, 40, 3), expected);
  ASSERT_EQ(run.binary.reset(second->component), fmi2OK);
  second->start();
  EXPECT_EQ(after_steps(run, *second, 40, 3), expected);
}

TEST(Fmu, RefusesCallsThatMustNotBeMadeAndSaysWhy) {
  const Hosted run(random_version({2, 2, 1}, 12));
  const FmuBinary& fmi = run.binary;
  FmuInstance& one = *run.instance;
  const fmi2Component c = one.component;
  const fmi2ValueReference none = 6, output = 2;
  const double infinite = std::numeric_limits<double>::infinity();
  double value = 0;
  int whole = 0;
  fmi2FMUstate state = nullptr;
  const auto expect = [&one](fmi2Status status, fmi2Status expected, const char* says) {
    EXPECT_EQ(status, expected) << says;
    EXPECT_THAT(one.logged(), HasSubstr(says));
  };
  expect(fmi.do_step(c, 0, 1, 1), fmi2Error, "fmi2DoStep must not be called before initialisation");
  expect(fmi.get_real(c, &output, 1, &value), fmi2Error, "must not be called before init");
  expect(fmi.exit_initialization(c), fmi2Error, "fmi2ExitInitializationMode must not be called");
  expect(fmi.setup_experiment(c, 0, 0, nan, 0, 0), fmi2Error, "start time nan is not finite");
  expect(fmi.setup_experiment(c, 0, 0, 5, 1, 4), fmi2Error, "the stop time 4");
  EXPECT_EQ(fmi.setup_experiment(c, 0, 0, 10, 1, 15), fmi2OK);
  EXPECT_EQ(fmi.enter_initialization(c), fmi2OK);
  EXPECT_EQ(fmi.exit_initialization(c), fmi2OK);
  expect(fmi.setup_experiment(c, 0, 0, 0, 0, 0), fmi2Error, "must not be called between steps");
  expect(fmi.get_real(c, &none, 1, &value), fmi2Error, "6 is no value reference of this FMU");
  expect(fmi.set_real(c, &output, 1, &value), fmi2Error,
         "2 is no value reference of an input or a state");
  expect(fmi.get_real(c, nullptr, 1, &value), fmi2Error, "needs references");
  expect(fmi.set_real(c, &output, 1, nullptr), fmi2Error, "needs references and values");
  expect(one.set({0, infinite}), fmi2Discard, "variable 1 cannot be inf; it keeps its value");
  expect(fmi.get_integer(c, &output, 1, &whole), fmi2Error, "no Integer variables");
  expect(fmi.set_string(c, &output, 1, nullptr), fmi2Error, "no String variables");
  expect(fmi.do_step(c, 11, 1, 1), fmi2Error, "does not begin where the last ended");
  expect(fmi.do_step(c, 10, 0, 1), fmi2Error, "must be finite and above 0");
  expect(fmi.do_step(c, 10, nan, 1), fmi2Error, "must be finite and above 0");
  expect(fmi.do_step(c, 10, 6, 1), fmi2Error, "ends after the stop time");
  expect(fmi.do_step(c, 10, 2e9, 1), fmi2Error, "is more than 1e9 sample periods");
  expect(fmi.set_state(c, nullptr), fmi2Error, "needs a state of this model");
  expect(fmi.get_state(c, nullptr), fmi2Error, "a place for the state is missing");
  expect(fmi.deserialize(c, nullptr, 3, &state), fmi2Error, "needs bytes");
  expect(fmi.set_debug_logging(c, 1, 1, nullptr), fmi2Error, "categories are missing");
  expect(fmi.directional_derivative(c, &output, 1, &none, 1, &value, &value), fmi2Error,
         "no directional derivatives");
  expect(fmi.set_input_derivatives(c, &output, 1, &whole, &value), fmi2Error,
         "2 is no value reference of an input");
  const fmi2ValueReference input = 1;
  expect(fmi.set_input_derivatives(c, &input, 1, &whole, &value), fmi2Error, "first derivative");
  expect(fmi.get_output_derivatives(c, &none, 1, &whole, &value), fmi2Error, "no derivatives");
  expect(fmi.cancel_step(c), fmi2Error, "no step is ever pending");
  fmi2Status status = fmi2OK;
  expect(fmi.get_status(c, fmi2DoStepStatus, &status), fmi2Discard, "no such status");
  EXPECT_EQ(one.set({1e308, 1e308}), fmi2OK);
  expect(fmi.do_step(c, 10, 5, 1), fmi2Discard, "beyond what a double can hold: no step");
  EXPECT_EQ(one.set({1, 1}), fmi2OK);
  EXPECT_EQ(fmi.do_step(c, 10, 5, 1), fmi2OK) << "what was refused changed nothing";
  EXPECT_EQ(fmi.get_real_status(c, fmi2LastSuccessfulTime, &value), fmi2OK);
  EXPECT_EQ(value, 15);
  EXPECT_EQ(fmi.get_boolean_status(c, fmi2Terminated, &whole), fmi2OK);
  EXPECT_EQ(whole, fmi2False);
  EXPECT_EQ(fmi.terminate(c), fmi2OK);
  EXPECT_EQ(fmi.get_real(c, &output, 1, &value), fmi2OK);
  expect(fmi.do_step(c, 15, 1, 1), fmi2Error, "must not be called terminated");
  EXPECT_EQ(fmi.do_step(nullptr, 0, 1, 1), fmi2Error);
  fmi.free_instance(nullptr);
}

TEST(Fmu, TakesNoBytesForAStateButItsOwn) {
  const Hosted run(random_version({2, 2, 1}, 13));
  const FmuBinary& fmi = run.binary;
  FmuInstance& one = *run.instance;
  fmi2FMUstate state = nullptr;
  std::size_t size = 0;
  ASSERT_EQ(fmi.get_state(one.component, &state), fmi2OK);
  ASSERT_EQ(fmi.serialized_size(one.component, state, &size), fmi2OK);
  std::vector<char> bytes(size);
  EXPECT_EQ(fmi.serialize(one.component, state, bytes.data(), size - 1), fmi2Error);
  ASSERT_EQ(fmi.serialize(one.component, state, bytes.data(), size), fmi2OK);
  fmi2FMUstate taken = nullptr;
  for (std::size_t i = 0; i < size; ++i) {
    EXPECT_EQ(fmi.deserialize(one.component, bytes.data(), i, &taken), fmi2Error) << i;
    std::vector<char> damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_EQ(fmi.deserialize(one.component, damaged.data(), size, &taken), fmi2Error) << i;
    EXPECT_THAT(one.logged(), HasSubstr("these bytes are not taken for a state"));
  }
  EXPECT_EQ(taken, nullptr);
  const Hosted another(random_version({2, 2, 1}, 14));
  EXPECT_EQ(another.binary.deserialize(another.instance->component, bytes.data(), size, &taken),
            fmi2Error);
  EXPECT_THAT(another.instance->logged(), HasSubstr("the state of another model"));
  EXPECT_EQ(another.binary.set_state(another.instance->component, state), fmi2Error);
  EXPECT_EQ(fmi.free_state(one.component, &state), fmi2OK);
}

TEST(Fmu, IsNotInstantiatedFromResourcesThatAreNotItsOwn) {
  const Hosted run(random_version(with_expressions, 15));
  const std::string sound = run.fmu.text("resources/model.txt");
  const auto refused = [&run](const std::string& guid, const std::string& uri) {
    FmuInstance instance(run.binary, guid, uri, 1, 1);
    EXPECT_EQ(instance.component, nullptr);
    return instance.logged();
  };
  const std::string guid = run.version.digest, uri = run.fmu.resources();
  EXPECT_THAT(refused("x" + guid.substr(1), uri), HasSubstr("the model of another guid"));
  EXPECT_THAT(refused(guid, "http://example.org/resources"), HasSubstr("is no file: URI"));
  EXPECT_THAT(refused(guid, "file:///tmp/%zz"), HasSubstr("is no file: URI"));
  EXPECT_THAT(refused(guid, ""), HasSubstr("is no file: URI"));
  EXPECT_THAT(refused(guid, "file:///nowhere/100%25"),
              AllOf(HasSubstr("/nowhere/100%/model.txt"), HasSubstr("it cannot be read")));
  for (std::size_t at = 0; at < sound.size(); at += 7) {
    run.fmu.write("resources/model.txt", sound.substr(0, at));
    EXPECT_THAT(refused(guid, uri), HasSubstr("it is damaged")) << "cut at " << at;
    std::string damaged = sound;
    damaged[at] = damaged[at] == '7' ? '5' : '7';
    run.fmu.write("resources/model.txt", damaged);
    EXPECT_THAT(refused(guid, uri), HasSubstr("it is damaged")) << "changed at " << at;
  }
}

TEST(Fmu, FindsResourcesByEveryFormOfAFileUri) {
  const Hosted run(random_version({1, 1, 1}, 16));
  run.fmu.write("a folder/é%#/model.txt", run.fmu.text("resources/model.txt"));
  const std::string folder = run.fmu.folder().string();
  for (const std::string& uri :
       {"file://" + folder + "/resources/", "file:" + folder + "/resources",
        "FILE://localhost" + folder + "/resources", "file://" + folder + "/a%20folder/%c3%A9%25%23",
        "file://" + folder + "/a folder/é%25#"}) {
    FmuInstance instance(run.binary, run.version.digest, uri, 1, 1);
    EXPECT_NE(instance.component, nullptr) << uri << ": " << instance.logged();
  }
}

TEST(Fmu, ShowsTheFunctionsOfTheStandardAndNothingElse) {
  const Hosted run(random_version({1, 1, 1}, 17));
  EXPECT_STREQ(run.binary.get_version(), "2.0");
  EXPECT_STREQ(run.binary.get_types_platform(), "default");
  const std::string command = "nm -D --defined-only " + run.fmu.binary().string() +
                              " | grep -v ' T fmi[23]' | grep -v -e asan -e ubsan -e tsan -e ' W '";
  FILE* pipe = popen(command.c_str(), "r");
  char line[200];
  EXPECT_EQ(std::fgets(line, sizeof line, pipe), nullptr) << line;
  pclose(pipe);
}

TEST(Fmu, HasSourcesWhoseFunctionsBeginWithTheIdentifier) {
  const Hosted run(random_version({1, 1, 1}, 18));
  const std::string folder = run.fmu.folder().string();
  const std::string command = "cd " + folder +
                              " && cc -std=c11 -Wall -Wextra -Werror -c sources/CBERS_4_BAT_1_v7.c "
                              "-o a.o && nm -g --defined-only a.o | grep -c "
                              "' T CBERS_4_BAT_1_v7_fmi[23]' > count";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(run.fmu.text("count"), "109\n");
}

TEST(Fmu, IsTheSameToTheLastByteWhenItIsExportedAgain) {
  EXPECT_EQ(fmu_of(random_version(with_expressions, 19)),
            fmu_of(random_version(with_expressions, 19)));
}

}  // namespace
}  // namespace reident::test::fmu_test
