// SPDX-License-Identifier: Apache-2.0
// The trigger master: divides one 100 Hz clock into the cameras' trigger lines.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/base/ring.h"

namespace mixrig::device {

/// Settings of one trigger line: a pulse of `width` begins `phase` after every `divider`-th master
/// tick.
struct TriggerChannel {
  int divider = 0;  ///< 0: the line is off
  Duration phase{}, width{};
  bool active_low = false;
};

/// One master tick, as the controller reports it.
struct TriggerTick {
  std::uint64_t tick = 0;      ///< counted from start; gaps show lost reports
  McuTime at{};                ///< on the controller's clock
  std::uint32_t channels = 0;  ///< mask of lines whose pulse begins in this tick
};

/// Holds reported ticks that were not read yet, for ten seconds of the master.
using TickRing = Ring<TriggerTick, 1024>;

struct TriggerInfo {
  std::string uri, version, unique_id;
  std::string reset_cause;  ///< why the controller last started
  std::string clock;        ///< source of its time base
  std::uint32_t image_crc = 0;
  int channels = 0, max_divider = 0;
  Duration tick{}, slot{};  ///< period of the master; unit of phases and widths
};

/// Checks that the master can produce these pulses: phase and width are multiples of a slot, width
/// is at least one slot, and a pulse ends before the next one begins. Errors: kUsage.
Result<void> check_channel(const TriggerInfo& info, int channel, const TriggerChannel& settings);

enum class TriggerState { kIdle, kArmed, kRunning };

/// One kind of fault on the controller or the link: how often it occurred and what it means.
struct TriggerFault {
  std::string name;
  std::uint64_t count = 0;
  std::string meaning;
};

struct TriggerStatus {
  TriggerState state = TriggerState::kIdle;
  std::uint32_t enabled = 0;  ///< mask of lines
  std::uint64_t tick = 0;
  McuTime now{};  ///< read by the controller between `asked` and `answered`
  HostTime asked{}, answered{};
  Duration late_max{};     ///< largest delay of the controller's tick interrupt since start
  Duration cost_max{};     ///< longest run time of that interrupt
  Duration silence_max{};  ///< longest time without a command from the host while running
  std::vector<TriggerFault> faults;  ///< every fault that the controller or the link counts
};

/// A trigger master. For one thread. Errors of every method: kTimeout when the controller does not
/// answer; kDevice when it refuses, was reset, or uses another protocol version (the line says
/// which).
class TriggerMaster {
 public:
  virtual ~TriggerMaster() = default;
  virtual const TriggerInfo& info() const = 0;
  virtual Result<TriggerStatus> status() = 0;
  /// Sets one line. Errors: kDevice while running; kUsage where check_channel() refuses.
  virtual Result<void> configure(int channel, const TriggerChannel& settings) = 0;
  /// Starts with the next master tick, which becomes tick 0. Restarts if it runs already.
  virtual Result<void> start() = 0;
  /// Sets the lines inactive at once. Does nothing if it does not run.
  virtual Result<void> stop() = 0;
  /// Moves reported ticks to `out`; waits at most `timeout` for the first one. 0 when none arrived.
  virtual Result<std::size_t> read_ticks(std::span<TriggerTick> out, Duration timeout) = 0;
};

}  // namespace mixrig::device
