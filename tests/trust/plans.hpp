// What may happen to a family of equipment, without times: plans of lives and of faults.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/satcs/family.hpp"
#include "service/satcs/faults/fault_injector.hpp"
#include "service/satcs/reference/reference_life.hpp"

namespace reident::trust {

/// A life without its times.
struct LifePlan {
  std::string_view name;
  struct Event {
    satcs::reference::LifeKind kind;
    double magnitude;
    int unit;
    double begin_day;  // after the time of the change
    double days;       // 0: a step, or for good
  };
  std::vector<Event> events;
  std::vector<std::string> equipment;
  int start_day = 0;  // after 2017-07-01
};

std::vector<LifePlan> life_plans(satcs::Family family);

/// Which of an equipment's parameters a fault is about.
enum class Role { none, output, first_input, last_input };

/// A fault without its time.
struct FaultPlan {
  satcs::FaultKind kind;
  Role role = Role::none;
  std::optional<double> magnitude = {};    // of a sensor's: in shares of the usual one
  std::optional<double> days = {};         // absent: drawn
  std::optional<bool> on_the_change = {};  // absent: the first and the third of a life
};

/// Every kind of fault, and of a parameter's each role of the parameter.
std::vector<FaultPlan> fault_plans();

/// The first faults of the platform's life with the number `life`, from 0: biases of a day and of
/// four days, with and without the change, and in each second life a stuck output or a gap. A
/// fourth one comes from fault_plans().
std::vector<FaultPlan> platform_faults(std::size_t life);

}  // namespace reident::trust
