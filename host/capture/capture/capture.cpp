// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/capture.h"

namespace mixrig::capture {

std::string_view name(StreamStatus status) {
  constexpr std::array<std::string_view, 4> kNames{"absent", "fresh", "repeated", "missing"};
  return kNames[static_cast<std::size_t>(status)];
}

std::string_view name(LensOrigin origin) {
  constexpr std::array<std::string_view, kLensOrigins> kNames{"fixed", "encoded", "clamped",
                                                              "held"};
  return kNames[static_cast<std::size_t>(origin)];
}

std::string_view name(PoseOrigin origin) {
  constexpr std::array<std::string_view, 3> kNames{"unknown", "recorded", "fixed"};
  return kNames[static_cast<std::size_t>(origin)];
}

}  // namespace mixrig::capture
