// SPDX-License-Identifier: Apache-2.0
// A room of boxes by formula, seen five times a second: what is a change, and what is not.
#include "host/room/changes/room_watch.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"

namespace mixrig::model {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kWatchRate_hz = 5;

struct WatchedBlock {
  Vector3d center_m, size_m;
  Array3d albedo{0.4, 0.3, 0.2};
};

/// Distance along a ray, infinity without a hit; slabs.
double hit_block(const WatchedBlock& block, const Vector3d& from, const Vector3d& ray) {
  const Array3d a = (block.center_m - 0.5 * block.size_m - from).array() / ray.array();
  const Array3d b = (block.center_m + 0.5 * block.size_m - from).array() / ray.array();
  const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
  return in < out && in > 0 ? in : INFINITY;
}

using RoomLight = std::function<Array3d(const Vector3d& place_m)>;
Array3d as_scanned(const Vector3d&) { return Array3d::Ones(); }

/// A camera in a room of 5 x 4 x 2.6 m, whose walls are blocks too.
class WatchedRoom : public ::testing::Test {
 protected:
  WatchedRoom() {
    const auto wall = [&](Vector3d center, Vector3d size, Array3d albedo) {
      walls_.push_back({center, size, albedo});
    };
    wall({0, 2, -0.05}, {5, 6, 0.1}, {0.3, 0.25, 0.2});
    wall({0, 4.05, 1.3}, {5, 0.1, 2.6}, {0.5, 0.5, 0.45});
    wall({-2.55, 2, 1.3}, {0.1, 6, 2.6}, {0.45, 0.5, 0.5});
    wall({2.55, 2, 1.3}, {0.1, 6, 2.6}, {0.5, 0.45, 0.5});
    wall({0, 2, 2.65}, {5, 6, 0.1}, {0.6, 0.6, 0.6});
  }

  void look_from(const Vector3d& eye_m, const Vector3d& at_m) {
    world_from_view_ = geometry::look_at(eye_m, at_m, Vector3d::UnitZ());
  }

  /// Gives one frame of the objects now in the room, a fifth of a second after the last one.
  void see(const std::vector<WatchedBlock>& now, const RoomLight& light = as_scanned) {
    std::vector<WatchedBlock> all = walls_, known = walls_;
    all.insert(all.end(), now.begin(), now.end());
    known.insert(known.end(), scanned_.begin(), scanned_.end());
    geometry::Pose turned = world_from_view_;
    turned.rotation = turned.rotation * model_turn_;
    draw(known, turned, as_scanned, model_m_, model_color_);
    draw(all, world_from_view_, light, seen_m_, seen_color_);
    std::normal_distribution<double> noise;
    Image<Rgb8> bytes(view_.size_px);
    for (int y = 0; y < view_.size_px.height; ++y)
      for (int x = 0; x < view_.size_px.width; ++x) {
        float& z = seen_m_.at(x, y);
        z += static_cast<float>(noise_.sigma_m(double{z}) * noise(random_));
        if (random_() % 100 == 0) z = 0.5F * z;  // a flying pixel
        const Rgbf c = seen_color_.at(x, y);
        bytes.at(x, y) = {srgb_byte_from_linear(c.r), srgb_byte_from_linear(c.g),
                          srgb_byte_from_linear(c.b)};
      }
    if (!watch_) watch_.emplace(room_m_, noise_);
    watch_->add({time_s_, view_, world_from_view_, seen_m_, bytes, model_m_, model_color_});
    time_s_ += 1 / kWatchRate_hz;
  }
  void see_for(double seconds, const std::vector<WatchedBlock>& now,
               const RoomLight& light = as_scanned) {
    const int frames = static_cast<int>(std::lround(seconds * kWatchRate_hz));
    for (int i = 0; i < frames; ++i) see(now, light);
  }

