// SPDX-License-Identifier: Apache-2.0
// Helpers shared by the files of the V4L2 node. Private to this module.
#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include <sys/ioctl.h>

namespace mixrig::device {

// Limit of entries read from a table that a driver enumerates.
inline constexpr std::uint32_t kMostV4l2Entries = 256;

inline int ioctl_again(int fd, unsigned long request, void* argument) {
  int result = 0;
  do {
    result = ::ioctl(fd, request, argument);
  } while (result < 0 && errno == EINTR);
  return result;
}

/// Returns the text of a field of fixed length, with or without a terminating zero.
template <std::size_t N>
std::string v4l2_text(const unsigned char (&bytes)[N]) {
  const auto* begin = reinterpret_cast<const char*>(bytes);
  return {begin, ::strnlen(begin, N)};
}

}  // namespace mixrig::device
