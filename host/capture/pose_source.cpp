// SPDX-License-Identifier: Apache-2.0
#include "host/capture/pose_source.h"

namespace mixrig::capture {

std::string_view name(PoseLoss loss) {
  constexpr std::array<std::string_view, kPoseLosses> kNames{
      "ok", "absent", "outside", "gap", "jump", "not_finite", "no_angle", "too_old"};
  return kNames[static_cast<std::size_t>(loss)];
}

}  // namespace mixrig::capture
