#include "service/transfer/import_rows.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "service/satcs/replay/replay_columns.hpp"
#include "service/support/text.hpp"
#include "service/telemetry_file/long_layout.hpp"
#include "service/transfer/parameter_book.hpp"

namespace reident::transfer {
namespace {

using csv::Error;
using telemetry_file::Cell;
using telemetry_file::StateMap;
using Reader = telemetry_file::TelemetryFile;
using storage::TelemetryFrame;
using Entry = ParameterBook::Entry;

std::string source_of(const ImportOptions& options) {
  return options.source.value_or("import:" + options.file.filename().string());
}

/// Those of --only without those of --leave-out; none named means all.
std::variant<std::vector<std::string>, Error> taken_columns(const ImportOptions& options,
                                                            const Reader& reader) {
  if (options.leave_out.empty()) return options.only;
  for (const std::string& column : options.leave_out) {
    const auto found = reader.find(column);
    if (const auto* error = std::get_if<Error>(&found)) return *error;
  }
  std::vector<std::string> taken = options.only;
  if (taken.empty())
    for (std::size_t c = 0; c < reader.columns().size(); ++c)
      if (!reader.columns()[c].empty() && !reader.is_time(c)) taken.push_back(reader.columns()[c]);
  std::erase_if(taken, [&](const std::string& column) {
    const auto& out = options.leave_out;
    return std::find(out.begin(), out.end(), column) != out.end();
  });
  if (!taken.empty()) return taken;
  return Error{options.file.string() +
               ": --leave-out leaves no column; there is nothing to import"};
}

storage::Quality quality_of(const Cell& cell) {
  return cell.is_flagged ? storage::Quality::out_of_limits : storage::Quality::good;
}

std::optional<double> state_among(const StateMap* states, std::string_view word) {
  if (states)
    for (const auto& [state, value] : *states)
      if (state == word) return value;
  return std::nullopt;
}

void describe_once(Entry& entry, ImportBatch& batch) {
  if (entry.is_described) return;
  batch.descriptors.push_back(entry.descriptor);
  entry.is_described = true;
}

class WideRows : public ImportRows {
 public:
  WideRows(const ImportOptions& options, const storage::Archive& archive)
      : spacecraft_(options.spacecraft.value_or("")),
        source_(source_of(options)),
        origin_(options.origin.value_or(storage::Origin::real)),
        book_(archive, spacecraft_) {}

  std::optional<Error> prepare(const ImportOptions& options, Reader& reader);

  std::optional<Error> add(const Reader& reader, ImportBatch& batch) override;
  std::vector<std::string> left_out() const override { return left_out_; }

 private:
  struct Column {
    std::size_t position;
    Entry* entry;
  };

  std::optional<Error> find_parameters(const Reader& reader, const satcs::ReplayPlan& plan);

