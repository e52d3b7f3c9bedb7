// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/sim/sim_board.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace mixrig::sim {

using protocol::kSlotsPerTick;
using protocol::kSlotUs;
using protocol::kTickUs;

namespace {
constexpr std::uint64_t kWatchdogUs = 500'000;
constexpr std::uint32_t kReadingsPerUs = 1000;
thread_local SimBoard* active = nullptr;

/// The port functions have no object argument: they use this board while its code runs.
class Activate {
 public:
  explicit Activate(SimBoard* board) : before_(std::exchange(active, board)) {}
  ~Activate() { active = before_; }
  Activate(const Activate&) = delete;
  Activate& operator=(const Activate&) = delete;

 private:
  SimBoard* before_;
};
}  // namespace

/// Access of the port functions to the board's private members.
struct PortAccess {
  static SimBoard& board() {
    assert(active != nullptr);
    return *active;
  }
  static port::Identity identity() { return board().identity_; }
  static std::uint64_t now_us() { return board().read_clock_us(); }
  static void idle(std::uint32_t word) {
    SimBoard& b = board();
    b.words_ = nullptr;
    b.streaming_ = false;
    b.driven_ = static_cast<std::uint16_t>(word | word >> 16);
    b.set_lines(word);
  }
  static void start(const std::uint32_t* words) {
    board().words_ = words;
    board().position_ = 0;
  }
  static bool running() { return board().streaming_; }
  static std::uint16_t read() { return static_cast<std::uint16_t>(board().lines_); }
  static void feed() { board().fed_at_us_ = board().time_us_; }
  static void reboot(protocol::RebootTarget target) { board().reboot_ = target; }
};

SimBoard::SimBoard(port::Identity identity) : identity_(identity) {
  reset(identity.reset_cause);
  resets_ = 0;
}

void SimBoard::reset(protocol::ResetCause cause) {
  const Activate scope(this);
  identity_.reset_cause = cause;
  reset_at_us_ = fed_at_us_ = time_us_;
  next_tick_us_ = time_us_ + kTickUs;
  next_slot_us_ = time_us_ + kSlotUs;
  interrupt_pending_ = hung_ = in_bootloader_ = false;
  words_ = nullptr;
  streaming_ = false;
  driven_ = 0;  // inputs, held low by the board's pull-downs
  set_lines(0xFFFF0000u);
  reboot_.reset();
  ++resets_;
  app_ = std::make_unique<firmware::App>();
  app_->init();
}

/// Emulated time stands still while code runs; only a long loop of readings sees 1 us pass.
std::uint64_t SimBoard::read_clock_us() {
  if (std::exchange(read_at_us_, time_us_) != time_us_) readings_ = 0;
  readings_ = std::min(readings_ + 1, kReadingsPerUs);
  const bool moved = readings_ == kReadingsPerUs && !clock_stopped_;
  return time_us_ - reset_at_us_ + (moved ? 1 : 0);
}

void SimBoard::set_lines(std::uint32_t word) {
  const std::uint32_t after = (lines_ & ~(word >> 16)) | (word & 0xFFFFu);
  for (std::uint32_t changed = after ^ lines_; changed != 0; changed &= changed - 1) {
    const auto channel = static_cast<std::uint8_t>(__builtin_ctz(changed));
    edges_.push_back({time_us_, channel, (after >> channel & 1u) != 0});
  }
  lines_ = after;
}

void SimBoard::receive(std::span<const std::uint8_t> bytes) {
  if (in_bootloader_) return;
  const Activate scope(this);
  for (const std::uint8_t byte : bytes) {
    app_->on_rx_byte(byte);
    if (!hung_) run_main_loop();
  }
}

std::vector<std::uint8_t> SimBoard::transmitted() { return std::exchange(transmitted_, {}); }
std::vector<LineEdge> SimBoard::take_edges() { return std::exchange(edges_, {}); }

std::uint64_t SimBoard::next_event_us() const {
  std::uint64_t next = next_tick_us_;
  if (words_ != nullptr) next = std::min(next, next_slot_us_);
  if (interrupt_pending_) next = std::min(next, std::max(time_us_, blocked_until_us_));
  return next;
}

void SimBoard::advance_to(std::uint64_t time_us) {
  const Activate scope(this);
  while (!in_bootloader_) {
    const std::uint64_t next = next_event_us();
    if (next > time_us) break;
    time_us_ = std::max(time_us_, next);
    if (next_tick_us_ <= time_us_) {
      last_tick_us_ = next_tick_us_;
      next_tick_us_ += kTickUs;
      interrupt_pending_ = true;
      if (words_ != nullptr && !streaming_) {  // the timer's trigger output starts the stream
        streaming_ = true;
        next_slot_us_ = last_tick_us_;
      }
    }
    if (words_ != nullptr && streaming_ && next_slot_us_ <= time_us_) run_slot();
    if (words_ == nullptr || !streaming_) next_slot_us_ = next_tick_us_;
    if (interrupt_pending_ && blocked_until_us_ <= time_us_) run_interrupt();
    if (!hung_) run_main_loop();
    if (time_us_ - fed_at_us_ > kWatchdogUs) reset(protocol::ResetCause::kWatchdog);
  }
  time_us_ = std::max(time_us_, time_us);
  if (!hung_ && !in_bootloader_) run_main_loop();
}

void SimBoard::run_slot() {
  set_lines(words_[position_]);
  position_ = (position_ + 1) % (2 * kSlotsPerTick);
  next_slot_us_ += kSlotUs;
}

void SimBoard::run_interrupt() {
  interrupt_pending_ = false;
  const std::uint64_t late_us = time_us_ - last_tick_us_;
  app_->on_tick(PortAccess::now_us(), static_cast<std::uint32_t>(late_us * 1000));
  app_->on_tick_done(0);
}

void SimBoard::run_main_loop() {
  app_->poll();
  std::uint8_t byte = 0;
  while (!hold_transmitter_ && app_->next_tx_byte(byte)) transmitted_.push_back(byte);
  app_->poll();
  if (!reboot_) return;
  if (*reboot_ == protocol::RebootTarget::kFirmware) {
    reset(protocol::ResetCause::kSoftware);
  } else {
    in_bootloader_ = true;
    PortAccess::idle(0);
  }
  reboot_.reset();
}

}  // namespace mixrig::sim

namespace mixrig::port {
using sim::PortAccess;

Identity identity() { return PortAccess::identity(); }
std::uint64_t now_us() { return PortAccess::now_us(); }
void outputs_idle(std::uint32_t idle_word) { PortAccess::idle(idle_word); }
void outputs_start(const std::uint32_t* two_ticks) { PortAccess::start(two_ticks); }
bool outputs_running() { return PortAccess::running(); }
std::uint16_t outputs_read(std::uint16_t) { return PortAccess::read(); }
void uart_kick() {}
void watchdog_feed() { PortAccess::feed(); }
void reboot(protocol::RebootTarget target) { PortAccess::reboot(target); }
std::uint32_t irq_save() { return 0; }
void irq_restore(std::uint32_t) {}
}  // namespace mixrig::port
