// SPDX-License-Identifier: Apache-2.0
// URIs of devices that extras open.
#include "host/capture/live/rig/devices.h"

#include <array>

#include <gtest/gtest.h>

namespace mixrig::live {
namespace {

/// Reports what it was asked to open.
class AskedDriver final : public DeviceDriver {
 public:
  Result<std::unique_ptr<device::Camera>> camera(const std::string& address,
                                                 const device::StreamRequest&) override {
    return Error{ErrorCode::kNotFound, "asked for camera " + address};
  }
  Result<std::unique_ptr<device::DepthCamera>> depth(const std::string& address,
                                                     const device::StreamRequest&) override {
    return Error{ErrorCode::kNotFound, "asked for depth " + address};
  }
  std::vector<FoundCamera> find() override { return {{"asked:1", {}}}; }
};

DeviceKind asked_kind() {
  DeviceKind kind;
  kind.scheme = "asked", kind.extra = "ask", kind.camera_uri = "asked:NUMBER";
  kind.make = [](Clock&) -> std::unique_ptr<DeviceDriver> {
    return std::make_unique<AskedDriver>();
  };
  return kind;
}

TEST(DeviceKinds, ADriverIsAskedForWhatStandsBehindItsScheme) {
  SystemClock clock;
  const std::array kinds{asked_kind()};
  DeviceOpener opener(clock, {}, kinds);
  EXPECT_EQ(opener.camera("asked:a:b/c", {}).error().context, "asked for camera a:b/c");
  const Error no_depth = opener.depth("asked:1", {}).error();
  EXPECT_EQ(no_depth.code, ErrorCode::kUsage);
  EXPECT_EQ(no_depth.context.find("asked:NUMBER"), std::string::npos) << no_depth.context;
  EXPECT_NE(opener.camera("no:1", {}).error().context.find("asked:NUMBER"), std::string::npos);
  ASSERT_EQ(opener.find().size(), 1U);
}

TEST(DeviceKinds, AnExtraThatIsLeftOutIsNamedWithTheWayToBuildIt) {
  SystemClock clock;
  DeviceKind kind;
  kind.scheme = "asked", kind.extra = "ask";
  const std::array kinds{kind};
  DeviceOpener opener(clock, {}, kinds);
  const std::array errors{opener.camera("asked:1", {}).error(), opener.depth("asked:1", {}).error(),
                          opener.lens("asked:1").error()};
  for (const Error& error : errors) {
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_NE(error.context.find("asked:1"), std::string::npos) << error.context;
    EXPECT_NE(error.context.find("\"ask\""), std::string::npos) << error.context;
    EXPECT_NE(error.context.find("MIXRIG_EXTRAS"), std::string::npos) << error.context;
  }
  EXPECT_TRUE(opener.find().empty());
}

}  // namespace
}  // namespace mixrig::live
