// SPDX-License-Identifier: Apache-2.0
// Edits of a scene that are undone, copied, fitted, and kept as presets.
#include <cmath>
#include <functional>
#include <vector>

#include "hal/base/clock.h"
#include "host/operator/desk/fitted_model.h"
#include "host/operator/desk/preset_desk.h"
#include "host/run/controls/edit_history.h"
#include "tests/unit/run/desk_scene.h"

namespace mixrig::session {
namespace {

TEST_F(Desk, EveryEditIsUndoneAndMadeAgain) {
  const std::vector<std::function<Result<void>()>> edits{
      [&] { return desk_->apply(move_to(0.6, 0.6, false), &from_); },
      [&] { return desk_->apply(page::SetObject{.name = "crate", .turn_rad = 1.0}, nullptr); },
      [&] { return desk_->apply(page::SetObject{.name = "crate", .hidden = true}, nullptr); },
      [&] { return desk_->apply(page::SetObject{.name = "crate", .rename = "box"}, nullptr); },
      [&] { return desk_->apply(page::CopyObject{"box"}, &from_); },
      [&] {
        return desk_->apply(page::AddObject{"tree", folder_.path() / "crate.glb"}, &from_);
      },
      [&] { return desk_->apply(page::RemoveObject{"box"}); },
      [&] { return desk_->apply(page::SetLamp{.name = "key", .on = false}); },
      [&] {
        return desk_->apply(page::AddLamp{.name = "new", .position_m = Eigen::Vector3d(1, 2, 3)},
                            nullptr);
      },
      [&] { return desk_->apply(page::RemoveLamp{"fill"}); },
      [&] { return desk_->apply(page::SetFocus{.distance_m = 2.5}); },
      [&] { return desk_->recall("[light]\nambient = 0.1\n", "night"); }};
  std::vector<std::string> texts{text()};
  for (const auto& edit : edits) {
    const auto done = edit();
    ASSERT_TRUE(done) << to_line(done.error());
    texts.push_back(text());
    EXPECT_NE(texts.back(), texts[texts.size() - 2]);
  }
  EXPECT_EQ(desk_->history().next_undo(), "preset night");
  for (std::size_t i = edits.size(); i-- > 0;) {
    ASSERT_TRUE(desk_->undo());
    EXPECT_EQ(text(), texts[i]);
  }
  EXPECT_EQ(text(), kDeskScene);
  EXPECT_EQ(desk_->undo().error().code, ErrorCode::kData);
  for (std::size_t i = 1; i < texts.size(); ++i) {
    ASSERT_TRUE(desk_->redo());
    EXPECT_EQ(text(), texts[i]);
  }
  EXPECT_EQ(desk_->redo().error().code, ErrorCode::kData);
}

TEST_F(Desk, WhatAnotherProgramWroteIsNotUndone) {
  ASSERT_TRUE(desk_->apply(page::RemoveLamp{"fill"}));
  const std::string by_hand = text() + "# by hand\n";
  write(by_hand);
  const auto refused = desk_->undo();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().context.find("another program has changed scene.toml"),
            std::string::npos);
  EXPECT_EQ(text(), by_hand);
  ASSERT_TRUE(desk_->apply(page::RemoveLamp{"key"}));
  ASSERT_TRUE(desk_->undo());
  EXPECT_EQ(text(), by_hand) << "with what was written by hand";
}

TEST_F(Desk, AFaderIsOneEditAndNewEditsEndWhatWasUndone) {
  ManualClock clock;
  EditHistory history(clock);
  const auto file = folder_.path() / "values";
  const auto put = [&](const std::string& what, const std::string& from, const std::string& to) {
    std::ofstream(file) << to;
    history.add({what, file, from, to, {}, {}});
  };
  put("dim", "0", "1");
  put("dim", "1", "2");
  clock.advance(std::chrono::seconds(2));
  put("dim", "2", "3");
  put("turn", "3", "4");
  ASSERT_TRUE(history.undo());
  EXPECT_EQ(test::read_bytes(file), "3");
  ASSERT_TRUE(history.undo());
  EXPECT_EQ(test::read_bytes(file), "2");
  EXPECT_EQ(history.next_redo(), "dim");
  put("move", "2", "5");
  EXPECT_EQ(history.next_redo(), "");
  ASSERT_TRUE(history.undo());
  ASSERT_TRUE(history.undo());
  EXPECT_EQ(test::read_bytes(file), "0");
}

TEST_F(Desk, ADragThatIsCancelledLeavesNothing) {
  ASSERT_TRUE(desk_->apply(move_to(0.6, 0.6, true), &from_));
  ASSERT_TRUE(desk_->discard());
  EXPECT_LT((desk_->objects(nullptr)[0].position_m - Eigen::Vector3d(2, 3, 0.5)).norm(), 1e-9);
  ASSERT_TRUE(desk_->save());
  EXPECT_EQ(text(), kDeskScene);
}

TEST_F(Desk, ACopyHasAllKeysAndStandsBeside) {
  ASSERT_TRUE(desk_->apply(page::CopyObject{"crate"}, &from_));
  ASSERT_TRUE(desk_->apply(page::CopyObject{"crate 2"}, &from_));
  const auto objects = written().objects;
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[1].name, "crate 2");
  EXPECT_EQ(objects[2].name, "crate 3");
  EXPECT_EQ(objects[1].scale, 2);
  EXPECT_EQ(objects[1].model_path, objects[0].model_path);
  const Eigen::Vector3d moved =
      objects[1].world_from_object.translation_m - objects[0].world_from_object.translation_m;
  EXPECT_NEAR(moved.x(), 2 * 1.0 + 0.05, 1e-5) << "its largest side, at scale 2, and a gap";
  EXPECT_LT(std::hypot(moved.y(), moved.z()), 1e-9);
  EXPECT_EQ(
      desk_->apply(page::SetObject{.name = "crate", .rename = "crate 2"}, nullptr).error().code,
      ErrorCode::kUsage);
}

