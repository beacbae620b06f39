#include "service/model_export/zip_archive.hpp"

#include <stdexcept>
#include <utility>
#include <zip.h>

namespace reident::model_export {
namespace {

constexpr zip_uint16_t no_time = 0;
constexpr zip_uint16_t no_date = (1 << 5) | 1;  // 1980-01-01, where the format's calendar begins

}  // namespace

ZipArchive::ZipArchive() {
  zip_error_t error;
  zip_error_init(&error);
  file_ = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (file_ != nullptr) archive_ = zip_open_from_source(file_, ZIP_TRUNCATE, &error);
  zip_error_fini(&error);
  if (archive_ == nullptr) {
    if (file_ != nullptr) zip_source_free(file_);
    throw std::runtime_error("no zip archive can be begun: there is no memory");
  }
  zip_source_keep(file_);  // the archive frees one reference when it closes
}

ZipArchive::~ZipArchive() {
  if (archive_ != nullptr) zip_discard(archive_);
  zip_source_free(file_);
}

void ZipArchive::fail(const std::string& what) const {
  throw std::runtime_error("the zip archive cannot be written, " + what + ": " +
                           zip_strerror(archive_));
}

void ZipArchive::add(const std::string& path, std::string content) {
  const std::string& kept = contents_.emplace_back(std::move(content));
  zip_source_t* const source = zip_source_buffer(archive_, kept.data(), kept.size(), 0);
  if (source == nullptr) fail(path);
  const zip_int64_t index = zip_file_add(archive_, path.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    fail(path);
  }
  if (zip_file_set_dostime(archive_, static_cast<zip_uint64_t>(index), no_time, no_date, 0) != 0)
    fail(path);
}

std::string ZipArchive::finish() {
  if (zip_close(archive_) != 0) fail("at its end");
  archive_ = nullptr;
  zip_stat_t size;
  zip_stat_init(&size);
  std::string bytes;
  if (zip_source_stat(file_, &size) == 0 && zip_source_open(file_) == 0) {
    bytes.resize(size.size);
    const zip_int64_t read = zip_source_read(file_, bytes.data(), bytes.size());
    zip_source_close(file_);
    if (read == static_cast<zip_int64_t>(bytes.size()) && read > 0) return bytes;
  }
  throw std::runtime_error("the zip archive cannot be read back from memory");
}

}  // namespace reident::model_export