  std::string told() const {
    std::string out;
    for (const RoomChange& c : watch_->changes())
      out += text(c) + ", unrest " + std::to_string(1e3 * c.unrest_m) + " mm, since " +
             std::to_string(c.since_s) + ", found " + std::to_string(c.found_s) + "\n";
    return out;
  }

  std::vector<WatchedBlock> walls_, scanned_;
  geometry::DepthNoise noise_{0.003, 0.001, 0.0005};
  std::optional<RoomWatch> watch_;
  Eigen::Quaterniond model_turn_ = Eigen::Quaterniond::Identity();  ///< error of the model's pose
  double time_s_ = 100;
  std::mt19937 random_{7};

 private:
  void draw(const std::vector<WatchedBlock>& blocks, const geometry::Pose& world_from_view,
            const RoomLight& light, Image<float>& z_m, Image<Rgbf>& color) {
    z_m.reset(view_.size_px), color.reset(view_.size_px);
    const Vector3d eye_m = world_from_view.translation_m;
    for (int y = 0; y < view_.size_px.height; ++y)
      for (int x = 0; x < view_.size_px.width; ++x) {
        const Eigen::Vector2d at = view_.unproject({x, y});
        const Vector3d ray = world_from_view.rotation * Vector3d(at.x(), at.y(), 1);
        double nearest = INFINITY;
        Array3d albedo = Array3d::Zero();
        for (const WatchedBlock& block : blocks)
          if (const double t = hit_block(block, eye_m, ray); t < nearest)
            nearest = t, albedo = block.albedo;
        if (!std::isfinite(nearest)) continue;
        const Array3d c = albedo * light(eye_m + nearest * ray);
        z_m.at(x, y) = static_cast<float>(nearest);
        color.at(x, y) = {static_cast<float>(c.x()), static_cast<float>(c.y()),
                          static_cast<float>(c.z())};
      }
  }

  const geometry::Pinhole view_{{120, 90}, 98, 98, 59.5, 44.5};
  const Eigen::AlignedBox3d room_m_{Vector3d(-2.5, -1, 0), Vector3d(2.5, 4, 2.6)};
  geometry::Pose world_from_view_ = geometry::look_at({0, 0, 1.5}, {0, 4, 0.9}, Vector3d::UnitZ());
  Image<float> model_m_, seen_m_;
  Image<Rgbf> model_color_, seen_color_;
};

WatchedBlock chair_at(double x, double y) {
  return {{x, y, 0.45}, {0.5, 0.5, 0.9}, {0.2, 0.3, 0.5}};
}
WatchedBlock person_at(double x, double y) {
  return {{x, y, 0.9}, {0.45, 0.25, 1.8}, {0.3, 0.1, 0.1}};
}

/// Bars of 0.09 m with gaps of that width: no part is wider than 3 pixels.
std::vector<WatchedBlock> bars_at(double x, double y) {
  std::vector<WatchedBlock> bars;
  for (int i = 0; i < 5; ++i)
    bars.push_back({{x, y, 0.1 + 0.18 * i}, {0.6, 0.03, 0.09}, {0.2, 0.3, 0.5}});
  return bars;
}

/// The middle of the sides that the camera sees, which is up to half of its depth nearer.
void expect_near(const Vector3d& found, const Vector3d& truth, double within_m) {
  EXPECT_LT((found - truth).norm(), within_m) << found.transpose();
}

TEST_F(WatchedRoom, WhatIsAsScannedIsNoChange) {
  scanned_ = {chair_at(1, 3)};
  see_for(40, {chair_at(1, 3)});
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

TEST_F(WatchedRoom, AThingThatAppearsIsFoundOnceItStood) {
  see_for(3, {});
  see_for(11.5, {chair_at(0.5, 2.8)});
  EXPECT_TRUE(watch_->changes().empty()) << "a person may stand so long";
  see_for(2, {chair_at(0.5, 2.8)});
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kAppeared);
  expect_near(changes[0].center_m, {0.5, 2.7, 0.45}, 0.17);
  EXPECT_NEAR(changes[0].size_m.z(), 0.9, 0.2);
  EXPECT_NEAR(changes[0].size_m.x(), 0.5, 0.15);
  EXPECT_NEAR(changes[0].since_s, 103, 0.3);
  EXPECT_GT(changes[0].certainty, 0.97);
  EXPECT_EQ(watch_->news().size(), 1U);
  EXPECT_TRUE(watch_->news().empty()) << "told once";
}

TEST_F(WatchedRoom, AThingThatIsTakenAwayIsGone) {
  scanned_ = {chair_at(0.5, 2.8)};
  see_for(2, scanned_);
  see_for(9, {});
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kGone);
  expect_near(changes[0].center_m, {0.5, 2.7, 0.45}, 0.17);
  see_for(3, scanned_);
  EXPECT_TRUE(watch_->changes()[0].over) << "it was brought back";
}

