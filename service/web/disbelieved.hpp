// Which sensors screening did not believe, put together from what windows found.
#pragma once

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "storage/types/registry_rows.hpp"

namespace reident::web {

/// One fault of a sensor, or one contradiction between sensors.
struct Disbelieved {
  std::string spacecraft, check, relation;  // no relation: a fault of one sensor
  std::vector<std::string> parameters;
  storage::TimeRange range;
  std::size_t stretches = 1;               // that it consists of
  std::set<std::string> equipment;         // that it was excluded from
  double residual = NAN, tolerance = NAN;  // of the relation, where it is broken most
};

class DisbelievedSensors {
 public:
  /// `pause`: stretches of the same fault that are not further apart are one [ns].
  explicit DisbelievedSensors(storage::Time pause) : pause_(pause) {}
  /// Adds what was excluded from a window. Windows overlap, and say the same again.
  void add(const storage::Attempt& attempt);
  /// How many shorter stretches of windows their evidence does not have.
  std::size_t left_out() const { return left_out_; }
  /// The newest first.
  std::vector<Disbelieved> take() &&;

 private:
  using Subject = std::tuple<std::string, std::string, std::string, std::vector<std::string>>;

  storage::Time pause_;
  std::size_t left_out_ = 0;
  std::map<Subject, std::vector<Disbelieved>> found_;
};

}  // namespace reident::web
