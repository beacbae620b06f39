// Orders of operators on their way from the page to the service, and what became of them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "service/dds/dds.hpp"
#include "service/web/access.hpp"
#include "service/web/json.hpp"
#include "service/web/query_pool.hpp"
#include "service/web/work_queue.hpp"

namespace reident::web {

/// An order as the page sends it.
struct PageOrder {
  storage::Command command;  // requester and request come from the page, once for each form
  /// The champion that the form showed; absent where the page did not say. 0: none.
  std::optional<std::int64_t> champion;
};

/// Reads the body of a request. Throws BadRequest.
PageOrder read_order(const std::string& body, const std::string& actor);

/// What an action asks for; absent for one that there is not.
std::optional<Role> role_for(std::string_view action);

/// A thread of its own for what may wait: orders over DDS, and passwords, which take a while.
class OrderDesk {
 public:
  /// `service`: instance name of the one that is asked, or the name of a pair: its leader. Throws
  /// dds::Error.
  OrderDesk(const dds::Endpoint& endpoint, std::string service);
  /// What still waits gets no answer: the page sends it again.
  ~OrderDesk();
  OrderDesk(const OrderDesk&) = delete;
  OrderDesk& operator=(const OrderDesk&) = delete;

  /// Gives the service's reply, or 503 where none came within ten seconds: the same order may be
  /// sent again, and is carried out once. From any thread.
  void send(const storage::Command& command, const Respond& respond);
  /// Gives what `work` returns.
  void later(std::function<HttpResponse()> work, const Respond& respond);

 private:
  struct Waiting {
    std::function<HttpResponse()> work;
    Respond respond;
  };
  void run();
  HttpResponse reply_to(const storage::Command& command);
  std::optional<storage::CommandOutcome> ask(const storage::Command& command);

  const std::string service_;
  dds::Participant participant_;
  dds::Writer<CommandRequest> commands_;
  dds::Reader<CommandReply> replies_;
  dds::WaitSet ready_;
  WorkQueue<Waiting> waiting_;
  std::thread thread_;
};

}  // namespace reident::web
