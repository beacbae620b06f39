#include "service/telemetry_file/text_source.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace reident::telemetry_file {
namespace {

constexpr std::size_t block_bytes = std::size_t{256} << 10;
constexpr std::string_view replacement_character = "\xEF\xBF\xBD";
constexpr std::size_t evidence_bytes = std::size_t{1} << 20;

std::string message_of(int code) {
  return std::error_code(code, std::generic_category()).message();
}

std::string cannot_open(int code) {
  if (code == ENOENT) return "there is no such file; check the path";
  if (code == EACCES) return "no permission to read it (chmod +r mends it)";
  return "cannot be opened: " + message_of(code);
}

/// What a word is in each of the encodings in which it may be one.
std::string readings_of(const std::string& word) {
  constexpr std::size_t most_bytes = 24;
  std::string readings;
  for (const char* encoding : {"GB18030", "BIG5", "EUC-KR", "EUC-JP", "SHIFT_JIS", "WINDOWS-1251",
                               "KOI8-R", "WINDOWS-1253", "WINDOWS-1250", "WINDOWS-1252"}) {
    const auto decoder = Decoder::of(encoding);
    std::string text;
    if (decoder) decoder->decode(word.substr(0, most_bytes), true, text);
    if (text.empty() || text.find(replacement_character) != std::string::npos) continue;
    readings += (readings.empty() ? "" : ", ") + std::string(encoding) + " (" + text + ")";
  }
  return readings;
}

/// The text before the NUL bytes that a block of a disk was filled up with. One is the end of a
/// text in UTF-16.
std::string_view without_padding(std::string_view head) {
  const std::size_t end = head.find_last_not_of('\0') + 1;
  return head.size() - end > 3 ? head.substr(0, end) : head;
}

}  // namespace

std::optional<Error> TextSource::failed(std::string_view what) const {
  return Error{name_ + ": " + std::string(what)};
}

std::variant<TextSource, Error> TextSource::open(const std::filesystem::path& path,
                                                 const std::optional<std::string>& encoding) {
  TextSource source;
  source.name_ = path.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return *source.failed("is a directory; name a CSV file in it");
  source.file_.reset(std::fopen(path.c_str(), "rb"));
  if (!source.file_) return *source.failed(cannot_open(errno));
  const auto size = std::filesystem::file_size(path, ignored);
  if (!ignored) source.size_ = size;
  const bool is_small = !ignored && size > 0 && size < evidence_bytes;  // a pipe has no size
  std::string head(is_small ? size + 1 : evidence_bytes, '\0');
  head.resize(std::fread(head.data(), 1, head.size(), source.file_.get()));
  if (std::ferror(source.file_.get()) != 0)
    return *source.failed("cannot be read: " + message_of(errno));
  const std::string_view evidence = without_padding(head);
  source.encoding_ = encoding ? *encoding : find_encoding(evidence);
  if (!encoding && is_binary(evidence, source.encoding_))
    return *source.failed("the file is packed or no text; unpack it, or convert it to text, first");
  if (!encoding && source.encoding_ != "SHIFT_JIS" && !source.encoding_.starts_with("UTF-"))
    if (const std::string word = foreign_word(evidence); !word.empty())
      return *source.failed("its encoding is not known by its bytes; say it with --encoding: " +
                            readings_of(word));
  if (source.encoding_ == "UTF-8" || source.encoding_ == "utf-8") {
    source.text_ = std::move(head);
    return source;
  }
  source.decoder_ = Decoder::of(source.encoding_);
  if (!source.decoder_)
    return *source.failed("--encoding " + source.encoding_ +
                          " is not known here; 'iconv -l' lists those that are");
  source.decoder_->decode(head, std::feof(source.file_.get()) != 0, source.text_);
  return source;
}

TextSource TextSource::of_text(std::string text, std::string name) {
  TextSource source;
  source.name_ = std::move(name);
  source.text_ = std::move(text);
  source.size_ = source.text_.size();
  return source;
}

std::optional<Error> TextSource::read(std::string& buffer) {
  if (!text_.empty()) {
    if (buffer.empty())
      buffer = std::move(text_);
    else
      buffer += text_;
    text_.clear();
    return std::nullopt;
  }
  if (!file_ || std::feof(file_.get()) != 0) return std::nullopt;
  const std::size_t before = buffer.size();
  while (buffer.size() == before) {
    const std::size_t at = decoder_ ? 0 : before;
    std::string bytes;
    std::string& into = decoder_ ? bytes : buffer;
    into.resize(at + block_bytes);
    const std::size_t count = std::fread(into.data() + at, 1, block_bytes, file_.get());
    into.resize(at + count);
    if (count == 0 && std::ferror(file_.get()) != 0)
      return failed("cannot be read: " + message_of(errno));
    const bool has_ended = std::feof(file_.get()) != 0;
    if (decoder_) decoder_->decode(bytes, has_ended, buffer);
    if (has_ended) break;
  }
  return std::nullopt;
}

std::optional<Error> TextSource::seek(std::uint64_t position) {
  text_.clear();
  const std::uint64_t begin = decoder_ ? 0 : position;
  if (fseeko(file_.get(), static_cast<off_t>(begin), SEEK_SET) != 0)
    return failed("cannot be read from its middle: " + message_of(errno));
  if (!decoder_) return std::nullopt;
  // Places are counted in the text: it is decoded again up to there.
  decoder_ = Decoder::of(encoding_);
  std::string passed;
  for (std::uint64_t left = position; left > 0;) {
    passed.clear();
    if (auto error = read(passed)) return error;
    if (passed.empty()) break;
    if (passed.size() > left) text_ = passed.substr(left);
    left -= std::min<std::uint64_t>(left, passed.size());
  }
  return std::nullopt;
}

}  // namespace reident::telemetry_file
