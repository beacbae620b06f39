#include <vector>

#include "service/dds/reader_impl.hpp"

namespace reident::dds {

struct WaitSet::Impl {
  // The library is the owner, no participant: readers of two sessions may be attached.
  Impl()
      : wait_set(dds_create_waitset(DDS_CYCLONEDDS_HANDLE), "dds_create_waitset", "the library"),
        guard(dds_create_guardcondition(DDS_CYCLONEDDS_HANDLE), "dds_create_guardcondition",
              "the library") {
    check(dds_waitset_attach(wait_set.get(), guard.get(), 0), "dds_waitset_attach", "the guard");
  }

  Entity wait_set;
  Entity guard;
  std::vector<std::weak_ptr<ReaderCore>> readers;
};

WaitSet::WaitSet(Participant& /*participant*/) : impl_(std::make_unique<Impl>()) {}
WaitSet::~WaitSet() = default;

template <class M>
void WaitSet::attach(Reader<M>& reader) {
  reader.impl_->core->attach_to(impl_->wait_set.get());
  impl_->readers.push_back(reader.impl_->core);
}

bool WaitSet::wait(std::chrono::nanoseconds timeout) {
  const dds_return_t ready =
      check(dds_waitset_wait(impl_->wait_set.get(), nullptr, 0, timeout.count()),
            "dds_waitset_wait", "the wait set");
  bool woken = false;
  check(dds_take_guardcondition(impl_->guard.get(), &woken), "dds_take_guardcondition",
        "the wait set");
  for (const std::weak_ptr<ReaderCore>& reader : impl_->readers) {
    if (const auto core = reader.lock()) core->meet_writers();
  }
  return ready > 0;
}

void WaitSet::wake() {
  check(dds_set_guardcondition(impl_->guard.get(), true), "dds_set_guardcondition", "the wait set");
}

template void WaitSet::attach(Reader<storage::TelemetryFrame>& reader);
template void WaitSet::attach(Reader<storage::ParameterDescriptor>& reader);
template void WaitSet::attach(Reader<ModelVersion>& reader);
template void WaitSet::attach(Reader<IdentificationReport>& reader);
template void WaitSet::attach(Reader<ModelAcknowledgement>& reader);
template void WaitSet::attach(Reader<ServiceStatus>& reader);
template void WaitSet::attach(Reader<CommandRequest>& reader);
template void WaitSet::attach(Reader<CommandReply>& reader);
template void WaitSet::attach(Reader<HistoryRequest>& reader);
template void WaitSet::attach(Reader<HistoryReply>& reader);
template void WaitSet::attach(Reader<Leadership>& reader);
template void WaitSet::attach(Reader<Replica>& reader);

}  // namespace reident::dds
