// Faults about whole frames: which come, when, in what order, from whom, with what times.
#include <algorithm>

#include "service/satcs/faults/fault_stage.hpp"
#include "service/satcs/platform/handwritten_platform.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"

namespace reident::satcs {
namespace {

using storage::Time;

double magnitude_of(const Fault& fault) {
  return fault.magnitude.value_or(facts(fault.kind).usual);
}

class FramesLost : public FaultStage {
 public:
  explicit FramesLost(const Fault& fault) : fault_(fault), share_(magnitude_of(fault)) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    if (draw(fault_, flight.generated).uniform() >= share_) on.push_back(std::move(flight));
  }

 private:
  Fault fault_;
  double share_;
};

class PassesLost : public FaultStage {
 public:
  PassesLost(const Fault& fault, const reference::OrbitConstants& orbit)
      : fault_(fault), share_(magnitude_of(fault)), orbit_(orbit) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    const Time time = flight.generated;
    if (time < interval_.begin || time >= interval_.end) find_interval(time);
    const Time contact = in_contact_ ? interval_.begin : interval_.end;
    if (contact < fault_.when.end && draw(fault_, contact).uniform() < share_) return;
    if (!in_contact_) flight.arrive_at(contact + (time - interval_.begin) / dump_speed);
    on.push_back(std::move(flight));
  }

 private:
  static constexpr Time dump_speed = 256;

  /// Around `time`, in which the spacecraft is or is not in contact all along.
  void find_interval(Time time) {
    in_contact_ = orbit_.in_contact(time);
    interval_ = {time, time};
    while (interval_.begin - storage::second_ns >= fault_.when.begin &&
           orbit_.in_contact(interval_.begin - storage::second_ns) == in_contact_)
      interval_.begin -= storage::second_ns;
    while (interval_.end < fault_.when.end && orbit_.in_contact(interval_.end) == in_contact_)
      interval_.end = std::min(interval_.end + storage::second_ns, fault_.when.end);
  }

  Fault fault_;
  double share_;
  reference::Orbit orbit_;
  storage::TimeRange interval_{0, 0};
  bool in_contact_ = false;
};

class BackwardsPlayback : public FaultStage {
 public:
  explicit BackwardsPlayback(const Fault& fault)
      : end_(fault.when.end), begins_(end_ + nanoseconds(magnitude_of(fault))) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    flight.arrive_at(begins_ + (end_ - flight.generated) / playback_speed);
    on.push_back(std::move(flight));
  }

 private:
  static constexpr Time playback_speed = 8;
  Time end_;
  Time begins_;
};

class TwoStations : public FaultStage {
 public:
  explicit TwoStations(const Fault& fault)
      : begin_(fault.when.begin),
        ahead_(nanoseconds(magnitude_of(fault))),
        stamps_(fault.kind == FaultKind::two_stamping_stations) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    const Time phase = (flight.generated - begin_) % turn;
    const bool first_hears = phase < 2 * turn / 3;
    if (phase >= turn / 3) {
      Flight heard = flight;
      heard.frame.source += "-2";
      heard.frame.first_sequence = 0;  // it hears what comes, and does not know when that began
      heard.frame.reception_time += ahead_;
      if (stamps_) heard.frame.generation_time += ahead_;
      if (first_hears) on.push_back(std::move(flight));
      on.push_back(std::move(heard));
    } else {
      on.push_back(std::move(flight));
    }
  }

 private:
  static constexpr Time turn = 600 * storage::second_ns;
  Time begin_;
  Time ahead_;
  bool stamps_;
};

class TimeJump : public FaultStage {
 public:
  explicit TimeJump(const Fault& fault) : jump_(nanoseconds(magnitude_of(fault))) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    flight.frame.generation_time += jump_;
    on.push_back(std::move(flight));
  }

 private:
  Time jump_;
};

class Again : public FaultStage {
 public:
  explicit Again(const Fault& fault)
      : later_(nanoseconds(magnitude_of(fault))),
        restamps_(fault.kind == FaultKind::duplicated_day) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    Flight again = flight;
    again.arrive_at(flight.arrival + later_);
    if (restamps_) again.frame.generation_time += later_;
    on.push_back(std::move(flight));
    on.push_back(std::move(again));
  }

 private:
  Time later_;
  bool restamps_;
};

template <class Simulator>
class SimulatedAsReal : public FaultStage {
 public:
  SimulatedAsReal(const Fault& fault, const auto& constants, const FaultInjectorOptions& options)
      : simulator_(constants, options.life, fault.when.begin, options.seed) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    // A fault before this one may have sent the same frame twice.
    if (sent_ == 0 || flight.generated > simulator_.time()) {
      while (simulator_.time() + storage::second_ns <= flight.generated) simulator_.advance();
      on.push_back(simulated(flight));
    }
    on.push_back(std::move(flight));
  }

 private:
  Flight simulated(const Flight& beside) {
    Flight flight{beside.generated, beside.arrival, {}};
    flight.frame.source = "simulator";
    flight.frame.sequence = ++sent_;
    flight.frame.first_sequence = 1;
    flight.frame.generation_time = beside.frame.generation_time;
    flight.frame.reception_time = beside.frame.reception_time;
    simulator_.read(flight.frame.samples);
    return flight;
  }

  Simulator simulator_;
  std::uint64_t sent_ = 0;
};

}  // namespace

std::unique_ptr<FaultStage> frame_fault(const Fault& fault, const FaultInjectorOptions& options) {
  switch (fault.kind) {
    case FaultKind::frames_lost:
      return std::make_unique<FramesLost>(fault);
    case FaultKind::passes_lost:
      return std::make_unique<PassesLost>(fault, options.constants.orbit);
    case FaultKind::backwards_playback:
      return std::make_unique<BackwardsPlayback>(fault);
    case FaultKind::two_stations:
    case FaultKind::two_stamping_stations:
      return std::make_unique<TwoStations>(fault);
    case FaultKind::time_jump:
      return std::make_unique<TimeJump>(fault);
    case FaultKind::duplicated_day:
    case FaultKind::repeated_day:
      return std::make_unique<Again>(fault);
    default:
      if (options.family == Family::platform)
        return std::make_unique<SimulatedAsReal<platform::HandwrittenPlatform>>(
            fault, platform::Constants{}, options);
      return std::make_unique<SimulatedAsReal<HandwrittenEps>>(fault, options.constants, options);
  }
}

}  // namespace reident::satcs
