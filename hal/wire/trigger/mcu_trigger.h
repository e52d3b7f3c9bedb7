// SPDX-License-Identifier: Apache-2.0
// TriggerMaster on the trigger board's firmware.
#pragma once

#include <memory>
#include <string>

#include "hal/device/stream_count.h"
#include "hal/device/trigger.h"
#include "hal/wire/trigger/mcu_link.h"

namespace mixrig::device {

/// Extends the controller's 32-bit microsecond stamps to 64 bits by the last 64-bit time that it
/// reported: correct while the two differ by less than 35 min.
class McuClock {
 public:
  void set(std::uint64_t now_us) { last_us_ = now_us; }
  std::uint64_t extend(std::uint32_t us) {
    const auto step = static_cast<std::int32_t>(us - static_cast<std::uint32_t>(last_us_));
    // The controller's clock began at 0.
    if (step < 0 && static_cast<std::uint64_t>(-std::int64_t{step}) > last_us_) return us;
    last_us_ += static_cast<std::int64_t>(step);
    return last_us_;
  }

 private:
  std::uint64_t last_us_ = 0;
};

/// Name and meaning of a fault, for users.
struct FaultText {
  const char* name;
  const char* meaning;
};
FaultText fault_text(protocol::Fault fault);
const char* self_test_text(protocol::SelfTestBit bit);

class McuTrigger final : public TriggerMaster {
 public:
  /// Sends Hello to the controller; fails for another message table and for a damaged image.
  /// `clock` must outlive it. `name` names the stream in error lines.
  static Result<std::unique_ptr<McuTrigger>> open(std::unique_ptr<ByteStream> stream, Clock& clock,
                                                  const std::string& name,
                                                  McuLink::RetryPolicy hello_retry = {
                                                      std::chrono::milliseconds(100), 30});

  const TriggerInfo& info() const override { return info_; }
  /// Reads the status. After a reset of the controller it counts `controller_reset`, sends Hello
  /// again, and then reads it.
  Result<TriggerStatus> status() override;
  Result<void> configure(int channel, const TriggerChannel& settings) override;
  Result<void> start() override;
  Result<void> stop() override;
  Result<std::size_t> read_ticks(std::span<TriggerTick> out, Duration timeout) override;

  /// Settings of a line as the controller holds them.
  Result<TriggerChannel> channel(int index);
  /// Names of the self-tests that failed; empty when all passed.
  Result<std::vector<std::string>> self_test();
  McuLink& link() { return link_; }

 private:
  McuTrigger(std::unique_ptr<ByteStream> stream, Clock& clock, const std::string& name,
             McuLink::RetryPolicy hello_retry);
  Result<void> say_hello();
  void take_telemetry(std::uint8_t type, std::span<const std::uint8_t> body);
  std::vector<TriggerFault> all_faults(const protocol::StatusReply& reply) const;
  template <typename M>
  Result<typename M::Reply> ask(const M& message, RoundTrip* times = nullptr);

  std::unique_ptr<ByteStream> stream_;
  McuLink link_;
  McuLink::RetryPolicy hello_retry_;
  TriggerInfo info_;
  McuClock mcu_clock_;
  CounterLine tick_line_;  ///< ticks of 32 bits wrap after 497 days
  TickRing ticks_;
  std::uint64_t resets_ = 0;
};

}  // namespace mixrig::device
