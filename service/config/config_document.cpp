#include "service/config/config_document.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <numeric>

#include <fmt/format.h>

#include "service/support/size_text.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

// A file with more syntax mistakes is something else than a configuration.
constexpr std::size_t max_syntax_mistakes = 20;
// How far back the beginning of an unfinished value is looked for.
constexpr std::size_t max_value_lines = 50;
// The text is parsed again after each mistake: of a longer one only the first is reported.
constexpr std::size_t max_recovered_bytes = std::size_t{128} << 10;
constexpr std::size_t max_file_bytes = 4u << 20;

/// The lines of a text that is parsed again and again with less and less in it.
class Lines {
 public:
  explicit Lines(std::string_view text) {
    while (!text.empty()) {
      const std::size_t length = std::min(text.find('\n'), text.size() - 1) + 1;
      lines_.emplace_back(text.substr(0, length));
      text.remove_prefix(length);
    }
  }

  std::size_t size() const { return lines_.size(); }
  const std::string& operator[](std::size_t index) const { return lines_[index]; }
  std::string first(std::size_t count) const {
    return std::accumulate(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(count),
                           std::string());
  }
  void leave_out(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) lines_[i].assign(1, '\n');
  }
  /// True where nothing follows the position but blanks.
  bool ends_after(std::size_t index, std::size_t column) const {
    const auto blank = [](std::string_view line) {
      return line.find_first_not_of(" \t\r\n") == std::string_view::npos;
    };
    if (index >= lines_.size()) return true;
    const std::string_view line = lines_[index];
    return blank(line.substr(std::min(column, line.size()))) &&
           std::all_of(lines_.begin() + static_cast<std::ptrdiff_t>(index) + 1, lines_.end(),
                       blank);
  }

 private:
  std::vector<std::string> lines_;
};

bool parses(std::string_view text) {
  return static_cast<bool>(toml::parse(text));
}

/// Whether the line gives a key letters without quotes, such as 10min.
bool lacks_quotes(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view value = line.substr(equals + 1);
  const std::size_t first = value.find_first_not_of(" \t\r\n");
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  return first != std::string_view::npos &&
         std::isalnum(static_cast<unsigned char>(value[first])) &&
         std::any_of(value.begin(), value.end(), is_letter);
}

std::string wording(const toml::parse_error& error, std::string_view line) {
  if (lacks_quotes(line)) return "mistake in value: a text or a duration needs double quotes";
  std::string text(error.description());
  if (constexpr std::string_view prefix = "Error while parsing "; text.starts_with(prefix))
    text = "mistake in " + text.substr(prefix.size());
  return text;
}

/// Where the value begins that is unfinished on line `index`; `index` itself where all before it is
/// whole.
std::size_t beginning_of_value(const Lines& lines, std::size_t index) {
  std::size_t begin = index;
  for (std::size_t back = 0; back < max_value_lines; ++back, --begin)
    if (begin == 0 || parses(lines.first(begin))) return begin;
  return index;
}

/// Notes the mistake and takes the least number of lines out that lets the rest be read.
void leave_out_mistake(const toml::parse_error& error, Lines& lines, ConfigDocument& document) {
  const toml::source_position at = error.source().begin;
  const std::size_t index = std::min<std::size_t>(std::max(at.line, 1U) - 1, lines.size() - 1);
  const bool unfinished = lines.ends_after(at.line - 1, at.column - 1);
  std::size_t begin = index;
  if (unfinished || parses(lines[index])) begin = beginning_of_value(lines, index);
  std::string message = wording(error, begin == index ? lines[index] : "");
  if (begin != index) message += fmt::format(" (noticed on line {})", index + 1);
  document.mistakes.push_back({static_cast<std::uint32_t>(begin + 1), std::move(message)});
  // The line on which an unfinished value is noticed belongs to the next statement.
  lines.leave_out(begin, begin == index || unfinished ? index + 1 : index);
}

std::string described(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return fmt::format("the text \"{}\"", **node.as_string());
    case toml::node_type::integer:
      return fmt::format("the number {}", **node.as_integer());
    case toml::node_type::floating_point:
      return fmt::format("the number {}", **node.as_floating_point());
    case toml::node_type::boolean:
      return **node.as_boolean() ? "true" : "false";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or a time";
  }
}

}  // namespace

std::variant<std::string, ConfigMistake> read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return ConfigMistake{0, "this is a folder; name the configuration file in it"};
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return ConfigMistake{0,
                         fmt::format("cannot be read: {}", std::generic_category().message(errno))};
  std::string text;
  std::array<char, 16384> piece;
  do {
    file.read(piece.data(), piece.size());
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  } while (file && text.size() <= max_file_bytes);
  if (file.bad()) return ConfigMistake{0, "cannot be read to its end"};
  if (text.size() > max_file_bytes)
    return ConfigMistake{
        0, fmt::format("is larger than {} MiB; this is no configuration", max_file_bytes >> 20)};
  return text;
}

ConfigDocument parse_document(std::string_view text) {
  ConfigDocument document;
  Lines lines(text);
  const std::size_t most = text.size() > max_recovered_bytes ? 1 : max_syntax_mistakes;
  while (document.mistakes.size() < most) {
    toml::parse_result result = toml::parse(std::string_view(lines.first(lines.size())));
    if (result) {
      document.table = std::move(result).table();
      return document;
    }
    document.complete = false;
    leave_out_mistake(result.error(), lines, document);
  }
  document.readable = false;
  return document;
}

TableReader::TableReader(const toml::table& table, std::string title, ConfigDocument& document)
    : table_(table), title_(std::move(title)), document_(document) {}

const toml::node* TableReader::find(std::string_view key) {
  known_.emplace(key);
  return table_.get(key);
}

