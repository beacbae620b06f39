#include "service/daemon/posted_task.hpp"

#include <utility>

namespace reident {

void PostedTask::post(Task task, std::function<void()> then) {
  then_ = std::move(then);
  done_ = writer_.post(
      [this, task = std::move(task)](storage::Registry& registry, storage::Archive& archive) {
        struct Wake {
          dds::WaitSet& ready;
          ~Wake() { ready.wake(); }
        } const wake{ready_};
        task(registry, archive);
      });
}

std::string PostedTask::finish() {
  using namespace std::chrono_literals;
  if (!done_.valid() || done_.wait_for(0s) != std::future_status::ready) return {};
  const auto then = std::exchange(then_, {});
  try {
    std::exchange(done_, {}).get();
  } catch (const storage::Error& error) {
    return error.what();
  }
  if (then) then();
  return {};
}

}  // namespace reident
