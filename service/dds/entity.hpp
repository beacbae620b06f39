// Ownership of the middleware's handles and the one place where its return codes become Error.
#pragma once

#include <string>
#include <utility>

#include <dds/dds.h>

#include "service/dds/dds.hpp"

namespace reident::dds {

/// Throws Error with the call, what it was about (a topic, a domain), the middleware's own words
/// and what would mend it.
[[noreturn]] void fail(dds_return_t code, const std::string& call, const std::string& about);

/// Returns a result that is not an error; throws Error as fail() does for one that is.
inline dds_return_t check(dds_return_t result, const char* call, const std::string& about) {
  if (result < 0) fail(result, call, about);
  return result;
}

/// An entity that is deleted with its owner, and what the middleware made within it with it. Empty
/// where it was made so or moved from.
class Entity {
 public:
  Entity() = default;
  /// Owns a handle that was checked already.
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  /// Owns what a call returned; throws Error where that is an error, and owns nothing then.
  Entity(dds_entity_t result, const char* call, const std::string& about)
      : handle_(check(result, call, about)) {}
  ~Entity() { reset(); }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    if (this != &other) {
      reset();
      handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
  }

  /// The handle, still owned here; 0 where it is empty.
  dds_entity_t get() const { return handle_; }
  explicit operator bool() const { return handle_ > 0; }

 private:
  void reset() noexcept {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = 0;
  }
  dds_entity_t handle_ = 0;
};

}  // namespace reident::dds
