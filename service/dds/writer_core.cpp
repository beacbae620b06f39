#include "service/dds/writer_core.hpp"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include "service/support/log.hpp"

namespace reident::dds {
namespace {

/// How long telemetry waits until the writer of a new session has the readers of the one before.
constexpr auto readers_found_within = std::chrono::seconds(5);

bool keeps_all(dds_entity_t writer, dds_instance_handle_t reader) {
  dds_builtintopic_endpoint_t* endpoint = dds_get_matched_subscription_data(writer, reader);
  if (endpoint == nullptr) return false;  // it has just left
  dds_history_kind_t kind = DDS_HISTORY_KEEP_LAST;
  dds_qget_history(endpoint->qos, &kind, nullptr);
  dds_builtintopic_free_endpoint(endpoint);
  return kind == DDS_HISTORY_KEEP_ALL;
}

std::uint32_t archives_of(dds_entity_t writer, const char* topic) {
  const dds_return_t count = check(dds_get_matched_subscriptions(writer, nullptr, 0),
                                   "dds_get_matched_subscriptions", topic);
  std::vector<dds_instance_handle_t> readers(static_cast<std::size_t>(count));
  const dds_return_t there =
      check(dds_get_matched_subscriptions(writer, readers.data(), readers.size()),
            "dds_get_matched_subscriptions", topic);
  readers.resize(std::min(readers.size(), static_cast<std::size_t>(there)));
  return static_cast<std::uint32_t>(
      std::count_if(readers.begin(), readers.end(),
                    [writer](dds_instance_handle_t reader) { return keeps_all(writer, reader); }));
}

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
  session->require_valid(profile_.topic);
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
  return matched(in_use());
}

std::uint32_t WriterCore::matched_archives() {
  const MutexLock lock(mutex_);
  const dds_entity_t writer = in_use().writer.get();
  dds_publication_matched_status_t status{};
  check(dds_get_publication_matched_status(writer, &status), "dds_get_publication_matched_status",
        profile_.topic);
  // Each reader that comes or goes changes the status.
  if (archives_.writer != writer || archives_.ever != status.total_count ||
      archives_.now != status.current_count)
    archives_ = {writer, status.total_count, status.current_count,
                 archives_of(writer, profile_.topic)};
  return archives_.count;
}

bool WriterCore::wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
  // The lock is not kept meanwhile: another thread may go on writing.
  constexpr auto look_again = std::chrono::milliseconds(1);
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    {
      const MutexLock lock(mutex_);
      if ((!before_ || is_acknowledged(*before_, 0)) && is_acknowledged(current_, 0)) return true;
    }
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(look_again);
  }
}

}  // namespace reident::dds
