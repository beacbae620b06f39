#include "storage/database/log_check.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <span>
#include <vector>

namespace reident::storage {
namespace {

constexpr std::size_t header_bytes = 32;
constexpr std::size_t frame_header_bytes = 24;
constexpr std::uint32_t log_magic = 0x377f0682;  // with its lowest bit set: big-endian checksums

using Bytes = std::span<const unsigned char>;

std::uint32_t big_endian(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) << 24 |
         static_cast<std::uint32_t>(bytes[at + 1]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 8 | bytes[at + 3];
}

std::uint32_t little_endian(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at + 3]) << 24 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 1]) << 8 | bytes[at];
}

struct Checksum {
  std::uint32_t first = 0, second = 0;
  bool operator==(const Checksum&) const = default;

  void add(Bytes bytes, bool is_big_endian) {
    for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
      first += (is_big_endian ? big_endian(bytes, at) : little_endian(bytes, at)) + second;
      second += (is_big_endian ? big_endian(bytes, at + 4) : little_endian(bytes, at + 4)) + first;
    }
  }
};

Checksum stored_at(Bytes bytes, std::size_t at) {
  return {big_endian(bytes, at), big_endian(bytes, at + 4)};
}

struct Frame {
  std::uint32_t page = 0;
  std::uint32_t pages = 0;      // of the database, in a commit frame; else 0
  bool is_of_this_log = false;  // its salts are the log's
  bool fits = false;            // its checksum follows from the one that the frame before it has
};

/// The frames in the order of the file, each checked against the one before it.
class FrameReader {
 public:
  explicit FrameReader(const std::filesystem::path& log) : file_(log, std::ios::binary) {
    file_.read(reinterpret_cast<char*>(header_.data()), header_bytes);
    if (file_.gcount() != header_bytes) {
      is_empty_ = true;
      return;
    }
    const std::uint32_t found = big_endian(header_, 0);
    big_endian_ = (found & 1U) != 0;
    page_size_ = big_endian(header_, 8);
    Checksum sum;
    sum.add(Bytes(header_).first(24), big_endian_);
    previous_ = stored_at(header_, 24);
    is_whole_ =
        (found & ~1U) == log_magic && sum == previous_ && page_size_ >= 512 && page_size_ <= 65536;
    if (is_whole_) bytes_.resize(frame_header_bytes + page_size_);
  }

  bool is_empty() const { return is_empty_; }
  bool is_whole() const { return is_whole_; }
  std::uint32_t page_size() const { return page_size_; }

  std::optional<Frame> next() {
    file_.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
    if (static_cast<std::size_t>(file_.gcount()) != bytes_.size()) return std::nullopt;
    const Bytes bytes(bytes_);
    Checksum sum = previous_;
    sum.add(bytes.first(8), big_endian_);
    sum.add(bytes.subspan(frame_header_bytes), big_endian_);
    previous_ = stored_at(bytes, 16);
    const bool same_salts = std::equal(bytes.begin() + 8, bytes.begin() + 16, header_.begin() + 16);
    return Frame{big_endian(bytes, 0), big_endian(bytes, 4), same_salts,
                 same_salts && sum == previous_};
  }

 private:
  std::ifstream file_;
  std::array<unsigned char, header_bytes> header_{};
  std::vector<unsigned char> bytes_;
  Checksum previous_;
  std::uint32_t page_size_ = 0;
  bool big_endian_ = false;
  bool is_empty_ = false;
  bool is_whole_ = false;
};

/// Goes on behind the first frame that does not fit, `at`. Frames of transactions that failed may
/// stand there as well; none of those goes on from a commit frame.
std::optional<std::string> damage_behind(FrameReader& frames, const Frame& broken,
                                         std::uint64_t at) {
  bool follows_commit = broken.is_of_this_log && broken.pages != 0;
  bool was_flushed = false;
  std::uint64_t commits = 0;
  while (const auto frame = frames.next()) {
    was_flushed = was_flushed || (follows_commit && frame->fits);
    follows_commit = frame->is_of_this_log && frame->pages != 0;
    if (follows_commit && frame->fits) ++commits;
  }
  if (!was_flushed) return std::nullopt;
  return "it is damaged in its frame " + std::to_string(at) + ", and the commits behind that (" +
         std::to_string(commits) + " or more) cannot be read";
}

}  // namespace

LogContents read_log(const std::filesystem::path& log) {
  LogContents contents;
  FrameReader frames(log);
  if (frames.is_empty()) return contents;
  if (!frames.is_whole()) {
    std::error_code error;
    if (std::filesystem::file_size(log, error) > header_bytes && !error)
      contents.damage = "its header is damaged, so that none of its commits can be read";
    return contents;
  }
  contents.page_size = frames.page_size();
  std::map<std::uint32_t, std::uint32_t> pending;
  std::uint32_t at = 0;
  while (const auto frame = frames.next()) {
    ++at;
    if (!frame->fits) {
      contents.damage = damage_behind(frames, *frame, at);
      break;
    }
    pending[frame->page] = at;
    if (frame->pages == 0) continue;
    contents.pages = frame->pages;
    for (const auto& [page, last] : pending) contents.held[page] = last;
    pending.clear();
  }
  return contents;
}

}  // namespace reident::storage
