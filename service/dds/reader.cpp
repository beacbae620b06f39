#include "service/dds/reader_impl.hpp"

namespace reident::dds {

template <class M>
void Reader<M>::Impl::decode(const void* wire, storage::Time sent, const DatedSink& sink,
                             const Refused& refused) {
  M message;
  const Fault fault =
      Codec<M>::decode(*static_cast<const typename Codec<M>::Wire*>(wire), options, message);
  if (!fault) {
    sink(std::move(message), sent);
    return;
  }
  {
    const MutexLock lock(mutex);
    ++malformed;
    last_malformed = *fault;
  }
  if (refused) refused(message, *fault);
}

template <class M>
Reader<M>::Reader(Participant& participant, const ReaderOptions& options)
    : impl_(std::make_unique<Impl>(participant, options)) {}
template <class M>
Reader<M>::~Reader() = default;
template <class M>
Reader<M>::Reader(Reader&&) noexcept = default;
template <class M>
Reader<M>& Reader<M>::operator=(Reader&&) noexcept = default;

template <class M>
std::size_t Reader<M>::take(std::size_t max, const Sink& sink, const Refused& refused) {
  return take(
      max, [&sink](M&& message, storage::Time) { sink(std::move(message)); }, refused);
}

template <class M>
std::size_t Reader<M>::take(std::size_t max, const DatedSink& sink, const Refused& refused) {
  return impl_->core->take(
      max, [&](const void* wire, storage::Time sent) { impl_->decode(wire, sent, sink, refused); });
}

template <class M>
std::size_t Reader<M>::take(std::size_t max, const Sink& sink, const Refused& refused,
                            const Sink& ended) {
  const DatedSink dated = [&sink](M&& message, storage::Time) { sink(std::move(message)); };
  return impl_->core->take(
      max, [&](const void* wire, storage::Time sent) { impl_->decode(wire, sent, dated, refused); },
      [&](const void* wire) {
        M key;  // the rest is missing, which is no fault here
        static_cast<void>(Codec<M>::decode(*static_cast<const typename Codec<M>::Wire*>(wire),
                                           impl_->options, key));
        ended(std::move(key));
      });
}

template <class M>
std::size_t Reader<M>::drain(const Sink& sink, const Refused& refused) {
  const DatedSink dated = [&sink](M&& message, storage::Time) { sink(std::move(message)); };
  return impl_->core->drain(
      [&](const void* wire, storage::Time sent) { impl_->decode(wire, sent, dated, refused); });
}

template <class M>
std::uint32_t Reader<M>::matched_writers() const {
  return impl_->core->matched_writers();
}

template <class M>
std::uint64_t Reader<M>::malformed() const {
  const MutexLock lock(impl_->mutex);
  return impl_->malformed;
}

template <class M>
std::string Reader<M>::last_malformed() const {
  const MutexLock lock(impl_->mutex);
  return impl_->last_malformed;
}

template class Reader<storage::TelemetryFrame>;
template class Reader<storage::ParameterDescriptor>;
template class Reader<ModelVersion>;
template class Reader<IdentificationReport>;
template class Reader<ModelAcknowledgement>;
template class Reader<ServiceStatus>;
template class Reader<CommandRequest>;
template class Reader<CommandReply>;
template class Reader<HistoryRequest>;
template class Reader<HistoryReply>;
template class Reader<Leadership>;
template class Reader<Replica>;

}  // namespace reident::dds
