// SPDX-License-Identifier: Apache-2.0
// The bytes of a file that may be larger than the memory. Private to this module.
#pragma once

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/result.h"

namespace mixrig::take {

class MappedFile {
 public:
  /// Errors: kNotFound.
  static Result<MappedFile> open(const std::filesystem::path& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    MappedFile file;
    if (fd >= 0 && ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
      file.size_ = static_cast<std::size_t>(status.st_size);
      void* const at = ::mmap(nullptr, file.size_, PROT_READ, MAP_PRIVATE, fd, 0);
      if (at != MAP_FAILED) file.bytes_ = at;
    }
    const int why = errno;
    if (fd >= 0) ::close(fd);
    if (file.bytes_ != nullptr) return file;
    return system_error(ErrorCode::kNotFound, "cannot read '" + path.string() + "'", why);
  }
  MappedFile(MappedFile&& other) noexcept
      : bytes_(std::exchange(other.bytes_, nullptr)), size_(other.size_) {}
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile() {
    if (bytes_ != nullptr) ::munmap(bytes_, size_);
  }
  std::span<const std::uint8_t> bytes() const {
    return {static_cast<const std::uint8_t*>(bytes_), size_};
  }

 private:
  MappedFile() = default;
  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace mixrig::take