  std::string spacecraft_, source_;
  storage::Origin origin_;
  ParameterBook book_;
  std::vector<Column> columns_;
  std::vector<std::string> left_out_;
};

std::optional<Error> WideRows::prepare(const ImportOptions& options, Reader& reader) {
  if (auto error = reader.find_time()) return error;
  satcs::ReplayPlan plan;
  plan.file = options.file;
  plan.time_column = reader.columns()[reader.clock().columns().front()];
  satcs::ReplayOptions columns;
  columns.mappings = options.mappings;
  columns.keep_names = options.keep_names;
  auto taken = taken_columns(options, reader);
  if (auto* error = std::get_if<Error>(&taken)) return std::move(*error);
  columns.only = std::get<std::vector<std::string>>(std::move(taken));
  // Numbers behind the head of the file are seen on the way: it may be too large to read it twice.
  std::vector<std::uint64_t> numbers;
  for (std::size_t c = 0; c < reader.columns().size(); ++c)
    numbers.push_back(reader.format(c).kind == telemetry_file::CellFormat::Kind::text ? 0 : 1);
  if (const auto error = satcs::choose_columns(columns, reader, numbers, plan)) {
    const std::string file = options.file.string() + ": ";
    return error->message.starts_with(file) ? *error : Error{file + error->message};
  }
  left_out_ = reader.unnamed_columns();
  for (const std::string& column : plan.left_out)
    left_out_.push_back(satcs::left_out_sentence(reader, column));
  return find_parameters(reader, plan);
}

std::optional<Error> WideRows::add(const Reader& reader, ImportBatch& batch) {
  TelemetryFrame& frame = batch.next();
  for (const Column& column : columns_) {
    const Cell cell = reader.cell(column.position);
    if (cell.kind == Cell::Kind::number)
      frame.samples.push_back({column.entry->descriptor.id, quality_of(cell), cell.value});
    else if (cell.kind == Cell::Kind::bad)
      return reader.cell_error(
          column.position,
          "is no number; mend it, say with --missing that it stands for no value, or leave out the "
          "column (--leave-out) or such lines (--skip-bad-lines)");
  }
  if (frame.samples.empty()) return std::nullopt;
  for (const Column& column : columns_)
    if (!column.entry->is_described && reader.cell(column.position).kind == Cell::Kind::number)
      describe_once(*column.entry, batch);
  frame.spacecraft = spacecraft_;
  frame.source = source_;
  frame.origin = origin_;
  frame.generation_time = frame.reception_time = reader.time_ns();
  batch.keep();
  return std::nullopt;
}

std::optional<Error> WideRows::find_parameters(const Reader& reader,
                                               const satcs::ReplayPlan& plan) {
  for (const auto& column : plan.columns) {
    const auto& wanted = column.parameter;
    const auto found = book_.find(wanted);
    if (const auto* refusal = std::get_if<std::string>(&found))
      return Error{fmt::format("{}: column '{}': {}; give it another name with --map {}=NAME",
                               plan.file.string(), reader.columns()[column.position], *refusal,
                               reader.columns()[column.position])};
    columns_.push_back({column.position, std::get<Entry*>(found)});
  }
  return std::nullopt;
}

class LongRows : public ImportRows {
 public:
  LongRows(const ImportOptions& options, const Reader& reader, const storage::Archive& archive,
           telemetry_file::LongLayout layout);

  /// Once the reader knows its time.
  void note_left_out(const Reader& reader);
  bool knows_spacecraft() const { return spacecraft_ || options_.spacecraft; }

  std::optional<Error> add(const Reader& reader, ImportBatch& batch) override;
  std::vector<std::string> left_out() const override { return left_out_; }

 private:
  std::optional<Error> read_quality(const Reader& reader, storage::Quality& quality) const;

  /// Takes over what the row says of spacecraft, source and origin, where it says something new.
  std::optional<Error> read_stream(const Reader& reader);

  /// `states` are those that the row's value is among.
  std::optional<Error> read_parameter(const Reader& reader, const StateMap* states);

  /// Into the last frame if it is of the same stream and time, else into one of its own.
  void place(const storage::Sample& sample, storage::Time time, ImportBatch& batch);

  const ImportOptions& options_;
  const storage::Archive& archive_;
  const std::string own_source_;
  const std::size_t parameter_, value_;
  std::optional<std::size_t> unit_, spacecraft_, source_, origin_, quality_;
  std::vector<std::size_t> known_;  // columns that have a meaning
  struct OfSpacecraft {
    ParameterBook book;
    telemetry_file::UnitsOfParameters units;
  };
  std::map<std::string, OfSpacecraft> of_spacecraft_;
  std::vector<std::string> left_out_;

