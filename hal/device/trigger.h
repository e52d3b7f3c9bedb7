// SPDX-License-Identifier: Apache-2.0
// The master of the triggers: divides one 100 Hz clock into the cameras' lines.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/base/ring.h"

namespace mixrig::device {

/// One line. A pulse of `width` begins `phase` after every `divider`-th master tick.
struct TriggerChannel {
  int divider = 0;  ///< 0: the line is off
  Duration phase{}, width{};
  bool active_low = false;
};

/// One master tick, as the controller tells it.
struct TriggerTick {
  std::uint64_t tick = 0;      ///< counted from start; gaps show lost reports
  McuTime at{};                ///< on the controller's clock
  std::uint32_t channels = 0;  ///< mask of lines whose pulse begins in this tick
};

/// Ticks that nobody has read yet: ten seconds of the master.
using TickRing = Ring<TriggerTick, 1024>;

struct TriggerInfo {
  std::string uri, version, unique_id;
  std::string reset_cause;  ///< why the controller last started
  std::string clock;        ///< what it counts time with
  std::uint32_t image_crc = 0;
  int channels = 0, max_divider = 0;
  Duration tick{}, slot{};  ///< period of the master; what phases and widths are multiples of
};

/// Whether a master of this kind can play it: phase and width are multiples of a slot, width at
/// least one, and the pulse ends before the next begins. Errors: kUsage.
Result<void> check_channel(const TriggerInfo& info, int channel, const TriggerChannel& settings);

enum class TriggerState { kIdle, kArmed, kRunning };

/// Something that went wrong on controller or link, with its count and what it means.
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
  Duration late_max{};     ///< worst entry into the controller's tick interrupt since start
  Duration cost_max{};     ///< worst run time of it
  Duration silence_max{};  ///< longest time without a word from the host while running
  std::vector<TriggerFault> faults;  ///< every fault that the controller or the link counts
};

/// For one thread. Errors of every method: kTimeout when the controller is silent; kDevice when it
/// refuses, was reset, or speaks another protocol (the line says which).
class TriggerMaster {
 public:
  virtual ~TriggerMaster() = default;
  virtual const TriggerInfo& info() const = 0;
  virtual Result<TriggerStatus> status() = 0;
  /// Not while running (kDevice). kUsage as check_channel() says.
  virtual Result<void> configure(int channel, const TriggerChannel& settings) = 0;
  /// Runs from the next master tick on, which is tick 0. Where it runs already it begins anew.
  virtual Result<void> start() = 0;
  /// Lines go inactive at once. Harmless where nothing runs.
  virtual Result<void> stop() = 0;
  /// Takes ticks that were reported, at least one, waiting at most `timeout`; 0 when none came.
  virtual Result<std::size_t> read_ticks(std::span<TriggerTick> out, Duration timeout) = 0;
};

}  // namespace mixrig::device
