// SPDX-License-Identifier: Apache-2.0
// From reset to main, and from the running firmware to the ROM bootloader.
#include "firmware/port/stm32f4/startup.h"

#include <array>
#include <span>

#include "firmware/app/app.h"
#include "firmware/port/stm32f4/registers.h"
#include "firmware/protocol/image_header.h"

int main();

extern "C" {
extern std::uint32_t stack_top, data_begin, data_end, data_load, bss_begin, bss_end, image_end;
using InitFunction = void (*)();
extern InitFunction init_array_begin[], init_array_end[];
void tim2_handler();
void tim4_handler();
void usart1_handler();
[[noreturn]] void reset_handler();
}

namespace mixrig::stm32 {
namespace {

constexpr std::uint32_t kGoToBootloader = 0xB007B007;
[[gnu::section(".noinit")]] volatile std::uint32_t boot_request;

/// Any fault or unexpected interrupt resets: lines become inputs, the firmware restarts.
[[noreturn]] void fault_handler() { system_reset(protocol::RebootTarget::kFirmware); }

struct VectorTable {
  std::uint32_t* stack;
  std::array<void (*)(), 15 + kIrqCount> handlers;
};
constexpr VectorTable make_vectors() {
  VectorTable table{&stack_top, {}};
  for (auto& handler : table.handlers) handler = fault_handler;
  table.handlers[0] = reset_handler;
  table.handlers[15 + kIrqTim2] = tim2_handler;
  table.handlers[15 + kIrqTim4] = tim4_handler;
  table.handlers[15 + kIrqUsart1] = usart1_handler;
  return table;
}
static_assert(sizeof(VectorTable) <= protocol::kHeaderOffset);

/// AN2606: system memory of the F405 begins at 0x1FFF0000; its first words are stack and entry.
/// Clocks are still as after reset, as the bootloader expects. SYSCFG maps it to 0 (RM0090 9.2.1).
[[noreturn]] void jump_to_bootloader() {
  rcc().apb2enr = rcc().apb2enr | bit(14);
  syscfg_memrmp() = 1;
  asm volatile(
      "ldr r0, =0x1FFF0000\n"
      "ldr r1, [r0]\n"
      "msr msp, r1\n"
      "ldr r0, [r0, #4]\n"
      "bx  r0\n");
  __builtin_unreachable();
}

}  // namespace

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = make_vectors();
static_assert(alignof(VectorTable) <= 512);  // at the start of flash: aligned as VTOR requires

// Size and CRC are written after linking (mixrig-stamp).
[[gnu::section(".image_header"),
  gnu::used]] extern const volatile protocol::ImageHeader image_header = {
    protocol::kImageMagic,
    0xFFFFFFFF,
    0xFFFFFFFF,
    protocol::kTableHash,
    protocol::kBoardF405,
    {firmware::kVersion[0], firmware::kVersion[1], firmware::kVersion[2]},
    0};

bool emulated() { return rcc().cr == 0; }

void system_reset(protocol::RebootTarget target) {
  boot_request = target == protocol::RebootTarget::kBootloader ? kGoToBootloader : 0;
  asm volatile("dsb" ::: "memory");
  scb_aircr() = 0x05FA0004;
  for (;;) {
  }
}

bool image_check(std::uint32_t& crc) {
  const std::uint32_t size = reinterpret_cast<std::uint32_t>(&image_end) - protocol::kFlashBase;
  const auto* image = reinterpret_cast<const std::uint8_t*>(protocol::kFlashBase);
  crc = protocol::image_crc({image, size});
  return image_header.size == size && image_header.crc == crc;
}

}  // namespace mixrig::stm32

void reset_handler() {
  using namespace mixrig::stm32;
  // No memory but boot_request may be used until data and bss are initialised.
  if (boot_request == kGoToBootloader && !emulated()) {
    boot_request = 0;
    jump_to_bootloader();
  }
  boot_request = 0;
  scb_vtor() = reinterpret_cast<std::uint32_t>(&vectors);
  scb_cpacr() = scb_cpacr() | 0xFu << 20;  // the compiler may use FPU registers
  asm volatile("dsb\nisb");
  const std::uint32_t* from = &data_load;
  for (std::uint32_t* to = &data_begin; to < &data_end;) *to++ = *from++;
  for (std::uint32_t* to = &bss_begin; to < &bss_end;) *to++ = 0;
  for (InitFunction* f = init_array_begin; f < init_array_end; ++f) (*f)();
  main();
  system_reset(mixrig::protocol::RebootTarget::kFirmware);
}
