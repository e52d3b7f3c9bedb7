// SPDX-License-Identifier: Apache-2.0
// Flashing over USB DfuSe, with an emulated device behind UsbControl.
#include "hal/wire/flash/dfuse.h"

#include <gtest/gtest.h>

#include "hal/fake/emulated_dfuse.h"
#include "hal/wire/flash/flash_image.h"
#include "tests/support/make_image.h"

namespace mixrig::device {
namespace {

struct UsbBoard {
  ManualClock clock;
  fake::EmulatedFlash flash;
  fake::EmulatedDfuse usb{flash};
  Dfuse dfuse{usb, clock};
  FlashProgress quiet = [](const char*, std::size_t, std::size_t) {};

  Result<void> write(std::span<const std::uint8_t> image) {
    MIXRIG_ASSIGN(const BootloaderInfo info, dfuse.connect());
    MIXRIG_TRY(write_flash(dfuse, info, image, quiet));
    return dfuse.go(protocol::kFlashBase);
  }
  bool holds(std::span<const std::uint8_t> image) {
    const auto bytes = flash.bytes().first(image.size());
    return std::equal(bytes.begin(), bytes.end(), image.begin());
  }
};

const std::vector<std::uint8_t> kImage = make_image(8800, 1);

TEST(DfuseTest, writes_reads_back_and_leaves) {
  UsbBoard b;
  const auto done = b.write(kImage);
  ASSERT_TRUE(done) << to_line(done.error());
  EXPECT_TRUE(b.holds(kImage));
  EXPECT_EQ(b.usb.gone_to(), protocol::kFlashBase);
}

TEST(DfuseTest, reads_what_was_there_before) {
  UsbBoard b;
  const auto old = make_image(5000, 2);
  b.flash.load(old);
  const auto info = b.dfuse.connect();
  ASSERT_TRUE(info);
  EXPECT_EQ(read_previous(b.dfuse, *info, 8800, b.quiet)->bytes, old);
}

TEST(DfuseTest, stall_at_any_request_is_an_error_and_the_next_flash_works) {
  int requests = 0;
  for (int stall = 1; stall < 10'000; ++stall) {
    UsbBoard b;
    b.usb.stall_at(stall);
    const auto done = b.write(kImage);
    if (b.usb.requests() < stall) break;
    requests = stall;
    if (!done) {
      EXPECT_FALSE(done.error().context.empty());
      b.usb.reset();
      ASSERT_TRUE(b.write(kImage)) << "stall at " << stall;
    }
    ASSERT_TRUE(b.holds(kImage)) << "stall at " << stall;
  }
  EXPECT_GT(requests, 100);
}

TEST(DfuseTest, power_loss_at_every_change_leaves_no_vectors_or_a_whole_image) {
  int changes = 0;
  for (int change = 1; change < 1000; ++change) {
    UsbBoard b;
    b.flash.fail_power_at(change);
    const auto done = b.write(kImage);
    if (b.flash.powered()) break;
    changes = change;
    ASSERT_FALSE(done);
    const std::uint8_t* entry = b.flash.bytes().data() + 4;
    const bool bootable = entry[0] != 0xFF || entry[1] != 0xFF || entry[3] != 0xFF;
    ASSERT_TRUE(!bootable || b.holds(kImage)) << change;
    b.flash.power_on();
    b.usb.reset();
    ASSERT_TRUE(b.write(kImage));
  }
  EXPECT_GT(changes, 5);
}

TEST(DfuseTest, recovers_a_device_left_in_the_middle_of_an_upload) {
  UsbBoard b;
  std::uint8_t some[16];
  ASSERT_TRUE(b.usb.receive(2, 2, some));
  EXPECT_TRUE(b.dfuse.connect());
}

TEST(DfuseTest, another_chip_is_refused_before_anything_is_erased) {
  UsbBoard b;
  b.usb.set_layout("@Internal Flash  /0x08000000/064*0002Kg");
  const auto done = b.write(kImage);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().context.find("wrong board"), std::string::npos);
  EXPECT_EQ(b.flash.changes(), 0);
}

TEST(DfuseTest, a_refusal_is_a_sentence) {
  UsbBoard b;
  ASSERT_TRUE(b.dfuse.connect());
  const auto done = b.dfuse.erase({0x08000001, 16});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().context,
            "USB bootloader refused to erase an address range that is no sector");
}

TEST(MemoryLayout, is_read_as_in_the_application_note) {
  const auto sectors =
      parse_memory_layout("@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg");
  ASSERT_EQ(sectors.size(), 12u);
  EXPECT_EQ(sectors[4], (FlashSector{0x08010000, 65536}));
  EXPECT_EQ(sectors[11], (FlashSector{0x080E0000, 131072}));
  EXPECT_EQ(parse_memory_layout("@Two /0x0800/1*512Bg/0x9000/2*1Mg").size(), 3u);
  EXPECT_TRUE(parse_memory_layout("@Read only/0x1FFF7800/01*512 a").empty());
}

TEST(MemoryLayout, malformed_text_gives_no_sectors) {
  for (const char* text :
       {"", "@", "@x", "x/0x0/1*1Kg", "@x/0x", "@x/0xG/1*1Kg", "@x/0x0/", "@x/0x0/1", "@x/0x0/1*",
        "@x/0x0/1*1", "@x/0x0/1*1K", "@x/0x0/1*1Kg,", "@x/0x0/1*1Kgg", "@x/0x0/99999*1Kg",
        "@x/0xFFFFFF00/9*9Mg", "@x/0x0/1*0Kg", "@x/0x0/99999999999*1Kg"}) {
    EXPECT_TRUE(parse_memory_layout(text).empty()) << text;
  }
}

}  // namespace
}  // namespace mixrig::device
