// client.h over SimulatorClient: plain structures for the types, results for the exceptions.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "service/client/include/reident/client.h"
#include "service/client/simulator_client.hpp"
#include "service/history/remote_history.hpp"
#include "service/model/model_json.hpp"
#include "service/security/material.hpp"
#include "service/support/utc_clock.hpp"
#include "service/support/version.hpp"

// What programs that were compiled before rely on. New members come after the last one.
static_assert(sizeof(void*) != 8 ||
              (offsetof(reident_options, security_folder) == 64 && sizeof(reident_options) >= 72 &&
               offsetof(reident_event, matched_rows) == 84 && sizeof(reident_event) >= 88 &&
               offsetof(reident_history_query, page_size) == 56 &&
               sizeof(reident_history_query) >= 64 && sizeof(reident_signal) == 16 &&
               offsetof(reident_runner_state, transition_left) == 108 &&
               sizeof(reident_runner_state) >= 112));

struct reident_runner {
  reident::EquipmentRunner* run;  // the client's
  reident_client* client;
};

struct reident_client {
  explicit reident_client(const reident::SimulatorClientOptions& options) : client(options) {}

  std::vector<std::unique_ptr<reident_runner>> runners;
  reident::SimulatorEvent event;  // whose texts the last reident_event points to
  std::string json;
  reident::SimulatorClient client;
  std::optional<reident::history::RemoteHistory> history;  // from the first question on
};

namespace {

using reident::SimulatorEvent;

thread_local std::string last_error;

int fail(int result, std::string text) {
  last_error = std::move(text);
  return result;
}

std::nullptr_t fail(std::string text) {
  last_error = std::move(text);
  return nullptr;
}

/// What `work` returns; what it throws becomes `failed`.
template <class Result, class Work>
Result guarded(Result failed, const Work& work) noexcept {
  try {
    return work();
  } catch (const std::exception& error) {
    try {
      last_error = error.what();
    } catch (...) {
    }
  } catch (...) {
  }
  return failed;
}

/// Copies as much of `value` as the caller's structure, of `size` bytes, has room for.
template <class T>
void copy_out(T value, T* to, std::size_t size) {
  value.size = size;
  std::memcpy(to, &value, std::min(size, sizeof(T)));
}

/// The caller's structure; what a shorter one, of an older header, leaves out is 0.
template <class T>
T copy_in(const T& from) {
  T copy{};
  std::memcpy(&copy, &from, std::min(from.size, sizeof(T)));
  return copy;
}

std::string text_or(const char* text, const char* otherwise) {
  return text == nullptr ? otherwise : text;
}

reident_event c_event(const SimulatorEvent& event) {
  reident_event result{};
  result.kind = static_cast<std::int32_t>(event.kind);
  result.from_cache = event.from_cache ? 1 : 0;
  result.spacecraft = event.equipment.spacecraft.c_str();
  result.equipment = event.equipment.equipment.c_str();
  result.text = event.text.c_str();
  result.version = event.version;
  result.time_ns = event.time;
  result.decided_ns = event.decided;
  result.published_ns = event.published;
  result.remaining_step = event.remaining_step;
  result.transition_steps = event.transition_steps;
  result.matched_rows = static_cast<std::int32_t>(event.matched_rows);
  return result;
}

bool has_null(const reident_signal* signals, std::size_t count) {
  if (signals == nullptr) return count > 0;
  return std::any_of(signals, signals + count,
                     [](const reident_signal& signal) { return signal.name == nullptr; });
}

std::vector<reident::DeclaredSignal> declared(const reident_signal* signals, std::size_t count) {
  std::vector<reident::DeclaredSignal> result;
  for (std::size_t i = 0; i < count; ++i)
    result.push_back({signals[i].name, text_or(signals[i].unit, "")});
  return result;
}

reident::HistoryQuery history_query(const reident_history_query& given, const char* cursor) {
  const reident_history_query c = copy_in(given);
  reident::HistoryQuery query;
  query.subject = text_or(c.subject, "versions");
  query.spacecraft = text_or(c.spacecraft, "");
  query.equipment = text_or(c.equipment, "");
  query.range = {c.begin_ns, c.end_ns};
  query.version = c.version;
  if (c.page_size > 0) query.page_size = c.page_size;
  query.cursor = cursor;
  query.newest_first = c.newest_first != 0;
  query.origin =
      c.simulated != 0 ? reident::storage::Origin::simulated : reident::storage::Origin::real;
  query.parameter = c.parameter;
  return query;
}

reident::SimulatorClientOptions client_options(const reident_options& given) {
  const reident_options c = copy_in(given);
  reident::SimulatorClientOptions options;
  options.endpoint.simulator = true;
  options.endpoint.domain = c.domain;
  options.endpoint.partition = text_or(c.partition, "operations");
  options.subscription.simulator =
      c.simulator == nullptr ? reident::default_simulator_name() : c.simulator;
  options.subscription.spacecraft = text_or(c.spacecraft, "*");
  for (std::size_t i = 0; i < c.equipment_count; ++i)
    options.subscription.equipment.push_back(text_or(c.equipment[i], ""));
  if (c.cache_folder == nullptr) {
    options.cache = reident::ModelCache::default_folder();
  } else if (*c.cache_folder != '\0') {
    options.cache = c.cache_folder;
  }
  options.endpoint.security = c.security_folder == nullptr
                                  ? reident::security::folder_of_environment()
                                  : std::filesystem::path(c.security_folder);
  return options;
}

}  // namespace

