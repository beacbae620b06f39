#include "service/web/metrics.hpp"

#include <cmath>
#include <fstream>
#include <set>
#include <unistd.h>

#include <fmt/format.h>

#include "service/support/version.hpp"

namespace reident::web {
namespace {

constexpr double percent = 0.01;

std::string escaped(const std::string& value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    if (c == '\n')
      text += "\\n";
    else
      text += c;
  }
  return text;
}

double seconds_of(storage::Time time) {
  return static_cast<double>(time) * 1e-9;
}

MetricsText::Labels labels_of(const Json& line) {
  return {{"spacecraft", line["spacecraft"].get<std::string>()},
          {"equipment", line["equipment"].get<std::string>()}};
}

double number_or_nan(const Json& value) {
  return value.is_number() ? value.get<double>() : NAN;
}

/// Clock ticks of this process on the processors [s], and its pages.
void put_process(MetricsText& text) {
  std::ifstream stat("/proc/self/stat"), memory("/proc/self/statm");
  std::string word;
  std::vector<std::string> fields;
  while (stat >> word) fields.push_back(word);
  constexpr std::size_t user = 13, system = 14;
  if (fields.size() > system) {
    text.begin("process_cpu_seconds_total", "counter", "Time on the processors.");
    text.add((std::stod(fields[user]) + std::stod(fields[system])) /
             static_cast<double>(::sysconf(_SC_CLK_TCK)));
  }
  double pages = 0, resident = 0;
  if (memory >> pages >> resident) {
    text.begin("process_resident_memory_bytes", "gauge", "Memory in use.");
    text.add(resident * static_cast<double>(::sysconf(_SC_PAGESIZE)));
  }
}

}  // namespace

void MetricsText::begin(std::string_view name, std::string_view type, std::string_view help) {
  name_ = name;
  text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

void MetricsText::add(double value, const Labels& labels, std::string_view suffix) {
  text_ += name_;
  text_ += suffix;
  for (std::size_t i = 0; i < labels.size(); ++i)
    text_ +=
        fmt::format("{}{}=\"{}\"", i == 0 ? "{" : ",", labels[i].first, escaped(labels[i].second));
  if (!labels.empty()) text_ += '}';
  if (std::isnan(value))
    text_ += " NaN\n";
  else if (std::isinf(value))
    text_ += value > 0 ? " +Inf\n" : " -Inf\n";
  else
    text_ += fmt::format(" {}\n", value);
}

void RequestCounts::add(std::string_view route, int status, double seconds) {
  const MutexLock lock(mutex_);
  ++answers_[{std::string(route), status}];
  Durations& durations = durations_[std::string(route)];
  std::size_t place = 0;
  while (place < bounds_s.size() && seconds > bounds_s[place]) ++place;
  ++durations.counts[place];
  durations.sum += seconds;
}

void RequestCounts::put(MetricsText& text) const {
  const MutexLock lock(mutex_);
  text.begin("reident_web_requests_total", "counter", "Answers, by route and status.");
  for (const auto& [key, count] : answers_)
    text.add(static_cast<double>(count),
             {{"route", key.first}, {"code", std::to_string(key.second)}});
  text.begin("reident_web_request_duration_seconds", "histogram",
             "From a request to its answer, without its way to the client.");
  for (const auto& [route, durations] : durations_) {
    std::uint64_t so_far = 0;
    for (std::size_t i = 0; i < bounds_s.size(); ++i) {
      so_far += durations.counts[i];
      text.add(static_cast<double>(so_far),
               {{"route", route}, {"le", fmt::format("{}", bounds_s[i])}}, "_bucket");
    }
    so_far += durations.counts[bounds_s.size()];
    text.add(static_cast<double>(so_far), {{"route", route}, {"le", "+Inf"}}, "_bucket");
    text.add(durations.sum, {{"route", route}}, "_sum");
    text.add(static_cast<double>(so_far), {{"route", route}}, "_count");
  }
}

void put_service(MetricsText& text, const std::optional<HeardStatus>& heard) {
  text.begin("reident_build_info", "gauge", "Version of this program.");
  text.add(1, {{"version", std::string(program_version())}});
  text.begin("reident_service_up", "gauge", "Whether the service's heartbeat is fresh.");
  const bool is_up = heard && heard->is_fresh();
  text.add(is_up ? 1 : 0);
  if (!heard) return;
  const ServiceStatus& status = heard->status;
  text.begin("reident_service_failing", "gauge", "Whether the service reports an error.");
  text.add(status.last_error.empty() ? 0 : 1);
  text.begin("reident_service_start_timestamp_seconds", "gauge", "When the service began.");
  text.add(seconds_of(status.started));
  if (status.certificate_end != 0) {
    text.begin("reident_certificate_end_timestamp_seconds", "gauge",
               "When the service's certificate ends, on a secured domain.");
    text.add(seconds_of(status.certificate_end));
  }
  const auto count = [&](std::string_view name, std::string_view help, std::uint64_t value,
                         std::string_view type = "counter") {
    text.begin(name, type, help);
    text.add(static_cast<double>(value));
  };
  count("reident_frames_received_total", "Frames of telemetry.", status.frames_received);
  count("reident_frames_rejected_total", "Frames that were malformed or too large.",
        status.frames_rejected);
  count("reident_descriptors_rejected_total", "Parameter descriptors that were malformed.",
        status.descriptors_rejected);
  count("reident_samples_stored_total", "Samples that were new.", status.samples_stored);
  count("reident_samples_duplicate_total", "Samples that came again.", status.duplicates);
  count("reident_samples_conflicting_total", "Samples of another value than one of their time.",
        status.conflicts);
  count("reident_samples_late_total", "Samples behind a newer one.", status.late);
  count("reident_sequence_missing", "Sequence numbers that have not come.", status.sequence_missing,
        "gauge");
  count("reident_clock_jumps_total", "Generation times far ahead of the clock.",
        status.clock_jumps);
  count("reident_queue_frames", "Frames taken and not yet committed.", status.queue_length,
        "gauge");
  count("reident_queue_waits_total", "Times that the reader waited for room.", status.queue_waits);
  count("reident_windows_pending", "Windows that are due or tried.", status.windows_pending,
        "gauge");
  count("reident_attempts_total", "Windows that were tried.", status.attempts);
  if (status.pair.empty()) return;
  const auto of_pair = [&](std::string_view name, std::string_view help, double value) {
    text.begin(name, "gauge", help);
    text.add(value, {{"pair", status.pair}});
  };
  of_pair("reident_pair_leads", "Whether the service leads its pair, while it is heard.",
          is_up && status.role == "leads");
  of_pair("reident_pair_term", "The last term of the pair that the service knows.",
          static_cast<double>(status.term));
  of_pair("reident_pair_partner_heard", "Whether it hears the other service.",
          !status.partner.empty());
  if (status.lag >= 0)
    of_pair("reident_pair_lag_rows", "Rows of the registry that one of the two lacks.",
            static_cast<double>(status.lag));
}

void put_server(MetricsText& text, const ServerCounts& counts) {
  text.begin("reident_web_connections", "gauge", "Connections of clients.");
  text.add(static_cast<double>(counts.connections));
  text.begin("reident_web_streams", "gauge", "Connections that get events.");
  text.add(static_cast<double>(counts.streams));
  text.begin("reident_web_refused_connections_total", "counter", "Connections beyond a limit.");
  text.add(static_cast<double>(counts.refused));
  text.begin("reident_web_coalesced_total", "counter",
             "Changes that a stream did not get, since a newer one came.");
  text.add(static_cast<double>(counts.coalesced));
  put_process(text);
}

void put_files(MetricsText& text, const std::filesystem::path& database) {
  const auto size = [](const std::filesystem::path& path) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    return error ? 0.0 : static_cast<double>(bytes);
  };
  text.begin("reident_archive_bytes", "gauge", "Size of the database.");
  text.add(size(database));
  text.begin("reident_wal_bytes", "gauge", "Size of its log.");
  text.add(size(database.string() + "-wal"));
}

