// The values of one packet, by the containers of an XTCE database.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "service/satcs/gateway/xtce.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// What a packet turned out to be.
struct DecodedPacket {
  enum class Outcome {
    complete,
    no_container,  // none that a packet may end with has criteria that hold
    too_short,     // the packet ends before its container does
  };
  Outcome outcome = Outcome::no_container;
  xtce::Index container = 0;    // the last one that was read
  std::string detail;           // of a failure
  std::uint64_t bits_left = 0;  // behind the last entry
};

/// One thread at a time; the database has to live as long.
class PacketDecoder {
 public:
  explicit PacketDecoder(const xtce::Database& database);

  /// Reads a whole packet. Its values, of published parameters alone and as often as they come,
  /// replace those in `samples`; a sample's parameter is an index of the database. A value outside
  /// of the alarms' ranges is out of limits, a state without a label suspect, and one that is no
  /// number or outside of the valid range invalid. After a failure they mean nothing.
  DecodedPacket decode(std::span<const std::uint8_t> packet, std::vector<storage::Sample>& samples);

 private:
  struct Value {
    std::uint64_t packet = 0;  // the last one that had it
    std::int64_t raw_integer = 0;
    double raw = 0;
    double calibrated = 0;
    std::string text;  // of texts
  };
  struct Place {
    std::uint64_t begin = 0;  // of the container
    std::uint64_t bit = 0;    // where the next entry begins
    bool is_known = true;
  };

  bool decode_from(const xtce::Container& root, DecodedPacket& result);
  const xtce::Container* heir_of(const xtce::Container& container) const;
  bool read_entries(const xtce::Container& container, Place& place);
  bool read_included(const xtce::Container& container, Place& place);
  bool read_parameter(xtce::Index parameter, Place& place);
  bool read_text(const xtce::Encoding& encoding, Place& place, Value& value);
  void calibrate(const xtce::ParameterType& type, Value& value) const;
  void publish(xtce::Index parameter, const xtce::ParameterType& type, const Value& value);
  bool holds(const xtce::Condition& condition) const;
  bool compare(const xtce::Condition& condition) const;
  /// Bits of the field; absent where the field that says it did not come.
  std::optional<std::uint64_t> size_of(const xtce::FieldSize& size) const;
  bool fits(const Place& place, std::uint64_t bits, xtce::Index parameter);

  const xtce::Database& database_;
  std::vector<bool> is_published_;
  std::vector<Value> values_;
  std::uint64_t packet_number_ = 0;
  std::span<const std::uint8_t> packet_;
  std::vector<storage::Sample>* samples_ = nullptr;
  std::string failure_;
  int depth_ = 0;
};

/// The value that a calibrator makes of a raw one; NaN outside of a spline that does not
/// extrapolate.
double calibrated(const xtce::Calibrator& calibrator, double raw);

}  // namespace reident::satcs
