// The binary of an FMU called as FMI 3.0 says, compared with the library that simulators link.
#include <cmath>

#include <gmock/gmock.h>

#include "tests/service/model_export/export_fixture.hpp"
#include "tests/service/model_export/fmu_host.hpp"

extern "C" {
#include "service/model_export/fmu/fmi3.h"
}

namespace reident::test::fmu3_test {
namespace {

using model_export::ExportedVersion;
using ::testing::HasSubstr;

/// A master of one FMU whose value references are its inputs, outputs, states and time.
class Master {
 public:
  explicit Master(const ExportedVersion& exported)
      : fmu_(model_export::fmu_file(exported, model_export::FmiVersion::three, REIDENT_FMU_PARTS)),
        digest_(exported.version.digest),
        binary_(fmu_.folder() / "binaries" / "x86_64-linux" / "CBERS_4_BAT_1_v7.so"),
        reference_(exported.version) {}
  ~Master() {
    if (instance != nullptr) call<decltype(&fmi3FreeInstance)>("fmi3FreeInstance")(instance);
  }
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  template <class Function>
  Function call(const char* name) const {
    return reinterpret_cast<Function>(binary_.symbol(name));
  }
#define FMI3_CALL(name, ...) call<decltype(&name)>(#name)(instance __VA_OPT__(, ) __VA_ARGS__)

  void instantiate(bool with_events, const std::string& token) {
    const std::string resources = (fmu_.folder() / "resources").string() + "/";
    instance = call<decltype(&fmi3InstantiateCoSimulation)>("fmi3InstantiateCoSimulation")(
        "one", token.c_str(), resources.c_str(), false, false, with_events, false, nullptr, 0, this,
        &Master::log, nullptr);
  }
  void start(bool with_events) {
    instantiate(with_events, digest_);
    ASSERT_NE(instance, nullptr) << logged;
    ASSERT_EQ(FMI3_CALL(fmi3EnterInitializationMode, false, 0, 0, false, 0), fmi3OK);
    ASSERT_EQ(FMI3_CALL(fmi3ExitInitializationMode), fmi3OK);
  }
  fmi3Status set(const std::vector<double>& inputs) const {
    const auto references = from(0, inputs.size());
    return FMI3_CALL(fmi3SetFloat64, references.data(), inputs.size(), inputs.data(),
                     inputs.size());
  }
  std::vector<double> outputs() const {
    std::vector<double> values(reference_.variables.outputs.size());
    const auto references = from(reference_.variables.inputs.size(), values.size());
    EXPECT_EQ(
        FMI3_CALL(fmi3GetFloat64, references.data(), values.size(), values.data(), values.size()),
        fmi3OK);
    return values;
  }
  double time() const {
    const fmi3ValueReference reference =
        from(reference_.variables.inputs.size() + reference_.variables.outputs.size() +
                 reference_.variables.states.size(),
             1)[0];
    double value = -1;
    EXPECT_EQ(FMI3_CALL(fmi3GetFloat64, &reference, 1, &value, 1), fmi3OK);
    return value;
  }
  fmi3Status step(double point, double step) const {
    bool event = true, terminate = true, early = true;
    double last = -1;
    const fmi3Status status =
        FMI3_CALL(fmi3DoStep, point, step, true, &event, &terminate, &early, &last);
    EXPECT_FALSE(event || terminate || early);
    EXPECT_NEAR(last, status == fmi3OK ? point + step : last, 1e-12);
    return status;
  }
  void enter_event_mode() const {
    EXPECT_EQ(FMI3_CALL(fmi3EnterEventMode), fmi3OK);
  }
  /// Sets the inputs of this very time, as a master does that uses event mode.
  void handle_event(const std::vector<double>& inputs) const {
    bool need_update = true, terminate = true, nominals = true, states = true, next = true;
    double next_time = 0;
    EXPECT_EQ(set(inputs), fmi3OK);
    EXPECT_EQ(FMI3_CALL(fmi3UpdateDiscreteStates, &need_update, &terminate, &nominals, &states,
                        &next, &next_time),
              fmi3OK);
    EXPECT_FALSE(need_update || terminate || nominals || states || next);
    EXPECT_EQ(FMI3_CALL(fmi3EnterStepMode), fmi3OK);
  }

  Reference& reference() {
    return reference_;
  }
  const UnpackedFmu& fmu() const {
    return fmu_;
  }

  fmi3Instance instance = nullptr;
  std::string logged;

 private:
  static std::vector<fmi3ValueReference> from(std::size_t first, std::size_t count) {
    std::vector<fmi3ValueReference> references(count);
    for (std::size_t i = 0; i < count; ++i)
      references[i] = static_cast<fmi3ValueReference>(first + i);
    return references;
  }
  static void log(fmi3InstanceEnvironment environment, fmi3Status, fmi3String, fmi3String text) {
    static_cast<Master*>(environment)->logged = text;
  }

