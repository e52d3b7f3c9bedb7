// SPDX-License-Identifier: Apache-2.0
#include "tests/board/trigger_peer.h"

namespace mixrig::board {

void TriggerPeer::plugged(HostTime now) {
  const std::lock_guard lock(mutex_);
  board_ = std::make_unique<sim::SimBoard>();
  begin_ = now;
}

/// Advances the board to `now`. Its slots of 0.1 ms are processed once per tick; the times of edges
/// are exact nevertheless.
void TriggerPeer::advance(HostTime now) {
  const auto time_us =
      static_cast<std::uint64_t>(static_cast<double>((now - begin_).count()) * rate_ / 1000);
  board_->advance_to(time_us);
  for (const sim::LineEdge& edge : board_->take_edges())
    if (edge.high)
      on_edge_(edge.channel, static_cast<std::uint32_t>(edge.time_us / kMasterTick_us));
  if (reset_ && time_us / kMasterTick_us * kMasterTick_us + kMasterTick_us / 10 > time_us) {
    board_->reset(protocol::ResetCause::kPin);  // at a tick, so that ticks keep their times
    reset_ = false;
  }
}

void TriggerPeer::receive(std::span<const std::uint8_t> bytes, HostTime now) {
  const std::lock_guard lock(mutex_);
  if (!board_) return;
  advance(now);
  board_->receive(bytes);
}

void TriggerPeer::transmit_ready(std::vector<std::uint8_t>& out, HostTime now) {
  const std::lock_guard lock(mutex_);
  if (!board_) return;
  advance(now);
  const auto said = board_->transmitted();
  out.insert(out.end(), said.begin(), said.end());
}

std::optional<HostTime> TriggerPeer::next_event() {
  const std::lock_guard lock(mutex_);
  if (!board_) return std::nullopt;
  const double next_us =
      static_cast<double>((board_->time_us() / kMasterTick_us + 1) * kMasterTick_us);
  return begin_ + Duration(static_cast<Duration::rep>(next_us * 1000 / rate_) + 1000);
}

void TriggerPeer::reset() {
  const std::lock_guard lock(mutex_);
  reset_ = true;
}

}  // namespace mixrig::board
