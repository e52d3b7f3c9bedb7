// SPDX-License-Identifier: Apache-2.0
// The checks of a grey card before a camera whose exposure takes effect frames later, in injected
// time.
#include "host/capture/live/check/grey_card.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

constexpr Size kCardPicture{80, 60};
constexpr double kCardRest_s = 8e-3;

/// A camera of 25 Hz before a grey card, with every fault.
class CardCamera final : public device::Camera {
 public:
  explicit CardCamera(ManualClock& clock) : clock_(clock) {
    info_.uri = "test:camera";
    info_.format = device::PixelFormat::kRgb8;
    info_.controls = {{device::CameraControl::kExposure, 1e-4, 0.1, 1e-5}};
  }
  const device::CameraInfo& info() const override { return info_; }
  Result<void> start(device::FrameSink) override { return {}; }
  void stop() override {}
  Result<void> set(device::CameraControl control, double value) override {
    if (control != device::CameraControl::kExposure) return {};
    if (refuses && value < kCardRest_s) return Error{ErrorCode::kDevice, "test:camera: refused"};
    if (!deaf) shown_s_ = value;
    told_s = value;
    return {};
  }
  Result<double> get(device::CameraControl control) override {
    if (control == device::CameraControl::kWhiteBalance && white_balance) return 4600.0;
    if (control == device::CameraControl::kExposure) return told_s;
    return Error{ErrorCode::kUnsupported, "test:camera: no such control"};
  }
  device::StreamHealth health() const override { return {}; }

  Result<device::FramePtr> next() {
    clock_.advance(40ms);
    if (silent) return device::FramePtr();
    if (++frames_ == fails_at) return Error{ErrorCode::kDevice, "the cameras have ended"};
    const double exposure_s = pending_[0];
    std::rotate(pending_.begin(), pending_.begin() + 1, pending_.end());
    pending_.back() = shown_s_;
    return frame(exposure_s / kCardRest_s);
  }

  device::CameraInfo info_;
  double gamma = 1;  ///< sample = light ^ (1 / gamma)
  std::array<double, 3> light{0.4, 0.6, 0.5};
  bool refuses = false, deaf = false, silent = false, white_balance = false;
  int fails_at = 0;
  double told_s = kCardRest_s;

 private:
  struct Owned {
    std::vector<std::uint8_t> bytes;
    device::Frame frame;
  };
  device::FramePtr frame(double brighter) const {
    auto owned = std::make_shared<Owned>();
    for (int i = 0; i < 3 * kCardPicture.width * kCardPicture.height; ++i) {
      const int x = i / 3 % kCardPicture.width;
      const double card = x < 20 ? 0.9 : light[static_cast<std::size_t>(i % 3)] * brighter;
      // Ordered dither in place of noise.
      const double dither = (i / 3 * 7 % 16) / 16.0;
      owned->bytes.push_back(static_cast<std::uint8_t>(
          std::min(255.0, 255 * std::pow(std::min(card, 1.0), 1 / gamma) + dither)));
    }
    owned->frame = {.format = device::PixelFormat::kRgb8,
                    .size = kCardPicture,
                    .stride_bytes = 3U * kCardPicture.width,
                    .bytes = owned->bytes,
                    .sequence = static_cast<std::uint64_t>(frames_)};
    return {owned, &owned->frame};
  }

  ManualClock& clock_;
  double shown_s_ = kCardRest_s;
  std::array<double, 3> pending_{kCardRest_s, kCardRest_s, kCardRest_s};
  int frames_ = 0;
};

class CardChecks : public ::testing::Test {
 protected:
  CardChecks() { config_.name = "color"; }
  const Check& run(const std::string& what,
                   const std::optional<capture::CardArea>& area = std::nullopt) {
    checks_ = check_card(
        config_, camera_, area, [this] { return camera_.next(); }, clock_);
    for (const Check& check : checks_)
      if (check.what == what) return check;
    ADD_FAILURE() << "no check of " << what;
    static const Check kNone;
    return kNone;
  }
  bool has(const std::string& what) const {
    return std::any_of(checks_.begin(), checks_.end(),
                       [&](const Check& check) { return check.what == what; });
  }

  ManualClock clock_;
  CardCamera camera_{clock_};
  CameraConfig config_;
  std::vector<Check> checks_;
};

