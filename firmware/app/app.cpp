// SPDX-License-Identifier: Apache-2.0
#include "firmware/app/app.h"

#include <algorithm>

namespace mixrig::firmware {

using protocol::Fault;
using protocol::kTickUs;
using protocol::State;

namespace {

/// An incomplete frame is dropped after this time, so that a typed `?` is recognised again.
constexpr std::uint32_t kFrameTimeoutUs = 2'000'000;
/// Resolution of the tick's time: clock and delay are each in whole microseconds.
constexpr std::uint64_t kReadingGrainUs = 2;
/// Bytes of the ring that telemetry leaves free for replies.
constexpr std::uint32_t kReplyRoom = 2 * protocol::kMaxWire;

void raise_to(std::atomic<std::uint32_t>& maximum, std::uint32_t value) {
  if (value > maximum.load(std::memory_order_relaxed)) maximum.store(value);
}

}  // namespace

void App::init() {
  identity_ = port::identity();
  if (identity_.reset_cause == protocol::ResetCause::kWatchdog) count(Fault::kWatchdog);
  if (identity_.clock == protocol::ClockSource::kInternal) count(Fault::kClockFallback);
  if (identity_.image_bad) count(Fault::kImageBad);
}

void App::poll() {
  receive();
  send_telemetry();
  watch_host();
  feed_watchdog();
  if (reboot_requested_ && tx_.empty()) {
    reboot_requested_ = false;
    port::reboot(reboot_target_);
  }
}

bool App::work_pending() const {
  return !rx_.empty() || !tx_.empty() || !records_.empty() || reboot_requested_ ||
         fed_at_tick_ != master_ticks_.load();
}

void App::count(Fault fault, std::uint32_t times) {
  auto& counter = faults_[static_cast<std::size_t>(fault)];
  const port::IrqLock lock;  // both contexts count
  counter.store(
      static_cast<std::uint16_t>(std::min<std::uint32_t>(counter.load() + times, 0xFFFF)));
}

// ---- interrupts

void App::on_rx_byte(std::uint8_t byte) {
  if (!rx_.push(byte)) count(Fault::kRxOverrun);
}

void App::on_tick(std::uint64_t now_us, std::uint32_t late_ns) {
  master_ticks_.store(master_ticks_.load(std::memory_order_relaxed) + 1);
  // The hardware starts up to one tick after the start command.
  if (state_.load() != State::kRunning || !port::outputs_running()) return;
  raise_to(late_max_ns_, late_ns);
  if (late_ns > protocol::kLateNs) count(Fault::kTickLate);

  std::uint64_t began_us = now_us - late_ns / 1000;
  if (!first_tick_seen_) {
    first_tick_seen_ = true;
    tick_began_us_ = began_us;
    report_tick(began_us);
    return;  // both halves were filled by start()
  }
  const auto elapsed_us = static_cast<std::uint32_t>(began_us - tick_began_us_);
  const std::uint32_t ticks = std::max<std::uint32_t>((elapsed_us + kTickUs / 2) / kTickUs, 1);
  if (ticks > 1) {
    count(Fault::kTickMissed, ticks - 1);
    schedule_.skip(ticks - 1);
  }
  // The clock read here also generates the ticks: a difference within the resolution of the reading
  // is a rounding error.
  const std::uint64_t due_us = tick_began_us_ + std::uint64_t{ticks} * kTickUs;
  if (began_us - due_us + kReadingGrainUs <= 2 * kReadingGrainUs) began_us = due_us;
  tick_began_us_ = began_us;
  tick_.store(tick_.load(std::memory_order_relaxed) + ticks);
  report_tick(began_us);
  refill(tick_.load(std::memory_order_relaxed) + 1);
}

void App::on_tick_done(std::uint32_t cost_ns) {
  if (state_.load() == State::kRunning) raise_to(cost_max_ns_, cost_ns);
}

void App::refill(std::uint32_t tick) { schedule_.fill(half(tick), plans_[tick & 1u]); }

void App::push_record(const Record& record) {
  if (!records_.push(record)) count(Fault::kTelemetryLost);
}

void App::report_tick(std::uint64_t began_us) {
  const std::uint8_t reports = subscribed_.load(std::memory_order_relaxed);
  const std::uint32_t tick = tick_.load(std::memory_order_relaxed);
  const TickPlan& plan = plans_[tick & 1u];
  Record record{tick, static_cast<std::uint32_t>(began_us), plan.fired, {}, false};
  if ((reports & protocol::kSubscribeTicks) != 0) push_record(record);
  if ((reports & protocol::kSubscribeEdges) == 0) return;
  record.is_edge = true;
  for (std::uint8_t i = 0; i < plan.edge_count; ++i) {
    record.edge = plan.edges[i];
    push_record(record);
  }
}

// ---- main loop

void App::receive() {
  const std::uint64_t now_us = port::now_us();
  std::uint8_t byte = 0;
  if (rx_.empty() && decoder_.mid_frame() && now_us - last_byte_us_ > kFrameTimeoutUs) {
    decoder_.reset();
  }
  while (rx_.pop(byte)) {
    last_byte_us_ = now_us;
    switch (decoder_.push(byte)) {
      case protocol::FrameEvent::kFrame:
        last_frame_us_ = now_us;
        handle_frame();
        break;
      case protocol::FrameEvent::kBad:
        count(Fault::kFrameBad);
        break;
      case protocol::FrameEvent::kProbe:
        send_text();
        break;
      case protocol::FrameEvent::kNone:
        break;
    }
  }
}

bool App::send(std::uint8_t type, std::uint8_t sequence, std::span<const std::uint8_t> body,
               std::uint32_t reserve) {
  std::array<std::uint8_t, protocol::kMaxWire> wire;
  const auto size = static_cast<std::uint32_t>(protocol::encode_frame(type, sequence, body, wire));
  if (tx_.free() < size + reserve) return false;
  for (std::uint32_t i = 0; i < size; ++i) tx_.push(wire[i]);
  port::uart_kick();
  return true;
}

template <typename M>
bool App::send_telemetry(const M& message) {
  std::array<std::uint8_t, protocol::kMaxBody> body;
  const std::size_t size = protocol::write_message(message, body);
  return send(M::kId, telemetry_sequence_, {body.data(), size}, kReplyRoom);
}

void App::send_telemetry() {
  while (const Record* r = records_.front()) {
    const bool sent = r->is_edge
                          ? send_telemetry(protocol::TriggerEdge{r->tick, r->edge.slot,
                                                                 r->edge.channel, r->edge.level})
                          : send_telemetry(protocol::TriggerTick{r->tick, r->mcu_us, r->fired});
    if (!sent) return;  // the transmit ring is full: wait; lost records are counted when pushed
    ++telemetry_sequence_;
    records_.pop();
  }
}

void App::send_text() {
  std::uint32_t fault_sum = 0;
  for (const auto& fault : faults_) fault_sum += fault.load();
  static constexpr const char* kStates[] = {"idle", "armed", "running"};
  const auto put = [this](const char* text) {
    for (; *text != 0; ++text) tx_.push(static_cast<std::uint8_t>(*text));
  };
  const auto put_number = [this](std::uint32_t value) {
    std::uint8_t digits[10];
    std::size_t n = 0;
    do {
      digits[n++] = static_cast<std::uint8_t>('0' + value % 10);
      value /= 10;
    } while (value != 0);
    while (n != 0) tx_.push(digits[--n]);
  };
  if (tx_.free() < kReplyRoom) return count(Fault::kReplyLost);
  put("mixrig-trigger ");
  for (std::size_t i = 0; i < kVersion.size(); ++i) {
    if (i != 0) put(".");
    put_number(kVersion[i]);
  }
  put(" ");
  put(kStates[static_cast<std::size_t>(state_.load())]);
  put(", tick ");
  put_number(tick_.load());
  put(", faults ");
  put_number(fault_sum);
  put("\r\n");
  port::uart_kick();
}

void App::watch_host() {
  if (state_.load() != State::kRunning) {
    host_lost_ = false;
    return;
  }
  const std::uint64_t silence_us = port::now_us() - last_frame_us_;
  silence_max_us_ = std::max(silence_max_us_, silence_us);
  const bool lost = silence_us > protocol::kHostSilentUs;
  if (lost && !host_lost_) count(Fault::kHostLost);
  host_lost_ = lost;
}

void App::feed_watchdog() {
  // Fed only when the main loop has seen a new tick: if loop or interrupt hangs, the watchdog
  // resets.
  const std::uint32_t ticks = master_ticks_.load();
  if (ticks == fed_at_tick_) return;
  fed_at_tick_ = ticks;
  port::watchdog_feed();
}

}  // namespace mixrig::firmware
