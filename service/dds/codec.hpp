// One codec for each message: its wire type, its profile, and the two directions.
//
// An Encoder holds the buffers that the wire sample borrows; the reference that it returns is good
// until its next call and as long as the message lives. It sends what it is given: whoever writes a
// message keeps the contract of idl/README.md.
//
// `decode` never trusts the wire: it fills `message` as far as it can, identity first, and returns
// what breaks the contract. What it fills in is a copy, so the loan may end. Neither of the two
// throws but std::bad_alloc. An encoder is for one thread at a time; `decode` has no state.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <dds/dds.h>

#include "reident.h"
#include "satcs.h"
#include "service/dds/dds.hpp"
#include "service/dds/qos.hpp"
#include "service/dds/wire.hpp"

namespace reident::dds {

/// M is a message of dds.hpp. Each specialisation has Wire, descriptor, profile, Encoder and
/// decode.
template <class M>
struct Codec;

template <>
struct Codec<storage::TelemetryFrame> {
  using Wire = satcs_TelemetryFrame;
  static constexpr const dds_topic_descriptor_t& descriptor = satcs_TelemetryFrame_desc;
  static constexpr const Profile& profile = telemetry_frame;

  class Encoder {
   public:
    const Wire& operator()(const storage::TelemetryFrame& frame);

   private:
    Wire wire_{};
    std::vector<std::uint32_t> parameter_;
    std::vector<double> value_;
    std::vector<std::uint8_t> quality_;
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options,
                      storage::TelemetryFrame& frame);
};

template <>
struct Codec<storage::ParameterDescriptor> {
  using Wire = satcs_ParameterDescriptor;
  static constexpr const dds_topic_descriptor_t& descriptor = satcs_ParameterDescriptor_desc;
  static constexpr const Profile& profile = parameter_descriptor;

  class Encoder {
   public:
    const Wire& operator()(const storage::ParameterDescriptor& parameter);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options,
                      storage::ParameterDescriptor& parameter);
};

template <>
struct Codec<ModelVersion> {
  using Wire = reident_ModelVersion;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_ModelVersion_desc;
  static constexpr const Profile& profile = model_version;

  class Encoder {
   public:
    const Wire& operator()(const ModelVersion& version);

   private:
    /// A copy of the matrix, row by row, in a buffer of its own.
    dds_sequence_double lend(const identification::Matrix& matrix);
    void put_tracking(const EquipmentModel::Tracking& tracking);

    Wire wire_{};
    std::vector<reident_Signal> inputs_, outputs_;
    std::deque<std::vector<double>> numbers_;  // one for each matrix that is lent
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, ModelVersion& version);
};

template <>
struct Codec<IdentificationReport> {
  using Wire = reident_IdentificationReport;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_IdentificationReport_desc;
  static constexpr const Profile& profile = identification_report;

  class Encoder {
   public:
    const Wire& operator()(const IdentificationReport& report);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, IdentificationReport& report);
};

template <>
struct Codec<ModelAcknowledgement> {
  using Wire = reident_ModelAcknowledgement;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_ModelAcknowledgement_desc;
  static constexpr const Profile& profile = model_acknowledgement;

  class Encoder {
   public:
    const Wire& operator()(const ModelAcknowledgement& acknowledgement);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options,
                      ModelAcknowledgement& acknowledgement);
};

template <>
struct Codec<ServiceStatus> {
  using Wire = reident_ServiceStatus;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_ServiceStatus_desc;
  static constexpr const Profile& profile = service_status;

  class Encoder {
   public:
    const Wire& operator()(const ServiceStatus& status);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, ServiceStatus& status);
};

template <>
struct Codec<CommandRequest> {
  using Wire = reident_Command;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_Command_desc;
  static constexpr const Profile& profile = command_request;

  class Encoder {
   public:
    const Wire& operator()(const CommandRequest& request);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, CommandRequest& request);
};

template <>
struct Codec<CommandReply> {
  using Wire = reident_CommandReply;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_CommandReply_desc;
  static constexpr const Profile& profile = command_reply;

  class Encoder {
   public:
    const Wire& operator()(const CommandReply& reply);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, CommandReply& reply);
};

template <>
struct Codec<HistoryRequest> {
  using Wire = reident_HistoryRequest;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_HistoryRequest_desc;
  static constexpr const Profile& profile = history_request;

  class Encoder {
   public:
    const Wire& operator()(const HistoryRequest& request);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, HistoryRequest& request);
};

template <>
struct Codec<HistoryReply> {
  using Wire = reident_HistoryReply;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_HistoryReply_desc;
  static constexpr const Profile& profile = history_reply;

  class Encoder {
   public:
    const Wire& operator()(const HistoryReply& reply);

   private:
    Wire wire_{};
    std::vector<char*> rows_;
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, HistoryReply& reply);
};

template <>
struct Codec<Leadership> {
  using Wire = reident_Leadership;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_Leadership_desc;
  static constexpr const Profile& profile = leadership;

  class Encoder {
   public:
    const Wire& operator()(const Leadership& message);

   private:
    Wire wire_{};
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, Leadership& message);
};

template <>
struct Codec<Replica> {
  using Wire = reident_Replica;
  static constexpr const dds_topic_descriptor_t& descriptor = reident_Replica_desc;
  static constexpr const Profile& profile = replica;

  class Encoder {
   public:
    const Wire& operator()(const Replica& message);

   private:
    Wire wire_{};
    std::vector<reident_Term> terms_;
    std::vector<std::uint8_t> rows_;
  };
  static Fault decode(const Wire& wire, const ReaderOptions& options, Replica& message);
};

}  // namespace reident::dds