TEST_F(CardChecks, ALinearCameraIsFoundAndTheLinesMakeItPass) {
  const Check transfer = run("transfer");
  EXPECT_EQ(transfer.verdict, Verdict::kFail);
  EXPECT_NE(transfer.value.find("srgb: "), std::string::npos) << transfer.value;
  EXPECT_NE(transfer.advice.find("[[camera]] \"color\" of rig.toml: transfer = \"linear\""),
            std::string::npos)
      << transfer.advice;
  EXPECT_NE(run("grey").advice.find("white_gains = [1.50"), std::string::npos)
      << run("grey").advice;
  EXPECT_EQ(camera_.told_s, kCardRest_s) << "put back";

  config_.color.transfer = device::Transfer::kLinear;
  config_.color.white_gains = {1.5, 1, 1.2};
  EXPECT_EQ(run("transfer").verdict, Verdict::kPass);
  ASSERT_EQ(checks_.size(), 3U);
  for (const Check& check : checks_) {
    EXPECT_EQ(check.verdict, Verdict::kPass) << check.what << ": " << check.value;
    EXPECT_TRUE(check.advice.empty()) << check.advice;
  }
}

TEST_F(CardChecks, AGammaIsGivenByItsValue) {
  camera_.gamma = 1.5;
  const Check transfer = run("transfer");
  EXPECT_EQ(transfer.verdict, Verdict::kFail);
  EXPECT_NE(transfer.advice.find("transfer = \"gamma\", gamma = 1."), std::string::npos)
      << transfer.advice;
}

TEST_F(CardChecks, TheLinesAreWhatRigTomlReads) {
  camera_.white_balance = true;
  const std::string grey = run("grey").advice;
  const std::string words = grey.substr(grey.find("white_gains"));
  std::string lines = words;
  lines.replace(lines.find(", white_balance_k"), 2, "\n");
  const auto rig =
      parse_rig("format = 1\n[[camera]]\nuri = \"v4l2:x\"\n" + lines + "\n", "rig.toml");
  ASSERT_TRUE(rig) << rig.error().context;
  EXPECT_EQ(rig->cameras[0].white_balance_k, 4600);
  EXPECT_NEAR(rig->cameras[0].color.white_gains[0], 1.5, 0.02);
}

TEST_F(CardChecks, WithoutAnExposureControlTheGreyIsStillJudged) {
  camera_.info_.controls.clear();
  config_.color.transfer = device::Transfer::kLinear;
  EXPECT_EQ(run("transfer").verdict, Verdict::kWarn);
  EXPECT_TRUE(has("grey"));
}

TEST_F(CardChecks, ACardThatIsTooBrightOrTooDarkIsNotJudged) {
  camera_.light = {0.5, 1.2, 0.5};
  EXPECT_EQ(run("card").verdict, Verdict::kFail);
  EXPECT_NE(checks_[0].advice.find("lower exposure_ms"), std::string::npos);
  camera_.light = {0.05, 0.05, 0.05};
  EXPECT_EQ(run("card").verdict, Verdict::kFail);
  EXPECT_NE(checks_[0].advice.find("raise exposure_ms"), std::string::npos);
  EXPECT_EQ(checks_.size(), 1U);
  camera_.light = {0.2, 0.2, 0.2};  // enough, but not at a quarter of it
  EXPECT_EQ(run("transfer").verdict, Verdict::kWarn);
  EXPECT_NE(checks_[1].advice.find("at 2 ms"), std::string::npos) << checks_[1].advice;
}

TEST_F(CardChecks, TheAreaIsTheCardsAndHasToLieInThePicture) {
  const std::string across = run("card", capture::CardArea{10, 0, {20, 20}}).advice;
  EXPECT_NE(across.find("does not look like one card"), std::string::npos) << across;
  EXPECT_NE(run("grey", capture::CardArea{0, 0, {20, 20}}).value.find("R/G 1.000"),
            std::string::npos);
  const Check& outside = run("card", capture::CardArea{70, 50, {11, 10}});
  EXPECT_EQ(outside.verdict, Verdict::kFail);
  EXPECT_NE(outside.advice.find("70,50,11,10 reaches beyond the picture of 80x60"),
            std::string::npos)
      << outside.advice;
}

TEST_F(CardChecks, ACameraThatDoesNotFollowIsNamedAndPutBack) {
  camera_.deaf = true;
  EXPECT_NE(run("transfer").advice.find("does not change with the exposure"), std::string::npos);
  camera_.deaf = false, camera_.refuses = true;
  EXPECT_NE(run("transfer").advice.find("refused"), std::string::npos);
  EXPECT_EQ(camera_.told_s, kCardRest_s);
  camera_.refuses = false, camera_.info_.controls[0].minimum = 4e-3;
  EXPECT_NE(run("transfer").advice.find("raise exposure_ms"), std::string::npos);
}

TEST_F(CardChecks, ACameraThatEndsOrIsSilentDoesNotHang) {
  camera_.fails_at = 40;
  EXPECT_NE(run("transfer").advice.find("have ended"), std::string::npos);
  EXPECT_EQ(camera_.told_s, kCardRest_s);
  camera_.silent = true;
  EXPECT_NE(run("card").advice.find("sends no whole picture"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::live
