// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/growing_table.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace mixrig::take {
namespace {

/// Writes all bytes at the end of a file. The kernel takes a row in one piece unless the disk is
/// full.
bool write_whole(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t taken = ::write(fd, bytes.data(), bytes.size());
    if (taken < 0 && errno == EINTR) continue;
    if (taken <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(taken));
  }
  return true;
}

}  // namespace

GrowingTable::GrowingTable(GrowingTable&& other) noexcept
    : path_(std::move(other.path_)),
      header_(std::move(other.header_)),
      fd_(std::exchange(other.fd_, -1)),
      bytes_(other.bytes_) {}

GrowingTable::~GrowingTable() {
  if (fd_ >= 0) ::close(fd_);
}

Result<void> GrowingTable::append(std::string_view rows) {
  std::string with_header;
  if (fd_ < 0) {
    fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    with_header = header_ + std::string(rows);
    if (fd_ >= 0) rows = with_header;
  }
  if (fd_ >= 0 && write_whole(fd_, rows)) {
    bytes_ += static_cast<std::int64_t>(rows.size());
    return {};
  }
  const int failed = errno;
  if (fd_ >= 0) (void)!::ftruncate(fd_, bytes_);
  return system_error(ErrorCode::kIo,
                      "cannot write '" + path_.string() + "': check the disk's free space", failed);
}

std::string_view whole_rows(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  return text.substr(0, text.rfind('\n') + 1);  // npos + 1 is 0
}

}  // namespace mixrig::take
