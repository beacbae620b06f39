// TOML text read so that every mistake in it is found, each with its line.
#pragma once

#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
#define TOML_FLOAT_CHARCONV 1
// toml++ 3.3 asserts that a table's name begins with a letter that it may, and then refuses it.
#define TOML_ASSERT(expression) static_assert(true)
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <toml++/toml.h>

#include "service/config/config.hpp"

namespace reident {

/// Returns the text of a file, or why it is none of a configuration.
std::variant<std::string, ConfigMistake> read_file(const std::filesystem::path& path);

/// What could be read of a text. Where `complete` is false, lines with syntax mistakes were left
/// out of the table, so that an absent key is no mistake of its own.
struct ConfigDocument {
  toml::table table;
  bool complete = true;
  bool readable = true;  // false: the table holds nothing that is worth a look
  std::vector<ConfigMistake> mistakes;
};

/// Reads a text; syntax mistakes are noted, and the lines that hold them left out, as few as
/// possible.
ConfigDocument parse_document(std::string_view text);

/// Reads one table key by key. A key that is absent gives nullopt; so does one of a wrong type or
/// out of range, and a mistake is noted. It remembers which keys were asked for
/// (refuse_unknown_keys()). Table and document have to outlive it.
class TableReader {
 public:
  /// `title` is how messages call the table, such as "[archive]".
  TableReader(const toml::table& table, std::string title, ConfigDocument& document);

  // Bounds are allowed values. A mistake says what is wanted.

  std::optional<std::string> text(std::string_view key);
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t low, std::int64_t high);
  std::optional<double> number(std::string_view key, double low, double high);
  /// A text with a number and a unit; a number alone is a mistake.
  std::optional<Duration> duration(std::string_view key, Duration low, Duration high);
  /// Bytes, from a text with a number and a unit.
  std::optional<std::uint64_t> size(std::string_view key, std::uint64_t low);
  /// A list of at least one text.
  std::optional<std::vector<std::string>> texts(std::string_view key);
  /// "auto" gives nullopt without a mistake.
  std::optional<std::int64_t> integer_or_auto(std::string_view key, std::int64_t low,
                                              std::int64_t high);
  /// Null where the key is absent or holds something else, which is no mistake yet.
  const toml::array* array(std::string_view key);
  /// The table under [key]; null where it is absent, or is something else, which is a mistake.
  const toml::table* section(std::string_view key);
  /// The tables under a [[key]].
  std::vector<const toml::table*> sections(std::string_view key);

  bool has(std::string_view key) const { return table_.contains(key); }
  /// Notes a mistake where the key is absent.
  void require(std::string_view key, std::string_view example);
  /// A key of an earlier version, and what to do instead.
  struct FormerKey {
    std::string_view key, remedy;
  };
  /// Notes every key that nobody asked for, with its remedy or the nearest one that exists.
  void refuse_unknown_keys(std::initializer_list<FormerKey> former = {});
  /// The line of a key, or of the table where it is absent.
  std::uint32_t line_of(std::string_view key) const;
  /// Notes a mistake at the key's line; the title goes before the message.
  void mistake(std::string_view key, std::string message);

  const std::string& title() const { return title_; }
  void set_title(std::string title) { title_ = std::move(title); }

 private:
  /// The key's value, or null; the key is known from now on.
  const toml::node* find(std::string_view key);
  void wrong_type(std::string_view key, const toml::node& node, std::string_view wanted);
  std::optional<std::int64_t> integer_in(std::string_view key, const toml::node& node,
                                         std::int64_t low, std::int64_t high,
                                         std::string_view wanted);

  const toml::table& table_;
  std::string title_;
  ConfigDocument& document_;
  std::set<std::string, std::less<>> known_;
};

}  // namespace reident