const char* reident_last_error(void) {
  return last_error.c_str();
}

const char* reident_library_version(void) {
  static const std::string version(reident::program_version());
  return version.c_str();
}

reident_client* reident_client_open(const reident_options* options) {
  if (options == nullptr || options->size == 0)
    return fail("no options, or their size is 0: call reident_options_init first");
  if (options->equipment == nullptr && options->equipment_count > 0)
    return fail("equipment is NULL and equipment_count is not 0");
  if (options->domain > 230)
    return fail("there is no DDS domain " + std::to_string(options->domain) +
                "; the last one is 230");
  return guarded<reident_client*>(nullptr, [&] {
    return std::make_unique<reident_client>(client_options(*options)).release();
  });
}

void reident_client_close(reident_client* client) {
  delete client;
}

int reident_next_event(reident_client* client, reident_event* event, int timeout_ms) {
  if (client == nullptr || event == nullptr || event->size == 0)
    return fail(REIDENT_BAD_ARGUMENT, "client or event is NULL, or the event's size is 0");
  return guarded<int>(REIDENT_FAILED, [&] {
    auto next = client->client.next_event(std::chrono::milliseconds(timeout_ms));
    if (!next) return 0;
    client->event = *std::move(next);
    copy_out(c_event(client->event), event, event->size);
    return 1;
  });
}

void reident_on_event(reident_client* client, reident_event_callback call, void* user) {
  if (client == nullptr) return;
  if (call == nullptr) {
    client->client.on_event({});
    return;
  }
  client->client.on_event([call, user](const SimulatorEvent& event) {
    reident_event c = c_event(event);
    c.size = sizeof(c);
    call(&c, user);
  });
}

const char* reident_version_json(reident_client* client, const char* spacecraft,
                                 const char* equipment) {
  if (client == nullptr || spacecraft == nullptr || equipment == nullptr)
    return fail("client, spacecraft or equipment is NULL");
  return guarded<const char*>(nullptr, [&]() -> const char* {
    const auto newest = client->client.newest({spacecraft, equipment});
    if (!newest)
      return fail("no version of " + std::string(spacecraft) + "/" + equipment + " has come");
    nlohmann::ordered_json json{
        {"version", newest->number},     {"digest", newest->digest},
        {"decided_ns", newest->decided}, {"decided_by", newest->decided_by},
        {"rollback", newest->rollback},  {"model", reident::to_json(newest->model)}};
    client->json = json.dump();
    return client->json.c_str();
  });
}

