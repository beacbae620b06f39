#include "service/dds/codec.hpp"
#include "service/dds/domain.hpp"

namespace reident::dds {

template <class M>
struct Writer<M>::Impl {
  Impl(Participant& participant, const WriterOptions& options)
      : topic(dds_create_topic(participant.impl().participant.get(), &Codec<M>::descriptor, name,
                               nullptr, nullptr),
              "dds_create_topic", name),
        writer(dds_create_writer(participant.impl().publisher.get(), topic.get(),
                                 writer_qos(Codec<M>::profile, options).get(), nullptr),
               "dds_create_writer", name) {}

  /// Makes the call until it does not time out, or `stop` answers true: then false.
  bool insist(const char* what, const std::function<dds_return_t()>& call,
              const std::function<bool()>& stop) const {
    const bool waits_for_room = Codec<M>::profile.history == keep_all;
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (true) {
      const dds_return_t result = call();
      if (result != DDS_RETCODE_TIMEOUT) {
        check(result, what, name);
        return true;
      }
      if (stop()) return false;
      if (!waits_for_room && std::chrono::steady_clock::now() >= deadline) fail(result, what, name);
    }
  }

  static constexpr const char* name = Codec<M>::profile.topic;
  Entity topic;
  Entity writer;
  typename Codec<M>::Encoder encode;
};

template <class M>
Writer<M>::Writer(Participant& participant, const WriterOptions& options)
    : impl_(std::make_unique<Impl>(participant, options)) {}
template <class M>
Writer<M>::~Writer() = default;
template <class M>
Writer<M>::Writer(Writer&&) noexcept = default;
template <class M>
Writer<M>& Writer<M>::operator=(Writer&&) noexcept = default;

template <class M>
void Writer<M>::write(const M& message) {
  write(message, [] { return false; });
}

template <class M>
bool Writer<M>::write(const M& message, const std::function<bool()>& stop) {
  const auto& wire = impl_->encode(message);
  return impl_->insist(
      "dds_write", [&] { return dds_write(impl_->writer.get(), &wire); }, stop);
}

template <class M>
void Writer<M>::dispose(const M& message) {
  const auto& wire = impl_->encode(message);
  impl_->insist(
      "dds_dispose", [&] { return dds_dispose(impl_->writer.get(), &wire); }, [] { return false; });
}

template <class M>
std::uint32_t Writer<M>::matched_readers() const {
  dds_publication_matched_status_t status{};
  check(dds_get_publication_matched_status(impl_->writer.get(), &status),
        "dds_get_publication_matched_status", impl_->name);
  return status.current_count;
}

template <class M>
bool Writer<M>::wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
  const dds_return_t result = dds_wait_for_acks(impl_->writer.get(), timeout.count());
  if (result == DDS_RETCODE_TIMEOUT) return false;
  check(result, "dds_wait_for_acks", impl_->name);
  return true;
}

template class Writer<storage::TelemetryFrame>;
template class Writer<storage::ParameterDescriptor>;
template class Writer<ModelVersion>;
template class Writer<IdentificationReport>;
template class Writer<ModelAcknowledgement>;
template class Writer<ServiceStatus>;
template class Writer<CommandRequest>;
template class Writer<CommandReply>;
template class Writer<HistoryRequest>;
template class Writer<HistoryReply>;
template class Writer<Leadership>;
template class Writer<Replica>;

}  // namespace reident::dds
