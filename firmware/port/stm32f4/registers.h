// SPDX-License-Identifier: Apache-2.0
// The registers that this port uses, from the reference manual RM0090 and the Cortex-M4 manual.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mixrig::stm32 {

using Register = volatile std::uint32_t;

struct Rcc {
  Register cr, pllcfgr, cfgr, cir, ahb1rstr, reserved0[7], ahb1enr, ahb2enr, ahb3enr, reserved1,
      apb1enr, apb2enr, reserved2[10], bdcr, csr;
};
struct Gpio {
  Register moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afrl, afrh;
};
struct Usart {
  Register sr, dr, brr, cr1, cr2, cr3, gtpr;
};
struct Timer {
  Register cr1, cr2, smcr, dier, sr, egr, ccmr1, ccmr2, ccer, cnt, psc, arr, rcr, ccr[4], bdtr, dcr,
      dmar, option;
};
struct DmaStream {
  Register cr, ndtr, par, m0ar, m1ar, fcr;
};
struct Dma {
  Register lisr, hisr, lifcr, hifcr;
  DmaStream stream[8];
};
struct FlashInterface {
  Register acr, keyr, optkeyr, sr, cr, optcr;
};
struct Iwdg {
  Register kr, pr, rlr, sr;
};
static_assert(offsetof(Rcc, ahb1enr) == 0x30 && offsetof(Rcc, apb2enr) == 0x44);
static_assert(offsetof(Rcc, csr) == 0x74);
static_assert(offsetof(Gpio, bsrr) == 0x18 && offsetof(Gpio, afrh) == 0x24);
static_assert(offsetof(Timer, cnt) == 0x24 && offsetof(Timer, bdtr) == 0x44);
static_assert(offsetof(Dma, stream) == 0x10 && sizeof(DmaStream) == 0x18);

template <typename T>
inline T& at(std::uint32_t address) {
  return *reinterpret_cast<T*>(address);
}

// RM0090 section 2.3, memory map.
inline Timer& tim2() { return at<Timer>(0x40000000); }
inline Timer& tim3() { return at<Timer>(0x40000400); }
inline Timer& tim4() { return at<Timer>(0x40000800); }
inline Timer& tim5() { return at<Timer>(0x40000C00); }
inline Timer& tim8() { return at<Timer>(0x40010400); }
inline Iwdg& iwdg() { return at<Iwdg>(0x40003000); }
inline Register& pwr_cr() { return at<Register>(0x40007000); }
inline Usart& usart1() { return at<Usart>(0x40011000); }
inline Register& syscfg_memrmp() { return at<Register>(0x40013800); }
inline Gpio& gpioa() { return at<Gpio>(0x40020000); }
inline Gpio& gpioc() { return at<Gpio>(0x40020800); }
inline Rcc& rcc() { return at<Rcc>(0x40023800); }
inline FlashInterface& flash_interface() { return at<FlashInterface>(0x40023C00); }
inline Dma& dma2() { return at<Dma>(0x40026400); }
inline const volatile std::uint8_t* unique_id() {
  return &at<const volatile std::uint8_t>(0x1FFF7A10);
}

// Cortex-M4: interrupt controller, system control, cycle counter.
inline Register& nvic_iser(unsigned irq) { return at<Register>(0xE000E100 + irq / 32 * 4); }
inline volatile std::uint8_t& nvic_priority(unsigned irq) {
  return at<volatile std::uint8_t>(0xE000E400 + irq);
}
inline Register& scb_vtor() { return at<Register>(0xE000ED08); }
inline Register& scb_aircr() { return at<Register>(0xE000ED0C); }
inline Register& scb_cpacr() { return at<Register>(0xE000ED88); }
inline Register& scb_demcr() { return at<Register>(0xE000EDFC); }
inline Register& dwt_ctrl() { return at<Register>(0xE0001000); }
inline Register& dwt_cyccnt() { return at<Register>(0xE0001004); }

inline constexpr std::uint32_t bit(unsigned n) { return 1u << n; }

/// Interrupt numbers, RM0090 table 62.
inline constexpr unsigned kIrqTim2 = 28;
inline constexpr unsigned kIrqTim4 = 30;
inline constexpr unsigned kIrqUsart1 = 37;
inline constexpr unsigned kIrqCount = 82;

}  // namespace mixrig::stm32
