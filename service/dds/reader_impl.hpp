// What a Reader holds; readers and wait sets share it.
#pragma once

#include "service/dds/codec.hpp"
#include "service/dds/reader_core.hpp"
#include "service/support/mutex.hpp"

namespace reident::dds {

template <class M>
struct Reader<M>::Impl {
  Impl(Participant& participant, const ReaderOptions& reader_options)
      : options(reader_options),
        core(std::make_shared<ReaderCore>(participant, Codec<M>::profile, Codec<M>::descriptor,
                                          reader_options)) {}

  /// Hands the message to `sink`, or counts it as malformed and hands it to `refused`.
  void decode(const void* wire, storage::Time sent, const DatedSink& sink, const Refused& refused);

  ReaderOptions options;
  std::shared_ptr<ReaderCore> core;  // a wait set holds it weakly
  mutable Mutex mutex;
  std::uint64_t malformed REIDENT_GUARDED_BY(mutex) = 0;
  std::string last_malformed REIDENT_GUARDED_BY(mutex);
};

}  // namespace reident::dds