std::uint32_t TableReader::line_of(std::string_view key) const {
  const auto entry = table_.find(key);
  return entry == table_.cend() ? table_.source().begin.line : entry->first.source().begin.line;
}

void TableReader::mistake(std::string_view key, std::string message) {
  document_.mistakes.push_back({line_of(key), fmt::format("{} {}", title_, std::move(message))});
}

void TableReader::wrong_type(std::string_view key, const toml::node& node,
                             std::string_view wanted) {
  mistake(key, fmt::format("{} must be {}, not {}", key, wanted, described(node)));
}

void TableReader::require(std::string_view key, std::string_view example) {
  if (!table_.contains(key) && document_.complete)
    mistake(key, fmt::format("{} is missing; add a line such as {} = {}", key, key, example));
}

std::optional<bool> TableReader::boolean(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (const auto* boolean = node->as_boolean()) return **boolean;
  wrong_type(key, *node, "true or false");
  return std::nullopt;
}

std::optional<std::string> TableReader::text(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* value = node->as_string()) return value->get();
  wrong_type(key, *node, "a text in double quotes");
  return std::nullopt;
}

std::optional<std::int64_t> TableReader::integer_in(std::string_view key, const toml::node& node,
                                                    std::int64_t low, std::int64_t high,
                                                    std::string_view wanted) {
  const auto* value = node.as_integer();
  if (value != nullptr && value->get() >= low && value->get() <= high) return value->get();
  wrong_type(key, node, wanted);
  return std::nullopt;
}

std::optional<std::int64_t> TableReader::integer(std::string_view key, std::int64_t low,
                                                 std::int64_t high) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return integer_in(key, *node, low, high, fmt::format("a whole number from {} to {}", low, high));
}

std::optional<std::int64_t> TableReader::integer_or_auto(std::string_view key, std::int64_t low,
                                                         std::int64_t high) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* value = node->as_string(); value != nullptr && value->get() == "auto")
    return std::nullopt;
  return integer_in(key, *node, low, high,
                    fmt::format("\"auto\" or a whole number from {} to {}", low, high));
}

std::optional<double> TableReader::number(std::string_view key, double low, double high) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<double> value =
      node->is_number() ? node->value<double>() : std::optional<double>();
  if (value && *value >= low && *value <= high) return value;
  wrong_type(key, *node, fmt::format("a number from {} to {}", low, high));
  return std::nullopt;
}

std::optional<Duration> TableReader::duration(std::string_view key, Duration low, Duration high) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_string();
  // A bare number would be seconds to parse_duration; here its unit is asked for.
  const bool has_unit = value != nullptr && value->get().find_first_of("smhd") != std::string::npos;
  const std::optional<Duration> parsed = has_unit ? parse_duration(value->get()) : std::nullopt;
  if (parsed && *parsed >= low && *parsed <= high) return parsed;
  wrong_type(key, *node,
             fmt::format("a duration in quotes with its unit (ns, us, ms, s, min, h, d), from "
                         "\"{}\" to \"{}\"",
                         duration_text(low), duration_text(high)));
  return std::nullopt;
}

std::optional<std::uint64_t> TableReader::size(std::string_view key, std::uint64_t low) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_string();
  const std::optional<std::uint64_t> parsed =
      value != nullptr ? parse_size(value->get()) : std::nullopt;
  if (parsed && *parsed >= low) return parsed;
  wrong_type(key, *node,
             fmt::format("a size in quotes with its unit (B, kB, MB, GB, TB, KiB, MiB, GiB, TiB), "
                         "at least \"{}\"",
                         size_text(low)));
  return std::nullopt;
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* list = node->as_array();
  const bool all_texts =
      list != nullptr && std::all_of(list->begin(), list->end(),
                                     [](const toml::node& element) { return element.is_string(); });
  if (!all_texts || list->empty()) {
    mistake(key,
            fmt::format("{} must be a list of at least one text, such as [\"I_BDRIN1\"]", key));
    return std::nullopt;
  }
  std::vector<std::string> result;
  for (const toml::node& element : *list) result.push_back(element.as_string()->get());
  return result;
}

const toml::array* TableReader::array(std::string_view key) {
  const toml::node* node = find(key);
  return node == nullptr ? nullptr : node->as_array();
}

const toml::table* TableReader::section(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) wrong_type(key, *node, fmt::format("a table that begins with [{}]", key));
  return node->as_table();
}

std::vector<const toml::table*> TableReader::sections(std::string_view key) {
  const toml::node* node = find(key);
  std::vector<const toml::table*> result;
  if (node == nullptr) return result;
  const toml::array* list = node->as_array();
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i)
    if (const toml::table* table = list->get(i)->as_table()) result.push_back(table);
  if (list == nullptr || result.size() != list->size())
    mistake(key, fmt::format("{} must be tables in double brackets, one for each", key));
  return result;
}

void TableReader::refuse_unknown_keys(std::initializer_list<FormerKey> former) {
  const std::vector<std::string> known(known_.begin(), known_.end());
  for (const auto& entry : table_) {
    const std::string_view key = entry.first.str();
    if (known_.contains(key)) continue;
    const auto* of_before = std::find_if(former.begin(), former.end(),
                                         [&](const FormerKey& one) { return one.key == key; });
    if (of_before != former.end()) {
      mistake(key, fmt::format("{} is no key any more: {}", key, of_before->remedy));
      continue;
    }
    const std::string_view meant = nearest(key, known);
    mistake(key, !meant.empty()
                     ? fmt::format("{} is not known; did you mean {}?", key, meant)
                     : fmt::format("{} is not known; known here: {}", key, joined(known)));
  }
}

}  // namespace reident
