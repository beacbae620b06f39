// CCSDS space packets as a stream of telemetry frames: one frame a packet that an XTCE database has
// a container for.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "service/satcs/frame_stream.hpp"
#include "service/satcs/gateway/packet_counts.hpp"
#include "service/satcs/gateway/packet_decoder.hpp"
#include "service/satcs/gateway/packet_source.hpp"
#include "service/satcs/gateway/packet_time.hpp"
#include "service/satcs/gateway/space_packet.hpp"
#include "service/support/csv.hpp"

namespace reident::satcs {

/// How packets become frames.
struct PacketOptions {
  TimeCode time;
  std::size_t prefix_bytes = 0;   // before each packet
  std::vector<std::string> only;  // parameters to publish, by name; empty: all
  bool force_times = false;       // times before 1990 and after tomorrow are taken
};

/// A parameter that is published, and its index in the database.
struct GatewayParameter {
  xtce::Index index = 0;
  storage::ParameterDescriptor descriptor;
};
/// Those that `only` names, or all but those that identify packets, by ascending index. A sentence
/// where a name of `only` is none, or two names have one id.
std::variant<std::vector<GatewayParameter>, csv::Error> gateway_parameters(
    const xtce::Database& database, const std::vector<std::string>& only);

/// The sequence numbers of its frames leave out those of packets that are missing by their sequence
/// counts, so that an archive counts them too. Of a live source, a frame is received when its
/// packet is, of a file when it was generated.
class PacketStream : public FrameStream {
 public:
  using Clock = std::function<storage::Time()>;

  /// The database has to live as long. A stop ends the stream of a live source.
  PacketStream(const xtce::Database& database, std::vector<GatewayParameter> parameters,
               PacketOptions options, std::unique_ptr<PacketSource> source, Sender sender,
               Clock clock, std::stop_token stop);

  std::vector<storage::ParameterDescriptor> parameters() const override;
  bool next(storage::TelemetryFrame& frame) override;
  double progress() const override { return source_->progress(); }

  const PacketCounts& counts() const { return counts_; }

 private:
  /// False where the packet is left out.
  bool take(std::span<const std::uint8_t> packet, storage::TelemetryFrame& frame);
  bool find_time(std::span<const std::uint8_t> packet, storage::TelemetryFrame& frame);
  void leave_out(const char* reason, std::span<const std::uint8_t> packet,
                 const std::string& detail);

  const xtce::Database& database_;
  std::vector<GatewayParameter> parameters_;
  std::vector<std::optional<std::uint32_t>> ids_;  // of the database's parameters
  PacketOptions options_;
  std::unique_ptr<PacketSource> source_;
  Sender sender_;
  Clock clock_;
  std::stop_token stop_;
  PacketCounts counts_;
  PacketSplitter splitter_;
  PacketDecoder decoder_;
  std::vector<std::uint8_t> bytes_;
  std::vector<storage::Sample> samples_;
  std::uint64_t next_sequence_;
  bool is_at_end_ = false;
};

}  // namespace reident::satcs
