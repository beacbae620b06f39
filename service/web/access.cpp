#include "service/web/access.hpp"

#include <algorithm>
#include <utility>

#include "service/support/sha256.hpp"

namespace reident::web {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t secret_bytes = 32;
constexpr std::size_t most_sessions = 1000, most_failures = 5, most_names = 1000;
constexpr auto session_length = 12h;
constexpr auto failures_count_for = 60s;
constexpr std::string_view cookie_name = "reident_session=";

}  // namespace

Access::Access(Accounts accounts)
    : accounts_(std::move(accounts)), secret_(random_text(secret_bytes)) {}

bool Access::has_passwords() const {
  return std::any_of(accounts_.begin(), accounts_.end(),
                     [](const auto& one) { return !one.second.password.empty(); });
}

std::string Access::session_of(const HttpRequest& request) const {
  const std::string cookies = "; " + request.cookie;
  const std::size_t at = cookies.find("; " + std::string(cookie_name));
  if (at == std::string::npos) return "";
  const std::size_t begin = at + 2 + cookie_name.size();
  return cookies.substr(begin, cookies.find(';', begin) - begin);
}

std::optional<Account> Access::who(const HttpRequest& request) const {
  std::string name = request.user;
  if (name.empty()) {
    const MutexLock lock(mutex_);
    const auto session = sessions_.find(session_of(request));
    if (session == sessions_.end() || Clock::now() >= session->second.until) return std::nullopt;
    name = session->second.name;
  }
  const auto account = accounts_.find(name);
  return account == accounts_.end() ? std::nullopt : std::optional(account->second);
}

std::string Access::token(const HttpRequest& request) const {
  const auto account = who(request);
  if (!account) return "";
  return sha256_hex(secret_ + "/" + account->name + "/" +
                    (request.user.empty() ? session_of(request) : ""));
}

std::optional<HttpResponse> Access::refusal(const HttpRequest& request) const {
  if (request.origin != (request.is_secure ? "https://" : "http://") + request.host &&
      !(request.peer == "unix" && request.origin == "https://" + request.host))
    return problem(403, "origin", "this came from another page than its own; open the page itself");
  if (request.content_type != "application/json")
    return problem(415, "content_type", "send application/json");
  return std::nullopt;
}

std::variant<std::string, Access::NoLogin> Access::log_in(const std::string& name,
                                                          const std::string& password,
                                                          Clock::time_point now) {
  {
    const MutexLock lock(mutex_);
    if (failures_.size() >= most_names) failures_.clear();
    auto& failures = failures_[name];
    while (!failures.empty() && now - failures.front() > failures_count_for) failures.pop_front();
    if (failures.size() >= most_failures) return NoLogin::too_often;
    failures.push_back(now);  // until it turns out to be right
  }
  const auto account = accounts_.find(name);
  // A name that nobody has takes as long as one that somebody has.
  static const std::string nobody = hash_password("");
  const bool is_right =
      matches(password, account == accounts_.end() ? nobody : account->second.password) &&
      account != accounts_.end();
  if (!is_right) return NoLogin::wrong;
  const std::string session = random_text(secret_bytes);
  const MutexLock lock(mutex_);
  failures_.erase(name);
  std::erase_if(sessions_, [now](const auto& one) { return now >= one.second.until; });
  if (sessions_.size() >= most_sessions) sessions_.erase(sessions_.begin());
  sessions_[session] = {name, now + session_length};
  return session;
}

void Access::log_out(const HttpRequest& request) {
  const MutexLock lock(mutex_);
  sessions_.erase(session_of(request));
}

}  // namespace reident::web
