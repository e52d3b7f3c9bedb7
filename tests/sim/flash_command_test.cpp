// SPDX-License-Identifier: Apache-2.0
// The command `mixrig flash` against emulated boards behind a pty.
#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "board_server.h"
#include "hal/wire/flash/firmware_image.h"
#include "run_command.h"
#include "tests/support/make_image.h"

namespace mixrig::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

const std::string kImage = std::string(MIXRIG_IMAGE_DIR) + "/trigger.bin";

Bytes image_bytes() { return *device::read_image_file(kImage); }

protocol::ImageHeader header_of(const Bytes& image) {
  protocol::ImageHeader header;
  std::memcpy(&header, image.data() + protocol::kHeaderOffset, sizeof header);
  return header;
}

/// Copies the program with another header, and hence another checksum.
Bytes with_header(void (*change)(protocol::ImageHeader&)) {
  Bytes image = image_bytes();
  protocol::ImageHeader header = header_of(image);
  change(header);
  device::stamp(image, header);
  return image;
}
Bytes second_image() {
  return with_header([](protocol::ImageHeader& h) { h.version[2] = 99; });
}

template <typename Board>
bool holds(Board& board, const Bytes& image) {
  const auto flash = board.flash().bytes().first(image.size());
  return std::equal(flash.begin(), flash.end(), image.begin());
}

std::string hex8(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "%08x", value);
  return text;
}

