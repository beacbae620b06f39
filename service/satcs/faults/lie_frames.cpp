// Lies about whole frames: which come, when, in what order, from whom, with what times.
#include <algorithm>

#include "service/satcs/faults/lie_stage.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"

namespace reident::satcs {
namespace {

using storage::Time;

constexpr Time second_ns = 1'000'000'000;

double magnitude_of(const Lie& lie) {
  return lie.magnitude.value_or(facts(lie.kind).usual);
}

class FramesLost : public LieStage {
 public:
  explicit FramesLost(const Lie& lie) : lie_(lie), share_(magnitude_of(lie)) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    if (draw(lie_, flight.generated).uniform() >= share_) on.push_back(std::move(flight));
  }

 private:
  Lie lie_;
  double share_;
};

class PassesLost : public LieStage {
 public:
  PassesLost(const Lie& lie, const reference::OrbitConstants& orbit)
      : lie_(lie), share_(magnitude_of(lie)), orbit_(orbit) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    const Time time = flight.generated;
    if (time < stretch_.begin || time >= stretch_.end) find_stretch(time);
    const Time contact = in_contact_ ? stretch_.begin : stretch_.end;
    if (contact < lie_.when.end && draw(lie_, contact).uniform() < share_) return;
    if (!in_contact_) flight.arrive_at(contact + (time - stretch_.begin) / dump_speed);
    on.push_back(std::move(flight));
  }

 private:
  static constexpr Time dump_speed = 256;

  /// Around `time`, in which the spacecraft is or is not in contact all along.
  void find_stretch(Time time) {
    in_contact_ = orbit_.in_contact(time);
    stretch_ = {time, time};
    while (stretch_.begin - second_ns >= lie_.when.begin &&
           orbit_.in_contact(stretch_.begin - second_ns) == in_contact_)
      stretch_.begin -= second_ns;
    while (stretch_.end < lie_.when.end && orbit_.in_contact(stretch_.end) == in_contact_)
      stretch_.end = std::min(stretch_.end + second_ns, lie_.when.end);
  }

  Lie lie_;
  double share_;
  reference::Orbit orbit_;
  storage::TimeRange stretch_{0, 0};
  bool in_contact_ = false;
};

class BackwardsPlayback : public LieStage {
 public:
  explicit BackwardsPlayback(const Lie& lie)
      : end_(lie.when.end), begins_(end_ + nanoseconds(magnitude_of(lie))) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    flight.arrive_at(begins_ + (end_ - flight.generated) / playback_speed);
    on.push_back(std::move(flight));
  }

 private:
  static constexpr Time playback_speed = 8;
  Time end_;
  Time begins_;
};

class TwoStations : public LieStage {
 public:
  explicit TwoStations(const Lie& lie)
      : begin_(lie.when.begin),
        ahead_(nanoseconds(magnitude_of(lie))),
        stamps_(lie.kind == LieKind::two_stamping_stations) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    const Time phase = (flight.generated - begin_) % turn;
    const bool first_hears = phase < 2 * turn / 3;
    if (phase >= turn / 3) {
      Flight heard = flight;
      heard.frame.source += "-2";
      heard.frame.reception_time += ahead_;
      if (stamps_) heard.frame.generation_time += ahead_;
      if (first_hears) on.push_back(std::move(flight));
      on.push_back(std::move(heard));
    } else {
      on.push_back(std::move(flight));
    }
  }

 private:
  static constexpr Time turn = 600 * second_ns;
  Time begin_;
  Time ahead_;
  bool stamps_;
};

class TimeJump : public LieStage {
 public:
  explicit TimeJump(const Lie& lie) : jump_(nanoseconds(magnitude_of(lie))) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    flight.frame.generation_time += jump_;
    on.push_back(std::move(flight));
  }

 private:
  Time jump_;
};

class Again : public LieStage {
 public:
  explicit Again(const Lie& lie)
      : later_(nanoseconds(magnitude_of(lie))), restamps_(lie.kind == LieKind::duplicated_day) {}

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

class SimulatedAsReal : public LieStage {
 public:
  SimulatedAsReal(const Lie& lie, const LiarOptions& options)
      : simulator_(options.constants, options.life, lie.when.begin, options.seed) {}

  void pass(Flight&& flight, std::vector<Flight>& on) override {
    // A lie before this one may have sent the same frame twice.
    if (sent_ == 0 || flight.generated > simulator_.time()) {
      while (simulator_.time() + second_ns <= flight.generated) simulator_.advance();
      on.push_back(simulated(flight));
    }
    on.push_back(std::move(flight));
  }

 private:
  Flight simulated(const Flight& beside) {
    Flight flight{beside.generated, beside.arrival, {}};
    flight.frame.source = "simulator";
    flight.frame.sequence = ++sent_;
    flight.frame.generation_time = beside.frame.generation_time;
    flight.frame.reception_time = beside.frame.reception_time;
    simulator_.read(flight.frame.samples);
    return flight;
  }

  HandwrittenEps simulator_;
  std::uint64_t sent_ = 0;
};

}  // namespace

std::unique_ptr<LieStage> frame_lie(const Lie& lie, const LiarOptions& options) {
  switch (lie.kind) {
    case LieKind::frames_lost:
      return std::make_unique<FramesLost>(lie);
    case LieKind::passes_lost:
      return std::make_unique<PassesLost>(lie, options.constants.orbit);
    case LieKind::backwards_playback:
      return std::make_unique<BackwardsPlayback>(lie);
    case LieKind::two_stations:
    case LieKind::two_stamping_stations:
      return std::make_unique<TwoStations>(lie);
    case LieKind::time_jump:
      return std::make_unique<TimeJump>(lie);
    case LieKind::duplicated_day:
    case LieKind::repeated_day:
      return std::make_unique<Again>(lie);
    default:
      return std::make_unique<SimulatedAsReal>(lie, options);
  }
}

}  // namespace reident::satcs