TEST(FittedModel, IsAsLargeAsThePictureHasRoom) {
  const SeenFrom from = seen_from();
  const Eigen::Vector3d place = point_on_level(from, {0.5, 0.8}, 0).value();
  const double shown_m = 1.01 * (inverse(from.world_from_view) * place).z();
  for (const double side_m : {0.001, 0.3, 180.0}) {  // metres that are metres, and what are not
    scene::Object object;
    const auto s = static_cast<float>(side_m);
    object.model.meshes.emplace_back().positions_m = {{s, s, s}, {2 * s, 1.5F * s, 2 * s}};
    fit(object, from, place);
    const double wanted_m = side_m < 0.05 ? 0.1 * shown_m : side_m > 1 ? 0.5 * shown_m : side_m;
    EXPECT_NEAR(object.scale * side_m, wanted_m, 0.05 * wanted_m) << side_m;
    const Eigen::Vector3d low =
        object.world_from_object * (object.scale * Eigen::Vector3d(1.5, 1.25, 1) * side_m);
    EXPECT_LT((low - place).norm(), 1e-6) << side_m;
  }
}

TEST_F(Desk, APresetIsStoredComparedAndRecalled) {
  session_.scene = scene::load_scene(file()).value();
  PresetDesk presets(session_, *desk_);
  EXPECT_TRUE(presets.presets().empty());
  ASSERT_TRUE(presets.apply(page::StorePreset{"day"}));
  EXPECT_EQ(presets.apply(page::StorePreset{"day"}).error().code, ErrorCode::kUsage);
  ASSERT_TRUE(presets.apply(page::StorePreset{"day", true}));
  ASSERT_EQ(presets.presets().size(), 1U);
  EXPECT_TRUE(presets.presets()[0].differences.empty());
  // A night of another program, with other lamps.
  std::filesystem::create_directories(folder_.path() / "presets");
  std::ofstream(folder_.path() / "presets/night.toml")
      << "[[object]]\nname = \"crate\"\nmodel = \"crate.glb\"\nposition_m = [2.0, 4.0, 0.5]\n"
         "yaw_deg = 10.0\nscale = 2.0\n\n[[light.lamp]]\nname = \"moon\"\n"
         "position_m = [0.0, 0.0, 9.0]\nintensity = 0.1\n\n[focus]\ndistance_m = 2.0\n";
  const auto states = presets.presets();
  ASSERT_EQ(states.size(), 2U);
  EXPECT_EQ(states[1].name, "night");
  EXPECT_EQ(states[1].differences,
            (std::vector<std::string>{"crate: moved by 1.00 m", "moon: is there, now not",
                                      "key: is not there, now is", "fill: is not there, now is",
                                      "depth of field: 2.00 m, f/2.8, now off"}));
  ASSERT_TRUE(presets.apply(page::RecallPreset{"night"}));
  EXPECT_EQ(written().light.lamps.at(0).name, "moon");
  EXPECT_EQ(text().substr(0, 8), "# a set\n");
  EXPECT_NE(text().find("pose = \"take\""), std::string::npos) << "the rest stays";
  ASSERT_TRUE(presets.apply(page::RecallPreset{"day"}));
  EXPECT_EQ(written().light.lamps.at(0).name, "key");
  EXPECT_NE(text().find("# ours"), std::string::npos);
  std::ofstream(folder_.path() / "presets/bad.toml") << "[camera]\npose = \"identity\"\n";
  const std::string before = text();
  EXPECT_EQ(presets.apply(page::RecallPreset{"bad"}).error().code, ErrorCode::kFormat);
  EXPECT_EQ(presets.apply(page::RecallPreset{"none"}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(text(), before);
  ASSERT_TRUE(presets.apply(page::RemovePreset{"night"}));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "presets/night.toml"));
}

TEST_F(Desk, ModelsBesideASceneHaveAQuota) {
  const std::filesystem::path old = folder_.write("models/old.glb", "");
  std::filesystem::resize_file(old, std::uintmax_t{1} << 30);  // no blocks of the disk
  const std::string before = text();
  const page::AddObject add{"tree", folder_.path() / "crate.glb"};
  EXPECT_TRUE(test::refused(desk_->apply(add, &from_), {"models", "more than 1 GiB", "remove"}));
  EXPECT_EQ(text(), before);
  std::filesystem::remove(old);
  EXPECT_TRUE(desk_->apply(add, &from_));
}

TEST_F(Desk, AModelThatIsNoneIsSaidInTheUsersWords) {
  std::ofstream(folder_.path() / "bad.glb") << "no model";
  const auto refused = desk_->apply(page::AddObject{"tree", folder_.path() / "bad.glb"}, &from_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().context, "the model \"tree\" is no glTF file: use .gltf or .glb");
}

}  // namespace
}  // namespace mixrig::session
