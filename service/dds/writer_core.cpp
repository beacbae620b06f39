#include "service/dds/writer_core.hpp"

#include <utility>

#include "service/support/log.hpp"

namespace reident::dds {
namespace {

/// How long telemetry waits until the writer of a new session has the readers of the one before.
constexpr auto readers_found_within = std::chrono::seconds(5);

}  // namespace

WriterCore::WriterCore(Participant& participant, const Profile& profile,
                       const dds_topic_descriptor_t& descriptor, const WriterOptions& options)
    : sessions_(participant.impl().sessions),
      profile_(profile),
      descriptor_(descriptor),
      options_(options),
      current_(make_writer(sessions_.newest())) {
  if (sessions_.is_secured()) sessions_.add(*this);
}

WriterCore::~WriterCore() {
  if (sessions_.is_secured()) sessions_.remove(*this);
  if (!profile_.autodispose) return;
  for (const auto& [instance, samples] : kept_) dds_dispose_ih(current_.writer.get(), instance);
}

WriterCore::SessionWriter WriterCore::make_writer(const SharedSession& session) const {
  SessionWriter made;
  made.session = session;
  made.topic = session->made(
      dds_create_topic(session->participant.get(), &descriptor_, profile_.topic, nullptr, nullptr),
      "dds_create_topic", profile_.topic, security::Direction::publish);
  const Qos qos = writer_qos(profile_, options_);
  // The end of one of two writers of a state is not the end of the state.
  if (keeps_state()) dds_qset_writer_data_lifecycle(qos.get(), false);
  made.writer = session->made(
      dds_create_writer(session->publisher.get(), made.topic.get(), qos.get(), nullptr),
      "dds_create_writer", profile_.topic, security::Direction::publish);
  return made;
}

bool WriterCore::keeps_state() const {
  return sessions_.is_secured() && !is_telemetry() && profile_.late_joiners > 0;
}

void WriterCore::follow() noexcept {
  const MutexLock lock(mutex_);
  try {
    move_on();
  } catch (const std::exception& error) {
    log::error("dds", "a writer stays with the old files of security",
               {{"topic", profile_.topic}, {"error", error.what()}});
  }
}

void WriterCore::move_on() {
  if (!sessions_.is_newest(current_.session) && !sessions_.is_newest(refused_)) join_newest();
  if (!before_) return;
  const auto since = std::chrono::steady_clock::now() - joined_;
  if (!took_over_)
    took_over_ = matched(current_) >= matched(*before_) || since >= readers_found_within;
  const bool is_done = !is_telemetry() || is_acknowledged(*before_, 0);
  if (since >= session_overlap && (is_done || since >= 2 * session_overlap)) before_.reset();
}

void WriterCore::join_newest() {
  const SharedSession newest = sessions_.newest();
  refused_ = newest;  // asked once
  SessionWriter next = make_writer(newest);
  for (const auto& [instance, samples] : kept_)
    for (const Call& again : samples) check(again(next.writer.get()), "dds_write", profile_.topic);
  before_ = std::exchange(current_, std::move(next));
  joined_ = std::chrono::steady_clock::now();
  took_over_ = !is_telemetry();
  refused_.reset();
}

dds_return_t WriterCore::attempt(const Call& call) {
  move_on();
  if (before_ && !took_over_) return call(before_->writer.get());
  if (before_ && !is_telemetry()) call(before_->writer.get());
  return call(current_.writer.get());
}

bool WriterCore::insist(const char* what, const Call& call, const std::function<bool()>& stop) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (true) {
    dds_return_t result = DDS_RETCODE_OK;
    {
      const MutexLock lock(mutex_);
      result = attempt(call);
    }
    if (result != DDS_RETCODE_TIMEOUT) {
      check(result, what, profile_.topic);
      return true;
    }
    if (stop()) return false;
    if (!is_telemetry() && std::chrono::steady_clock::now() >= deadline)
      fail(result, what, profile_.topic);
  }
}

bool WriterCore::write(const void* wire, const Call& call, const std::function<bool()>& stop,
                       const Call& again) {
  if (!again) return insist("dds_write", call, stop);
  const auto write_and_keep = [&](dds_entity_t writer) REIDENT_REQUIRES(mutex_) {
    const dds_return_t result = call(writer);
    if (result != DDS_RETCODE_OK || writer != current_.writer.get()) return result;
    std::deque<Call>& samples = kept_[dds_lookup_instance(writer, wire)];
    samples.push_back(again);
    if (samples.size() > static_cast<std::size_t>(profile_.late_joiners)) samples.pop_front();
    return result;
  };
  return insist("dds_write", write_and_keep, stop);
}

void WriterCore::dispose(const void* wire) {
  {
    const MutexLock lock(mutex_);
    kept_.erase(dds_lookup_instance(current_.writer.get(), wire));
  }
  insist(
      "dds_dispose", [wire](dds_entity_t writer) { return dds_dispose(writer, wire); },
      [] { return false; });
}

std::uint32_t WriterCore::matched(const SessionWriter& one) const {
  dds_publication_matched_status_t status{};
  check(dds_get_publication_matched_status(one.writer.get(), &status),
        "dds_get_publication_matched_status", profile_.topic);
  return status.current_count;
}

bool WriterCore::is_acknowledged(const SessionWriter& one, dds_duration_t timeout) const {
  const dds_return_t result = dds_wait_for_acks(one.writer.get(), timeout);
  if (result == DDS_RETCODE_TIMEOUT) return false;
  check(result, "dds_wait_for_acks", profile_.topic);
  return true;
}

std::uint32_t WriterCore::matched_readers() const {
  const MutexLock lock(mutex_);
  return matched(before_ && !took_over_ ? *before_ : current_);
}

bool WriterCore::wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
  const MutexLock lock(mutex_);
  return (!before_ || is_acknowledged(*before_, timeout.count())) &&
         is_acknowledged(current_, timeout.count());
}

}  // namespace reident::dds
