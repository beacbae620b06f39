#include "tests/service/model_export/fmu_host.hpp"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <zip.h>

#include <gtest/gtest.h>

namespace reident::test {

namespace fs = std::filesystem;

UnpackedFmu::UnpackedFmu(const std::string& bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  zip_t* archive = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
  zip_error_fini(&error);
  if (archive == nullptr) throw std::runtime_error("no zip archive");
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    zip_stat_t entry;
    zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &entry);
    std::string content(entry.size, '\0');
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    EXPECT_EQ(zip_fread(file, content.data(), entry.size), static_cast<zip_int64_t>(entry.size));
    zip_fclose(file);
    write(entry.name, content);
  }
  zip_discard(archive);
}

std::string UnpackedFmu::text(const std::string& name) const {
  std::stringstream text;
  text << std::ifstream(folder_ / name, std::ios::binary).rdbuf();
  return text.str();
}

void UnpackedFmu::write(const std::string& name, const std::string& content) const {
  fs::create_directories((folder_ / name).parent_path());
  std::ofstream(folder_ / name, std::ios::binary) << content;
}

fs::path UnpackedFmu::binary() const {
  const fs::directory_iterator files(folder_ / "binaries" / "linux64");
  return files->path();
}

fs::path UnpackedFmu::compiled() const {
  const fs::path made = folder_ / "compiled.so";
  const std::string command =
      "cc -std=c11 -Wall -Wextra -Werror -O2 -ffp-contract=off -fPIC -fvisibility=hidden -shared " +
      (folder_ / "sources" / "reident_fmu.c").string() + " -lm -o " + made.string();
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return made;
}

FmuBinary::FmuBinary(const fs::path& path) : library_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (library_ == nullptr) throw std::runtime_error(dlerror());
  const auto load = [this](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbol(name));
    if (function == nullptr) throw std::runtime_error(std::string(name) + " is missing");
  };
  load(get_version, "fmi2GetVersion");
  load(get_types_platform, "fmi2GetTypesPlatform");
  load(set_debug_logging, "fmi2SetDebugLogging");
  load(instantiate, "fmi2Instantiate");
  load(free_instance, "fmi2FreeInstance");
  load(setup_experiment, "fmi2SetupExperiment");
  load(enter_initialization, "fmi2EnterInitializationMode");
  load(exit_initialization, "fmi2ExitInitializationMode");
  load(terminate, "fmi2Terminate");
  load(reset, "fmi2Reset");
  load(get_real, "fmi2GetReal");
  load(set_real, "fmi2SetReal");
  load(get_integer, "fmi2GetInteger");
  load(set_string, "fmi2SetString");
  load(get_state, "fmi2GetFMUstate");
  load(set_state, "fmi2SetFMUstate");
  load(free_state, "fmi2FreeFMUstate");
  load(serialized_size, "fmi2SerializedFMUstateSize");
  load(serialize, "fmi2SerializeFMUstate");
  load(deserialize, "fmi2DeSerializeFMUstate");
  load(directional_derivative, "fmi2GetDirectionalDerivative");
  load(set_input_derivatives, "fmi2SetRealInputDerivatives");
  load(get_output_derivatives, "fmi2GetRealOutputDerivatives");
  load(do_step, "fmi2DoStep");
  load(cancel_step, "fmi2CancelStep");
  load(get_status, "fmi2GetStatus");
  load(get_real_status, "fmi2GetRealStatus");
  load(get_boolean_status, "fmi2GetBooleanStatus");
}

FmuBinary::~FmuBinary() {
  dlclose(library_);
}

void* FmuBinary::symbol(const char* name) const {
  return dlsym(library_, name);
}

void FmuInstance::log(fmi2ComponentEnvironment environment, fmi2String, fmi2Status, fmi2String,
                      fmi2String message, ...) {
  char text[2000];
  va_list values;
  va_start(values, message);
  std::vsnprintf(text, sizeof text, message, values);
  va_end(values);
  static_cast<FmuInstance*>(environment)->logged_ = text;
}

FmuInstance::FmuInstance(const FmuBinary& binary, const std::string& guid,
                         const std::string& resources, std::size_t inputs, std::size_t outputs)
    : binary_(binary),
      inputs_(inputs),
      outputs_(outputs),
      functions_{&FmuInstance::log, nullptr, nullptr, nullptr, this} {
  std::iota(inputs_.begin(), inputs_.end(), 0U);
  std::iota(outputs_.begin(), outputs_.end(), static_cast<fmi2ValueReference>(inputs));
  component = binary_.instantiate("one", fmi2CoSimulation, guid.c_str(), resources.c_str(),
                                  &functions_, fmi2False, fmi2False);
}

FmuInstance::~FmuInstance() {
  binary_.free_instance(component);
}

void FmuInstance::start(double begin) {
  EXPECT_EQ(binary_.setup_experiment(component, fmi2False, 0, begin, fmi2False, 0), fmi2OK);
  EXPECT_EQ(binary_.enter_initialization(component), fmi2OK);
  EXPECT_EQ(binary_.exit_initialization(component), fmi2OK);
  time = begin;
}

fmi2Status FmuInstance::set(const std::vector<double>& inputs) const {
  return binary_.set_real(component, inputs_.data(), inputs_.size(), inputs.data());
}

std::vector<double> FmuInstance::outputs() const {
  std::vector<double> values(outputs_.size());
  EXPECT_EQ(binary_.get_real(component, outputs_.data(), outputs_.size(), values.data()), fmi2OK);
  return values;
}

fmi2Status FmuInstance::step(double seconds) {
  const fmi2Status status = binary_.do_step(component, time, seconds, fmi2True);
  if (status <= fmi2Warning) time += seconds;
  return status;
}

std::string FmuInstance::logged() {
  return std::exchange(logged_, "");
}

}  // namespace reident::test
