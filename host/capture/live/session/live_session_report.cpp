// SPDX-License-Identifier: Apache-2.0
// The report of a session.
#include <algorithm>
#include <cmath>

#include "host/capture/live/session/live_session.h"

namespace mixrig::live {

/// `handled` is read before `pushed`, so that the difference is never too small.
std::uint64_t LiveSession::waiting_events() const {
  const std::uint64_t handled = handled_, dropped = events_.dropped();
  return pushed_ - handled - dropped;
}

Result<void> LiveSession::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_ ? Result<void>(*fault_) : Result<void>();
}

bool LiveSession::ended() const {
  if (!fault()) return true;
  const auto over = [](const device::StreamHealth& health) {
    return health.state == device::DeviceState::kStopped ||
           health.state == device::DeviceState::kFailed;
  };
  for (const auto& camera : devices_.cameras)
    if (!over(camera->health())) return false;
  for (const auto* depth : {&devices_.depth, &devices_.depth2})
    if (*depth && !over((*depth)->health())) return false;
  return waiting_events() == 0 && held_count_ == 0;
}

SessionReport LiveSession::report() const {
  std::vector<device::StreamHealth> health;
  for (const auto& camera : devices_.cameras) health.push_back(camera->health());
  if (devices_.depth) health.push_back(devices_.depth->health());
  if (devices_.depth && devices_.depth2) health.push_back(devices_.depth2->health());
  const std::lock_guard lock(mutex_);
  SessionReport report = counts_;
  report.ticks_lost = devices_.trigger ? ticks_.lost() : 0;
  if (const auto newest = ticks_.newest(); newest && has_ticks())
    report.newest_tick = {*newest, ticks_.time_of(*newest).value_or(HostTime())};
  if (edges_) report.edges = edges_->counts();
  report.trigger_drift_ppm = trigger_clock_.drift_ppm();
  report.sets = builder_->sets();
  report.incomplete_sets = builder_->incomplete();
  report.dropped_events = events_.dropped();
  report.dropped_sets = sets_.dropped();
  report.waiting_events = waiting_events();
  report.waiting_sets = sets_.size();
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const Stream& stream = streams_[i];
    const double count = std::max<double>(1, static_cast<double>(stream.paired));
    const double mean_s = stream.residual_sum_s / count;
    const double variance = std::max(0.0, stream.residual_square_s2 / count - mean_s * mean_s);
    report.streams.push_back({.name = stream.config->name,
                              .uri = stream.config->uri,
                              .health = health[i],
                              .pairing = stream.pairer.counts(),
                              .drift_ppm = stream.clock.drift_ppm(),
                              .jitter_ms = milliseconds(stream.clock.jitter()),
                              .residual_mean_ms = mean_s * 1e3,
                              .residual_sd_ms = std::sqrt(variance) * 1e3});
  }
  return report;
}

}  // namespace mixrig::live
