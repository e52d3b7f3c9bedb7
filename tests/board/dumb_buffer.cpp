// SPDX-License-Identifier: Apache-2.0
#include "tests/board/dumb_buffer.h"

#include <array>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace mixrig::board {
namespace {

// Structures of the kernel's drm.h and drm_mode.h.
struct DrmVersion {
  int major, minor, patch;
  std::size_t name_length;
  char* name;
  std::size_t date_length;
  char* date;
  std::size_t text_length;
  char* text;
};
struct CreateDumb {
  std::uint32_t height, width, bits, flags, handle, pitch;
  std::uint64_t size;
};
struct MapDumb {
  std::uint32_t handle, pad;
  std::uint64_t offset;
};
struct Prime {
  std::uint32_t handle, flags;
  std::int32_t fd;
};
constexpr unsigned long kVersion = _IOWR('d', 0x00, DrmVersion);
constexpr unsigned long kCreateDumb = _IOWR('d', 0xB2, CreateDumb);
constexpr unsigned long kMapDumb = _IOWR('d', 0xB3, MapDumb);
constexpr unsigned long kHandleToFd = _IOWR('d', 0x2D, Prime);

bool is_of(int node, const std::string& driver) {
  std::array<char, 32> text{};
  DrmVersion version{};
  version.name_length = text.size() - 1;
  version.name = text.data();
  return ::ioctl(node, kVersion, &version) == 0 && driver == text.data();
}

int open_node(const std::string& driver) {
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/dri", code)) {
    if (!entry.path().filename().string().starts_with("card")) continue;
    const int node = ::open(entry.path().c_str(), O_RDWR | O_CLOEXEC);
    if (node >= 0 && is_of(node, driver)) return node;
    if (node >= 0) ::close(node);
  }
  return -1;
}

}  // namespace

std::unique_ptr<DumbBuffer> DumbBuffer::make(const std::string& driver, Size size) {
  std::unique_ptr<DumbBuffer> buffer(new DumbBuffer);
  buffer->node_ = open_node(driver);
  if (buffer->node_ < 0 || !buffer->create(size)) return nullptr;
  return buffer;
}

bool DumbBuffer::create(Size size) {
  CreateDumb made{};
  made.width = static_cast<std::uint32_t>(size.width);
  made.height = static_cast<std::uint32_t>(size.height);
  made.bits = 8;
  if (::ioctl(node_, kCreateDumb, &made) != 0) return false;
  handle_ = made.handle, stride_bytes_ = made.pitch;
  MapDumb map{.handle = handle_, .pad = 0, .offset = 0};
  if (::ioctl(node_, kMapDumb, &map) != 0) return false;
  void* const address = ::mmap(nullptr, made.size, PROT_READ | PROT_WRITE, MAP_SHARED, node_,
                               static_cast<off_t>(map.offset));
  if (address == MAP_FAILED) return false;
  bytes_ = {static_cast<std::uint8_t*>(address), made.size};
  Prime prime{.handle = handle_, .flags = O_CLOEXEC | O_RDWR, .fd = -1};
  if (::ioctl(node_, kHandleToFd, &prime) != 0) return false;
  exported_ = prime.fd;
  return true;
}

DumbBuffer::~DumbBuffer() {
  if (!bytes_.empty()) ::munmap(bytes_.data(), bytes_.size());
  if (exported_ >= 0) ::close(exported_);
  if (node_ >= 0) ::close(node_);  // releases its buffers too
}

}  // namespace mixrig::board
