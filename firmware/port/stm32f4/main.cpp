// SPDX-License-Identifier: Apache-2.0
// USART, watchdog, identity, interrupts and the main loop.
#include "firmware/app/app.h"
#include "firmware/port/stm32f4/clocks.h"
#include "firmware/port/stm32f4/outputs.h"
#include "firmware/port/stm32f4/registers.h"
#include "firmware/port/stm32f4/startup.h"

namespace mixrig::stm32 {
namespace {

firmware::App app;
port::Identity self;
bool is_emulated;

constexpr std::uint32_t kBaud = 115'200;

/// Sets up the USART on PA9 and PA10, the pins of the ROM bootloader, so that one cable serves
/// both. 8 bits, no parity.
void uart_init() {
  gpioa().afrh = (gpioa().afrh & ~0xFF0u) | 0x770u;
  gpioa().moder = (gpioa().moder & ~(0xFu << 18)) | 0xAu << 18;
  usart1().brr = timer_hz() / kBaud;  // APB2 runs at the timers' rate
  usart1().cr1 = bit(13) | bit(5) | bit(3) | bit(2);
  // Higher priority than the tick, whose run time must never cause the loss of a byte (87 us).
  nvic_priority(kIrqUsart1) = 0x10;
  nvic_iser(kIrqUsart1) = bit(kIrqUsart1 % 32);
}

/// Starts the watchdog. RM0090 21.4: 32 kHz / 16, 1000 counts: 500 ms, 340 to 940 ms over the
/// oscillator's spread.
void watchdog_init() {
  iwdg().kr = 0x5555;
  iwdg().pr = 2;
  iwdg().rlr = 1000;
  iwdg().kr = 0xCCCC;
}

/// Reads the cause of the reset (RM0090 7.3.21). Every reset sets the pin flag, so it is checked
/// last.
protocol::ResetCause read_reset_cause() {
  const std::uint32_t csr = rcc().csr;
  rcc().csr = csr | bit(24);
  if ((csr & (bit(29) | bit(30))) != 0) return protocol::ResetCause::kWatchdog;
  if ((csr & (bit(25) | bit(27))) != 0) return protocol::ResetCause::kPower;
  if ((csr & bit(28)) != 0) return protocol::ResetCause::kSoftware;
  if ((csr & bit(26)) != 0) return protocol::ResetCause::kPin;
  return protocol::ResetCause::kUnknown;
}

void send_next_byte() {
  std::uint8_t byte = 0;
  if (app.next_tx_byte(byte)) {
    usart1().dr = byte;
  } else {
    usart1().cr1 = usart1().cr1 & ~bit(7);
  }
}

/// Drains the transmitter by polling, since QEMU's USART never raises the interrupt for an empty
/// transmitter; harmless on a real chip.
void drain_transmitter() {
  const port::IrqLock lock;
  if ((usart1().cr1 & bit(7)) != 0 && (usart1().sr & bit(7)) != 0) send_next_byte();
}

void sleep_if_idle() {
  // Interrupts are masked between the check and wfi; a pending one still wakes the core.
  const port::IrqLock lock;
  if (!app.work_pending()) asm volatile("wfi");
}

void init() {
  is_emulated = emulated();
  self.reset_cause = read_reset_cause();
  self.clock = clocks_init();
  self.image_bad = !image_check(self.image_crc);
  for (std::size_t i = 0; i < self.uid.size(); ++i) {
    self.uid[i] = is_emulated ? std::uint8_t{'Q'} : unique_id()[i];
  }
  outputs_init();
  uart_init();
  app.init();
  time_init();
  watchdog_init();
}

}  // namespace
}  // namespace mixrig::stm32

namespace mixrig::port {

Identity identity() { return stm32::self; }
void uart_kick() { stm32::usart1().cr1 = stm32::usart1().cr1 | stm32::bit(7); }
void watchdog_feed() { stm32::iwdg().kr = 0xAAAA; }

void reboot(protocol::RebootTarget target) {
  for (int i = 0; i < 100'000 && (stm32::usart1().sr & stm32::bit(6)) == 0; ++i) {
  }
  stm32::system_reset(target);
}

std::uint32_t irq_save() {
  std::uint32_t primask;
  asm volatile("mrs %0, primask\n cpsid i" : "=r"(primask)::"memory");
  return primask;
}
void irq_restore(std::uint32_t saved) { asm volatile("msr primask, %0" ::"r"(saved) : "memory"); }

}  // namespace mixrig::port

extern "C" void tim2_handler() {
  using namespace mixrig::stm32;
  const std::uint32_t begin = span_begin();
  const std::uint64_t now_us = mixrig::port::now_us();
  std::uint32_t late_ns = 0;
  tim2().sr = 0;
  if (is_emulated) {
    const std::uint32_t due_ns = emulated_tick_rearm();
    late_ns = begin - due_ns;
    emulated_outputs_tick(due_ns);
  } else {
    late_ns = tick_late_ns();
  }
  app.on_tick(now_us, late_ns);
  app.on_tick_done(span_ns(begin));
}

extern "C" void tim4_handler() { mixrig::stm32::emulated_outputs_slot(); }

extern "C" void usart1_handler() {
  using namespace mixrig::stm32;
  // RM0090 30.6.1: byte (RXNE), overrun (ORE); reading the data register clears both.
  const std::uint32_t status = usart1().sr;
  if ((status & (bit(5) | bit(3))) != 0) {
    const auto byte = static_cast<std::uint8_t>(usart1().dr);
    if ((status & bit(5)) != 0) app.on_rx_byte(byte);
    if ((status & bit(3)) != 0) app.on_rx_lost();
  }
  if ((usart1().cr1 & bit(7)) != 0 && (usart1().sr & bit(7)) != 0) send_next_byte();
}

int main() {
  using namespace mixrig::stm32;
  init();
  for (;;) {
    app.poll();
    drain_transmitter();
    sleep_if_idle();
  }
}
