// SPDX-License-Identifier: Apache-2.0
// mixrig flash: puts firmware into the trigger controller, over UART or USB.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include "hal/base/log.h"
#include "hal/linux/dfuse.h"
#include "hal/linux/flash_image.h"
#include "hal/linux/libusb_control.h"
#include "hal/linux/mcu_trigger.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/linux/stm32_rom.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

using device::BootloaderInfo;

struct Words {
  std::string image, port = "/dev/ttyUSB0", usb, kept;
  bool verify_only = false, restore = false;
};

/// A way to the chip. For a serial line, also the line, to greet what was flashed.
struct Target {
  std::unique_ptr<device::ByteStream> stream;
  std::unique_ptr<device::UsbControl> usb;
  std::unique_ptr<device::Bootloader> bootloader;
  BootloaderInfo info;
};

std::string kept_path(const Words& words) {
  if (!words.kept.empty()) return words.kept;
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  const std::string base = state != nullptr  ? state
                           : home != nullptr ? std::string(home) + "/.local/state"
                                             : "/var/lib";
  return base + "/mixrig/previous-trigger.bin";
}

/// A bar for each step of the work.
device::FlashProgress progress_bars() {
  struct State {
    std::string what;
    std::optional<Progress> bar;
  };
  auto state = std::make_shared<State>();
  return [state](const char* what, std::size_t done, std::size_t total) {
    if (state->what != what || !state->bar) {
      state->bar.reset();
      state->what = what;
      state->bar.emplace(what, static_cast<int>(total));
    }
    state->bar->step(static_cast<int>(done));
    if (done == total) state->bar.reset();
  };
}

Result<Target> open_target(const Words& words, Clock& clock) {
  Target target;
  if (!words.usb.empty()) {
    MIXRIG_ASSIGN(target.usb, device::open_dfu_device(words.usb));
    target.bootloader = std::make_unique<device::Dfuse>(*target.usb, clock);
  } else {
    MIXRIG_ASSIGN(target.stream, device::open_byte_stream(words.port));
    MIXRIG_TRY(device::enter_bootloader(*target.stream, clock, words.port));
    target.bootloader = std::make_unique<device::Stm32Rom>(*target.stream, clock);
  }
  MIXRIG_ASSIGN(target.info, target.bootloader->connect());
  std::printf("%s\n", target.info.name.c_str());
  return target;
}

/// The bytes to write: an image that passed all checks, or what was kept.
Result<std::vector<std::uint8_t>> wanted_bytes(const Words& words) {
  if (!words.restore) {
    MIXRIG_ASSIGN(device::FirmwareImage image, device::load_image(words.image));
    std::printf("%s: firmware %s, %zu bytes, crc %08x\n", words.image.c_str(),
                device::version_text(image.header).c_str(), image.bytes.size(), image.header.crc);
    return std::move(image.bytes);
  }
  const std::string path = kept_path(words);
  MIXRIG_ASSIGN(std::vector<std::uint8_t> bytes, device::read_image_file(path));
  if (!device::worth_keeping(bytes)) {
    return Error{ErrorCode::kFormat, path + ": holds nothing that would boot"};
  }
  if (!device::check_image(bytes, path, {.this_protocol = false})) {
    log_warning("flash", path + " is no mixrig image; restored as it was found");
  }
  return bytes;
}

Result<void> keep_previous(const Words& words, const device::PreviousFlash& previous) {
  if (previous.blank || !device::worth_keeping(previous.bytes)) {
    std::printf("nothing bootable in flash: nothing kept\n");
    return {};
  }
  MIXRIG_TRY(device::write_image_file(kept_path(words), previous.bytes));
  std::printf("kept the old firmware in %s (mixrig flash --restore)\n", kept_path(words).c_str());
  return {};
}

/// Leaves the bootloader; over a serial line, greets what runs then.
Result<void> start_firmware(Target& target, Clock& clock, const Words& words) {
  MIXRIG_TRY(target.bootloader->go(protocol::kFlashBase));
  if (!target.stream || words.restore) return {};
  MIXRIG_TRY(target.stream->set_line({}));
  MIXRIG_ASSIGN(const auto trigger,
                device::McuTrigger::open(std::move(target.stream), clock, words.port));
  std::printf("running: firmware %s, crc %08x\n", trigger->info().version.c_str(),
              trigger->info().image_crc);
  return {};
}

Result<nlohmann::json> flash(const Words& words) {
  if (words.image.empty() != words.restore) {
    return Error{ErrorCode::kUsage, "flash: give an IMAGE, or --restore without one"};
  }
  MIXRIG_ASSIGN(const std::vector<std::uint8_t> bytes, wanted_bytes(words));
  SystemClock clock;
  const device::FlashProgress progress = progress_bars();
  MIXRIG_ASSIGN(Target target, open_target(words, clock));
  bool written = false;
  if (words.verify_only) {
    MIXRIG_TRY(verify_flash(*target.bootloader, bytes, progress));
  } else {
    MIXRIG_ASSIGN(const device::PreviousFlash previous,
                  read_previous(*target.bootloader, target.info, bytes.size(), progress));
    written = previous.bytes != bytes;
    if (written) {
      MIXRIG_TRY(keep_previous(words, previous));
      MIXRIG_TRY(write_flash(*target.bootloader, target.info, bytes, progress));
    }
  }
  std::printf(written ? "written and read back: %zu bytes\n" : "flash holds it: %zu bytes\n",
              bytes.size());
  MIXRIG_TRY(start_firmware(target, clock, words));
  return nlohmann::json{
      {"bytes", bytes.size()}, {"written", written}, {"bootloader", target.info.name}};
}

}  // namespace

void add_flash_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command = app.add_subcommand("flash", "write firmware into the trigger controller");
  command->add_option("image", words->image, "firmware/trigger.bin of the build");
  auto* port = command->add_option("--port", words->port, "serial port of the controller");
  command->add_option("--usb", words->usb, "USB bootloader instead, VID:PID (0483:df11)")
      ->excludes(port);
  command->add_flag("--verify-only", words->verify_only, "compare, write nothing");
  command->add_flag("--restore", words->restore, "write back what the last flash replaced");
  command->add_option("--kept", words->kept, "where the replaced firmware is kept");
  command->callback([&context, words] { context.action = [words] { return flash(*words); }; });
}

}  // namespace mixrig::tools
