// Questions to a running service over DDS, a page at a time.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "service/dds/dds.hpp"
#include "service/history/readers.hpp"

namespace reident::history {

/// Asks again and again until the answer comes: a reply can be lost to a reader that its writer has
/// not discovered yet, and a service that is asked twice answers twice the same. Of several
/// services the one that answered first is asked on. One thread at a time.
class RemoteHistory {
 public:
  /// Called some times a second with true while an answer is waited for, and with false when it is
  /// there, or will not come.
  using Waits = std::function<void(bool)>;

  /// Asks the service of this instance name, or any. The participant must outlive it. Throws
  /// dds::Error.
  explicit RemoteHistory(dds::Participant& participant, std::string service = "", Waits waits = {});

  /// Why there is no page; the message says what would mend it.
  struct Failure {
    Error::Kind kind = Error::Kind::no_answer;
    std::string message;
  };
  /// Asks one question and waits for its page, at most `timeout`; discovery of the service counts
  /// too. idl/README.md, "History", has the questions and their rows. The page's next_cursor goes
  /// into the next question. Throws dds::Error.
  std::variant<HistoryPage, Failure> page(const HistoryQuery& query,
                                          std::chrono::milliseconds timeout);

 private:
  /// The reply to the last question, if it has come; a malformed one as a refusal.
  std::optional<HistoryReply> take();

  const std::string wanted_service_;
  const Waits waits_;
  dds::Writer<HistoryRequest> requests_;
  dds::Reader<HistoryReply> replies_;
  dds::WaitSet ready_;
  HistoryRequest request_;  // the last one; its service is the one that answered, once one did
};

}  // namespace reident::history