template <typename Board>
class Bench : public ::testing::Test {
 protected:
  std::string save(const std::string& name, const Bytes& bytes) {
    return folder_.write(name,
                         std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  Outcome flash(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "flash");
    arguments.insert(arguments.end(), {"--port", folder_ / "port", "--kept", folder_ / "kept.bin"});
    return run_mixrig(arguments);
  }
  Outcome trigger(const std::string& what) {
    return run_mixrig({"trigger", what, "--port", folder_ / "port"});
  }
  nlohmann::json report(const std::string& name) const {
    return nlohmann::json::parse(read_bytes(folder_ / name));
  }

  TemporaryFolder folder_;
  PtyServer<Board> server_{folder_ / "port"};
};

class FlashCommand : public Bench<RealTimeBoard> {
 protected:
  /// Starts running firmware, as after an earlier flash.
  void run(const Bytes& image) {
    server_.with([&](RealTimeBoard& board) {
      board.flash().load(image);
      board.power_cycle(false);
    });
  }
  int changes() {
    return server_.with([](RealTimeBoard& board) { return board.flash().changes(); });
  }
  bool flash_holds(const Bytes& image) {
    return server_.with([&](RealTimeBoard& board) { return holds(board, image); });
  }
  bool runs_firmware() {
    return server_.with(
        [](RealTimeBoard& board) { return board.mode() == fake::BoardMode::kFirmware; });
  }
  /// Expects one error line, the given exit status, nothing written, and firmware that still runs.
  void expect_refusal(const Outcome& outcome, int status, const std::string& text) {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_TRUE(outcome.says(text)) << outcome.err;
    EXPECT_EQ(changes(), 0);
    EXPECT_TRUE(runs_firmware());
  }
};

TEST_F(FlashCommand, empty_board_is_written_started_and_answers_hello) {
  server_.with([](RealTimeBoard& board) { board.power_cycle(true); });
  const Outcome outcome = flash({kImage, "--json", folder_ / "report.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto crc = header_of(image_bytes()).crc;
  for (const std::string& text :
       {std::string("chip 0x413"), std::string("nothing kept"),
        std::string("written and read back"), "running: firmware 0.1.0, crc " + hex8(crc)}) {
    EXPECT_TRUE(outcome.says(text)) << text << "\n" << outcome.out;
  }
  EXPECT_TRUE(flash_holds(image_bytes()));
  const auto json = report("report.json");
  EXPECT_EQ(json["written"], true);
  EXPECT_EQ(json["bytes"], image_bytes().size());
  EXPECT_EQ(json["kept"], nullptr);
  EXPECT_EQ(json["running"]["image_crc"], crc);
}

TEST_F(FlashCommand, enters_the_bootloader_by_itself_keeps_the_old_image_and_restores_it) {
  const Bytes old = second_image();
  run(old);
  const Outcome written = flash({kImage, "--json", folder_ / "report.json"});
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_TRUE(flash_holds(image_bytes()));
  EXPECT_EQ(*device::read_image_file(folder_ / "kept.bin"), old);
  EXPECT_EQ(report("report.json")["kept"], (folder_ / "kept.bin").string());

  const Outcome restored = flash({"--restore"});
  ASSERT_EQ(restored.status, 0) << restored.err;
  EXPECT_TRUE(flash_holds(old));
  EXPECT_TRUE(restored.says("crc " + hex8(header_of(old).crc))) << restored.out;
  EXPECT_EQ(*device::read_image_file(folder_ / "kept.bin"), image_bytes())
      << "--restore saves the replaced image too";
}

TEST_F(FlashCommand, an_image_that_flash_holds_already_is_not_written_again) {
  run(image_bytes());
  const Outcome outcome = flash({kImage});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(outcome.says("flash holds it"));
  EXPECT_EQ(changes(), 0);
  EXPECT_TRUE(runs_firmware());
}

TEST_F(FlashCommand, verify_only_compares_writes_nothing_and_restarts_the_firmware) {
  run(image_bytes());
  const Outcome same = flash({kImage, "--verify-only"});
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_TRUE(same.says("flash holds it"));
  const Outcome other = flash({save("other.bin", second_image()), "--verify-only"});
  ASSERT_TRUE(wait_until([&] { return runs_firmware(); }));
  expect_refusal(other, 1, "flash differs from the image at 0x0800020");
  EXPECT_EQ(trigger("status").status, 0);
}

TEST_F(FlashCommand, files_that_are_no_image_for_this_board_are_refused_before_it_is_touched) {
  const Bytes good = image_bytes();
  run(second_image());
  Bytes damaged = good;
  damaged[3000] ^= 1;
  const Bytes wrong_board = with_header([](protocol::ImageHeader& h) { h.board = 407; });
  const Bytes other_protocol = with_header([](protocol::ImageHeader& h) { h.table_hash ^= 1; });
  expect_refusal(flash({folder_ / "missing.bin"}), 2, "cannot open image");
  expect_refusal(flash({save("empty.bin", {})}), 2, "is no mixrig trigger image");
  expect_refusal(flash({save("noise.bin", Bytes(5000, 0x5A))}), 2, "is no mixrig trigger image");
  expect_refusal(flash({save("large.bin", Bytes(200'000, 1))}), 2, "is larger than any image");
  expect_refusal(flash({save("damaged.bin", damaged)}), 2, "checksum does not match");
  expect_refusal(flash({save("board.bin", wrong_board)}), 2, "is for board 407");
  expect_refusal(flash({save("other_protocol.bin", other_protocol)}), 2, "uses another protocol");
  expect_refusal(flash({save("cut.bin", {good.begin(), good.end() - 500})}), 2, "truncated");
  expect_refusal(flash({"--restore"}), 2, "cannot open image");
  save("kept.bin", {good.begin(), good.begin() + 4000});
  expect_refusal(flash({"--restore"}), 2, "holds nothing that would boot");
  EXPECT_EQ(trigger("status").status, 0);
}

TEST_F(FlashCommand, contradicting_options_are_usage_errors) {
  run(image_bytes());
  expect_refusal(flash({}), 2, "give an IMAGE, or --restore");
  expect_refusal(flash({kImage, "--restore"}), 2, "give an IMAGE, or --restore");
  expect_refusal(flash({kImage, "--usb", "0483:df11"}), 2, "--usb");
  for (const char* id : {"malformed", "0483:", "99999:1"}) {
    expect_refusal(run_mixrig({"flash", kImage, "--usb", id}), 2, "VID:PID");
  }
  expect_refusal(flash({kImage, "--json", folder_ / "no/such/report.json"}), 2, "make it first");
}

TEST_F(FlashCommand, another_chip_is_refused_before_anything_is_erased) {
  server_.with([](RealTimeBoard& board) {
    board.rom().chip_id = 0x410;
    board.power_cycle(true);
  });
  const Outcome outcome = flash({kImage});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  EXPECT_TRUE(outcome.says("wrong board: chip 0x410")) << outcome.err;
  EXPECT_EQ(changes(), 0);
}

TEST_F(FlashCommand, running_triggers_are_not_interrupted) {
  run(second_image());
  ASSERT_EQ(trigger("start").status, 0);
  expect_refusal(flash({kImage}), 1, "stop them first (mixrig trigger stop)");
  ASSERT_EQ(trigger("stop").status, 0);
  EXPECT_EQ(flash({kImage}).status, 0);
}

TEST_F(FlashCommand, a_board_that_is_dead_or_missing_is_one_line) {
  const Outcome dead = flash({kImage});  // blank and without BOOT0
  EXPECT_EQ(dead.status, 1);
  EXPECT_EQ(dead.error_lines(), 1) << dead.err;
  EXPECT_TRUE(dead.says("neither firmware nor bootloader answers")) << dead.err;
  const Outcome missing = run_mixrig({"flash", kImage, "--port", folder_ / "nothing"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_EQ(missing.error_lines(), 1) << missing.err;
}

TEST_F(FlashCommand, an_old_image_that_cannot_be_saved_is_not_erased) {
  run(second_image());
  folder_.write("file", "in the way");
  const Outcome outcome = run_mixrig(
      {"flash", kImage, "--port", folder_ / "port", "--kept", folder_ / "file/kept.bin"});
  ASSERT_TRUE(wait_until([&] { return runs_firmware(); }));
  expect_refusal(outcome, 1, "cannot write");
}

TEST_F(FlashCommand, a_power_failure_is_reported_and_recovered_from_with_boot0) {
  run(second_image());
  server_.with([](RealTimeBoard& board) { board.flash().fail_power_at(10); });
  const Outcome cut = flash({kImage});
  EXPECT_EQ(cut.status, 1);
  EXPECT_EQ(cut.error_lines(), 1) << cut.err;
  EXPECT_TRUE(cut.says("flash again, with BOOT0 held at reset")) << cut.err;
  server_.with([](RealTimeBoard& board) { board.power_cycle(true); });
  EXPECT_EQ(flash({kImage}).status, 0);
  EXPECT_TRUE(flash_holds(image_bytes()));
  EXPECT_EQ(*device::read_image_file(folder_ / "kept.bin"), second_image());
}

TEST_F(FlashCommand, a_noisy_line_works_and_repeats_are_reported) {
  run(second_image());
  server_.with([](RealTimeBoard& board) { board.byte_error_share = 0.002; });
  const Outcome outcome = flash({kImage, "--json", folder_ / "report.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(flash_holds(image_bytes()));
  EXPECT_EQ(*device::read_image_file(folder_ / "kept.bin"), second_image());
  EXPECT_TRUE(outcome.says("noisy line: ")) << outcome.out;
  EXPECT_GT(report("report.json")["commands_repeated"], 5);
}

TEST_F(FlashCommand, shows_a_progress_bar_on_a_terminal_and_clears_it) {
  server_.with([](RealTimeBoard& board) { board.power_cycle(true); });
  const Outcome outcome = run_mixrig_at_terminal(
      {"flash", kImage, "--port", folder_ / "port", "--kept", folder_ / "kept.bin"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* text : {"erase [", "write [", "verify [", "#] "}) {
    EXPECT_TRUE(outcome.says(text)) << text;
  }
  ASSERT_GE(outcome.err.size(), 4u);
  EXPECT_EQ(outcome.err.substr(outcome.err.size() - 4), "\r\033[K");
}

#ifdef MIXRIG_HAVE_STM32FLASH
TEST_F(FlashCommand, stm32flash_reads_what_was_written) {
  server_.with([](RealTimeBoard& board) { board.power_cycle(true); });
  const Outcome outcome = flash({kImage});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  server_.with([](RealTimeBoard& board) { board.power_cycle(true); });
  const Bytes image = image_bytes();
  ChildProcess peer({"stm32flash", "-m", "8n1", "-b", "115200", "-r", folder_ / "read.bin", "-S",
                     "0x08000000:" + std::to_string(image.size()), folder_ / "port"},
                    kCommandLimit_s, folder_ / "log");
  ASSERT_EQ(peer.wait(), 0) << read_bytes(folder_ / "log");
  EXPECT_EQ(*device::read_image_file(folder_ / "read.bin"), image);
}
#endif

#ifdef MIXRIG_HAVE_QEMU_ARM
using FlashToQemu = Bench<QemuBoard>;

/// Flash, boot, hello, reboot to the bootloader, flash another, restore the first: every image was
/// written by the command and runs on an emulated STM32F405.
TEST_F(FlashToQemu, boots_the_written_image_and_flashes_again_from_running_firmware) {
  const Bytes first = image_bytes(), second = second_image();
  int boots = 0;
  const auto expect_running = [&](const Outcome& outcome, const Bytes& image) {
    ASSERT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    EXPECT_TRUE(outcome.says("running: firmware 0.1.0, crc " + hex8(header_of(image).crc)))
        << outcome.out;
    EXPECT_TRUE(server_.with([&](QemuBoard& board) { return holds(board, image); }));
    EXPECT_EQ(server_.with([](QemuBoard& board) { return board.boots(); }), ++boots);
  };
  ASSERT_NO_FATAL_FAILURE(expect_running(flash({kImage}), first));
  const Outcome status = trigger("status");
  EXPECT_EQ(status.status, 0) << status.err;
  EXPECT_TRUE(status.says("image " + hex8(header_of(first).crc))) << status.out;
  ASSERT_NO_FATAL_FAILURE(expect_running(flash({save("second.bin", second)}), second));
  EXPECT_EQ(*device::read_image_file(folder_ / "kept.bin"), first);
  ASSERT_NO_FATAL_FAILURE(expect_running(flash({"--restore"}), first));
}
#endif

}  // namespace
}  // namespace mixrig::test
