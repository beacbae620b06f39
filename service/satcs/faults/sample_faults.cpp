// Faults about the samples of a frame.
#include <algorithm>
#include <functional>
#include <map>

#include "service/satcs/faults/fault_stage.hpp"

namespace reident::satcs {
namespace {

using storage::ParameterDescriptor;
using storage::Quality;
using storage::Sample;

constexpr double spike_share = 0.01;
constexpr Limits any_value{-1, 1};  // of a parameter without limits

const ParameterDescriptor& named(std::span<const ParameterDescriptor> parameters,
                                 std::string_view name) {
  return *std::find_if(parameters.begin(), parameters.end(),
                       [name](const auto& parameter) { return parameter.name == name; });
}

/// A sensor that reads something else than it measures.
class SensorFault : public FaultStage {
 public:
  SensorFault(const Fault& fault, const ParameterDescriptor& parameter)
      : fault_(fault), parameter_(parameter.id), limits_(limits_of(parameter)) {
    const double span = limits_ ? limits_->span() : 1;
    magnitude_ = fault.magnitude.value_or(facts(fault.kind).usual * span);
    if (fault.kind == FaultKind::stuck) stuck_at_ = fault.magnitude;
  }

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    for (Sample& sample : flight.frame.samples) {
      if (sample.parameter != parameter_) continue;
      sample.value = reading(sample.value, flight.generated);
    }
    on.push_back(std::move(flight));
  }

 private:
  double reading(double value, storage::Time time) {
    switch (fault_.kind) {
      case FaultKind::stuck:
        if (!stuck_at_) stuck_at_ = value;
        return *stuck_at_;
      case FaultKind::bias_step:
        return limited(value + magnitude_);
      case FaultKind::drifting_bias:
        return limited(value + magnitude_ * passed(time));
      case FaultKind::noise_burst:
        return limited(value + magnitude_ * draw(fault_, time, parameter_).gaussian());
      default:
        return limited(value + spike(time));
    }
  }

  double spike(storage::Time time) const {
    RandomStream random = draw(fault_, time, parameter_);
    if (random.uniform() >= spike_share) return 0;
    return random.uniform() < 0.5 ? magnitude_ : -magnitude_;
  }

  double passed(storage::Time time) const {
    return static_cast<double>(time - fault_.when.begin) /
           static_cast<double>(fault_.when.end - fault_.when.begin);
  }

  double limited(double value) const {
    return limits_ ? std::clamp(value, limits_->low, limits_->high) : value;
  }

  Fault fault_;
  std::uint32_t parameter_;
  std::optional<Limits> limits_;
  double magnitude_ = 0;
  std::optional<double> stuck_at_;
};

class WrongCalibration : public FaultStage {
 public:
  WrongCalibration(const Fault& fault, const ParameterDescriptor& parameter)
      : parameter_(parameter.id), gain_(fault.magnitude.value_or(facts(fault.kind).usual)) {
    const Limits limits = limits_of(parameter).value_or(any_value);
    offset_ = (1 - gain_) * (limits.low + limits.high) / 2;
  }

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    for (Sample& sample : flight.frame.samples) {
      if (sample.parameter == parameter_) sample.value = gain_ * sample.value + offset_;
    }
    on.push_back(std::move(flight));
  }

 private:
  std::uint32_t parameter_;
  double gain_;
  double offset_;
};

class Swapped : public FaultStage {
 public:
  Swapped(std::uint32_t one, std::uint32_t other) : one_(one), other_(other) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    for (Sample& sample : flight.frame.samples) {
      if (sample.parameter == one_)
        sample.parameter = other_;
      else if (sample.parameter == other_)
        sample.parameter = one_;
    }
    on.push_back(std::move(flight));
  }

 private:
  std::uint32_t one_, other_;
};

class Stops : public FaultStage {
 public:
  explicit Stops(std::uint32_t parameter) : parameter_(parameter) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    std::erase_if(flight.frame.samples,
                  [this](const Sample& sample) { return sample.parameter == parameter_; });
    on.push_back(std::move(flight));
  }

 private:
  std::uint32_t parameter_;
};

class WrongValidity : public FaultStage {
 public:
  WrongValidity(const Fault& fault, std::span<const ParameterDescriptor> parameters)
      : fault_(fault), share_(fault.magnitude.value_or(facts(fault.kind).usual)) {
    for (const auto& parameter : parameters) {
      if (!fault.parameter.empty() && fault.parameter != parameter.name) continue;
      // The digital ones say 0 or 1 even when they are wrong.
      const bool digital = parameter.kind == storage::ParameterKind::digital;
      subjects_[parameter.id] = {limits_of(parameter).value_or(digital ? Limits{0, 1} : any_value),
                                 digital};
    }
  }

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    for (Sample& sample : flight.frame.samples) {
      const auto subject = subjects_.find(sample.parameter);
      if (subject == subjects_.end()) continue;
      RandomStream random = draw(fault_, flight.generated, sample.parameter);
      const double choice = random.uniform();
      if (choice < share_ / 2) {
        sample.quality = Quality::invalid;
      } else if (choice < share_) {
        sample = {sample.parameter, Quality::good, subject->second.anything(random.uniform())};
      }
    }
    on.push_back(std::move(flight));
  }

 private:
  struct Subject {
    Limits limits;
    bool digital = false;
    double anything(double share) const {
      return digital ? (share < 0.5 ? limits.low : limits.high)
                     : limits.low + share * limits.span();
    }
  };
  Fault fault_;
  double share_;
  std::map<std::uint32_t, Subject> subjects_;
};

}  // namespace

std::unique_ptr<FaultStage> sample_fault(const Fault& fault,
                                         std::span<const ParameterDescriptor> parameters) {
  if (fault.kind == FaultKind::wrong_validity)
    return std::make_unique<WrongValidity>(fault, parameters);
  const ParameterDescriptor& parameter = named(parameters, fault.parameter);
  switch (fault.kind) {
    case FaultKind::wrong_calibration:
      return std::make_unique<WrongCalibration>(fault, parameter);
    case FaultKind::swapped:
      return std::make_unique<Swapped>(parameter.id, named(parameters, fault.other).id);
    case FaultKind::stops:
      return std::make_unique<Stops>(parameter.id);
    default:
      return std::make_unique<SensorFault>(fault, parameter);
  }
}

}  // namespace reident::satcs