TEST_F(WatchedRoom, AThingThatStandsElsewhereMoved) {
  scanned_ = {chair_at(0.9, 3)};
  see_for(14, {chair_at(-0.6, 2.4)});
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kMoved);
  expect_near(changes[0].center_m, {-0.6, 2.3, 0.45}, 0.17);
  ASSERT_TRUE(changes[0].from_m);
  expect_near(*changes[0].from_m, {0.9, 2.9, 0.45}, 0.17);
}

/// All around each bar the model has the wall that is measured now.
TEST_F(WatchedRoom, AThingOfNarrowPartsThatStandsElsewhereMoved) {
  scanned_ = bars_at(0.9, 2.8);
  see_for(14, bars_at(-0.6, 2.4));
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kMoved);
  expect_near(changes[0].center_m, {-0.6, 2.4, 0.45}, 0.1);
  ASSERT_TRUE(changes[0].from_m);
  expect_near(*changes[0].from_m, {0.9, 2.8, 0.45}, 0.1);
}

TEST_F(WatchedRoom, NarrowPartsOfAModelThatIsTwoPixelsOffAreNotGone) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0.7, -0.7, 0)}) {
    watch_.reset();
    model_turn_ = Eigen::AngleAxisd(2.0 / 98, axis);
    scanned_ = bars_at(0.9, 2.8);
    see_for(9, scanned_);
    EXPECT_TRUE(watch_->changes().empty()) << told();
  }
}

