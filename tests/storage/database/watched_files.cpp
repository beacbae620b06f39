#include "tests/storage/database/watched_files.hpp"

#include <csignal>
#include <cstring>
#include <stdexcept>
#include <unistd.h>

#include <sqlite3.h>

namespace reident::storage::test {
namespace {

using Kind = FileOperation::Kind;
using Fate = WatchedFiles::Fate;

constexpr int write_lock = 0;  // which of the log's locks a transaction that writes holds

sqlite3_vfs* real_vfs = nullptr;
WatchedFiles::Observer observer;

// SQLite allocates szOsFile bytes: this, and behind it the real file.
struct File {
  sqlite3_file base;
  const char* path;  // SQLite keeps it as long as the file is open
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

File& file_of(sqlite3_file* file) {
  return *reinterpret_cast<File*>(file);
}

[[noreturn]] void die() {
  ::raise(SIGKILL);
  ::_exit(1);
}

void announce(const FileOperation& operation) {
  if (observer(operation) != Fate::happens) die();
}

// Names of SQLite's methods; each passes on what the observer lets happen.
int close(sqlite3_file* file) {
  return file_of(file).real()->pMethods->xClose(file_of(file).real());
}

int read(sqlite3_file* file, void* out, int size, sqlite3_int64 offset) {
  return file_of(file).real()->pMethods->xRead(file_of(file).real(), out, size, offset);
}

int write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  File& own = file_of(file);
  const Fate fate = observer({Kind::write,
                              own.path,
                              offset,
                              {static_cast<const char*>(bytes), static_cast<std::size_t>(size)},
                              false});
  if (fate == Fate::killed_half_way)
    own.real()->pMethods->xWrite(own.real(), bytes, size / 2, offset);
  if (fate != Fate::happens) die();
  return own.real()->pMethods->xWrite(own.real(), bytes, size, offset);
}

int truncate(sqlite3_file* file, sqlite3_int64 size) {
  announce({Kind::truncate, file_of(file).path, size, {}, false});
  return file_of(file).real()->pMethods->xTruncate(file_of(file).real(), size);
}

int sync(sqlite3_file* file, int flags) {
  announce({Kind::sync, file_of(file).path, 0, {}, false});
  return file_of(file).real()->pMethods->xSync(file_of(file).real(), flags);
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  return file_of(file).real()->pMethods->xFileSize(file_of(file).real(), size);
}

int lock(sqlite3_file* file, int level) {
  return file_of(file).real()->pMethods->xLock(file_of(file).real(), level);
}

int unlock(sqlite3_file* file, int level) {
  return file_of(file).real()->pMethods->xUnlock(file_of(file).real(), level);
}

int check_reserved_lock(sqlite3_file* file, int* out) {
  return file_of(file).real()->pMethods->xCheckReservedLock(file_of(file).real(), out);
}

int file_control(sqlite3_file* file, int operation, void* argument) {
  return file_of(file).real()->pMethods->xFileControl(file_of(file).real(), operation, argument);
}

int sector_size(sqlite3_file* file) {
  return file_of(file).real()->pMethods->xSectorSize(file_of(file).real());
}

int device_characteristics(sqlite3_file* file) {
  return file_of(file).real()->pMethods->xDeviceCharacteristics(file_of(file).real());
}

int shm_map(sqlite3_file* file, int page, int size, int extend, void volatile** out) {
  return file_of(file).real()->pMethods->xShmMap(file_of(file).real(), page, size, extend, out);
}

int shm_lock(sqlite3_file* file, int offset, int count, int flags) {
  if (offset == write_lock && (flags & SQLITE_SHM_EXCLUSIVE) != 0)
    announce({(flags & SQLITE_SHM_LOCK) != 0 ? Kind::begin : Kind::end,
              file_of(file).path,
              0,
              {},
              false});
  return file_of(file).real()->pMethods->xShmLock(file_of(file).real(), offset, count, flags);
}

void shm_barrier(sqlite3_file* file) {
  file_of(file).real()->pMethods->xShmBarrier(file_of(file).real());
}

int shm_unmap(sqlite3_file* file, int remove) {
  return file_of(file).real()->pMethods->xShmUnmap(file_of(file).real(), remove);
}

// Version 2: with shared memory, without mapped reads, so that every byte passes here.
constexpr sqlite3_io_methods methods = {2,
                                        close,
                                        read,
                                        write,
                                        truncate,
                                        sync,
                                        file_size,
                                        lock,
                                        unlock,
                                        check_reserved_lock,
                                        file_control,
                                        sector_size,
                                        device_characteristics,
                                        shm_map,
                                        shm_lock,
                                        shm_barrier,
                                        shm_unmap,
                                        nullptr,
                                        nullptr};

int open(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags, int* out_flags) {
  File& own = file_of(file);
  own.base.pMethods = nullptr;
  own.path = path ? path : "";
  int exists = 0;
  if (path) real_vfs->xAccess(real_vfs, path, SQLITE_ACCESS_EXISTS, &exists);
  if (path && exists == 0 && (flags & SQLITE_OPEN_CREATE) != 0)
    announce({Kind::create, path, 0, {}, false});
  const int code = real_vfs->xOpen(real_vfs, path, own.real(), flags, out_flags);
  if (own.real()->pMethods) own.base.pMethods = &methods;
  return code;
}

int remove(sqlite3_vfs*, const char* path, int sync_folder) {
  announce({Kind::remove, path, 0, {}, sync_folder != 0});
  return real_vfs->xDelete(real_vfs, path, sync_folder);
}

sqlite3_vfs own_vfs;

}  // namespace

WatchedFiles::WatchedFiles(Observer given) {
  if (real_vfs) throw std::logic_error("files are watched already");
  real_vfs = sqlite3_vfs_find(nullptr);
  observer = std::move(given);
  own_vfs = *real_vfs;  // what it does not replace is asked of the real one's functions
  own_vfs.zName = "watched";
  own_vfs.szOsFile = static_cast<int>(sizeof(File)) + real_vfs->szOsFile;
  own_vfs.pNext = nullptr;
  own_vfs.xOpen = open;
  own_vfs.xDelete = remove;
  sqlite3_vfs_register(&own_vfs, 1);
}

WatchedFiles::~WatchedFiles() {
  sqlite3_vfs_unregister(&own_vfs);
  sqlite3_vfs_register(real_vfs, 1);
  real_vfs = nullptr;
  observer = nullptr;
}

}  // namespace reident::storage::test
