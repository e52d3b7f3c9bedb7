// SPDX-License-Identifier: Apache-2.0
// mixrig flash: writes firmware into the trigger controller, over UART or USB.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "hal/linux/libusb_control.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/wire/flash/dfuse.h"
#include "hal/wire/flash/flash_image.h"
#include "hal/wire/flash/stm32_rom.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

using device::BootloaderInfo;

struct FlashArguments {
  std::string image, port = "/dev/ttyUSB0", usb, kept;
  bool verify_only = false, restore = false;
};

/// The connection to the chip. For a serial line also the line, to query the new firmware.
struct Target {
  std::unique_ptr<device::ByteStream> stream;
  std::unique_ptr<device::UsbControl> usb;
  std::unique_ptr<device::Bootloader> bootloader;
  const device::Stm32Rom* rom = nullptr;  ///< the bootloader, over a serial line
  BootloaderInfo info;
};

std::string kept_path(const FlashArguments& arguments) {
  if (!arguments.kept.empty()) return arguments.kept;
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  const std::string base = state != nullptr  ? state
                           : home != nullptr ? std::string(home) + "/.local/state"
                                             : "/var/lib";
  return base + "/mixrig/previous-trigger.bin";
}

/// A progress bar for each step.
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

Result<Target> open_target(const FlashArguments& arguments, Clock& clock) {
  Target target;
  if (!arguments.usb.empty()) {
    MIXRIG_ASSIGN(target.usb, device::open_dfu_device(arguments.usb));
    target.bootloader = std::make_unique<device::Dfuse>(*target.usb, clock);
  } else {
    MIXRIG_ASSIGN(target.stream, device::open_byte_stream(arguments.port));
    MIXRIG_TRY(device::enter_bootloader(*target.stream, clock, arguments.port));
    auto rom = std::make_unique<device::Stm32Rom>(*target.stream, clock);
    target.rom = rom.get();
    target.bootloader = std::move(rom);
  }
  MIXRIG_ASSIGN(target.info, target.bootloader->connect());
  std::printf("%s\n", target.info.name.c_str());
  return target;
}

/// The content to write to flash.
struct Wanted {
  std::vector<std::uint8_t> bytes;
  bool must_answer = false;  ///< a mixrig image with this host's protocol
};

/// An image that passed all checks, or the kept firmware.
Result<Wanted> find_wanted(const FlashArguments& arguments) {
  if (!arguments.restore) {
    MIXRIG_ASSIGN(device::FirmwareImage image, device::load_image(arguments.image));
    std::printf("%s: firmware %s, %zu bytes, crc %08x\n", arguments.image.c_str(),
                device::version_text(image.header).c_str(), image.bytes.size(), image.header.crc);
    return Wanted{std::move(image.bytes), true};
  }
  const std::string path = kept_path(arguments);
  MIXRIG_ASSIGN(std::vector<std::uint8_t> bytes, device::read_image_file(path));
  if (!device::worth_keeping(bytes)) {
    return Error{ErrorCode::kFormat,
                 path + ": holds nothing that would boot: flash an IMAGE instead"};
  }
  if (!device::check_image(bytes, path, {.this_protocol = false})) {
    log_warning("flash", path + " is not a mixrig image; it is restored unchanged");
  }
  const bool must_answer = static_cast<bool>(device::check_image(bytes, path));
  return Wanted{std::move(bytes), must_answer};
}

/// Writes bootable firmware that flash held to a file; returns whether there was any.
Result<bool> keep_previous(const FlashArguments& arguments, const device::PreviousFlash& previous) {
  if (previous.blank || !device::worth_keeping(previous.bytes)) {
    std::printf("nothing bootable in flash: nothing kept\n");
    return false;
  }
  MIXRIG_TRY(device::write_image_file(kept_path(arguments), previous.bytes));
  std::printf("kept the old firmware in %s (mixrig flash --restore)\n",
              kept_path(arguments).c_str());
  return true;
}

/// Starts the firmware that is in flash, after an error before anything was changed. Returns
/// `error`.
Error start_old_firmware(Target& target, Error error) {
  (void)target.bootloader->go(protocol::kFlashBase);
  return error;
}

