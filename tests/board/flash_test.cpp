// SPDX-License-Identifier: Apache-2.0
// mixrig flash and dfu-util on the same emulated USB bootloader: each reads back byte by byte what
// the other wrote.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/board/bench.h"
#include "tests/board/dfuse_device.h"

namespace mixrig::board {
namespace {

constexpr const char* kImage = "/tmp/bin/trigger.bin";
constexpr const char* kUtil = "dfu-util -d 0483:df11 -a 0 ";

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Flash : public ::testing::Test {
 protected:
  void SetUp() override {
    image_ = bytes_of(kImage);
    if (image_.empty()) GTEST_SKIP() << "no firmware image: it needs arm-none-eabi-g++";
    plug();
  }
  /// Plugs the board in as after a power cycle with BOOT0 high.
  void plug() {
    const auto plugged = port_.plug();
    ASSERT_TRUE(plugged) << to_line(plugged.error());
    ASSERT_TRUE(wait_until(
        [] { return run(std::string(kUtil) + "-l").text.find("Found DFU") != std::string::npos; }));
  }
  std::string in_flash() {
    const auto bytes = device_.flash().read(fake::EmulatedFlash::kBase, image_.size());
    return {bytes.begin(), bytes.end()};
  }
  void upload(const std::string& path) {
    std::filesystem::remove(path);
    const Ran ran = run(kUtil + ("-s 0x08000000:" + std::to_string(image_.size())) + " -U " + path);
    ASSERT_EQ(ran.status, 0) << ran.text;
  }

  std::string image_;
  DfuseDevice device_;
  VhciPort port_{4, device_};
};

TEST_F(Flash, DfuUtilReadsBackWhatMixrigWrote) {
  const Ran written =
      run(std::string("mixrig flash --usb 0483:df11 --kept /tmp/kept.bin ") + kImage);
  ASSERT_EQ(written.status, 0) << written.text;
  port_.unplug();  // it started the firmware
  EXPECT_TRUE(in_flash() == image_);
  plug();
  upload("/tmp/back.bin");
  EXPECT_TRUE(bytes_of("/tmp/back.bin") == image_);
  measured("%zu bytes written by mixrig, byte-identical in flash and in dfu-util's read-back",
           image_.size());
}

TEST_F(Flash, MixrigVerifiesWhatDfuUtilWrote) {
  const Ran written = run(std::string(kUtil) + "-s 0x08000000 -D " + kImage);
  ASSERT_EQ(written.status, 0) << written.text;
  const Ran verified = run(std::string("mixrig flash --usb 0483:df11 --verify-only ") + kImage);
  EXPECT_EQ(verified.status, 0) << verified.text;
  port_.unplug();
  EXPECT_TRUE(in_flash() == image_);
  measured("%zu bytes written by dfu-util, byte-identical in flash, verified by mixrig",
           image_.size());
}

TEST_F(Flash, ADamagedImageIsRefusedBeforeAnythingIsErased) {
  std::string damaged = image_;
  damaged[damaged.size() / 2] ^= 1;
  std::ofstream("/tmp/damaged.bin", std::ios::binary) << damaged;
  const Ran ran = run("mixrig flash --usb 0483:df11 /tmp/damaged.bin");
  EXPECT_NE(ran.status, 0) << ran.text;
  port_.unplug();
  EXPECT_EQ(device_.flash().changes(), 0);
}

}  // namespace
}  // namespace mixrig::board
