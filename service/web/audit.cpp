#include "service/web/audit.hpp"

#include <stdexcept>

#include "service/support/log.hpp"

namespace reident::web {
namespace {

constexpr std::size_t most_kept = 500;

}  // namespace

Audit::Audit(const std::filesystem::path& file) {
  if (file.empty()) return;
  file_.open(file, std::ios::app);
  if (!file_)
    throw std::runtime_error(
        file.string() + " cannot be written: name a file in a folder that this user can write");
}

void Audit::add(const Refused& refused, storage::Time time) {
  log::warning("web", "refused",
               {{"code", refused.code},
                {"user", refused.user},
                {"peer", refused.peer},
                {"action", refused.action},
                {"equipment", refused.spacecraft + "/" + refused.equipment}});
  const Json row = {{"time", time_value(time)},       {"code", refused.code},
                    {"user", refused.user},           {"peer", refused.peer},
                    {"action", refused.action},       {"spacecraft", refused.spacecraft},
                    {"equipment", refused.equipment}, {"version", refused.version}};
  const MutexLock lock(mutex_);
  if (file_.is_open())
    file_ << row.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  last_.push_front(row);
  if (last_.size() > most_kept) last_.pop_back();
}

Json Audit::last() const {
  const MutexLock lock(mutex_);
  Json rows = Json::array();
  for (const Json& row : last_) rows.push_back(row);
  return {{"refusals", std::move(rows)}};
}

}  // namespace reident::web
