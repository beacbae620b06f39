#include "service/satcs/reference_plant.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace reident::satcs::reference {

namespace {
constexpr storage::Time second_ns = 1'000'000'000;
constexpr double charger_rated_C = 10;

storage::Time warm_up_ns(const Constants& constants) {
  return static_cast<storage::Time>(std::ceil(constants.orbit.period_s)) * second_ns;
}

}  // namespace

Plant::Plant(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
             std::uint64_t seed)
    : fresh_(fresh),
      life_(std::move(life)),
      constants_(aged(fresh_, life_, start - warm_up_ns(fresh))),
      orbit_(constants_.orbit),
      array_(constants_.array),
      batteries_{Battery(constants_.battery[0], step_s), Battery(constants_.battery[1], step_s)},
      bdr_(constants_.bdr, step_s),
      bus_(constants_.bus, constants_.mea, step_s),
      loads_(orbit_, constants_.load, life_, seed),
      second_(start - warm_up_ns(fresh)) {
  illumination_end_ = orbit_.illumination(second_);
  for (std::size_t k = 0; k < battery_count; ++k) {
    charging_[k] = 1;
    flows_.battery_V[k] = batteries_[k].internal_V();
  }
  flows_.bus_V = bus_.bus_V();
  while (time() < start) step();
}

storage::Time Plant::time() const {
  return second_ + step_in_second_ * (second_ns / steps_per_second);
}

void Plant::step() {
  if (step_in_second_ == 0) begin_second();
  const double share = static_cast<double>(step_in_second_ + 1) / steps_per_second;
  flows_.illumination = illumination_begin_ + share * (illumination_end_ - illumination_begin_);
  array_.set_sun(flows_.illumination, incidence_);

  solve_bus();
  for (std::size_t k = 0; k < battery_count; ++k) solve_battery(k);

  const auto& loss = flows_.bdr_loss_W;
  bdr_.step(flows_.battery_V, std::accumulate(loss.begin(), loss.end(), 0.0));
  array_.step(step_s);
  if (++step_in_second_ == steps_per_second) {
    step_in_second_ = 0;
    second_ += second_ns;
  }
}

void Plant::age() {
  if (!ages_between(life_, second_ - second_ns, second_)) return;
  constants_ = aged(fresh_, life_, second_);
  array_.age(constants_.array);
  for (std::size_t k = 0; k < battery_count; ++k) batteries_[k].age(constants_.battery[k]);
  bdr_.age(constants_.bdr);
}

void Plant::begin_second() {
  age();
  illumination_begin_ = illumination_end_;
  illumination_end_ = orbit_.illumination(second_ + second_ns);
  incidence_ = array_.incidence(orbit_.beta(second_));
  std::array<double, battery_count> battery_C{};
  for (std::size_t k = 0; k < battery_count; ++k) {
    battery_C[k] = batteries_[k].state().temperature_C;
  }
  loads_.update(second_, illumination_begin_, battery_C);
}

DischargeRegulator::Supplied Plant::modules_supplied() const {
  return {batteries_[0].state().soc > 0, batteries_[1].state().soc > 0};
}

void Plant::solve_bus() {
  Bus::Demand demand;
  const double string_A = array_.string_current(constants_.array.bus_cells, flows_.bus_V);
  for (std::size_t c = 0; c < shunt_channels; ++c) {
    demand.channel_A[c] =
        constants_.array.bus_strings[c] * constants_.array.section_share[battery_count] * string_A;
  }
  const auto supplied = modules_supplied();
  demand.bdr_max_A = bdr_.max_output_A(supplied);
  for (std::size_t l = 0; l < load_count; ++l) {
    flows_.load_A[l] = loads_.current_A(static_cast<Load>(l), flows_.bus_V);
    demand.load_A += flows_.load_A[l];
  }
  const Bus::Solution solution = bus_.step(demand);
  for (double& load_A : flows_.load_A) load_A *= solution.load_share;
  flows_.array_A = solution.array_A;
  flows_.shunt_A = solution.shunt_A;
  flows_.sg2_A = solution.array_A - solution.shunt_A;
  flows_.bdr_out_A = solution.bdr_A;
  flows_.bdr_module_A = bdr_.share(solution.bdr_A, supplied);
  flows_.bus_A = flows_.sg2_A + flows_.bdr_out_A;
  flows_.capacitor_A = solution.capacitor_A;
  flows_.bus_V = bus_.bus_V();
  flows_.mea_V = bus_.mea_V();
}

void Plant::solve_battery(std::size_t k) {
  Battery& battery = batteries_[k];
  const double before_V = flows_.battery_V[k];
  flows_.section_A[k] = constants_.array.charge_strings[k] * constants_.array.section_share[k] *
                        array_.string_current(constants_.array.charge_cells, before_V);
  flows_.charge_A[k] = charging_[k] * flows_.section_A[k];
  flows_.section_shunt_A[k] = flows_.section_A[k] - flows_.charge_A[k];

  const bool supplied = modules_supplied()[k];
  flows_.bdr_loss_W[k] = supplied ? bdr_.loss_W(flows_.bdr_module_A[k], before_V) : 0;
  const double drawn_W = flows_.bus_V * flows_.bdr_module_A[k] + flows_.bdr_loss_W[k];
  const double voltage = battery.terminal_V(flows_.charge_A[k], drawn_W);
  flows_.battery_V[k] = voltage;
  flows_.bdr_in_A[k] = drawn_W / voltage;
  flows_.battery_A[k] = flows_.charge_A[k] - flows_.bdr_in_A[k];
  flows_.stored_A[k] = battery.stored_A(flows_.battery_A[k]);

  const ChargerConstants& charger = constants_.charger[constants_.charger_in_use[k]];
  const double cell_limit_V =
      charger.cell_limit_V +
      charger.cell_limit_V_per_K * (battery.state().temperature_C - charger_rated_C);
  const double limit_V = charger.cells * cell_limit_V;
  charging_[k] =
      std::clamp(charging_[k] + charger.gain_per_Vs * (limit_V - voltage) * step_s, 0.0, 1.0);
  const Load heater = k == 0 ? battery_heater_1 : battery_heater_2;
  battery.step(flows_.battery_A[k], flows_.load_A[heater] * flows_.bus_V);
}

}  // namespace reident::satcs::reference