/// Writes the content unless flash already holds it; keeps the old content first.
Result<nlohmann::json> keep_and_write(Target& target, const FlashArguments& arguments,
                                      const Wanted& wanted) {
  const device::FlashProgress progress = progress_bars();
  MIXRIG_ASSIGN(const device::PreviousFlash previous,
                read_previous(*target.bootloader, target.info, wanted.bytes.size(), progress));
  const bool there = previous.bytes == wanted.bytes;
  nlohmann::json report{{"written", !there}, {"kept", nullptr}};
  if (!there) {
    const auto kept = keep_previous(arguments, previous);
    if (!kept) return start_old_firmware(target, kept.error());
    if (*kept) report["kept"] = kept_path(arguments);
    MIXRIG_TRY(write_flash(*target.bootloader, target.info, wanted.bytes, progress));
  }
  std::printf(there ? "flash holds it: %zu bytes\n" : "written and read back: %zu bytes\n",
              wanted.bytes.size());
  return report;
}

/// Prints and returns the number of commands that were repeated.
int print_noise(const Target& target) {
  const int repeats = target.rom != nullptr ? target.rom->repeats() : 0;
  if (repeats > 0) {
    std::printf("noisy line: %d commands repeated: check cable and ground\n", repeats);
  }
  return repeats;
}

/// Leaves the bootloader; over a serial line, queries the firmware that runs then.
Result<nlohmann::json> start_firmware(Target& target, Clock& clock, const FlashArguments& arguments,
                                      const Wanted& wanted) {
  MIXRIG_TRY(target.bootloader->go(protocol::kFlashBase));
  if (!target.stream || !wanted.must_answer) return nlohmann::json(nullptr);
  MIXRIG_TRY(target.stream->set_line({}));
  // The firmware is still starting: twice the usual number of tries.
  const device::McuLink::RetryPolicy retry{std::chrono::milliseconds(100), 60};
  MIXRIG_ASSIGN(const auto trigger,
                device::McuTrigger::open(std::move(target.stream), clock, arguments.port, retry));
  const device::TriggerInfo& info = trigger->info();
  std::printf("running: firmware %s, crc %08x\n", info.version.c_str(), info.image_crc);
  return nlohmann::json{{"version", info.version}, {"image_crc", info.image_crc}};
}

Result<nlohmann::json> flash(const FlashArguments& arguments) {
  if (arguments.image.empty() != arguments.restore) {
    return Error{ErrorCode::kUsage, "flash: give an IMAGE, or --restore without one"};
  }
  MIXRIG_ASSIGN(const Wanted wanted, find_wanted(arguments));
  SystemClock clock;
  MIXRIG_ASSIGN(Target target, open_target(arguments, clock));
  nlohmann::json report{{"written", false}, {"kept", nullptr}};
  if (arguments.verify_only) {
    const auto same = verify_flash(*target.bootloader, wanted.bytes, progress_bars());
    if (!same) return start_old_firmware(target, same.error());
    std::printf("flash holds it: %zu bytes\n", wanted.bytes.size());
  } else {
    MIXRIG_ASSIGN(report, keep_and_write(target, arguments, wanted));
  }
  report["bytes"] = wanted.bytes.size();
  report["bootloader"] = target.info.name;
  report["commands_repeated"] = print_noise(target);
  MIXRIG_ASSIGN(report["running"], start_firmware(target, clock, arguments, wanted));
  return with_end(std::move(report), {}, "mixrig trigger status --self-test");
}

}  // namespace

void add_flash_command(Command app, Context& context) {
  auto arguments = std::make_shared<FlashArguments>();
  Command command = app.add_subcommand("flash", "write firmware into the trigger controller");
  command.add_option("IMAGE", arguments->image, "firmware/trigger.bin of the build");
  const Option port =
      command.add_option("--port", arguments->port, "serial port of the controller");
  command.add_option("--usb", arguments->usb, "USB bootloader instead, VID:PID (0483:df11)")
      .excludes(port);
  command.add_flag("--verify-only", arguments->verify_only, "compare only, do not write");
  command.add_flag("--restore", arguments->restore, "write back what the last flash replaced");
  command.add_option("--kept", arguments->kept, "where the replaced firmware is kept");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return flash(*arguments); }; });
}

}  // namespace mixrig::tools