  UnpackedFmu fmu_;
  std::string digest_;
  FmuBinary binary_;
  Reference reference_;
};

void expect_near(const std::vector<double>& ours, const std::vector<double>& theirs) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i)
    EXPECT_NEAR(ours[i], theirs[i], 1e-12 * std::max(1.0, std::fabs(theirs[i])));
}

TEST(Fmu3, GivesInEventModeTheOutputsOfTheInputsOfThatTime) {
  Master master(random_version({3, 2, 2, true, 0.5, {"U * I_1"}}, 31));
  master.start(true);
  Noise noise(32);
  for (int k = 0; k < 200; ++k) {
    const std::vector<double> u = random_inputs(noise, master.reference().variables.inputs.size());
    if (k > 0) master.enter_event_mode();
    master.handle_event(u);
    expect_near(master.outputs(), master.reference().step(u));
    ASSERT_EQ(master.step(k * 0.5, 0.5), fmi3OK) << master.logged;
    EXPECT_NEAR(master.time(), (k + 1) * 0.5, 1e-12);
  }
}

TEST(Fmu3, GivesTheOutputsOfTheEndOfAStepWithoutEventMode) {
  Master master(random_version({4, 2, 1, false}, 33));
  master.start(false);
  Noise noise(34);
  std::vector<double> u = random_inputs(noise, 2);
  master.reference().step(u);
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(master.set(u), fmi3OK);
    ASSERT_EQ(master.step(k, 1), fmi3OK) << master.logged;
    const std::vector<double> recorded = master.outputs();
    u = random_inputs(noise, 2);
    expect_near(recorded, master.reference().step(u));
  }
}

TEST(Fmu3, RefusesWhatItDoesNotHaveAndSaysWhy) {
  Master master(random_version({2, 1, 1}, 35));
  master.instantiate(false, "another");
  EXPECT_EQ(master.instance, nullptr);
  EXPECT_THAT(master.logged, HasSubstr("the model of another guid"));
  master.start(false);
  using Simple = fmi3Status (*)(fmi3Instance);
  for (const auto& [name, says] : std::vector<std::pair<const char*, const char*>>{
           {"fmi3EnterEventMode", "event mode was not asked for"},
           {"fmi3EnterConfigurationMode", "nothing that fmi3EnterConfigurationMode is for"},
           {"fmi3EnterStepMode", "fmi3EnterStepMode must not be called between steps"}}) {
    EXPECT_EQ(master.call<Simple>(name)(master.instance), fmi3Error) << name;
    EXPECT_THAT(master.logged, HasSubstr(says));
  }
  double value = 0;
  const fmi3ValueReference none = 5;
  EXPECT_EQ(master.call<decltype(&fmi3GetFloat64)>("fmi3GetFloat64")(master.instance, &none, 1,
                                                                     &value, 1),
            fmi3Error);
  EXPECT_THAT(master.logged, HasSubstr("5 is no value reference"));
  EXPECT_EQ(master.step(3, 1), fmi3Error);
  EXPECT_THAT(master.logged, HasSubstr("does not begin where the last ended"));
}

TEST(Fmu3, GoesOnFromASerializedState) {
  Master first(random_version({3, 1, 1}, 36)), second(random_version({3, 1, 1}, 36));
  first.start(false);
  second.start(false);
  Noise noise(37);
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(first.set(random_inputs(noise, 1)), fmi3OK);
    EXPECT_EQ(first.step(k, 1), fmi3OK);
  }
  fmi3FMUState state = nullptr, taken = nullptr;
  std::size_t size = 0;
  const auto call = [](const Master& master, const char* name, auto... arguments) {
    using Function = fmi3Status (*)(fmi3Instance, decltype(arguments)...);
    EXPECT_EQ(master.call<Function>(name)(master.instance, arguments...), fmi3OK) << name;
  };
  call(first, "fmi3GetFMUState", &state);
  call(first, "fmi3SerializedFMUStateSize", state, &size);
  std::vector<fmi3Byte> bytes(size);
  call(first, "fmi3SerializeFMUState", state, bytes.data(), size);
  call(second, "fmi3DeserializeFMUState", static_cast<const fmi3Byte*>(bytes.data()), size, &taken);
  call(second, "fmi3SetFMUState", taken);
  EXPECT_EQ(second.outputs(), first.outputs());
  EXPECT_EQ(second.time(), 20);
  call(first, "fmi3FreeFMUState", &state);
  call(second, "fmi3FreeFMUState", &taken);
}

}  // namespace
}  // namespace reident::test::fmu3_test
