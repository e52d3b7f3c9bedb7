// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/depth_phases.h"

#include <numeric>

#include <fmt/format.h>

namespace mixrig::live {
namespace {

constexpr Duration kMasterTick = std::chrono::milliseconds(10);

std::string names(const RigConfig& rig) {
  return fmt::format("depth cameras \"{}\" and \"{}\"", rig.depth->name, rig.depth2->name);
}

}  // namespace

DepthPhases depth_phases(const RigConfig& rig) {
  const TriggerLine *first = rig.line_of(*rig.depth), *second = rig.line_of(*rig.depth2);
  if (first == nullptr || second == nullptr)
    return {.known = false,
            .line = names(rig) +
                    ": one of them runs free, so that their light may meet: give each its own "
                    "trigger_line, with phases that differ by their exposure"};
  // The distances between pulses of both are all multiples of the common divisor of their periods.
  const long divisor = std::gcd(first->channel.divider, second->channel.divider);
  const Duration period = divisor * kMasterTick;
  const Duration apart =
      ((second->channel.phase - first->channel.phase) % period + period) % period;
  DepthPhases phases{.line = {}, .apart = apart};
  const auto& exposure_s = rig.depth->exposure_s;
  const auto& exposure2_s = rig.depth2->exposure_s;
  const double before_s = seconds(apart), after_s = seconds(period - apart);
  phases.overlap = apart == Duration(0) || (exposure_s && before_s < *exposure_s) ||
                   (exposure2_s && after_s < *exposure2_s);
  phases.known = phases.overlap || (exposure_s && exposure2_s);
  if (phases.overlap)
    phases.line = fmt::format(
        "{} expose at the same time, and each measures the light of the other: every {:.1f} ms "
        "the second begins {:.1f} ms after the first{}; give their lines other phases, or shorter "
        "exposures",
        names(rig), 1e3 * seconds(period), 1e3 * before_s,
        exposure_s && exposure2_s ? fmt::format(", and they expose {:.1f} and {:.1f} ms",
                                                1e3 * *exposure_s, 1e3 * *exposure2_s)
                                  : "");
  else if (!phases.known)
    phases.line = fmt::format(
        "{}: the second begins {:.1f} ms after the first, but not both have exposure_ms, which "
        "would tell whether their light meets: give both",
        names(rig), 1e3 * before_s);
  else
    phases.line = fmt::format(
        "the second begins {:.1f} ms after the first; {:.1f} and {:.1f} ms "
        "without light",
        1e3 * before_s, 1e3 * (before_s - *exposure_s), 1e3 * (after_s - *exposure2_s));
  return phases;
}

}  // namespace mixrig::live
