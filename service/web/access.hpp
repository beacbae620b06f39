// Who asks, and what that one may order. Without accounts nobody may order anything.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "service/support/mutex.hpp"
#include "service/web/accounts.hpp"
#include "service/web/http.hpp"

namespace reident::web {

/// Any thread may call it.
class Access {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Access(Accounts accounts);

  /// Who asks: by a certificate, a trusted proxy or a cookie; absent where nobody known does.
  std::optional<Account> who(const HttpRequest& request) const;
  /// What an order of this request has to carry, so that no other page can send one for its viewer.
  /// Empty where nobody known asks.
  std::string token(const HttpRequest& request) const;

  /// Why the request may not change anything, whoever asks: it came from another page. Absent where
  /// it may. Requires a POST.
  std::optional<HttpResponse> refusal(const HttpRequest& request) const;

  enum class NoLogin { wrong, too_often };
  /// A new session's id, for the cookie. Takes as long as a password does. After five failures
  /// within a minute a name is not looked at (too_often).
  std::variant<std::string, NoLogin> log_in(const std::string& name, const std::string& password,
                                            Clock::time_point now);
  /// Ends the request's session.
  void log_out(const HttpRequest& request);

  bool has_passwords() const;

 private:
  struct Session {
    std::string name;
    Clock::time_point until;
  };
  std::string session_of(const HttpRequest& request) const;

  const Accounts accounts_;
  const std::string secret_;
  mutable Mutex mutex_;
  std::map<std::string, Session, std::less<>> sessions_ REIDENT_GUARDED_BY(mutex_);
  std::map<std::string, std::deque<Clock::time_point>, std::less<>> failures_
      REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident::web
