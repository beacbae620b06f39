// Which number a parameter has that a file knows by its name. Frames carry numbers alone.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::transfer {

/// The parameters of one spacecraft.
class ParameterBook {
 public:
  /// Reads the descriptors that the archive has now. Throws storage::Error.
  ParameterBook(const storage::Archive& archive, std::string spacecraft);

  /// A parameter, to be described once where it is not yet.
  struct Entry {
    storage::ParameterDescriptor descriptor;
    bool is_described =
        false;  // the archive has a descriptor, a batch does, or there is to be none
  };

  /// The entry of a parameter by its name: the one that the archive has; else a new one, whose
  /// number follows from the name as satcs-replay makes it. A whole number that names no parameter
  /// is the number of one without a descriptor. The text of a refusal where `unit` is not empty and
  /// not the archive's, or where the number belongs to another name. Entries stay where they are.
  std::variant<Entry*, std::string> find(std::string_view name, std::string_view unit,
                                         std::string_view description);

 private:
  /// The entry of a name that is new here.
  std::variant<Entry*, std::string> add(std::string_view name, std::string_view unit,
                                        std::string_view description);

  std::string spacecraft_;
  std::map<std::string, Entry, std::less<>> by_name_;
  std::unordered_map<std::uint32_t, std::string> name_of_;  // of described parameters
};

}  // namespace reident::transfer
