// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/pose_source.h"

namespace mixrig::capture {

std::string_view name(PoseLoss loss) {
  constexpr std::array<std::string_view, kPoseLosses> kNames{
      "ok",       "absent",  "outside",   "gap",        "jump",     "not_finite",
      "no_angle", "too_old", "untracked", "no_picture", "no_sample"};
  return kNames[static_cast<std::size_t>(loss)];
}

bool moved(const geometry::Pose& a, const geometry::Pose& b) {
  constexpr double kStill_m = 0.01, kStill_rad = 0.004;
  return (a.translation_m - b.translation_m).norm() > kStill_m ||
         a.rotation.angularDistance(b.rotation) > kStill_rad;
}

}  // namespace mixrig::capture
