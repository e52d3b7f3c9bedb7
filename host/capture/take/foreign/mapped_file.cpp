// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/foreign/mapped_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <optional>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace mixrig::take {
namespace {

/// Where SIGBUS is a file that was cut. `end` is 0 while a guard is free.
struct Guard {
  std::atomic<std::uintptr_t> begin{0}, end{0};
  std::atomic<bool> cut{false};
};
std::array<Guard, 8> guards;
struct sigaction before_guards;
std::uintptr_t page_size = 4096;

/// Puts zeros where the file ends now. Only system calls and lock-free atomics are used here.
void on_bus_error(int, siginfo_t* info, void*) {
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (Guard& guard : guards) {
    const std::uintptr_t end = guard.end;
    if (at < guard.begin || at >= end) continue;
    const std::uintptr_t page = at / page_size * page_size;
    void* const zeros = ::mmap(reinterpret_cast<void*>(page), end - page, PROT_READ,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED | MAP_NORESERVE, -1, 0);
    if (zeros == MAP_FAILED) break;
    guard.cut = true;
    return;
  }
  ::sigaction(SIGBUS, &before_guards, nullptr);  // it is not ours: a fault comes again by itself
  if (info->si_code <= 0) ::raise(SIGBUS);       // a signal that was sent does not
}

void install_handler() {
  page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, &before_guards);
}

std::optional<std::size_t> take_guard(std::span<const std::uint8_t> bytes) {
  static std::mutex mutex;
  static std::once_flag once;
  std::call_once(once, install_handler);
  const std::lock_guard lock(mutex);
  for (std::size_t i = 0; i < guards.size(); ++i) {
    if (guards[i].end != 0) continue;
    const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data());
    guards[i].cut = false;
    guards[i].begin = begin, guards[i].end = begin + bytes.size();
    return i;
  }
  return std::nullopt;
}

}  // namespace

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  void* at = MAP_FAILED;
  std::size_t size = 0;
  if (fd >= 0 && ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    size = static_cast<std::size_t>(status.st_size);
    at = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  }
  const int why = errno;
  if (fd >= 0) ::close(fd);
  if (at == MAP_FAILED)
    return system_error(ErrorCode::kNotFound, "cannot read '" + path.string() + "'", why);
  const std::span bytes(static_cast<const std::uint8_t*>(at), size);
  if (const auto guard = take_guard(bytes)) return MappedFile(path, bytes, *guard);
  ::munmap(at, size);
  return Error{ErrorCode::kUnsupported, "cannot read '" + path.string() +
                                            "': eight recordings are read already: wait for one"};
}

MappedFile::~MappedFile() {
  if (bytes_.empty()) return;
  guards[guard_].end = 0;
  ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

Result<void> MappedFile::if_whole(Result<void> done) const {
  // The kernel, where it reads the bytes for a write, fails without a signal.
  std::error_code error;
  const bool shorter = std::filesystem::file_size(path_, error) < bytes_.size() && !error;
  if (!shorter && !guards[guard_].cut) return done;
  return Error{ErrorCode::kIo,
               "got shorter while it was read: wait until it is written or copied whole"};
}

}  // namespace mixrig::take
