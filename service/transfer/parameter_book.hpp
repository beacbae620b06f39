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

  /// The entry of the parameter with the name of `wanted`: the one that the archive has; else a new
  /// one with what `wanted` says, whose number follows from the name as satcs-replay makes it. A
  /// whole number that names no parameter is the number of one without a descriptor. The text of a
  /// refusal where the unit is not empty and not the archive's, where states have other numbers
  /// there, or where the number belongs to another name. Entries stay where they are.
  std::variant<Entry*, std::string> find(const storage::ParameterDescriptor& wanted);

 private:
  /// The entry of a name that is new here.
  std::variant<Entry*, std::string> add(const storage::ParameterDescriptor& wanted);

  std::string spacecraft_;
  std::map<std::string, Entry, std::less<>> by_name_;
  std::unordered_map<std::uint32_t, std::string> name_of_;  // of described parameters
};

}  // namespace reident::transfer
