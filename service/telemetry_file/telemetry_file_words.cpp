#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/joined_blocks.hpp"
#include "service/telemetry_file/name_words.hpp"
#include "service/telemetry_file/telemetry_file_impl.hpp"

namespace reident::telemetry_file {
namespace {

std::string letters_and_digits(std::string_view name) {
  std::string plain;
  for (const std::string& word : words_of(name)) plain += word;
  return plain;
}

}  // namespace

bool TelemetryFile::has_rows() const {
  return !impl_->head_lines.empty();
}

std::string TelemetryFile::first_word(std::size_t column) const {
  const auto& cells = impl_->head_columns[column];
  const StateMap* const given = given_states(impl_->options.cells, columns()[column]);
  for (std::size_t row = 0; row < cells.size(); ++row)
    if (!trimmed(cells[row]).empty() && !(given && has_state(*given, trimmed(cells[row]))))
      return fmt::format("{} in line {}{}", shown(cells[row]),
                         impl_->line_of(row, column, impl_->head_lines[row]),
                         may_be_hexadecimal(cells[row])
                             ? " (where it is hexadecimal, write 0x in front of all in the column)"
                             : "");
  return "no cell";
}

std::string TelemetryFile::found() const {
  const Impl& at = *impl_;
  if (at.made_of) return at.made_of->found;
  std::string text = describe(at.dialect);
  if (at.style.decimal == ',') text += ", decimal commas";
  if (at.style.thousands != '\0') text += fmt::format(", thousands with '{}'", at.style.thousands);
  text += ", " + at.rows.source().encoding();
  if (at.clock)
    text += ", time: " + (at.clock->description().empty() ? "none yet" : at.clock->description());
  for (std::size_t c = 0; c < at.formats.size(); ++c) {
    if (is_time(c)) continue;
    const std::string format = describe(at.formats[c]);
    if (!format.empty()) text += fmt::format("; {}: {}", at.dialect.columns[c], format);
  }
  return text;
}

bool TelemetryFile::has_samples_of_their_own() const {
  return impl_->made_of.has_value();
}

std::vector<std::string> TelemetryFile::unnamed_columns() const {
  std::vector<std::string> sentences;
  for (std::size_t c = 0; c < columns().size(); ++c)
    if (columns()[c].empty() && format(c).kind != CellFormat::Kind::empty && !is_time(c))
      sentences.push_back(fmt::format(
          "column {} has no name and is left out; --names gives each column one", c + 1));
  return sentences;
}

/// Where times and names may be read otherwise: columns of other times beside the clock, names in a
/// one-byte encoding that are no words of Latin letters.
std::vector<std::string> TelemetryFile::Impl::other_readings() const {
  std::vector<std::string> sentences;
  const auto others = clock ? other_times(dialect.columns, head_columns, formats, *clock)
                            : std::vector<std::string>();
  if (!others.empty())
    sentences.push_back(fmt::format(
        "{}: there are other times in {}; each value is taken at '{}' (--time names another "
        "column)",
        rows.source().name(), joined(others), dialect.columns[clock->columns().front()]));
  const std::string encoding = rows.source().encoding();
  if (!options.encoding && are_doubtful_names(dialect.columns, encoding))
    sentences.push_back(
        fmt::format("{}: the names were read in {}; where they are not such letters, --encoding "
                    "names another, as GB18030, CP949 or CP1251",
                    rows.source().name(), encoding));
  return sentences;
}

/// Where the file names another spacecraft than the one that was named for it. Letters and digits
/// alone count; numbers are those of some catalogue.
std::vector<std::string> TelemetryFile::Impl::other_spacecraft() const {
  std::vector<std::string> sentences;
  const auto check = [&](std::uint64_t line, std::string_view said) {
    const std::string plain = letters_and_digits(said),
                      wanted = letters_and_digits(*options.spacecraft);
    if (plain.find_first_not_of("0123456789") != std::string::npos && plain != wanted)
      sentences.push_back(
          fmt::format("{}:{}: the file says that it is of {}; its rows are taken for those of {}",
                      rows.source().name(), line, shown(said), *options.spacecraft));
  };
  if (!options.spacecraft) return sentences;
  for (const SpacecraftColumn& column : spacecraft) check(column.line, column.spacecraft);
  for (const NumberedLine& line : dialect.above) check(line.number, spacecraft_of_line(line.text));
  return sentences;
}

std::vector<std::string> TelemetryFile::remarks() const {
  const RowReader& rows = impl_->rows;
  if (impl_->made_of) return impl_->made_of->remarks;
  std::vector<std::string> remarks = impl_->other_readings();
  for (std::string& sentence : impl_->other_spacecraft()) remarks.push_back(std::move(sentence));
  if (rows.repeated_headers() > 0)
    remarks.push_back(
        fmt::format("{}:{}: the header stands here again, as where files were joined ({} in all)",
                    rows.source().name(), rows.first_repeated_header(), rows.repeated_headers()));
  if (impl_->watch && impl_->watch->hour_ahead_line() > 0)
    remarks.push_back(fmt::format(
        "{}:{}: the clock goes ahead an hour: telemetry is missing, or it is a local time at the "
        "beginning of daylight saving; --time-zone names its zone",
        rows.source().name(), impl_->watch->hour_ahead_line()));
  if (impl_->cut_number_line > 0)
    remarks.push_back(fmt::format(
        "{}:{}: the file ends within a line here, whose last cell is shorter than all above it; {}",
        rows.source().name(), impl_->cut_number_line,
        impl_->is_cut_left_out
            ? "the line is taken for cut, and left out (where it is whole, end it with a line end)"
            : "if it is cut, delete the line"));
  if (rows.cut_line() > 0)
    remarks.push_back(fmt::format("{}:{}: the last line was cut, or is no row, and is left out",
                                  rows.source().name(), rows.cut_line()));
  return remarks;
}

Error TelemetryFile::error_here(std::string_view what) const {
  return Error{fmt::format("{}:{}: {}", impl_->rows.source().name(), line(), what)};
}
Error TelemetryFile::cell_error(std::size_t column, std::string_view what) const {
  return Error{fmt::format("{}:{}: {} in column '{}' {}{}", impl_->rows.source().name(),
                           line(column), shown(cells()[column]), columns()[column], what,
                           may_be_hexadecimal(cells()[column])
                               ? "; where it is hexadecimal, write 0x in front of all in the column"
                               : "")};
}
std::variant<std::size_t, Error> TelemetryFile::find(std::string_view column) const {
  const auto& names = columns();
  const auto found = std::find(names.begin(), names.end(), column);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  return Error{impl_->rows.source().name() + ": there is no column '" + std::string(column) +
               "'; the columns are: " + joined(names)};
}

}  // namespace reident::telemetry_file
