// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/pan_tilt_track.h"

namespace mixrig::sync {

void PanTiltTrack::add(const device::PanTiltSample& sample) {
  pan_.add({sample.pan_at, sample.angles.pan_rad});
  tilt_.add({sample.tilt_at, sample.angles.tilt_rad});
}

std::optional<device::PanTiltAngles> PanTiltTrack::at(HostTime time) const {
  const auto pan = pan_.at(time), tilt = tilt_.at(time);
  if (!pan || !tilt) return std::nullopt;
  return device::PanTiltAngles{*pan, *tilt};
}

void PanTiltTrack::Axis::add(Point point) {
  if (count_ > 0 && point.at <= kept(count_ - 1).at) return;
  // A unit that answers thousands of times a second must not displace positions that are a few
  // frames old.
  if (count_ >= 2 && kept(count_ - 1).rad == point.rad && kept(count_ - 2).rad == point.rad &&
      point.at - kept(count_ - 2).at < kSpacing) {
    points_[(begin_ + count_ - 1) % kKept].at = point.at;
    return;
  }
  if (count_ == kKept) {
    begin_ = (begin_ + 1) % kKept;
    --count_;
  }
  points_[(begin_ + count_++) % kKept] = point;
}

std::optional<double> PanTiltTrack::Axis::at(HostTime time) const {
  if (count_ == 0 || time < kept(0).at) return std::nullopt;
  const Point& last = kept(count_ - 1);
  if (time >= last.at) {
    const bool still = count_ >= 2 && kept(count_ - 2).rad == last.rad;
    if (time == last.at || (still && time - last.at <= kHold)) return last.rad;
    return std::nullopt;
  }
  std::size_t i = count_ - 1;
  while (kept(i - 1).at > time) --i;
  const Point &before = kept(i - 1), &after = kept(i);
  if (after.rad != before.rad && time > before.at && after.at - before.at > kHold)
    return std::nullopt;
  const double share = seconds(time - before.at) / seconds(after.at - before.at);
  return before.rad + share * (after.rad - before.rad);
}

}  // namespace mixrig::sync
