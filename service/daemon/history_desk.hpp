// The thread between consoles on DDS and the database: it hears their questions and answers each
// with a page.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <variant>

#include "service/dds/dds.hpp"
#include "service/history/answer.hpp"

namespace reident {

class HistoryDesk {
 public:
  /// May throw storage::Error, whose text is then the answer.
  using Answer =
      std::function<std::variant<HistoryPage, history::BadQuestion>(const HistoryQuery& query)>;

  /// Hears questions to `service` and those to every service, these while `is_one_of_all`
  /// answers true (without it always). The participant must outlive it. Throws dds::Error.
  HistoryDesk(dds::Participant& participant, std::string service,
              std::function<bool()> is_one_of_all = {});

  /// The thread's body: until stop().
  void run(const Answer& answer);
  void stop();

 private:
  void reply(const HistoryRequest& request, std::variant<HistoryPage, history::BadQuestion> answer);

  bool is_meant(const std::string& service) const {
    return service.empty() ? !is_one_of_all_ || is_one_of_all_() : service == service_;
  }

  const std::string service_;
  const std::function<bool()> is_one_of_all_;
  dds::Reader<HistoryRequest> requests_;
  dds::Writer<HistoryReply> replies_;
  dds::WaitSet ready_;
  std::atomic<bool> stopping_ = false;
};

}  // namespace reident
