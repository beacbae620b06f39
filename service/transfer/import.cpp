#include "service/transfer/import.hpp"

#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>

#include "service/support/sha256.hpp"
#include "service/telemetry_file/long_layout.hpp"

namespace reident::transfer {
namespace {

using csv::Error;
using telemetry_file::Damage;
using Reader = telemetry_file::TelemetryFile;

constexpr std::uint64_t digest_bytes = std::uint64_t{64} << 10;
constexpr std::size_t bad_lines_shown = 5;

/// What identifies an import: the same words for the same file go on where it ended.
std::string request_text(const ImportOptions& options, const Reader& reader) {
  const auto text = [](const std::optional<std::string>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  };
  nlohmann::ordered_json mappings = nlohmann::ordered_json::array();
  for (const auto& mapping : options.mappings)
    mappings.push_back({mapping.column, mapping.parameter, mapping.unit});
  const nlohmann::ordered_json request = {
      {"spacecraft", text(options.spacecraft)},
      {"source", text(options.source)},
      {"origin", options.origin ? nlohmann::ordered_json(storage::name(*options.origin))
                                : nlohmann::ordered_json()},
      {"reading", reader.found()},
      {"map", mappings},
      {"only", options.only},
      {"leave_out", options.leave_out},
      {"keep_names", options.keep_names},
      {"columns", reader.columns()}};
  return request.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// SHA-256 of the first and the last 64 KiB of the file's first `position` bytes: whether it is
/// still the file that was read so far.
std::string digest_before(const std::filesystem::path& file, std::uint64_t position) {
  std::ifstream stream(file, std::ios::binary);
  const auto part = [&](std::uint64_t from, std::uint64_t to) {
    std::string bytes(to - from, '\0');
    stream.seekg(static_cast<std::streamoff>(from));
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return bytes;
  };
  const std::uint64_t head = std::min(position, digest_bytes);
  const std::string first = part(0, head);
  return sha256_hex(first + part(std::max(head, position - head), position));
}

class Import {
 public:
  Import(storage::Database& database, const ImportOptions& options, Reader& reader,
         const ImportLimits& limits)
      : options_(options), reader_(reader), limits_(limits), archive_(database), log_(database) {}

  std::variant<ImportReport, Error> run(const std::function<storage::Time()>& now,
                                        const ImportObserver& observer);

 private:
  /// Finds the rows' layout and the place to begin at.
  std::optional<Error> start(const std::function<storage::Time()>& now);

  /// Reads until the batch is full, the file ends or a line is bad.
  std::optional<Error> fill(bool& at_end);

  void commit();

  const ImportOptions& options_;
  Reader& reader_;
  const ImportLimits limits_;
  storage::Archive archive_;
  storage::ImportLog log_;
  std::unique_ptr<ImportRows> rows_;
  ImportBatch batch_;
  std::int64_t id_ = 0;
  storage::ImportPosition at_;
  ImportReport report_;
  bool tells_steps_back_ = true;  // a file of one sample a row has one series after the other
  std::uint64_t steps_back_ = 0;
  std::string first_step_;
};

std::variant<ImportReport, Error> Import::run(const std::function<storage::Time()>& now,
                                              const ImportObserver& observer) {
  if (auto error = start(now)) return *std::move(error);
  std::optional<Error> broken;
  bool at_end = false, go_on = true;
  while (go_on && !at_end && !broken) {
    broken = fill(at_end);
    commit();
    if (!broken)
      go_on = observer(
          {std::min(1.0, static_cast<double>(at_.position) / static_cast<double>(reader_.size())),
           report_.samples, at_});
  }
  if (broken && at_.rows > 0)
    return Error{broken->message +
                 "; the lines before it are imported, the same command goes on there, and --undo "
                 "takes them back"};
  if (broken) return *std::move(broken);
  for (const std::string& remark : reader_.remarks()) report_.remarks.push_back(remark);
  if (steps_back_ > 0 && tells_steps_back_)
    report_.remarks.push_back(
        first_step_ +
        (steps_back_ == 1 ? "" : ", and " + std::to_string(steps_back_ - 1) + " times more"));
  if (at_end) {
    archive_.compact();
    log_.finish(id_, now());
  }
  report_.total = at_;
  report_.complete = at_end;
  return std::move(report_);
}

std::optional<Error> Import::start(const std::function<storage::Time()>& now) {
  const std::uint64_t first_row = reader_.bytes_read(), first_line = reader_.next_line();
  if (!reader_.has_rows())
    return Error{options_.file.string() +
                 ": the header is not followed by a row; there is nothing to import"};
  auto rows = import_rows(options_, reader_, archive_);
  if (auto* error = std::get_if<Error>(&rows)) return std::move(*error);
  rows_ = std::get<std::unique_ptr<ImportRows>>(std::move(rows));
  tells_steps_back_ = !telemetry_file::find_long_layout(reader_);
  report_.found = reader_.found();
  report_.remarks = rows_->left_out();
  const std::string request = request_text(options_, reader_);
  at_.position = first_row;
  at_.line = first_line;
  for (auto& before : log_.unfinished(request)) {
    if (before.at.rows + before.at.bad_lines == 0 ||
        before.at.digest != digest_before(options_.file, before.at.position))
      continue;
    id_ = before.id;
    at_ = std::move(before.at);
    report_.resumed_at = at_.line;
    break;
  }
  if (id_ == 0) id_ = log_.begin(options_.file.string(), request, now());
  return reader_.go_on_at(at_.position, at_.line);
}

std::optional<Error> Import::fill(bool& at_end) {
  batch_.clear();
  while (batch_.samples() < limits_.samples && batch_.frames().size() < limits_.frames) {
    const Reader::Step step = reader_.next();
    at_end = step == Reader::Step::end;
    if (at_end) break;
    std::optional<Error> error;
    Damage damage = Damage::value;
    if (step == Reader::Step::error) {
      error = reader_.error();
      damage = reader_.damage();
      if (damage == Damage::none) return error;
    } else {
      error = rows_->add(reader_, batch_);
      if (reader_.clock_step() && steps_back_++ == 0)
        first_step_ = reader_.error_here(reader_.clock_step()->what).message;
    }
    if (error && !options_.skip_bad_lines) return error;
    ++(error ? at_.bad_lines : at_.rows);
    if (error) {
      report_.left_out.add(damage, *error);
      if (report_.first_bad_lines.size() < bad_lines_shown)
        report_.first_bad_lines.push_back(std::move(error->message));
    }
    at_.position = reader_.bytes_read();
    at_.line = reader_.next_line();
  }
  return std::nullopt;
}

void Import::commit() {
  at_.digest = digest_before(options_.file, at_.position);
  report_.postponed = log_.append(id_, batch_.descriptors, batch_.frames(), at_).postponed;
  report_.samples += batch_.samples();
  report_.new_parameters += batch_.descriptors.size();
}

}  // namespace

std::variant<ImportReport, Error> import_file(storage::Database& database, Reader& file,
                                              const ImportOptions& options,
                                              const std::function<storage::Time()>& now,
                                              const ImportObserver& observer,
                                              const ImportLimits& limits) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(options.file, failed))
    return Error{options.file.string() +
                 ": is no regular file, so an import could not go on where it was stopped; save it "
                 "as one first"};
  return Import(database, options, file, limits).run(now, observer);
}

}  // namespace reident::transfer
