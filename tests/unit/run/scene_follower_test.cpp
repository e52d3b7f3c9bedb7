// SPDX-License-Identifier: Apache-2.0
// A scene that is saved while it runs: composited from the next frame on as if it had been so.
#include "host/run/controls/scene_follower.h"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/run/loop/run.h"
#include "tests/support/box_source.h"
#include "tests/support/hand_gltf.h"
#include "tests/support/progress.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/throw_in.h"

namespace mixrig::session {
namespace {

constexpr int kEmptyFrames = 3, kLastFrame = 9, kEditAt = 7;

using Pixels = std::vector<Rgb8>;

/// A triangle before the camera, seen from both sides, in glTF's axes.
std::string a_triangle() {
  return test::glb(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "materials":[{"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.1,0.8,0.2,1]}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "buffers":[{"byteLength":44}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})",
      test::floats({-0.4F, 0, 0.4F, 0.4F, 0, 0.4F, 0, 0, -0.4F}) + test::shorts({0, 1, 2}));
}

const std::string kHead =
    "[camera]\npose = \"identity\"\n[background]\nlearn = [1, 3]\n"
    "[light]\nambient = 0.5\n[[light.lamp]]\nname = \"key\"\nposition_m = [0.5, -0.5, 0.5]\n";

std::string object(const std::string& name, const std::string& lines) {
  return "[[object]]\nname = \"" + name + "\"\nmodel = \"t.glb\"\n" + lines + "\n";
}

const std::string kThing = object("thing", "position_m = [-0.5, 0, 2.5]");

/// Keeps the pictures; does something before the frame after one, on the compositing thread.
class Pictures final : public output::CompositeSink {
 public:
  Pictures(std::map<int, Pixels>& kept, std::function<void()> change)
      : kept_(kept), change_(std::move(change)) {}
  std::string_view name() const override { return "pictures"; }
  render::OutputMask wanted(int number) const override {
    if (number == kEditAt && change_) std::exchange(change_, nullptr)();
    return render::kColor;
  }
  Result<void> write(const output::CompositePtr& composite) override {
    const Image<Rgb8>& color = composite->images.color;
    Pixels& pixels = kept_[composite->capture->number];
    for (int y = 0; y < color.height(); ++y)
      pixels.insert(pixels.end(), color.row(y), color.row(y) + color.width());
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  std::map<int, Pixels>& kept_;
  mutable std::function<void()> change_;
};

class SceneFollowerTest : public ::testing::TestWithParam<render::Backend> {
 protected:
  SceneFollowerTest() { folder_.write("t.glb", a_triangle()); }

  void save(const std::string& text) { path_ = folder_.write("scene.toml", text); }

  /// Pictures of a run that begins with the scene as it is saved.
  std::map<int, Pixels> run_it(std::function<void()> change = nullptr) {
    Session session;
    auto scene = scene::load_scene(path_);
    EXPECT_TRUE(scene) << scene.error().context;
    session.scene = *std::move(scene);
    session.source = std::make_unique<test::BoxSource>(kEmptyFrames, kLastFrame);
    session.setup = *setup_of(session.source->info(), std::nullopt);
    session.meshes = mesh_arrays(session.scene);
    set_scene(session.scene, session.meshes, session.setup);
    session.backend = {GetParam(), 1};
    std::map<int, Pixels> kept;
    RunOptions options;
    options.judge = false;
    RunParts parts;
    parts.scene = follower_ = std::make_shared<SceneFollower>(session, false);
    parts.sinks.push_back(std::make_unique<Pictures>(kept, std::move(change)));
    const SystemClock clock;
    auto report = run(session, options, clock, {}, std::move(parts));
    EXPECT_TRUE(report) << report.error().context;
    if (report) report_ = *std::move(report);
    EXPECT_EQ(kept.size(), static_cast<std::size_t>(kLastFrame - kEmptyFrames)) << "no frame lost";
    return kept;
  }

  /// Pictures of a run with this scene from beginning to end.
  const std::map<int, Pixels>& pictures_of(const std::string& text) {
    save(text);
    const auto [found, is_new] = of_text_.try_emplace(text);
    if (is_new) found->second = run_it();
    return found->second;
  }

  /// A run in which the scene is saved anew shows the old one, then the new one.
  void expect_followed(const std::string& from, const std::string& to) {
    const auto &after = pictures_of(to), &before = pictures_of(from);
    const auto kept = run_it([&] { save(to); });
    EXPECT_TRUE(kept.at(kEditAt) == before.at(kEditAt)) << to;
    for (int number = kEditAt + 1; number <= kLastFrame; ++number)
      EXPECT_TRUE(kept.at(number) == after.at(number)) << to << number;
    EXPECT_FALSE(before.at(kLastFrame) == after.at(kLastFrame)) << "it can be seen: " << to;
    EXPECT_EQ(report_.compositor.scene_edits->taken, 1U);
    EXPECT_EQ(report_.compositor.scene_edits->refused, 0U);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::map<std::string, std::map<int, Pixels>> of_text_;
  std::shared_ptr<SceneFollower> follower_;
  RunReport report_;
};

/// Cases that do not depend on the back end.
class SceneFollowerOnCpu : public SceneFollowerTest {};

TEST_P(SceneFollowerTest, WhatIsSavedIsComposited) {
  const std::string from = kHead + kThing;
  expect_followed(from, kHead + object("thing", "position_m = [0.3, 0, 2.5]"));
  expect_followed(from, kHead + object("thing", "position_m = [-0.5, 0, 2.5]\nscale = 1.5"));
  expect_followed(from, kHead + object("thing", "position_m = [-0.5, 0, 2.5]\nhidden = true"));
  expect_followed(from, kHead + kThing + object("second", "position_m = [0.5, 0, 2.5]"));
  expect_followed(from, kHead);
  expect_followed(kHead, from);
  expect_followed(from, kHead + "intensity = 0.2\n" + kThing);
  expect_followed(from, kHead + "[[light.lamp]]\nposition_m = [0, 0.5, 0.5]\n" + kThing);
}

TEST_P(SceneFollowerOnCpu, AFileThatCannotBeReadIsLeftAlone) {
  const auto& before = pictures_of(kHead + kThing);
  const auto kept = run_it([&] { save(kHead + "[[object]]\nname = 7\n"); });
  EXPECT_TRUE(kept == before);
  EXPECT_EQ(report_.compositor.scene_edits->taken, 0U);
  EXPECT_EQ(report_.compositor.scene_edits->refused, 1U);
  EXPECT_EQ(to_json(report_).at("scene_edits").at("refused"), 1);
  save(kHead + kThing);
  EXPECT_TRUE(run_it([&] { std::filesystem::remove(path_); }) == before);
}

TEST_P(SceneFollowerTest, ASceneThatCannotBeDrawnIsLeftAlone) {
  std::string lamps = kHead + kThing;
  for (int i = 0; i < 40; ++i) lamps += "[[light.lamp]]\nposition_m = [0, 0.5, 0.5]\n";
  const auto& before = pictures_of(kHead + kThing);
  const auto kept = run_it([&] { save(lamps); });
  const bool is_drawn = GetParam() == render::Backend::kCpu;  // gles draws 32 lamps at most
  EXPECT_EQ(kept == before, !is_drawn);
  EXPECT_EQ(report_.compositor.scene_edits->taken, is_drawn ? 1U : 0U);
  EXPECT_EQ(report_.compositor.scene_edits->refused, is_drawn ? 0U : 1U);
}

TEST_P(SceneFollowerOnCpu, WhatARunTakesOnceStays) {
  const auto& before = pictures_of(kHead + kThing);
  std::string other = kHead + kThing;
  other.replace(other.find("learn = [1, 3]"), 14, "walls = \"open\"");
  const auto kept = run_it([&] { save(other); });
  EXPECT_TRUE(kept == before);
  EXPECT_EQ(report_.compositor.scene_edits->taken, 1U);
}

TEST_P(SceneFollowerTest, APreviewIsSeenAtOnceAndEndsWithTheNextSave) {
  // Ambient light by direction stays that of the place where the compositor was made.
  const std::string head =
      "[camera]\npose = \"identity\"\n[background]\nlearn = [1, 3]\n"
      "[light]\nambient = 0.5\nambient_by = \"constant\"\n"
      "[[light.lamp]]\nname = \"key\"\nposition_m = [0.5, -0.5, 0.5]\n";
  const std::string moved = head + object("thing", "position_m = [0.3, 0, 2.5]");
  const auto &after = pictures_of(moved), &before = pictures_of(head + kThing);
  save(head + kThing);
  const auto kept = run_it([&] {
    follower_->preview_object("thing", {Eigen::Quaterniond::Identity(), {0.3, 0, 2.5}});
    follower_->preview_object("nobody", {});
  });
  EXPECT_TRUE(kept.at(kEditAt) == before.at(kEditAt));
  EXPECT_TRUE(kept.at(kEditAt + 1) == after.at(kEditAt + 1));
  EXPECT_TRUE(kept.at(kLastFrame) == after.at(kLastFrame));
  EXPECT_EQ(report_.compositor.scene_edits->taken, 0U);
  const auto again = run_it([&] {
    follower_->preview_object("thing", {Eigen::Quaterniond::Identity(), {0, 0, 2.9}});
    follower_->preview_lamp("key", {0.1F, 0.1F, 0.1F});
    save(moved);
  });
  EXPECT_TRUE(again.at(kEditAt + 1) == after.at(kEditAt + 1));
}

TEST_P(SceneFollowerTest, ALampIsDimmedAtOnce) {
  const auto& after = pictures_of(kHead + "intensity = 0.25\n" + kThing);
  save(kHead + kThing);
  const auto kept = run_it([&] { follower_->preview_lamp("key", {0.25F, 0.25F, 0.25F}); });
  EXPECT_TRUE(kept.at(kLastFrame) == after.at(kLastFrame));
}

INSTANTIATE_TEST_SUITE_P(Cpu, SceneFollowerOnCpu, ::testing::Values(render::Backend::kCpu));
INSTANTIATE_TEST_SUITE_P(Backends, SceneFollowerTest,
                         ::testing::Values(render::Backend::kCpu, render::Backend::kGles),
                         [](const auto& param) {
                           return param.param == render::Backend::kCpu ? "cpu" : "gles";
                         });

/// A separate thread reads the file; a file that is still being written is not read.
TEST(LiveSceneFollower, ReadsWhatWasSaved) {
  const test::TemporaryFolder folder;
  folder.write("t.glb", a_triangle());
  Session session;
  session.scene = *scene::load_scene(folder.write("scene.toml", kHead + kThing));
  SceneFollower follower(session, true);
  EXPECT_EQ(follower.take_edited(), nullptr);
  folder.write("scene.toml", kHead + kThing + object("second", "position_m = [0.5, 0, 2.5]"));
  ASSERT_TRUE(test::comes_true([&] { return follower.edits().taken == 1; }));
  const EditedScenePtr edited = follower.take_edited();
  ASSERT_NE(edited, nullptr);
  EXPECT_EQ(edited->scene.objects.size(), 2U);
  EXPECT_EQ(follower.take_edited(), nullptr);
}

TEST(LiveSceneFollower, WhatItsThreadThrowsIsLoggedAndTheNextSaveIsRead) {
  const test::TemporaryFolder folder;
  folder.write("t.glb", a_triangle());
  Session session;
  session.scene = *scene::load_scene(folder.write("scene.toml", kHead + kThing));
  const test::ThrowIn thrown("reading the scene");
  SceneFollower follower(session, true);
  EXPECT_TRUE(
      test::comes_true([] { return test::logged("reading the scene: no memory is left"); }));
  folder.write("scene.toml", kHead + kThing + object("second", "position_m = [0.5, 0, 2.5]"));
  EXPECT_TRUE(test::comes_true([&] { return follower.edits().taken == 1; }));
}

/// With [events], objects may be moved, but neither added nor scaled.
TEST(TouchedSceneFollower, ObjectsMayOnlyBeMoved) {
  const test::TemporaryFolder folder;
  folder.write("t.glb", a_triangle());
  const std::string head = kHead + "[events]\n";
  Session session;
  session.scene = *scene::load_scene(folder.write("scene.toml", head + kThing));
  SceneFollower follower(session, false);
  folder.write("scene.toml", head + object("second", "position_m = [0.5, 0, 2.5]") +
                                 object("thing", "position_m = [0.1, 0, 2.5]\nscale = 3.0"));
  const EditedScenePtr edited = follower.take_edited();
  ASSERT_NE(edited, nullptr);
  ASSERT_EQ(edited->scene.objects.size(), 1U);
  EXPECT_EQ(edited->scene.objects[0].scale, 1);
  EXPECT_EQ(edited->scene.objects[0].world_from_object.translation_m.x(), 0.1);
}

}  // namespace
}  // namespace mixrig::session
