// What an XTCE 1.2 database says about telemetry packets, as far as the gateway knows XTCE
// (gateway/README.md has the list): names are resolved, and each thing is an index into Database.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace reident::satcs::xtce {

using Index = std::size_t;

/// How the bits of a field are a value.
enum class Coding {
  unsigned_integer,
  twos_complement,
  ones_complement,
  sign_magnitude,
  ieee754,        // 16, 32 or 64 bits
  mil_std_1750a,  // 32 or 48 bits
  text,
  binary,
};

/// Bits of a field: `bits`, and where `of` is another field, slope * its value + intercept of them.
struct FieldSize {
  std::uint64_t bits = 0;
  std::optional<Index> of = {};  // a parameter that is decoded before
  double slope = 1;
  double intercept = 0;
};

/// A polynomial in the raw value, or straight lines between points; without either the raw value.
struct Calibrator {
  std::vector<double> coefficients;               // of the powers 0, 1, ...
  std::vector<std::pair<double, double>> points;  // raw, calibrated; ascending by raw
  bool holds_between_points = false;              // order 0: the value of the point before
  bool extrapolates = false;
};

enum class Operator { equal, not_equal, less, at_most, greater, at_least };

/// One comparison of a parameter that is decoded before, or all or any of the parts.
struct Condition {
  enum class Kind { comparison, all, any };
  Kind kind = Kind::all;
  std::vector<Condition> parts = {};
  Index parameter = 0;
  Operator op = Operator::equal;
  std::string value = {};  // a number, or a label
  bool uses_calibrated = true;
};

struct ContextCalibrator {
  Condition when;
  Calibrator calibrator;
};

struct Encoding {
  Coding coding = Coding::unsigned_integer;
  FieldSize size = {};
  bool low_byte_first = false;
  bool low_bit_first = false;
  std::optional<std::uint8_t> terminator = {};  // of a text, which ends there
  std::uint32_t length_bits = 0;                // of a text: an unsigned count of bytes before it
  Calibrator calibrator = {};
  std::vector<ContextCalibrator> context_calibrators = {};  // the first whose condition holds
};

/// A state, for raw values from `low` to `high`.
struct Label {
  std::int64_t low = 0;
  std::int64_t high = 0;
  std::string text;
};

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool holds(double value) const { return low <= value && value <= high; }
};

enum class Kind { integer, real, boolean, state, text, binary, aggregate };

struct ParameterType {
  std::string name;
  Kind kind = Kind::integer;
  std::string unit;
  std::string description;
  std::optional<Encoding> encoding;  // none: its fields have no place in a packet
  std::vector<Label> labels;         // of states and booleans
  Range alarm_free;                  // outside of it a value is out of limits
  Range valid;                       // outside of it a value is no measurement
  bool valid_is_calibrated = true;
  bool is_usable = true;  // false: its values cannot be computed, its size is known
  std::vector<std::pair<std::string, Index>> members;  // of an aggregate: name and type
};

struct Parameter {
  std::string path;  // "/SAT/EPS/V_BUS"
  std::string name;  // the last part where that is unique in the database, else the path below SAT
  Index type = 0;
  std::string description;
  std::vector<Index> members;  // of an aggregate, in their order
};

/// A place in a container, relative to what was read before or to the container's begin.
struct Location {
  bool from_begin = false;
  std::int64_t bits = 0;
};

struct Entry {
  enum class What { parameter, container, unknown };
  What what = What::unknown;  // unknown: of no known size, what follows has no known place
  Index index = 0;
  Location location = {};
  std::optional<Condition> when = {};
};

struct Container {
  std::string path;
  std::string name;
  bool is_abstract = false;
  std::optional<Index> base = {};
  std::optional<Condition> criteria = {};  // which separate it from others with its base
  bool is_decidable = true;                // false: its criteria are not all known
  std::vector<Entry> entries = {};
  std::vector<Index> heirs = {};  // whose base it is
};

/// What the database has and the gateway cannot follow.
struct Note {
  long line = 0;
  std::string path;  // of the element
  std::string what;  // what is wrong and what follows from it
};

struct Database {
  std::string name;
  std::vector<ParameterType> types;
  std::vector<Parameter> parameters;
  std::vector<Container> containers;
  std::vector<Index> roots;      // containers that a packet begins with
  std::vector<Index> published;  // parameters with numbers, outside the primary header
  std::set<Index> identifying;   // by which containers are chosen; the same in many packets
  std::vector<Note> notes;
};

}  // namespace reident::satcs::xtce