/// Depth cameras see a pole of a pixel's width or not.
TEST_F(WatchedRoom, APoleThatIsNotMeasuredIsNotGone) {
  scanned_ = {{{0.7, 2.5, 1.1}, {0.03, 0.03, 2.2}}, {{-0.7, 2.5, 1.1}, {0.02, 0.02, 2.2}}};
  see_for(9, {});
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

TEST_F(WatchedRoom, WhoWalksIsNoChange) {
  for (int i = 0; i < 60 * kWatchRate_hz; ++i)
    see({person_at(1.5 * std::sin(0.5 * i / kWatchRate_hz),
                   2.5 + 0.7 * std::cos(0.4 * i / kWatchRate_hz))});
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

/// People sway by a centimetre or two and shift their weight.
TEST_F(WatchedRoom, WhoStandsAndSwaysIsNoChange) {
  for (int i = 0; i < 40 * kWatchRate_hz; ++i) {
    const double t = i / kWatchRate_hz;
    see({person_at(0.3 + 0.012 * std::sin(1.3 * t), 2.5 + 0.01 * std::sin(1.9 * t))});
  }
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

/// A person who stands as still as an object is taken for one; this ends when they go.
TEST_F(WatchedRoom, WhoStandsLikeAStatueIsTakenForAThingUntilTheyGo) {
  see_for(20, {person_at(0.3, 2.5)});
  ASSERT_EQ(watch_->changes().size(), 1U);
  EXPECT_EQ(watch_->changes()[0].kind, ChangeKind::kAppeared);
  EXPECT_TRUE(watch_->any_open());
  see_for(3, {});
  EXPECT_TRUE(watch_->changes()[0].over) << told();
  EXPECT_FALSE(watch_->any_open());
}

/// The time in which people hide a thing does not count, and no one's legs become one.
TEST_F(WatchedRoom, AThingBehindPeopleIsFoundWhereItWasSeenLongEnough) {
  const auto passing = [&](int i) { return person_at(-2 + 0.8 * (i % 25) / kWatchRate_hz, 2); };
  for (int i = 0; i < 12 * kWatchRate_hz; ++i) see({chair_at(0.5, 2.9), passing(i)});
  EXPECT_TRUE(watch_->changes().empty()) << told();
  for (int i = 0; i < 10 * kWatchRate_hz; ++i) see({chair_at(0.5, 2.9), passing(i)});
  ASSERT_EQ(watch_->changes().size(), 1U);
  expect_near(watch_->changes()[0].center_m, {0.5, 2.8, 0.45}, 0.17);
}

/// It is open five of six seconds and never gone.
TEST_F(WatchedRoom, ADoorThatSwingsIsNoChange) {
  const WatchedBlock closed{{0.5, 3.94, 1}, {0.8, 0.04, 2}};
  walls_[1].center_m.y() = 4.4;
  scanned_ = {closed};
  for (int i = 0; i < 48 * kWatchRate_hz; ++i) {
    const bool open = i % static_cast<int>(6 * kWatchRate_hz) >= kWatchRate_hz;
    see(open ? std::vector<WatchedBlock>{} : std::vector<WatchedBlock>{closed});
  }
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

TEST_F(WatchedRoom, ACameraThatMovesFindsTheSame) {
  scanned_ = {chair_at(0.9, 3)};
  for (int i = 0; i < 25 * kWatchRate_hz; ++i) {
    const double t = i / kWatchRate_hz;
    look_from({0.3 * std::sin(0.7 * t), 0.1 * std::sin(t), 1.5 + 0.05 * std::sin(2 * t)},
              {1.2 * std::sin(0.8 * t), 4, 0.9});
    see({chair_at(-0.6, 2.4), person_at(1.4 * std::sin(0.9 * t), 1.8)});
  }
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kMoved);
  expect_near(changes[0].center_m, {-0.6, 2.4, 0.45}, 0.25);
  expect_near(*changes[0].from_m, {0.9, 3, 0.45}, 0.25);
}

TEST_F(WatchedRoom, AHeadThatTurnsKeepsWhatItFoundOutOfView) {
  see_for(14, {chair_at(0.5, 2.8)});
  ASSERT_EQ(watch_->changes().size(), 1U);
  look_from({0, 0, 1.5}, {-4, 0.5, 1});
  see_for(20, {chair_at(0.5, 2.8)});
  look_from({0, 0, 1.5}, {0, 4, 0.9});
  see_for(5, {chair_at(0.5, 2.8)});
  ASSERT_EQ(watch_->changes().size(), 1U);
  EXPECT_FALSE(watch_->changes()[0].over);
}

TEST_F(WatchedRoom, LampsThatAreDimmedAreOneFactorForTheRoom) {
  see_for(3, {});
  see_for(4, {person_at(0, 2.5)}, [](const Vector3d&) { return Array3d(0.5, 0.45, 0.4); });
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kLights);
  EXPECT_TRUE(changes[0].common);
  EXPECT_NEAR(changes[0].factor.x(), 0.5, 0.03);
  EXPECT_NEAR(changes[0].factor.z(), 0.4, 0.03);
  EXPECT_FALSE(watch_->any_open()) << "nothing moved";
  see_for(4, {});
  EXPECT_TRUE(watch_->changes()[0].over);
}

TEST_F(WatchedRoom, ALampThatIsSwitchedDiffersFromPlaceToPlace) {
  see_for(3, {});
  see_for(30, {}, [](const Vector3d& p) {
    return Array3d::Constant(0.35 + 0.65 / (1 + std::exp(-4 * p.x()))).eval();
  });
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << "and no surface has a colour of its own";
  EXPECT_EQ(changes[0].kind, ChangeKind::kLights);
  EXPECT_FALSE(changes[0].common);
}

TEST_F(WatchedRoom, ExposureThatDriftsIsNoChange) {
  for (int i = 0; i < 30 * kWatchRate_hz; ++i) {
    const double gain = std::exp2(0.12 * std::sin(0.4 * i / kWatchRate_hz));
    see({}, [gain](const Vector3d&) { return Array3d::Constant(gain).eval(); });
  }
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

TEST_F(WatchedRoom, AThingThatMovesAsTheLightChangesIsToldApart) {
  const RoomLight half = [](const Vector3d&) { return Array3d::Constant(0.5).eval(); };
  scanned_ = {chair_at(0.9, 3)};
  see_for(14, {chair_at(-0.6, 2.4)}, half);
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[0].kind, ChangeKind::kLights);
  EXPECT_EQ(changes[1].kind, ChangeKind::kMoved);
}

TEST_F(WatchedRoom, APictureOnTheWallIsAColour) {
  see_for(3, {});
  see_for(22, {{{0.6, 3.99, 1.2}, {0.8, 0.02, 0.7}, {0.1, 0.1, 0.3}}});
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kColor);
  expect_near(changes[0].center_m, {0.6, 4, 1.2}, 0.3);
  EXPECT_FALSE(watch_->any_open()) << "its surface is where it was";
}

TEST_F(WatchedRoom, WhatWasAcceptedIsNotFoundAgain) {
  scanned_ = {chair_at(0.9, 3)};
  see_for(14, {chair_at(-0.6, 2.4)});
  ASSERT_TRUE(watch_->any_open());
  EXPECT_GT(watch_->seen_share(), 0.8);
  EXPECT_TRUE(watch_->is_open(ChangeCells::Kind::kSurface, {-0.6, 2.15, 0.5}, 1));
  EXPECT_TRUE(watch_->is_open(ChangeCells::Kind::kHole, {0.9, 2.75, 0.5}, 1));
  EXPECT_FALSE(watch_->is_open(ChangeCells::Kind::kHole, {-0.6, 2.15, 0.5}, 1));
  watch_->accept();
  EXPECT_FALSE(watch_->any_open());
  scanned_ = {chair_at(-0.6, 2.4)};
  see_for(20, scanned_);
  ASSERT_EQ(watch_->changes().size(), 1U);
  EXPECT_TRUE(watch_->changes()[0].accepted);
  EXPECT_FALSE(watch_->changes()[0].over);
}

TEST_F(WatchedRoom, NoiseOfAPoorCameraIsNoChange) {
  noise_ = {0.01, 0.005, 0.002};
  scanned_ = {chair_at(1, 3)};
  see_for(40, {chair_at(1, 3)});
  EXPECT_TRUE(watch_->changes().empty()) << told();
}

/// Sigma is 25 mm at the chair's distance, the sway 4 mm RMS: motion is distinguished from noise.
TEST_F(WatchedRoom, APoorCameraTellsAThingFromWhoSways) {
  noise_ = {0.01, 0.005, 0.002};
  for (int i = 0; i < 20 * kWatchRate_hz; ++i) {
    const double t = i / kWatchRate_hz;
    see({chair_at(-0.7, 2.4), person_at(0.6, 2.5 + 0.006 * std::sin(1.5 * t))});
  }
  const auto changes = watch_->changes();
  ASSERT_EQ(changes.size(), 1U) << told();
  EXPECT_EQ(changes[0].kind, ChangeKind::kAppeared);
  expect_near(changes[0].center_m, {-0.7, 2.35, 0.5}, 0.1);
  EXPECT_LT(changes[0].unrest_m, 0.001) << "noise is no unrest";
}

}  // namespace
}  // namespace mixrig::model
