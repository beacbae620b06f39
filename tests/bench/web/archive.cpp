// Makes what the page is measured on: five signals at 1 Hz, with a gap each day, and equipment with
// a champion, of which the first has the signals.
//
//   reident_web_archive DATABASE DAYS EQUIPMENT

#include "storage/archive/archive.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "service/model/model_json.hpp"
#include "storage/registry/registry.hpp"

namespace {

using namespace reident;

constexpr storage::Time day = 86'400 * storage::second_ns;
constexpr storage::Time begin = 20'000 * day;
constexpr std::int64_t gap_begins_s = 40'000, gap_ends_s = 41'000;
constexpr std::size_t frames_at_once = 4096;
constexpr int signals = 5, decisions = 50;

void fill(storage::Archive& archive, std::int64_t days) {
  std::vector<storage::ParameterDescriptor> descriptors;
  for (int i = 1; i <= signals; ++i)
    descriptors.push_back({"BENCH", static_cast<std::uint32_t>(i), "P" + std::to_string(i), "V", "",
                           storage::ParameterKind::analog, 0.0, 100.0});
  archive.describe(descriptors);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<storage::TelemetryFrame> frames;
  const auto store = [&] {
    archive.append(frames);
    frames.clear();
  };
  for (std::int64_t second = 0; second < days * 86'400; ++second) {
    const std::int64_t of_day = second % 86'400;
    if (of_day >= gap_begins_s && of_day < gap_ends_s) continue;
    storage::TelemetryFrame frame;
    frame.spacecraft = "BENCH";
    frame.source = "bench";
    frame.sequence = static_cast<std::uint64_t>(second);
    frame.generation_time = frame.reception_time = begin + second * storage::second_ns;
    const double phase = static_cast<double>(second) * (6.2831853 / 6016);
    for (int i = 1; i <= signals; ++i)
      frame.samples.push_back(
          {static_cast<std::uint32_t>(i), storage::Quality::good,
           std::round((50 + 10 * std::sin(phase * i) + noise(random)) * 100) / 100});
    frames.push_back(std::move(frame));
    if (frames.size() == frames_at_once) store();
  }
  store();
  archive.compact();
}

EquipmentModel model(const std::string& name) {
  EquipmentModel made;
  made.spacecraft = "BENCH";
  made.equipment = name;
  for (int i = 1; i < signals; ++i) made.inputs.push_back({"P" + std::to_string(i), "V", 40, 60});
  made.outputs.push_back({"P" + std::to_string(signals), "V", 40, 60});
  using identification::Matrix;
  using identification::Vector;
  made.dynamics = {Matrix::Constant(1, 1, 0.9),
                   Matrix::Constant(1, signals - 1, 0.01),
                   Matrix::Constant(1, 1, 1.0),
                   Matrix::Zero(1, signals - 1),
                   Matrix(),
                   Vector::Constant(signals - 1, 50),
                   Vector::Constant(1, 50),
                   1};
  made.sample_hold_ns = 3 * storage::second_ns;
  made.identified_from = {begin, begin + day};
  made.validated_on = {begin + day, begin + 2 * day};
  made.validation.mrse_percent = made.validation.fit_percent = Vector::Constant(1, 5.0);
  made.validation.rows = 86'400;
  made.method = "bench";
  return made;
}

void decide(storage::Registry& registry, std::int64_t days, std::int64_t equipment) {
  for (std::int64_t i = 1; i <= equipment; ++i) {
    const std::string name = "E" + std::to_string(i);
    const std::string text = to_json(model(name)).dump();
    const int versions = i == 1 ? decisions : 3;
    for (int k = 0; k < versions; ++k) {
      storage::NewAttempt attempt;
      attempt.spacecraft = "BENCH";
      attempt.equipment = name;
      attempt.window = {begin + k * days * day / versions, begin + (k + 1) * days * day / versions};
      attempt.time = attempt.window.end;
      attempt.outcome = "challenger";
      attempt.reason = "made for the benchmark";
      attempt.evidence_json = R"({"mrse_percent": 5.0, "fit_percent": 90.0})";
      registry.record(attempt, {text, model_digest(model(name))},
                      {storage::DecisionKind::approve, "gate", "made for the benchmark"});
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: reident_web_archive DATABASE DAYS EQUIPMENT\n", stderr);
    return 2;
  }
  const std::int64_t days = std::strtoll(argv[2], nullptr, 10);
  storage::Database database(argv[1], storage::Database::Mode::read_write,
                             storage::Durability::kill);
  storage::Archive archive(database);
  fill(archive, days);
  storage::Registry registry(database);
  decide(registry, days, std::strtoll(argv[3], nullptr, 10));
}
