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
  const device::Stm32Rom* rom = nullptr;  ///< the bootloader, over a serial line
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
    auto rom = std::make_unique<device::Stm32Rom>(*target.stream, clock);
    target.rom = rom.get();
    target.bootloader = std::move(rom);
  }
  MIXRIG_ASSIGN(target.info, target.bootloader->connect());
  std::printf("%s\n", target.info.name.c_str());
  return target;
}

/// What flash is to hold.
struct Wanted {
  std::vector<std::uint8_t> bytes;
  bool greets = false;  ///< an image of ours with this host's protocol: it must answer when started
};

/// An image that passed all checks, or what was kept.
Result<Wanted> find_wanted(const Words& words) {
  if (!words.restore) {
    MIXRIG_ASSIGN(device::FirmwareImage image, device::load_image(words.image));
    std::printf("%s: firmware %s, %zu bytes, crc %08x\n", words.image.c_str(),
                device::version_text(image.header).c_str(), image.bytes.size(), image.header.crc);
    return Wanted{std::move(image.bytes), true};
  }
  const std::string path = kept_path(words);
  MIXRIG_ASSIGN(std::vector<std::uint8_t> bytes, device::read_image_file(path));
  if (!device::worth_keeping(bytes)) {
    return Error{ErrorCode::kFormat, path + ": holds nothing that would boot"};
  }
  if (!device::check_image(bytes, path, {.this_protocol = false})) {
    log_warning("flash", path + " is no mixrig image; restored as it was found");
  }
  const bool greets = static_cast<bool>(device::check_image(bytes, path));
  return Wanted{std::move(bytes), greets};
}

/// Returns whether there was anything to keep.
Result<bool> keep_previous(const Words& words, const device::PreviousFlash& previous) {
  if (previous.blank || !device::worth_keeping(previous.bytes)) {
    std::printf("nothing bootable in flash: nothing kept\n");
    return false;
  }
  MIXRIG_TRY(device::write_image_file(kept_path(words), previous.bytes));
  std::printf("kept the old firmware in %s (mixrig flash --restore)\n", kept_path(words).c_str());
  return true;
}

/// Nothing was changed: the board goes on with what it has.
Error leave(Target& target, Error error) {
  (void)target.bootloader->go(protocol::kFlashBase);
  return error;
}

/// Writes what flash does not hold yet, after keeping what it holds.
Result<nlohmann::json> keep_and_write(Target& target, const Words& words, const Wanted& wanted) {
  const device::FlashProgress progress = progress_bars();
  MIXRIG_ASSIGN(const device::PreviousFlash previous,
                read_previous(*target.bootloader, target.info, wanted.bytes.size(), progress));
  const bool there = previous.bytes == wanted.bytes;
  nlohmann::json report{{"written", !there}, {"kept", nullptr}};
  if (!there) {
    const auto kept = keep_previous(words, previous);
    if (!kept) return leave(target, kept.error());
    if (*kept) report["kept"] = kept_path(words);
    MIXRIG_TRY(write_flash(*target.bootloader, target.info, wanted.bytes, progress));
  }
  std::printf(there ? "flash holds it: %zu bytes\n" : "written and read back: %zu bytes\n",
              wanted.bytes.size());
  return report;
}

/// Returns how many commands had to be said again.
int tell_noise(const Target& target) {
  const int repeats = target.rom != nullptr ? target.rom->repeats() : 0;
  if (repeats > 0) {
    std::printf("noisy line: %d commands repeated: check cable and ground\n", repeats);
  }
  return repeats;
}

/// Leaves the bootloader; over a serial line, greets what runs then.
Result<nlohmann::json> start_firmware(Target& target, Clock& clock, const Words& words,
                                      const Wanted& wanted) {
  MIXRIG_TRY(target.bootloader->go(protocol::kFlashBase));
  if (!target.stream || !wanted.greets) return nlohmann::json(nullptr);
  MIXRIG_TRY(target.stream->set_line({}));
  // It has only just been started: twice the patience of everyday.
  const device::McuLink::Patience patience{std::chrono::milliseconds(100), 60};
  MIXRIG_ASSIGN(const auto trigger,
                device::McuTrigger::open(std::move(target.stream), clock, words.port, patience));
  const device::TriggerInfo& info = trigger->info();
  std::printf("running: firmware %s, crc %08x\n", info.version.c_str(), info.image_crc);
  return nlohmann::json{{"version", info.version}, {"image_crc", info.image_crc}};
}

Result<nlohmann::json> flash(const Words& words) {
  if (words.image.empty() != words.restore) {
    return Error{ErrorCode::kUsage, "flash: give an IMAGE, or --restore without one"};
  }
  MIXRIG_ASSIGN(const Wanted wanted, find_wanted(words));
  SystemClock clock;
  MIXRIG_ASSIGN(Target target, open_target(words, clock));
  nlohmann::json report{{"written", false}, {"kept", nullptr}};
  if (words.verify_only) {
    const auto same = verify_flash(*target.bootloader, wanted.bytes, progress_bars());
    if (!same) return leave(target, same.error());
    std::printf("flash holds it: %zu bytes\n", wanted.bytes.size());
  } else {
    MIXRIG_ASSIGN(report, keep_and_write(target, words, wanted));
  }
  report["bytes"] = wanted.bytes.size();
  report["bootloader"] = target.info.name;
  report["commands_repeated"] = tell_noise(target);
  MIXRIG_ASSIGN(report["running"], start_firmware(target, clock, words, wanted));
  return report;
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
