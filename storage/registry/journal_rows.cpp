#include "storage/registry/journal_rows.hpp"

#include <bit>
#include <cstring>

namespace reident::storage {
namespace {

static_assert(std::endian::native == std::endian::little);

template <typename Number>
void append_number(Number number, std::vector<std::uint8_t>& bytes) {
  const auto begin = bytes.size();
  bytes.resize(begin + sizeof number);
  std::memcpy(bytes.data() + begin, &number, sizeof number);
}

template <typename Text>
void append_sized(char kind, const Text& text, std::vector<std::uint8_t>& bytes) {
  bytes.push_back(static_cast<std::uint8_t>(kind));
  append_number(static_cast<std::uint32_t>(text.size()), bytes);
  bytes.insert(bytes.end(), text.begin(), text.end());
}

void append_value(const sqlite::Value& value, std::vector<std::uint8_t>& bytes) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    bytes.push_back('i');
    append_number(*integer, bytes);
  } else if (const auto* real = std::get_if<double>(&value)) {
    bytes.push_back('r');
    append_number(*real, bytes);
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    append_sized('t', *text, bytes);
  } else if (const auto* blob = std::get_if<std::vector<std::uint8_t>>(&value)) {
    append_sized('b', *blob, bytes);
  } else {
    bytes.push_back('n');
  }
}

class RowReader {
 public:
  explicit RowReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool at_end() const { return bytes_.empty(); }

  JournalRow row() {
    JournalRow row;
    const auto name = take(number<std::uint8_t>());
    row.table.assign(name.begin(), name.end());
    const auto count = number<std::uint8_t>();
    for (std::uint8_t i = 0; i < count; ++i) row.values.push_back(value());
    return row;
  }

 private:
  std::span<const std::uint8_t> take(std::size_t size) {
    if (size > bytes_.size())
      throw Error(Error::Kind::corrupt,
                  "rows of a registry's journal are cut short: both services of a pair have to be "
                  "of one version");
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }
  template <typename Number>
  Number number() {
    Number number;
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
  }
  sqlite::Value value() {
    switch (number<std::uint8_t>()) {
      case 'n':
        return std::monostate();
      case 'i':
        return number<std::int64_t>();
      case 'r':
        return number<double>();
      case 't': {
        const auto text = take(number<std::uint32_t>());
        return std::string(text.begin(), text.end());
      }
      case 'b': {
        const auto blob = take(number<std::uint32_t>());
        return std::vector<std::uint8_t>(blob.begin(), blob.end());
      }
      default:
        throw Error(Error::Kind::corrupt,
                    "rows of a registry's journal have a value of unknown kind: both services of a "
                    "pair have to be of one version");
    }
  }

  std::span<const std::uint8_t> bytes_;
};

}  // namespace

void append_row(const JournalRow& row, std::vector<std::uint8_t>& bytes) {
  bytes.push_back(static_cast<std::uint8_t>(row.table.size()));
  bytes.insert(bytes.end(), row.table.begin(), row.table.end());
  bytes.push_back(static_cast<std::uint8_t>(row.values.size()));
  for (const sqlite::Value& value : row.values) append_value(value, bytes);
}

std::vector<JournalRow> read_rows(std::span<const std::uint8_t> bytes) {
  std::vector<JournalRow> rows;
  for (RowReader reader(bytes); !reader.at_end();) rows.push_back(reader.row());
  return rows;
}

}  // namespace reident::storage
