// SPDX-License-Identifier: Apache-2.0
// A board, its serial line and a bootloader driver for tests.
#pragma once

#include <algorithm>

#include "hal/fake/emulated_board.h"
#include "hal/wire/flash/flash_image.h"
#include "hal/wire/flash/stm32_rom.h"
#include "hal/wire/trigger/mcu_link.h"
#include "tests/support/make_image.h"

namespace mixrig::device {

struct FlashBoard {
  ManualClock clock;
  fake::EmulatedBoard board;
  fake::BoardStream stream{board, clock};
  Stm32Rom rom{stream, clock};
  FlashProgress quiet = [](const char*, std::size_t, std::size_t) {};

  /// All steps of `mixrig flash`, whatever runs on the board.
  Result<void> flash(std::span<const std::uint8_t> image) {
    MIXRIG_TRY(enter_bootloader(stream, clock, "test"));
    MIXRIG_ASSIGN(const BootloaderInfo info, rom.connect());
    MIXRIG_TRY(write_flash(rom, info, image, quiet));
    return rom.go(protocol::kFlashBase);
  }
  bool holds(std::span<const std::uint8_t> image) {
    const auto flash = board.flash().bytes().first(image.size());
    return std::equal(flash.begin(), flash.end(), image.begin());
  }
  /// Power-up without BOOT0: whether a program starts that is neither of the two images.
  bool boots_partial_image(std::span<const std::uint8_t> before,
                           std::span<const std::uint8_t> after) {
    board.power_cycle(false);
    return board.mode() == fake::BoardMode::kFirmware && !holds(before) && !holds(after);
  }
};

}  // namespace mixrig::device