  // What the row before had: most rows differ from it in time and value alone.
  std::string cell_of_spacecraft_, cell_of_source_, cell_of_origin_;
  std::optional<TelemetryFrame> stream_;
  OfSpacecraft* known_of_it_ = nullptr;
  Entry* entry_ = nullptr;
};

LongRows::LongRows(const ImportOptions& options, const Reader& reader,
                   const storage::Archive& archive, telemetry_file::LongLayout layout)
    : options_(options),
      archive_(archive),
      own_source_(source_of(options)),
      parameter_(layout.parameter),
      value_(layout.value),
      unit_(layout.unit),
      known_{parameter_, value_} {
  const auto column = [&](std::string_view name, bool is_asked_for) {
    const auto found = reader.find(name);
    const auto* at = std::get_if<std::size_t>(&found);
    if (at) known_.push_back(*at);
    return at && !is_asked_for ? std::optional(*at) : std::nullopt;
  };
  spacecraft_ = column("spacecraft", options.spacecraft.has_value());
  source_ = column("source", options.source.has_value());
  origin_ = column("origin", options.origin.has_value());
  quality_ = column("quality", false);
  if (unit_) known_.push_back(*unit_);
}

void LongRows::note_left_out(const Reader& reader) {
  for (std::size_t c = 0; c < reader.columns().size(); ++c) {
    const std::string& name = reader.columns()[c];
    if (!reader.is_time(c) && !name.empty() && !std::ranges::count(known_, c))
      left_out_.push_back(fmt::format(
          "column '{}' is left out: of rows with a sample each, parameter, time and value are "
          "read, and spacecraft, origin, source, quality and unit (--names gives other names)",
          name));
  }
}

std::optional<Error> LongRows::add(const Reader& reader, ImportBatch& batch) {
  storage::Sample sample;
  Cell cell = reader.cell(value_);
  const bool is_state = reader.format(value_).kind == telemetry_file::CellFormat::Kind::state;
  const StateMap* states = nullptr;
  if (cell.kind == Cell::Kind::bad || (is_state && cell.kind == Cell::Kind::number)) {
    states = given_states(options_.reading.cells, std::string(trimmed(reader.cells()[parameter_])));
    const auto state = state_among(states, trimmed(reader.cells()[value_]));
    if (!state)
      return reader.cell_error(
          value_,
          "is no number; mend it, say with --missing that it stands for no value, with "
          "--map-states PARAMETER:STATE=NUMBER,... what states are, or leave out such lines with "
          "--skip-bad-lines");
    cell = {Cell::Kind::number, *state, false};
  }
  if (cell.kind != Cell::Kind::number) return std::nullopt;
  sample.value = cell.value;
  sample.quality = quality_of(cell);
  if (auto error = read_quality(reader, sample.quality)) return error;
  if (auto error = read_stream(reader)) return error;
  if (auto error = read_parameter(reader, states)) return error;
  sample.parameter = entry_->descriptor.id;
  describe_once(*entry_, batch);
  place(sample, reader.time_ns(), batch);
  return std::nullopt;
}

std::optional<Error> LongRows::read_quality(const Reader& reader, storage::Quality& quality) const {
  if (!quality_ || trimmed(reader.cells()[*quality_]).empty()) return std::nullopt;
  const auto read = parse_quality(reader.cells()[*quality_]);
  if (!read) return reader.cell_error(*quality_, "is no quality; use " + storage::quality_names());
  quality = *read;
  return std::nullopt;
}

std::optional<Error> LongRows::read_stream(const Reader& reader) {
  const auto cells = reader.cells();
  const auto text = [&](std::optional<std::size_t> column) {
    return column ? trimmed(cells[*column]) : std::string_view();
  };
  if (stream_ && text(spacecraft_) == cell_of_spacecraft_ && text(source_) == cell_of_source_ &&
      text(origin_) == cell_of_origin_)
    return std::nullopt;
  TelemetryFrame stream;
  stream.origin = options_.origin.value_or(storage::Origin::real);
  if (!text(origin_).empty()) {
    const auto origin = parse_origin(text(origin_));
    if (!origin) return reader.cell_error(*origin_, "is no origin; use real or simulated");
    stream.origin = *origin;
  }
  stream.spacecraft = options_.spacecraft.value_or(std::string(text(spacecraft_)));
  if (stream.spacecraft.empty())
    return reader.cell_error(*spacecraft_, "names no spacecraft; name it with --spacecraft");
  stream.source = text(source_).empty() ? own_source_ : std::string(text(source_));
  auto known = of_spacecraft_.find(stream.spacecraft);
  if (known == of_spacecraft_.end())
    known = of_spacecraft_
                .emplace(stream.spacecraft,
                         OfSpacecraft{ParameterBook(archive_, stream.spacecraft), {}})
                .first;
  known_of_it_ = &known->second;
  entry_ = nullptr;
  cell_of_spacecraft_ = text(spacecraft_);
  cell_of_source_ = text(source_);
  cell_of_origin_ = text(origin_);
  stream_ = std::move(stream);
  return std::nullopt;
}

std::optional<Error> LongRows::read_parameter(const Reader& reader, const StateMap* states) {
  const std::string_view name = trimmed(reader.cells()[parameter_]);
  const std::string_view unit = unit_ ? trimmed(reader.cells()[*unit_]) : std::string_view();
  if (const auto wrong = known_of_it_->units.check(name, unit, reader.line()))
    return reader.error_here(*wrong);
  if (entry_ && entry_->descriptor.name == name) return std::nullopt;
  if (name.empty()) return reader.cell_error(parameter_, "names no parameter; mend the line");
  storage::ParameterDescriptor wanted;
  wanted.name = name;
  wanted.unit = unit;
  wanted.description = "imported from " + options_.file.filename().string();
  if (states) {
    wanted.kind = storage::ParameterKind::digital;
    wanted.description =
        "states " + telemetry_file::states_text(*states) + "; " + wanted.description;
  }
  const auto found = known_of_it_->book.find(wanted);
  if (const auto* refusal = std::get_if<std::string>(&found))
    return reader.error_here(*refusal + "; give it another name in the file");
  entry_ = std::get<Entry*>(found);
  return std::nullopt;
}

void LongRows::place(const storage::Sample& sample, storage::Time time, ImportBatch& batch) {
  if (TelemetryFrame* last = batch.last();
      last && last->generation_time == time && last->spacecraft == stream_->spacecraft &&
      last->source == stream_->source && last->origin == stream_->origin) {
    batch.add(*last, sample);
    return;
  }
  TelemetryFrame& frame = batch.next();
  frame.spacecraft = stream_->spacecraft;
  frame.source = stream_->source;
  frame.origin = stream_->origin;
  frame.generation_time = frame.reception_time = time;
  frame.samples.push_back(sample);
  batch.keep();
}

}  // namespace

TelemetryFrame& ImportBatch::next() {
  if (count_ == frames_.size()) frames_.emplace_back().numbered = false;
  frames_[count_].samples.clear();
  return frames_[count_];
}

void ImportBatch::keep() {
  samples_ += frames_[count_].samples.size();
  ++count_;
}

void ImportBatch::clear() {
  count_ = 0;
  samples_ = 0;
  descriptors.clear();
}

std::variant<std::unique_ptr<ImportRows>, Error> import_rows(const ImportOptions& options,
                                                             Reader& reader,
                                                             const storage::Archive& archive) {
  const auto needs_spacecraft = [&] {
    return Error{options.file.string() +
                 ": the file does not say which spacecraft it is of; name it with --spacecraft"};
  };
  if (const auto layout = telemetry_file::find_long_layout(reader)) {
    if (!options.mappings.empty() || !options.only.empty() || !options.leave_out.empty() ||
        options.keep_names)
      return Error{options.file.string() +
                   ": the file has one sample a row (columns parameter, time and value); "
                   "--map, --only, --leave-out and --keep-names are for files with a column for "
                   "each parameter"};
    auto rows = std::make_unique<LongRows>(options, reader, archive, *layout);
    if (!rows->knows_spacecraft()) return needs_spacecraft();
    if (auto error = reader.find_time(true, options.spacecraft.has_value()))
      return *std::move(error);
    rows->note_left_out(reader);
    return rows;
  }
  if (!options.spacecraft) return needs_spacecraft();
  auto rows = std::make_unique<WideRows>(options, archive);
  if (auto error = rows->prepare(options, reader)) return *std::move(error);
  return rows;
}

}  // namespace reident::transfer
