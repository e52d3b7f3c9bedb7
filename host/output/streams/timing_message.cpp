// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/timing_message.h"

#include <algorithm>
#include <optional>

namespace mixrig::output {
namespace {

constexpr std::size_t kStartBytes = 3;  // 00 00 01
constexpr int kMessages = 6;            // kind of a unit; 1 to 5 are slices
constexpr std::uint8_t kEnd = 0x80, kEscape = 3;

/// Index behind the next 00 00 01 at or after `at`; the size where there is none.
std::size_t after_start_code(std::span<const std::uint8_t> unit, std::size_t at) {
  for (; at + 2 < unit.size(); ++at)
    if (unit[at] == 0 && unit[at + 1] == 0 && unit[at + 2] == 1) return at + kStartBytes;
  return unit.size();
}

/// Reads bytes of a unit without the escapes, each a 03 after two zeros.
class UnescapedBytes {
 public:
  UnescapedBytes(std::span<const std::uint8_t> unit, std::size_t begin, std::size_t end)
      : unit_(unit), at_(begin), end_(end) {}
  std::optional<std::uint8_t> next() {
    if (zeros_ >= 2 && at_ < end_ && unit_[at_] == kEscape) ++at_, zeros_ = 0;
    if (at_ >= end_) return std::nullopt;
    const std::uint8_t byte = unit_[at_++];
    zeros_ = byte == 0 ? zeros_ + 1 : 0;
    return byte;
  }
  std::size_t at() const { return at_; }

 private:
  std::span<const std::uint8_t> unit_;
  std::size_t at_, end_;
  int zeros_ = 0;
};

/// A number as messages have it: 255 for each FF, then the rest.
std::optional<std::size_t> read_sum(UnescapedBytes& bytes) {
  std::size_t sum = 0;
  while (const auto byte = bytes.next()) {
    sum += *byte;
    if (*byte != 0xFF) return sum;
  }
  return std::nullopt;
}

/// Whether a whole message was read.
bool skip_message(UnescapedBytes& bytes) {
  const auto kind = read_sum(bytes);
  const auto size = kind ? read_sum(bytes) : std::nullopt;
  if (!size) return false;
  for (std::size_t i = 0; i < *size; ++i)
    if (!bytes.next()) return false;
  return true;
}

/// Index behind the 80 that ends the messages; nullopt where they do not end.
std::optional<std::size_t> end_of_messages(std::span<const std::uint8_t> unit, std::size_t begin,
                                           std::size_t end) {
  UnescapedBytes bytes(unit, begin, end);
  for (;;) {
    UnescapedBytes here = bytes;
    const auto first = here.next();
    if (!first) return std::nullopt;
    const std::size_t behind = here.at();
    if (!skip_message(bytes)) return *first == kEnd ? std::optional(behind) : std::nullopt;
  }
}

}  // namespace

std::size_t end_messages(std::span<std::uint8_t> unit) {
  std::size_t size = unit.size(), begin = after_start_code(unit, 0);
  while (begin < size) {
    const auto now = unit.first(size);
    const int kind = now[begin] & 31;
    if (kind >= 1 && kind < kMessages) break;
    std::size_t next = after_start_code(now, begin), end = next == size ? size : next - kStartBytes;
    while (end > begin + 1 && now[end - 1] == 0) --end;  // a start code of four bytes
    if (kind == kMessages) {
      const std::size_t kept = end_of_messages(now, begin + 1, end).value_or(begin - kStartBytes);
      // A start code of four bytes stays whole, further zeros go.
      const std::size_t tail = next == size ? end : std::max(end, next - kStartBytes - 1);
      if (kept < end) {
        std::copy(now.begin() + static_cast<std::ptrdiff_t>(tail), now.end(),
                  now.begin() + static_cast<std::ptrdiff_t>(kept));
        size -= tail - kept;
        next -= tail - kept;
      }
    }
    begin = next;
  }
  return size;
}

}  // namespace mixrig::output
