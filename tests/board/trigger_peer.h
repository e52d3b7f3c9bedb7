// SPDX-License-Identifier: Apache-2.0
// The trigger firmware (port sim) on a serial line of this process. Its edges fire cameras.
#pragma once

#include <functional>
#include <memory>
#include <mutex>

#include "firmware/port/sim/sim_board.h"
#include "tests/board/acm_device.h"

namespace mixrig::board {

inline constexpr std::uint64_t kMasterTick_us = 10'000;

class TriggerPeer final : public SerialPeer {
 public:
  /// Called on the port's thread for every rising edge with the line and the number of the master
  /// tick since the board was plugged in.
  using OnEdge = std::function<void(int line, std::uint32_t tick)>;
  /// `drift_ppm`: how much faster than the host's clock the board's crystal runs.
  TriggerPeer(double drift_ppm, OnEdge on_edge)
      : rate_(1 + drift_ppm * 1e-6), on_edge_(std::move(on_edge)) {}

  void plugged(HostTime now) override;
  void receive(std::span<const std::uint8_t> bytes, HostTime now) override;
  void transmit_ready(std::vector<std::uint8_t>& out, HostTime now) override;
  std::optional<HostTime> next_event() override;

  /// Presses the reset button. Thread-safe.
  void reset();

 private:
  void advance(HostTime now);

  double rate_;
  OnEdge on_edge_;
  std::mutex mutex_;  ///< guards the members below
  std::unique_ptr<sim::SimBoard> board_;
  HostTime begin_{};
  bool reset_ = false;
};

}  // namespace mixrig::board