int reident_history_page(reident_client* client, const reident_history_query* query,
                         const char* cursor, int timeout_ms, reident_history_row row, void* user,
                         char* next, size_t next_size) {
  if (client == nullptr || query == nullptr || query->size == 0 || cursor == nullptr ||
      row == nullptr || next == nullptr || next_size == 0)
    return fail(REIDENT_BAD_ARGUMENT,
                "client, query, cursor, row or next is NULL, or the size of query or next is 0");
  return guarded<int>(REIDENT_FAILED, [&] {
    if (!client->history) client->history.emplace(client->client.participant());
    const auto answer =
        client->history->page(history_query(*query, cursor), std::chrono::milliseconds(timeout_ms));
    if (const auto* failure = std::get_if<reident::history::RemoteHistory::Failure>(&answer))
      return fail(failure->kind == reident::history::Error::Kind::refused ? REIDENT_BAD_ARGUMENT
                                                                          : REIDENT_UNAVAILABLE,
                  failure->message);
    const auto& page = std::get<reident::HistoryPage>(answer);
    if (page.next_cursor.size() >= next_size)
      return fail(REIDENT_BAD_ARGUMENT, "next has no room for a cursor of " +
                                            std::to_string(page.next_cursor.size() + 1) + " bytes");
    for (const std::string& json : page.rows) row(json.c_str(), user);
    std::memcpy(next, page.next_cursor.c_str(), page.next_cursor.size() + 1);
    return static_cast<int>(page.rows.size());
  });
}

reident_runner* reident_runner_open(reident_client* client, const char* spacecraft,
                                    const char* equipment, const reident_signal* inputs,
                                    size_t input_count, const reident_signal* outputs,
                                    size_t output_count) {
  if (client == nullptr || spacecraft == nullptr || equipment == nullptr ||
      has_null(inputs, input_count) || has_null(outputs, output_count))
    return fail("client, spacecraft, equipment, or the name of an input or output is NULL");
  return guarded<reident_runner*>(nullptr, [&]() -> reident_runner* {
    auto opened = client->client.open(
        {spacecraft, equipment}, {declared(inputs, input_count), declared(outputs, output_count)});
    if (auto* reason = std::get_if<std::string>(&opened)) return fail(std::move(*reason));
    return client->runners
        .emplace_back(std::make_unique<reident_runner>(
            reident_runner{std::get<reident::EquipmentRunner*>(opened), client}))
        .get();
  });
}

void reident_runner_close(reident_runner* runner) {
  if (runner == nullptr) return;
  reident_client* const client = runner->client;
  guarded(0, [&] {
    client->client.close(*runner->run);
    return 0;
  });
  std::erase_if(client->runners, [runner](const auto& owned) { return owned.get() == runner; });
}

int reident_step(reident_runner* runner, const double* u, double* y) {
  return runner->run->step(u, y);
}

int reident_follow(reident_runner* runner, const double* u, const double* measured, double* y) {
  return runner->run->follow(u, measured, y);
}

void reident_observe(reident_runner* runner, const double* measured) {
  runner->run->observe(measured);
}

int reident_accept(reident_runner* runner) {
  if (runner == nullptr) return fail(REIDENT_BAD_ARGUMENT, "runner is NULL");
  return guarded<int>(REIDENT_FAILED, [&] {
    auto reason = runner->client->client.accept(*runner->run);
    return reason ? fail(REIDENT_UNAVAILABLE, *std::move(reason)) : 0;
  });
}

int reident_input_flags(const reident_runner* runner, size_t input) {
  if (runner == nullptr) return fail(REIDENT_BAD_ARGUMENT, "runner is NULL");
  if (input >= runner->run->declaration().inputs.size())
    return fail(REIDENT_BAD_ARGUMENT, "there is no input " + std::to_string(input));
  return runner->run->input_flags(input);
}

int reident_runner_get_state(const reident_runner* runner, reident_runner_state* state) {
  if (runner == nullptr || state == nullptr || state->size == 0)
    return fail(REIDENT_BAD_ARGUMENT, "runner or state is NULL, or the state's size is 0");
  return guarded<int>(REIDENT_FAILED, [&] {
    const reident::RunState run = runner->run->state();
    const auto versions = runner->client->client.version_state(*runner->run);
    reident_runner_state c{};
    c.version = run.version;
    c.offered_version = versions.offered;
    c.decided_ns = run.decided;
    c.age_ns = run.version == 0 ? 0 : std::max<std::int64_t>(0, reident::utc_now() - run.decided);
    c.swapped_ns = run.swapped;
    c.following = run.is_following ? 1 : 0;
    c.from_cache = run.version != 0 && versions.from_cache ? 1 : 0;
    c.sample_period_s = run.period_s;
    c.running_mrse_percent = run.mrse_percent;
    c.steps = run.steps;
    c.steps_outside = run.steps_outside;
    c.steps_missing = run.steps_missing;
    c.remaining_step = run.remaining_step;
    c.transition_steps = run.transition_steps;
    c.transition_left = run.transition_left;
    copy_out(c, state, state->size);
    return 0;
  });
}
