// SPDX-License-Identifier: Apache-2.0
// The focus that an operator chooses must be sharp in the pictures of the run.
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host/run/loop/run.h"
#include "tests/support/box_source.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

constexpr int kEmpty = 3, kFrames = 8;
const glm::ivec2 kBoxPixel(32, 24), kWallPixel(5, 5);

using FramePictures = std::vector<std::vector<Rgb8>>;

class KeptPictures final : public output::CompositeSink {
 public:
  KeptPictures(FramePictures& kept, std::function<void()> between)
      : kept_(kept), between_(std::move(between)) {}
  std::string_view name() const override { return "kept"; }
  render::OutputMask wanted(int number) const override {
    if (number == kEmpty + 3 && between_) std::exchange(between_, nullptr)();
    return render::kColor;
  }
  Result<void> write(const output::CompositePtr& composite) override {
    const Image<Rgb8>& color = composite->images.color;
    std::vector<Rgb8>& pixels = kept_.emplace_back();
    for (int y = 0; y < color.height(); ++y)
      pixels.insert(pixels.end(), color.row(y), color.row(y) + color.width());
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  FramePictures& kept_;
  mutable std::function<void()> between_;
};

class FocusRun : public ::testing::Test {
 protected:
  void save(const std::string& focus) {
    path_ = folder_.write("scene.toml",
                          "[camera]\npose = \"identity\"\n[background]\nlearn = [1, 3]\n" + focus);
  }
  /// The last picture of a run that is sharp there from its start; `between` is called before the
  /// third one.
  std::vector<Rgb8> last_picture(std::optional<glm::ivec2> focus_px = {},
                                 std::function<void()> between = nullptr) {
    Session session;
    session.scene = scene::load_scene(path_).value();
    session.source = std::make_unique<test::BoxSource>(kEmpty, kFrames);
    session.setup = *setup_of(session.source->info(), std::nullopt);
    session.meshes = mesh_arrays(session.scene);
    set_scene(session.scene, session.meshes, session.setup);
    session.backend = {render::Backend::kCpu, 1};
    RunOptions options;
    options.judge = false, options.focus_px = focus_px;
    RunParts parts;
    parts.orders = &orders_, parts.scene = std::make_shared<SceneFollower>(session, false);
    FramePictures kept;
    parts.sinks.push_back(std::make_unique<KeptPictures>(kept, std::move(between)));
    const SystemClock clock;
    const auto report = run(session, options, clock, {}, std::move(parts));
    EXPECT_TRUE(report) << report.error().context;
    return kept.empty() ? std::vector<Rgb8>{} : kept.back();
  }
  static int most_difference(const std::vector<Rgb8>& a, const std::vector<Rgb8>& b) {
    int most = a.size() == b.size() ? 0 : 255;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      most = std::max(
          {most, std::abs(a[i].r - b[i].r), std::abs(a[i].g - b[i].g), std::abs(a[i].b - b[i].b)});
    return most;
  }
  static std::string at_m(const std::string& distance) {
    return "[focus]\nf_number = 0.5\nsensor_width_mm = 200\n"
           "most_blur_pct = 15\ndistance_m = " +
           distance + "\n";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
};

TEST_F(FocusRun, AClickTakesThePlaceOfTheScenesDistance) {
  save("");
  const auto sharp = last_picture();
  save(at_m("3.0"));
  const auto wall = last_picture();
  EXPECT_TRUE(orders_.state().can_focus);
  EXPECT_GT(most_difference(wall, sharp), 30) << "the edges of the box are blurred";
  EXPECT_LT(most_difference(last_picture(kBoxPixel), sharp), 10) << "only an even wall is";
  EXPECT_EQ(most_difference(last_picture(kWallPixel), wall), 0) << "the wall is at 3 m";
  ASSERT_TRUE(orders_.give(output::FocusAt{kBoxPixel}));
  const auto ordered = last_picture();
  EXPECT_TRUE(ordered == last_picture(kBoxPixel));
  EXPECT_FALSE(orders_.waits<output::FocusAt>());
}

TEST_F(FocusRun, WhatTheSceneSaysNewlyTakesThePlaceOfAClick) {
  save(at_m("3.0"));
  const auto wall = last_picture();
  EXPECT_FALSE(last_picture(kBoxPixel) == wall);
  save(at_m("2.0"));
  EXPECT_TRUE(last_picture(kBoxPixel, [&] { save(at_m("3.0")); }) == wall);
  EXPECT_FALSE(orders_.state().focus_px);
}

TEST_F(FocusRun, AFocusThatComesAndGoesWhileItRuns) {
  save("");
  const auto sharp = last_picture(kBoxPixel);
  EXPECT_FALSE(orders_.state().can_focus);
  save(at_m("3.0"));
  const auto focused = last_picture();
  EXPECT_FALSE(focused == sharp);
  EXPECT_TRUE(last_picture({}, [&] { save(""); }) == sharp);
  save("");
  EXPECT_TRUE(last_picture({}, [&] { save(at_m("3.0")); }) == focused);
  EXPECT_TRUE(orders_.state().can_focus);
}

}  // namespace
}  // namespace mixrig::session
