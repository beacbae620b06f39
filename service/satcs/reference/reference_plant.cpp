#include "service/satcs/reference/reference_plant.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace reident::satcs::reference {

namespace {

storage::Time warm_up_ns(const Constants& constants) {
  return static_cast<storage::Time>(std::ceil(constants.orbit.period_s)) * storage::second_ns;
}

double sum(const auto& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

Plant::Plant(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
             std::uint64_t seed, int steps_per_second)
    : steps_per_second_(steps_per_second),
      step_s_(1.0 / steps_per_second),
      fresh_(fresh),
      life_(std::move(life)),
      constants_(aged(fresh_, life_, start - warm_up_ns(fresh))),
      orbit_(constants_.orbit),
      array_(constants_.array),
      batteries_{Battery(constants_.battery[0], step_s_), Battery(constants_.battery[1], step_s_)},
      chargers_{Charger(constants_.charger[constants_.charger_in_use[0]], step_s_),
                Charger(constants_.charger[constants_.charger_in_use[1]], step_s_)},
      bdr_(constants_.bdr, step_s_),
      converters_(constants_.converter, constants_.converter_plate, step_s_),
      bus_(constants_.bus, constants_.mea, step_s_),
      loads_(orbit_, constants_.load, life_, seed),
      second_(start - warm_up_ns(fresh)) {
  illumination_end_ = orbit_.illumination(second_);
  for (std::size_t k = 0; k < battery_count; ++k) {
    flows_.battery_V[k] = batteries_[k].internal_V();
    flows_.section_V[k] = chargers_[k].section_V(flows_.battery_V[k], 0);
  }
  flows_.bus_V = bus_.bus_V();
  flows_.distributor_V = flows_.bus_V;
  while (time() < start) step();
}

storage::Time Plant::time() const {
  return second_ + step_in_second_ * storage::second_ns / steps_per_second_;
}

void Plant::step() {
  if (step_in_second_ == 0) begin_second();
  const double share = (step_in_second_ + 0.5) * step_s_;  // its middle
  flows_.illumination = illumination_begin_ + share * (illumination_end_ - illumination_begin_);
  array_.set_sun(flows_.illumination * relative_flux_, incidence_);

  solve_bus();
  for (std::size_t k = 0; k < battery_count; ++k) solve_battery(k);

  bdr_.step(flows_.battery_V, sum(flows_.bdr_loss_W));
  converters_.step(converter_loss_W());
  array_.step(step_s_, array_W());
  if (++step_in_second_ == steps_per_second_) {
    step_in_second_ = 0;
    second_ += storage::second_ns;
  }
}

void Plant::begin_second() {
  if (ages_between(life_, second_ - storage::second_ns, second_)) age();
  illumination_begin_ = illumination_end_;
  illumination_end_ = orbit_.illumination(second_ + storage::second_ns);
  incidence_ = array_.incidence(orbit_.beta(second_));
  relative_flux_ = orbit_.relative_flux(second_);
  std::array<double, battery_count> battery_C{};
  for (std::size_t k = 0; k < battery_count; ++k) {
    battery_C[k] = batteries_[k].state().temperature_C;
  }
  loads_.update(second_, illumination_begin_, battery_C);
}

void Plant::age() {
  constants_ = aged(fresh_, life_, second_);
  array_.age(constants_.array);
  for (std::size_t k = 0; k < battery_count; ++k) {
    batteries_[k].age(constants_.battery[k]);
    chargers_[k].age(constants_.charger[constants_.charger_in_use[k]]);
  }
  bdr_.age(constants_.bdr);
  converters_.age(constants_.converter);
  loads_.age(constants_.load);
}

DischargeRegulator::Supplied Plant::modules_supplied() const {
  const auto supplied = [this](const Battery& battery) {
    return battery.state().soc > 0 && battery.internal_V() > constants_.bdr.least_input_V;
  };
  return {supplied(batteries_[0]), supplied(batteries_[1])};
}

void Plant::solve_bus() {
  Bus::Demand demand;
  const double string_A = constants_.array.section_share[battery_count] *
                          array_.string_current(constants_.array.bus_cells, flows_.bus_V);
  for (std::size_t c = 0; c < shunt_channels; ++c) {
    demand.channel_A[c] = constants_.array.bus_strings[c] * string_A;
  }
  const auto supplied = modules_supplied();
  demand.bdr_max_A = bdr_.max_output_A(supplied);
  Converters::Lines converter_W{};
  for (std::size_t l = 0; l < converter_count; ++l) {
    converter_W[l] = converters_.input_W(l, loads_.line_A(l));
  }
  flows_.load_A = loads_.currents_A(flows_.distributor_V, converter_W);
  demand.load_A = sum(flows_.load_A);
  const Bus::Solution solution = bus_.step(demand);
  for (double& load_A : flows_.load_A) load_A *= solution.load_share;
  for (std::size_t l = 0; l < converter_count; ++l) {
    flows_.line_A[l] = solution.load_share * loads_.line_A(l);
    flows_.line_V[l] = converters_.output_V(l, flows_.line_A[l]);
  }
  flows_.array_A = solution.array_A;
  flows_.shunt_A = solution.shunt_A;
  flows_.shunting = solution.shunting;
  flows_.sg2_A = solution.array_A - solution.shunt_A;
  flows_.bdr_out_A = solution.bdr_A;
  flows_.bdr_module_A = bdr_.share(solution.bdr_A, supplied);
  flows_.bus_A = flows_.sg2_A + flows_.bdr_out_A;
  flows_.capacitor_A = solution.capacitor_A;
  flows_.capacitor_J = solution.capacitor_J;
  flows_.distributor_A = sum(flows_.load_A);
  flows_.bus_V = bus_.bus_V();
  flows_.distributor_V = flows_.bus_V - constants_.bus.harness_ohm * flows_.distributor_A;
  flows_.mea_V = bus_.mea_V();
}

void Plant::solve_battery(std::size_t k) {
  Battery& battery = batteries_[k];
  flows_.section_A[k] = constants_.array.charge_strings[k] * constants_.array.section_share[k] *
                        array_.string_current(constants_.array.charge_cells, flows_.section_V[k]);
  flows_.charge_A[k] = chargers_[k].share() * flows_.section_A[k];
  flows_.section_shunt_A[k] = flows_.section_A[k] - flows_.charge_A[k];

  const bool supplied = modules_supplied()[k];
  flows_.bdr_loss_W[k] = supplied ? bdr_.loss_W(flows_.bdr_module_A[k], flows_.battery_V[k]) : 0;
  const double drawn_W = flows_.bus_V * flows_.bdr_module_A[k] + flows_.bdr_loss_W[k];
  const double voltage = battery.terminal_V(flows_.charge_A[k], drawn_W);
  flows_.battery_V[k] = voltage;
  flows_.section_V[k] = chargers_[k].section_V(voltage, flows_.charge_A[k]);
  flows_.bdr_in_A[k] = drawn_W / voltage;
  flows_.battery_A[k] = flows_.charge_A[k] - flows_.bdr_in_A[k];
  flows_.stored_A[k] = battery.stored_A(flows_.battery_A[k]);

  chargers_[k].step(voltage, battery.state().temperature_C);
  battery.step(flows_.battery_A[k], flows_.load_A[battery_heater_1 + k] * flows_.distributor_V);
}

double Plant::array_W() const {
  const ArrayConstants& c = constants_.array;
  const Flows& f = flows_;
  double power_W = (f.bus_V + c.blocking_diode_V) * f.sg2_A + c.shunt_drop_V * f.shunt_A;
  for (std::size_t k = 0; k < battery_count; ++k) {
    power_W += (f.section_V[k] + c.blocking_diode_V) * f.charge_A[k] +
               c.shunt_drop_V * f.section_shunt_A[k];
  }
  return power_W;
}

double Plant::converter_loss_W() const {
  double loss_W = 0;
  for (std::size_t l = 0; l < converter_count; ++l) {
    loss_W +=
        flows_.distributor_V * flows_.load_A[converter_1 + l] - flows_.line_V[l] * flows_.line_A[l];
  }
  return loss_W;
}

PowerBalance Plant::power_balance() const {
  const Flows& f = flows_;
  const ArrayConstants& array = constants_.array;
  PowerBalance p;
  p.array = array_W();
  p.blocking_diodes = array.blocking_diode_V * (f.sg2_A + sum(f.charge_A));
  p.shunt_switches = array.shunt_drop_V * (f.shunt_A + sum(f.section_shunt_A));
  p.discharge_regulators = sum(f.bdr_loss_W);
  p.harness = (f.bus_V - f.distributor_V) * f.distributor_A;
  p.converters = converter_loss_W();
  p.capacitor = f.capacitor_J / step_s_;
  p.capacitor_resistance = f.bus_V * f.capacitor_A - p.capacitor;
  for (std::size_t k = 0; k < battery_count; ++k) {
    p.chargers += (f.section_V[k] - f.battery_V[k]) * f.charge_A[k];
    p.battery_heat += batteries_[k].heat_W();
    p.batteries += f.battery_V[k] * f.battery_A[k] - batteries_[k].heat_W();
  }
  p.platform = f.distributor_V * f.load_A[platform];
  p.transmitter = f.distributor_V * f.load_A[transmitter];
  for (const Load heater : {equipment_heater, battery_heater_1, battery_heater_2}) {
    p.heaters += f.distributor_V * f.load_A[heater];
  }
  for (std::size_t l = 0; l < converter_count; ++l) {
    p.secondary_lines += f.line_V[l] * f.line_A[l];
  }
  return p;
}

}  // namespace reident::satcs::reference
