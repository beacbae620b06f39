#include "tests/bench/simulator/watched_thread.hpp"

#include <atomic>
#include <csignal>
#include <cstddef>
#include <stdexcept>

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

namespace {

thread_local bool is_watched = false;
std::atomic<std::uint64_t> allocation_count{0};
std::atomic<std::uint64_t> system_call_count{0};

void count_allocation() {
  if (is_watched) ++allocation_count;
}

void refuse_system_call(int) {
  ++system_call_count;
}

}  // namespace

// The program's own take the place of the C library's, in every library of the process; operator
// new calls malloc.
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  count_allocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  count_allocation();
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  count_allocation();
  return __libc_realloc(old, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_allocation();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  count_allocation();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;
}

void free(void* memory) {
  if (memory != nullptr) count_allocation();
  __libc_free(memory);
}

}  // extern "C"

namespace reident::bench {

void watch_this_thread() {
  struct sigaction action = {};
  action.sa_handler = refuse_system_call;
  sigaction(SIGSYS, &action, nullptr);
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
  };
  const sock_fprog filter = {sizeof(program) / sizeof(program[0]), program};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0)
    throw std::runtime_error("the kernel sets no seccomp filter; system calls cannot be counted");
  is_watched = true;
}

std::uint64_t allocations() {
  return allocation_count;
}

std::uint64_t system_calls() {
  return system_call_count;
}

}  // namespace reident::bench
