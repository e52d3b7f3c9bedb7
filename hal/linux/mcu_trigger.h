// SPDX-License-Identifier: Apache-2.0
// TriggerMaster on the trigger controller's firmware.
#pragma once

#include <memory>
#include <string>

#include "hal/device/trigger.h"
#include "hal/linux/mcu_link.h"

namespace mixrig::device {

/// Extends the controller's 32-bit microseconds by the last 64-bit time that it told: right while
/// the two lie less than 35 min apart.
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

/// "kTickMissed" and so on, as users read them.
struct FaultText {
  const char* name;
  const char* meaning;
};
FaultText fault_text(protocol::Fault fault);
const char* self_test_text(protocol::SelfTestBit bit);

class McuTrigger final : public TriggerMaster {
 public:
  /// Greets the controller; refuses another message table and a damaged image. `clock` outlives
  /// it. `name` is the stream's, for error lines.
  static Result<std::unique_ptr<McuTrigger>> open(std::unique_ptr<ByteStream> stream, Clock& clock,
                                                  const std::string& name,
                                                  McuLink::Patience greeting = {
                                                      std::chrono::milliseconds(100), 30});

  const TriggerInfo& info() const override { return info_; }
  /// After a reset of the controller: greets it again, counts `controller_reset`, goes on.
  Result<TriggerStatus> status() override;
  Result<void> configure(int channel, const TriggerChannel& settings) override;
  Result<void> start() override;
  Result<void> stop() override;
  Result<std::size_t> read_ticks(std::span<TriggerTick> out, Duration timeout) override;

  /// What the controller holds for a line.
  Result<TriggerChannel> channel(int index);
  /// Names of the self-tests that failed; none is a pass.
  Result<std::vector<std::string>> self_test();
  McuLink& link() { return link_; }

 private:
  McuTrigger(std::unique_ptr<ByteStream> stream, Clock& clock, const std::string& name,
             McuLink::Patience greeting);
  Result<void> greet();
  void take_telemetry(std::uint8_t type, std::span<const std::uint8_t> body);
  std::vector<TriggerFault> all_faults(const protocol::StatusReply& reply) const;
  template <typename M>
  Result<typename M::Reply> ask(const M& message, RoundTrip* times = nullptr);

  std::unique_ptr<ByteStream> stream_;
  McuLink link_;
  McuLink::Patience greeting_;
  TriggerInfo info_;
  McuClock mcu_clock_;
  TickRing ticks_;
  std::uint64_t resets_ = 0;
};

}  // namespace mixrig::device
