#include "service/dds/codec.hpp"
#include "service/dds/writer_core.hpp"

namespace reident::dds {

template <class M>
struct Writer<M>::Impl {
  Impl(Participant& participant, const WriterOptions& options)
      : core(participant, Codec<M>::profile, Codec<M>::descriptor, options) {}

  /// Writes a copy of the message.
  static WriterCore::Call rewrite(const M& message) {
    return [message](dds_entity_t writer) {
      typename Codec<M>::Encoder encode;
      return dds_write(writer, &encode(message));
    };
  }

  WriterCore core;
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
  const auto* wire = &impl_->encode(message);
  return impl_->core.write(
      wire, [wire](dds_entity_t writer) { return dds_write(writer, wire); }, stop,
      impl_->core.keeps_state() ? Impl::rewrite(message) : WriterCore::Call());
}

template <class M>
void Writer<M>::dispose(const M& message) {
  impl_->core.dispose(&impl_->encode(message));
}

template <class M>
std::uint32_t Writer<M>::matched_readers() const {
  return impl_->core.matched_readers();
}

template <class M>
std::uint32_t Writer<M>::matched_archives() const {
  return impl_->core.matched_archives();
}

template <class M>
bool Writer<M>::wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
  return impl_->core.wait_for_acknowledgments(timeout);
}

template <class M>
std::optional<std::string> refusal(const M& message) {
  typename Codec<M>::Encoder encode;
  M received;
  return Codec<M>::decode(encode(message), ReaderOptions{}, received);
}

template std::optional<std::string> refusal(const storage::TelemetryFrame&);
template std::optional<std::string> refusal(const storage::ParameterDescriptor&);

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
