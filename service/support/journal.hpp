// The journal of systemd, which keeps the fields of a log line so that it can be searched by them:
//   journalctl EQUIPMENT=CBERS-4/BDR
//   journalctl SPACECRAFT=CBERS-4 COMPONENT=alarm
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace reident::log {

/// Names and values of a line's fields.
using JournalFields = std::vector<std::pair<std::string_view, std::string_view>>;

/// Whether standard error is the journal: then JOURNAL_STREAM has its device and inode.
bool is_stderr_journal();

/// The datagram of a line in the journal's native protocol. Names of fields become upper case.
/// `equipment` (SPACECRAFT/EQUIPMENT) also gives SPACECRAFT; `about`, which names a spacecraft or
/// an equipment, gives these. `priority` is that of syslog(3).
std::string journal_entry(int priority, std::string_view component, std::string_view message,
                          const JournalFields& fields);

/// Sends a datagram to the journal. False where the journal did not take it.
bool send_to_journal(const std::string& entry);

}  // namespace reident::log
