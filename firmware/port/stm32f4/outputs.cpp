// SPDX-License-Identifier: Apache-2.0
// TIM2 generates the master tick and, by its trigger output, starts TIM8; each update of TIM8
// (10 kHz, from the same PLL) makes DMA 2 copy one word to the set/reset register of port C. No
// instruction is involved in an edge.
#include "firmware/port/stm32f4/outputs.h"

#include "firmware/port/port.h"
#include "firmware/port/stm32f4/clocks.h"
#include "firmware/port/stm32f4/registers.h"
#include "firmware/port/stm32f4/startup.h"

namespace mixrig::stm32 {

namespace {

constexpr std::uint32_t kWords = 2 * protocol::kSlotsPerTick;
constexpr std::uint32_t kSlotNs = protocol::kSlotUs * 1000;

bool is_emulated;

/// State of the emulated slot stream.
struct {
  const std::uint32_t* words;
  volatile bool running;
  std::uint32_t half;      // first word of the present tick
  std::uint32_t position;  // next slot of that half
  std::uint32_t tick_ns;
} stream;

/// Starts the DMA (RM0090 10.5.5): 32-bit, memory to peripheral, circular, very high priority,
/// channel 7 of stream 1, which is TIM8's update (table 43). Only DMA 2 reaches the ports (figure
/// 1).
void start_dma(const std::uint32_t* words) {
  DmaStream& s = dma2().stream[1];
  dma2().lifcr = 0x3Fu << 6;
  s.par = reinterpret_cast<std::uint32_t>(&gpioc().bsrr);
  s.m0ar = reinterpret_cast<std::uint32_t>(words);
  s.ndtr = kWords;
  s.fcr = 0;
  s.cr = 7u << 25 | 3u << 16 | 2u << 13 | 2u << 11 | bit(10) | bit(8) | 1u << 6 | bit(0);
}

/// Starts the slot timer in trigger mode on ITR1 (RM0090 17.4), which for TIM8 is TIM2 (table 93).
/// The counter starts one count before an update, so that slot 0 is output when the tick begins.
void start_slot_timer() {
  Timer& t = tim8();
  t.cr1 = 0;
  t.psc = 0;
  t.arr = 2 * timer_hz() / (protocol::kTickHz * protocol::kSlotsPerTick) - 1;
  t.egr = 1;
  t.sr = 0;
  t.cnt = t.arr;
  t.dier = bit(8);
  t.smcr = 1u << 4 | 6u;
}

void stop_stream() {
  tim8().smcr = 0;
  tim8().cr1 = 0;
  tim8().dier = 0;
  DmaStream& s = dma2().stream[1];
  s.cr = 0;
  for (int i = 0; i < 1000 && (s.cr & 1u) != 0; ++i) {
  }
}

/// Outputs the slots that are due and arms TIM4 for the next one that changes a line.
void play_and_arm(std::uint32_t now_ns) {
  const std::uint32_t* words = stream.words + stream.half;
  while (stream.position < protocol::kSlotsPerTick) {
    const std::uint32_t due_ns = stream.tick_ns + stream.position * kSlotNs;
    if (static_cast<std::int32_t>(due_ns - now_ns) > 0) break;
    const std::uint32_t word = words[stream.position++];
    if (word != 0) gpioc().bsrr = word;
  }
  while (stream.position < protocol::kSlotsPerTick && words[stream.position] == 0) {
    ++stream.position;
  }
  if (stream.position == protocol::kSlotsPerTick) {
    tim4().cr1 = 0;
    return;
  }
  tim4().cr1 = 1;
  const std::uint32_t due_ns = stream.tick_ns + stream.position * kSlotNs;
  const auto wait = static_cast<std::int32_t>(due_ns - tim3().cnt);
  tim4().arr = wait > 0 ? static_cast<std::uint32_t>(wait) : 1u;
}

}  // namespace

void outputs_init() {
  is_emulated = emulated();
  gpioc().pupdr = 0xAAAAAAAAu;    // pulled down while not driven
  gpioc().ospeedr = 0x01555555u;  // 25 MHz; PC13..15 stay at 2 MHz, their maximum
  if (!is_emulated) return;
  tim4().dier = 1;
  nvic_priority(kIrqTim4) = 0x20;
  nvic_iser(kIrqTim4) = bit(kIrqTim4 % 32);
}

void emulated_outputs_tick(std::uint32_t tick_ns) {
  if (stream.words == nullptr) return;
  stream.half = stream.running ? protocol::kSlotsPerTick - stream.half : 0;
  stream.running = true;
  stream.position = 0;
  stream.tick_ns = tick_ns;
  play_and_arm(tim3().cnt);
}

void emulated_outputs_slot() {
  tim4().sr = 0;
  if (stream.running) play_and_arm(tim3().cnt);
}

}  // namespace mixrig::stm32

namespace mixrig::port {

using namespace stm32;

void outputs_idle(std::uint32_t idle_word) {
  stream.words = nullptr;
  stream.running = false;
  if (is_emulated) tim4().cr1 = 0;
  stop_stream();
  gpioc().bsrr = idle_word;  // set the level before the output mode: no glitch
  const std::uint32_t mask = (idle_word | idle_word >> 16) & 0xFFFFu;
  std::uint32_t modes = 0;
  for (unsigned line = 0; line < 16; ++line) modes |= (mask >> line & 1u) << (2 * line);
  gpioc().moder = modes;
}

void outputs_start(const std::uint32_t* two_ticks) {
  stream.words = two_ticks;
  stream.running = false;
  if (is_emulated) return;
  start_dma(two_ticks);
  start_slot_timer();
}

bool outputs_running() { return is_emulated ? stream.running : (tim8().cr1 & 1u) != 0; }

std::uint16_t outputs_read(std::uint16_t expected) {
  return is_emulated ? expected : static_cast<std::uint16_t>(gpioc().idr);
}

}  // namespace mixrig::port