void put_registry(MetricsText& text, const Stored& stored, const Json& overview,
                  const DecisionCounts& decisions) {
  text.begin("reident_decisions_total", "counter", "Decisions, by kind and by whom.");
  for (const auto& [key, count] : decisions)
    text.add(static_cast<double>(count),
             {{"kind", key.first}, {"by", key.second ? "gate" : "operator"}});
  std::map<std::string, storage::Time> newest;
  for (const storage::SeriesInfo& series : stored.telemetry.series())
    if (series.origin == storage::Origin::real)
      newest[series.spacecraft] = std::max(newest[series.spacecraft], series.last);
  text.begin("reident_newest_telemetry_timestamp_seconds", "gauge",
             "Generation time of the newest sample.");
  for (const auto& [spacecraft, time] : newest)
    text.add(seconds_of(time), {{"spacecraft", spacecraft}});
  const auto each = [&](std::string_view name, std::string_view help, const auto& value) {
    text.begin(name, "gauge", help);
    for (const Json& line : overview["equipment"])
      if (const double number = value(line); !std::isnan(number)) text.add(number, labels_of(line));
  };
  each("reident_champion_version", "Number of the champion; 0: none.", [](const Json& line) {
    return line["champion"].is_null() ? 0 : std::stod(line["champion"].get<std::string>());
  });
  each("reident_champion_since_timestamp_seconds", "When it became champion.",
       [](const Json& line) {
         const auto since =
             line["since"].is_null() ? std::nullopt : parse_time(line["since"].get<std::string>());
         return since ? seconds_of(*since) : NAN;
       });
  each("reident_champion_error_ratio", "MRSE of the champion on its record.",
       [](const Json& line) { return number_or_nan(line["error_percent"]) * percent; });
  each("reident_champion_approved_error_ratio", "MRSE of the champion when it was approved.",
       [](const Json& line) { return number_or_nan(line["approved_error_percent"]) * percent; });
  each("reident_champion_failing", "Whether it errs more than a constant or the simulator's model.",
       [](const Json& line) { return line["failure"].is_null() ? 0.0 : 1.0; });
  each("reident_versions_waiting", "Versions that wait for an operator.",
       [](const Json& line) { return static_cast<double>(line["waiting"].size()); });
  text.begin("reident_simulators", "gauge", "Simulators that run a model, by state.");
  for (const Json& line : overview["equipment"]) {
    const double all = line["simulators"].get<double>(), current = line["current"].get<double>();
    for (const auto& [state, number] :
         {std::pair("current", current), std::pair("other", all - current)}) {
      auto labels = labels_of(line);
      labels.emplace_back("state", state);
      text.add(number, labels);
    }
  }
  text.begin("reident_alarms", "gauge", "Alarms that are raised, by code.");
  std::map<std::string, double> raised;
  for (const Json& alarm : overview["alarms"]) ++raised[alarm["code"].get<std::string>()];
  for (const auto& [code, number] : raised) text.add(number, {{"code", code}});
  each("reident_held", "Whether an operator holds the champion.",
       [](const Json& line) { return line["hold"].is_null() ? 0.0 : 1.0; });
}

}  // namespace reident::web
