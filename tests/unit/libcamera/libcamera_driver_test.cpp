// SPDX-License-Identifier: Apache-2.0
#include "extras/libcamera/libcamera_driver.h"

#include <gtest/gtest.h>

namespace mixrig::device {
namespace {

TEST(LibcameraDriver, WebcamsAreLeftToV4l2) {
  EXPECT_EQ(without_webcams({"/base/soc/i2c0mux/i2c@1/imx219@10",
                             "\\_SB_.PCI0.GP17.XHC0.RHUB.PRT3-3:1.0-046d:0825"}),
            std::vector<std::string>{"/base/soc/i2c0mux/i2c@1/imx219@10"});
}

}  // namespace
}  // namespace mixrig::device
