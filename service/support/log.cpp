#include "service/support/log.hpp"

#include <syslog.h>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "service/support/journal.hpp"

namespace reident::log {
namespace {

spdlog::logger& logger() {
  static const auto instance = [] {
    auto made = std::make_shared<spdlog::logger>("reident",
                                                 std::make_shared<spdlog::sinks::stderr_sink_mt>());
    made->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
    made->flush_on(spdlog::level::trace);
    return made;
  }();
  return *instance;
}

spdlog::level::level_enum to_spdlog(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warning:
      return spdlog::level::warn;
    case Level::error:
      break;
  }
  return spdlog::level::err;
}

int to_priority(Level level) {
  switch (level) {
    case Level::debug:
      return LOG_DEBUG;
    case Level::info:
      return LOG_INFO;
    case Level::warning:
      return LOG_WARNING;
    case Level::error:
      break;
  }
  return LOG_ERR;
}

/// False where standard error is not the journal, or the journal did not take the line.
bool to_journal(Level level, std::string_view component, std::string_view line,
                std::initializer_list<Field> fields) {
  static const bool is_journal = is_stderr_journal();
  if (!is_journal) return false;
  JournalFields named;
  for (const Field& field : fields) named.emplace_back(field.key, field.value);
  return send_to_journal(journal_entry(to_priority(level), component, line, named));
}

/// Plain where it reads back as one word, otherwise in double quotes with escapes.
void append_value(std::string& line, std::string_view value) {
  if (!value.empty() && value.find_first_of(" \"=\\\n\r\t") == std::string_view::npos) {
    line += value;
    return;
  }
  line += '"';
  for (const char c : value) {
    if (c == '"' || c == '\\') line += '\\';
    line += (c == '\n' || c == '\r' || c == '\t') ? ' ' : c;
  }
  line += '"';
}

}  // namespace

bool set_level(std::string_view name) {
  for (const Level level : {Level::debug, Level::info, Level::warning, Level::error}) {
    const auto known = spdlog::level::to_string_view(to_spdlog(level));
    if (name == std::string_view(known.data(), known.size())) {
      logger().set_level(to_spdlog(level));
      return true;
    }
  }
  return false;
}

void write(Level level, std::string_view component, std::string_view message,
           std::initializer_list<Field> fields) {
  if (!logger().should_log(to_spdlog(level))) return;
  std::string line = fmt::format("{}: {}", component, message);
  for (const Field& field : fields) {
    line += ' ';
    line += field.key;
    line += '=';
    append_value(line, field.value);
  }
  if (!to_journal(level, component, line, fields))
    logger().log(to_spdlog(level), spdlog::string_view_t(line));
}

}  // namespace reident::log
