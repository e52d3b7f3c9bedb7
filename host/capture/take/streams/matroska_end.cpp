// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/matroska_end.h"

#include <algorithm>
#include <array>
#include <bit>

#include <fcntl.h>
#include <unistd.h>

namespace mixrig::take {
namespace {

constexpr std::uint32_t kSegmentId = 0x18538067, kClusterId = 0x1F43B675;
constexpr std::uint32_t kBlockGroupId = 0xA0, kSimpleBlockId = 0xA3;
/// Head of a file, what stands beside clusters, what a cluster has: other numbers are no element.
constexpr std::array<std::uint32_t, 12> kSkipped{0x1A45DFA3, 0x114D9B74, 0x1549A966, 0x1654AE6B,
                                                 0x1C53BB6B, 0x1254C367, 0xEC,       0xBF,
                                                 0xE7,       0xA7,       0xAB,       0x1043A770};
constexpr std::size_t kMostHeadBytes = 12;  ///< of an element: number and size

struct ElementHead {
  std::uint32_t id = 0;
  int bytes = 0;          ///< of the head itself
  std::int64_t body = 0;  ///< bytes after the head; negative: not known
};

/// Reads a number of variable length; 0 bytes where there is none.
int read_number(const unsigned char* from, std::size_t left, int most, std::uint64_t& value) {
  const int length = left > 0 ? std::countl_zero(*from) + 1 : most + 1;
  if (length > most || left < static_cast<std::size_t>(length)) return 0;
  value = 0;
  for (int i = 0; i < length; ++i) value = (value << 8U) | from[i];
  return length;
}

/// Reads the head of an element; 0 bytes where there is none.
ElementHead read_head(const unsigned char* from, std::size_t left) {
  ElementHead head;
  std::uint64_t id = 0, size = 0;
  const int first = read_number(from, left, 4, id);
  if (first == 0) return {};
  const int second = read_number(from + first, left - static_cast<std::size_t>(first), 8, size);
  if (second == 0) return {};
  const std::uint64_t mask = (std::uint64_t{1} << (7U * static_cast<unsigned>(second))) - 1;
  head.id = static_cast<std::uint32_t>(id);
  head.bytes = first + second;
  head.body = (size & mask) == mask ? -1 : static_cast<std::int64_t>(size & mask);
  return head;
}

}  // namespace

Result<MatroskaEnd> find_matroska_end(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return MatroskaEnd{};
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  const int fd = error ? -1 : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return Error{ErrorCode::kIo, "cannot read '" + path.string() + "': check its rights"};
  MatroskaEnd end;
  std::array<unsigned char, kMostHeadBytes> bytes{};
  for (std::int64_t at = 0; at < size;) {
    const ssize_t got = ::pread(fd, bytes.data(), bytes.size(), at);
    const ElementHead head = read_head(bytes.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
    if (head.bytes == 0) break;
    at += head.bytes;
    // What such an element holds follows as elements; its own size is written when it ends.
    if (head.id == kSegmentId || head.id == kClusterId) continue;
    const bool picture = head.id == kBlockGroupId || head.id == kSimpleBlockId;
    if (!picture && std::find(kSkipped.begin(), kSkipped.end(), head.id) == kSkipped.end()) break;
    if (head.body < 0 || head.body > size - at) break;
    at += head.body;
    end.bytes = at;
    if (picture) ++end.frames;
  }
  ::close(fd);
  return end;
}

}  // namespace mixrig::take
