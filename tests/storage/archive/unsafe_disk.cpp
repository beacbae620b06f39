#include "tests/storage/archive/unsafe_disk.hpp"

#include <algorithm>
#include <cstring>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test {
namespace {

using Kind = FileOperation::Kind;

constexpr std::size_t sector = 512;

void put(std::string& file, std::size_t offset, std::string_view bytes) {
  if (file.size() < offset + bytes.size()) file.resize(offset + bytes.size(), '\0');
  std::memcpy(file.data() + offset, bytes.data(), bytes.size());
}

/// Any of the sectors that the write covers.
void put_torn(std::string& file, const FileOperation& write, std::mt19937& random) {
  const auto begin = static_cast<std::size_t>(write.offset);
  const std::size_t end = begin + write.bytes.size();
  for (std::size_t at = begin; at < end;) {
    const std::size_t next = std::min(end, (at / sector + 1) * sector);
    if (random() % 2 == 0)
      put(file, at, std::string_view(write.bytes).substr(at - begin, next - at));
    at = next;
  }
}

void carry_out(std::string& file, const FileOperation& operation) {
  const auto offset = static_cast<std::size_t>(operation.offset);
  if (operation.kind == Kind::write)
    put(file, offset, operation.bytes);
  else
    file.resize(offset, '\0');
}

/// What is there of a file; `share` of 10 of its unsynced operations are, whole or torn.
std::string remains(const std::string& synced, const std::vector<FileOperation>& unsynced,
                    unsigned share, std::mt19937& random) {
  std::string file = synced;
  for (const FileOperation& operation : unsynced) {
    if (random() % 10 >= share) continue;
    if (operation.kind == Kind::write && random() % 3 == 0)
      put_torn(file, operation, random);
    else
      carry_out(file, operation);
  }
  return file;
}

}  // namespace

void UnsafeDisk::change(Names& names, const NameChange& change) {
  if (change.file == none)
    names.erase(change.path);
  else
    names[change.path] = change.file;
}

void UnsafeDisk::sync_names() {
  synced_names_ = names_;
  unsynced_names_.clear();
}

void UnsafeDisk::sync_file(const std::string& path) {
  const std::size_t number = names_.at(path);
  File& file = files_[number];
  for (const FileOperation& operation : file.unsynced) carry_out(file.synced, operation);
  file.unsynced.clear();
  const auto name = synced_names_.find(path);
  if (name == synced_names_.end() || name->second != number) sync_names();
}

void UnsafeDisk::apply(const FileOperation& operation) {
  const auto change_name = [&](std::size_t file) {
    unsynced_names_.push_back({operation.path, file});
    change(names_, unsynced_names_.back());
  };
  switch (operation.kind) {
    case Kind::create:
      change_name(files_.size());
      files_.emplace_back();
      break;
    case Kind::write:
    case Kind::truncate:
      files_[names_.at(operation.path)].unsynced.push_back(operation);
      break;
    case Kind::sync:
      sync_file(operation.path);
      break;
    case Kind::remove:
      if (!names_.contains(operation.path)) break;
      change_name(none);
      if (operation.folder_synced) sync_names();
      break;
    case Kind::begin:
    case Kind::end:
      break;
  }
}

void UnsafeDisk::cut_power(const std::filesystem::path& folder, std::mt19937& random) const {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  Names names = synced_names_;
  const std::size_t kept = random() % (unsynced_names_.size() + 1);
  for (std::size_t i = 0; i < kept; ++i) change(names, unsynced_names_[i]);
  const unsigned shares[] = {0, 1, 5, 9, 10};
  const unsigned share = shares[random() % std::size(shares)];
  for (const auto& [path, number] : names)
    write_file(folder / std::filesystem::path(path).filename(),
               remains(files_[number].synced, files_[number].unsynced, share, random));
}

std::size_t UnsafeDisk::unsynced() const {
  std::size_t count = unsynced_names_.size();
  for (const auto& [path, number] : names_) count += files_[number].unsynced.size();
  return count;
}

}  // namespace reident::storage::test
