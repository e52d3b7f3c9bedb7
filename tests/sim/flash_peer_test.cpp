// SPDX-License-Identifier: Apache-2.0
// Tests our emulated devices with independent programs: stm32flash and dfu-util.
#include <atomic>
#include <cstdio>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "firmware/port/sim/sim_line.h"
#include "hal/fake/emulated_dfuse.h"
#include "hal/fake/emulated_rom.h"
#include "hal/wire/flash/firmware_image.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::device {
namespace {

constexpr int kPeerLimit_s = 120;  // long enough for a busy machine
const std::string kImage = std::string(MIXRIG_IMAGE_DIR) + "/trigger.bin";

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(FlashPeer, stm32flash_writes_verifies_and_starts_our_emulated_rom) {
  const test::TemporaryFolder folder;
  std::string error;
  auto line = sim::SimLine::open_pty(folder / "port", error);
  ASSERT_TRUE(line) << error;
  fake::EmulatedFlash flash;
  fake::EmulatedRom rom(flash);
  std::atomic<bool> stop = false;
  std::thread device([&] {
    std::array<std::uint8_t, 512> buffer;
    while (!stop) {
      const std::size_t n = line->read(buffer, 20'000);
      for (std::size_t i = 0; i < n; ++i) rom.receive(buffer[i]);
      line->write(rom.output());
      rom.output().clear();
    }
  });
  // A pty has no parity bit, hence 8n1 instead of 8e1.
  test::ChildProcess peer({"stm32flash", "-m", "8n1", "-b", "115200", "-w", kImage, "-v", "-g",
                           "0x08000000", folder / "port"},
                          kPeerLimit_s, folder / "log");
  EXPECT_EQ(peer.wait(), 0) << text_of(folder / "log");
  stop = true;
  device.join();
  const auto image = load_image(kImage);
  ASSERT_TRUE(image);
  const auto written = flash.bytes().first(image->bytes.size());
  EXPECT_TRUE(std::equal(written.begin(), written.end(), image->bytes.begin()));
  EXPECT_EQ(rom.gone_to(), protocol::kFlashBase);
}

TEST(FlashPeer, dfu_util_lists_our_emulated_device) {
  const test::TemporaryFolder folder;
  std::string descriptors;
  for (const std::uint8_t byte : fake::EmulatedDfuse::descriptors()) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02X", byte);
    descriptors += digits;
  }
  const std::string device = folder.write(
      "device.umockdev",
      "P: /devices/usb1/1-1\nN: bus/usb/001/002\nE: DEVTYPE=usb_device\nE: DRIVER=usb\n"
      "E: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=002\nE: DEVNAME=/dev/bus/usb/001/002\n"
      "E: PRODUCT=483/df11/200\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=2\\n\n"
      "A: speed=12\\n\nA: idVendor=0483\\n\nA: idProduct=df11\\n\nH: descriptors=" +
          descriptors + "\n");
  test::ChildProcess peer({"umockdev-run", "-d", device, "--", "dfu-util", "-l"}, kPeerLimit_s,
                          folder / "log");
  peer.wait();
  const std::string said = text_of(folder / "log");
  EXPECT_NE(said.find("Found DFU: [0483:df11]"), std::string::npos) << said;
}

}  // namespace
}  // namespace mixrig::device
