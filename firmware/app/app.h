// SPDX-License-Identifier: Apache-2.0
// The trigger controller's application: commands, the tick interrupt, telemetry, health.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "firmware/app/ring.h"
#include "firmware/app/trigger_schedule.h"
#include "firmware/port/port.h"
#include "firmware/protocol/framing.h"
#include "firmware/protocol/messages.h"

namespace mixrig::firmware {

inline constexpr std::array<std::uint8_t, 3> kVersion = {0, 1, 0};

/// The firmware's application. Members marked "interrupt" may be called from an interrupt, all
/// others from the main loop only.
class App {
 public:
  /// Call once, after the port has initialised the hardware and before interrupts are enabled.
  void init();
  /// One round of the main loop. Never blocks.
  void poll();
  /// Whether poll() has something to do; if not, the main loop may sleep.
  bool work_pending() const;

  /// Interrupt: a received byte.
  void on_rx_byte(std::uint8_t byte);
  /// Interrupt: the receiver lost a byte.
  void on_rx_lost() { count(protocol::Fault::kRxOverrun); }
  /// Interrupt or main loop, never both at once: takes the next byte to send; false if there is
  /// none.
  bool next_tx_byte(std::uint8_t& byte) { return tx_.pop(byte); }
  /// Interrupt: call once per master tick, at `now_us`, `late_ns` after the hardware's tick.
  void on_tick(std::uint64_t now_us, std::uint32_t late_ns);
  /// Interrupt: run time of the tick interrupt, entry to exit.
  void on_tick_done(std::uint32_t cost_ns);

 private:
  /// A record that the interrupt passes to the main loop for telemetry.
  struct Record {
    std::uint32_t tick = 0;
    std::uint32_t mcu_us = 0;
    std::uint16_t fired = 0;
    SlotEdge edge;
    bool is_edge = false;
  };
  class Body;

  // commands.cpp
  void handle_frame();
  protocol::Verdict dispatch(Body& reply);
  protocol::Verdict hello(Body& reply);
  protocol::Verdict status(Body& reply);
  protocol::Verdict set_channel();
  protocol::Verdict get_channel(Body& reply);
  protocol::Verdict arm();
  protocol::Verdict start();
  protocol::Verdict stop();
  protocol::Verdict self_test(Body& reply);
  protocol::Verdict reboot();
  std::uint32_t failed_self_tests();
  template <typename M>
  bool read(M& message) const {
    return protocol::read_message(decoder_.body(), message);
  }

  // app.cpp
  void receive();
  bool send(std::uint8_t type, std::uint8_t sequence, std::span<const std::uint8_t> body,
            std::uint32_t reserve);
  template <typename M>
  bool send_telemetry(const M& message);
  void send_telemetry();
  void send_text();
  void watch_host();
  void feed_watchdog();
  void count(protocol::Fault fault, std::uint32_t times = 1);
  TriggerSchedule::Words half(std::uint32_t tick) {
    return TriggerSchedule::Words(words_.data() + (tick & 1u) * protocol::kSlotsPerTick,
                                  protocol::kSlotsPerTick);
  }
  void push_record(const Record& record);
  void report_tick(std::uint64_t began_us);
  void refill(std::uint32_t tick);

  port::Identity identity_;
  TriggerSchedule schedule_;
  protocol::FrameDecoder decoder_;
  Ring<std::uint8_t, 256> rx_;
  Ring<std::uint8_t, 1024> tx_;
  Ring<Record, 64> records_;
  alignas(4) std::array<std::uint32_t, 2 * protocol::kSlotsPerTick> words_{};
  std::array<TickPlan, 2> plans_{};  ///< plan of the tick in each half of words_

  // Shared with the interrupt: single words, or changed under an IrqLock.
  std::atomic<protocol::State> state_{protocol::State::kIdle};
  std::atomic<std::uint32_t> master_ticks_{0};
  std::atomic<std::uint32_t> tick_{0};
  std::atomic<std::uint32_t> late_max_ns_{0};
  std::atomic<std::uint32_t> cost_max_ns_{0};
  std::atomic<std::uint8_t> subscribed_{0};
  std::array<std::atomic<std::uint16_t>, protocol::kFaults> faults_{};
  bool first_tick_seen_ = false;
  std::uint64_t tick_began_us_ = 0;

  // Main loop only.
  bool hello_done_ = false;
  bool host_lost_ = false;
  std::uint64_t last_frame_us_ = 0;
  std::uint64_t last_byte_us_ = 0;
  std::uint64_t silence_max_us_ = 0;
  std::uint32_t fed_at_tick_ = 0;
  std::uint8_t telemetry_sequence_ = 0;
  bool reboot_requested_ = false;
  protocol::RebootTarget reboot_target_ = protocol::RebootTarget::kFirmware;
};

}  // namespace mixrig::firmware
