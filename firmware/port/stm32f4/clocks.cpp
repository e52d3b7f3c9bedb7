// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/stm32f4/clocks.h"

#include "firmware/port/port.h"
#include "firmware/port/stm32f4/registers.h"
#include "firmware/port/stm32f4/startup.h"

namespace mixrig::stm32 {

namespace {

constexpr std::uint32_t kCoreMhz = 168;
constexpr std::uint32_t kTimerMhz = 84;
constexpr std::uint32_t kTickNs = protocol::kTickUs * 1000;

bool is_emulated;

bool wait_for(Register& reg, std::uint32_t mask, std::uint32_t value) {
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    if ((reg & mask) == value) return true;
  }
  return false;
}

/// Starts the PLL. RM0090 7.3.1, 7.3.2: input / M = 1 MHz, x 336 / 2 = 168 MHz, Q = 7 for 48 MHz.
bool start_pll(bool crystal) {
  Rcc& r = rcc();
  r.cr = r.cr & ~bit(24);
  if (!wait_for(r.cr, bit(25), 0)) return false;
  if (crystal) {
    r.cr = r.cr | bit(16);
    if (!wait_for(r.cr, bit(17), bit(17))) return false;
  }
  r.pllcfgr = (crystal ? 8u | bit(22) : 16u) | 336u << 6 | 0u << 16 | 7u << 24;
  r.cr = r.cr | bit(24);
  return wait_for(r.cr, bit(25), bit(25));
}

}  // namespace

protocol::ClockSource clocks_init() {
  is_emulated = emulated();
  Rcc& r = rcc();
  // Timers 2..5, power interface; timer 8, USART 1, SYSCFG; ports A and C, DMA 2.
  r.apb1enr = r.apb1enr | bit(0) | bit(1) | bit(2) | bit(3) | bit(28);
  r.apb2enr = r.apb2enr | bit(1) | bit(4) | bit(14);
  r.ahb1enr = r.ahb1enr | bit(0) | bit(2) | bit(22);
  if (is_emulated) return protocol::ClockSource::kEmulated;

  pwr_cr() = pwr_cr() | bit(14);   // RM0090 5.4.1: voltage scale 1, needed above 144 MHz
  flash_interface().acr = 0x0705;  // RM0090 3.9.1: 5 wait states, prefetch, caches
  const bool crystal = start_pll(true);
  if (!crystal && !start_pll(false)) system_reset(protocol::RebootTarget::kFirmware);
  r.cfgr = 5u << 10 | 4u << 13;  // RM0090 7.3.3: APB1 / 4, APB2 / 2
  r.cfgr = r.cfgr | 2u;          // run from the PLL
  wait_for(r.cfgr, 3u << 2, 2u << 2);
  return crystal ? protocol::ClockSource::kCrystal : protocol::ClockSource::kInternal;
}

std::uint32_t timer_hz() { return kTimerMhz * 1'000'000; }

void time_init() {
  tim5().psc = is_emulated ? 999 : kTimerMhz - 1;
  tim5().arr = 0xFFFFFFFF;
  tim5().egr = 1;
  tim5().cr1 = 1;
  tim2().dier = 1;
  nvic_priority(kIrqTim2) = 0x40;
  nvic_iser(kIrqTim2) = bit(kIrqTim2 % 32);
  if (is_emulated) {
    tim2().cr1 = 1;
    tim2().arr = kTickNs;  // no prescaler, no update event: either would change the model's period
    return;
  }
  scb_demcr() = scb_demcr() | bit(24);  // the cycle counter
  dwt_ctrl() = dwt_ctrl() | 1u;
  tim2().cr2 = 2u << 4;  // RM0090 18.4.2: trigger output on update; it starts the slot stream
  tim2().psc = 0;
  tim2().arr = timer_hz() / protocol::kTickHz - 1;
  tim2().egr = 1;
  tim2().sr = 0;
  tim2().cr1 = 1;
}

std::uint32_t tick_late_ns() { return tim2().cnt * 1000 / kTimerMhz; }

std::uint32_t span_begin() { return is_emulated ? tim3().cnt : dwt_cyccnt(); }

std::uint32_t span_ns(std::uint32_t begin) {
  if (is_emulated) return tim3().cnt - begin;
  return (dwt_cyccnt() - begin) * 1000 / kCoreMhz;
}

std::uint32_t emulated_tick_rearm() {
  static std::uint32_t due;
  const std::uint32_t now = tim3().cnt;
  due = due == 0 ? now : due + kTickNs;
  // An emulator that is late catches up at one tick per millisecond.
  const auto wait = static_cast<std::int32_t>(due + kTickNs - now);
  tim2().arr = wait < 1'000'000 ? 1'000'000u : static_cast<std::uint32_t>(wait);
  return due;
}

}  // namespace mixrig::stm32

namespace mixrig::port {

std::uint64_t now_us() {
  // Called at least once per tick, so that no wrap of the counter (71.6 min) is missed.
  static std::uint32_t high;
  static std::uint32_t last;
  const IrqLock lock;
  const std::uint32_t now = stm32::tim5().cnt;
  if (now < last) ++high;
  last = now;
  return std::uint64_t{high} << 32 | now;
}

}  // namespace mixrig::port
