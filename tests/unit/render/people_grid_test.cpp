// SPDX-License-Identifier: Apache-2.0
// Occlusion of wide lamps by people, around the objects: interpolated between the points of a grid
// it equals the lookups in the maps, and it is not computed where nobody is near.
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/cpu/light/irradiance.h"
#include "host/render/cpu/light/people_shadow.h"
#include "tests/gl/room_setup.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using render::cpu::FloatLanes;
using render::cpu::VectorLanes;

/// A box of 0.6 m, 3 m away, under a panel to its left; world as camera, y down. People are blocks
/// of the view.
class PanelScene {
 public:
  explicit PanelScene(double panel_m, int height = 240)
      : size_{height * 4 / 3, height}, setup_(plain_setup(size_, height, {64, 48}, 64)) {
    geometry::Lamp lamp;
    lamp.position_m = {-2, 0, 3}, lamp.direction = Eigen::Vector3d::UnitX();
    lamp.size_m = {panel_m, panel_m};
    setup_.light.lamps.push_back(lamp);
    for (int i = 0; i < 8; ++i)
      corners_.emplace_back(i & 1 ? 0.3F : -0.3F, i & 2 ? 0.3F : -0.3F, i & 4 ? 3.3F : 2.7F);
    normals_.assign(8, {0, 0, -1});
    render::VirtualObject box;
    box.meshes.push_back({corners_, normals_, {}, triangles_, glm::vec3(1), {}, true});
    setup_.objects.push_back(box);
    background_m_.reset(size_, 5), sigma_m_.reset(size_, 0.01F);
    setup_.background.depth_m = background_m_, setup_.background.depth_sigma_m = sigma_m_;
    setup_.people_cast_shadows = true;
    preparer_.emplace(setup_);
    preparer_->update({});
  }
  /// Somebody 0.3 m wide, z_m away, whose middle is x_m to the right.
  void stand(double x_m, double z_m = 3) {
    Image<float> w(size_, 0);
    Image<std::uint8_t> matte(size_, 0);
    const auto column = [&](double at_m) {
      const double px = setup_.view.cx_px + at_m / z_m * setup_.view.fx_px;
      return std::clamp(static_cast<int>(px), 0, size_.width);
    };
    for (int y = size_.height / 6; y < size_.height * 5 / 6; ++y)
      for (int x = column(x_m - 0.15); x < column(x_m + 0.15); ++x)
        w.at(x, y) = static_cast<float>(1 / z_m), matte.at(x, y) = 255;
    people_ = render::cpu::PeopleShadow(size_);
    Crew crew(2);
    const glm::vec2 focal(static_cast<float>(setup_.view.fx_px));
    const glm::vec2 center(setup_.view.cx_px, setup_.view.cy_px);
    render::cpu::draw_people_maps(crew, preparer_->params(), {focal, center}, w, matte, people_);
  }
  render::cpu::PeopleShadow& people() { return people_; }
  /// Share of the lamp that a point sees past people, as passes ask for it, and by the map alone.
  std::pair<float, float> seen(const glm::vec3& p) const {
    render::cpu::SurfaceLanes at{};
    at.position_m.x += p.x, at.position_m.y += p.y, at.position_m.z += p.z;
    FloatLanes share[1];
    render::cpu::seen_past_people({people_.lamps, people_.maps, people_.grid}, at, share);
    const VectorLanes no_normal{};
    return {share[0][0], render::cpu::visibility(people_.lamps[0], people_.maps[0], at.position_m,
                                                 no_normal)[0]};
  }

 private:
  Size size_;
  render::CompositorSetup setup_;
  std::vector<glm::vec3> corners_, normals_;
  std::vector<std::uint32_t> triangles_{0, 1, 2, 1, 3, 2, 4, 5, 6, 5, 7, 6};
  Image<float> background_m_, sigma_m_;
  std::optional<render::FramePreparer> preparer_;
  render::cpu::PeopleShadow people_;
};

class PeopleGridOfPanel : public testing::TestWithParam<double> {};

TEST_P(PeopleGridOfPanel, TellsBetweenItsPointsWhatTheMapTells) {
  PanelScene scene(GetParam());
  scene.stand(-1);  // between the panel and the box
  ASSERT_EQ(scene.people().grid.lamps, 1U);
  double sum = 0, count = 0, most = 0, least_seen = 1;
  for (float x = -0.3F; x <= 0.3F; x += 0.037F)
    for (float y = -0.3F; y <= 0.3F; y += 0.041F)
      for (float z = 2.7F; z <= 3.3F; z += 0.043F) {
        const auto [told, by_map] = scene.seen({x, y, z});
        const double off = std::abs(told - by_map);
        sum += off, ++count, most = std::max(most, off);
        least_seen = std::min<double>(least_seen, by_map);
      }
  EXPECT_LT(least_seen, 0.45) << "nobody stands before the panel";
  EXPECT_LT(sum / count, 0.04);
  EXPECT_LT(most, 0.35);
}
INSTANTIATE_TEST_SUITE_P(Sides, PeopleGridOfPanel, testing::Values(0.6, 0.7, 0.8));

TEST(PeopleGrid, IsLookedUpAndBeyondItTheMap) {
  PanelScene scene(0.7);
  scene.stand(-1);
  const auto [beyond, by_map] = scene.seen({0.8F, 0, 3});
  EXPECT_EQ(beyond, by_map);
  EXPECT_LT(beyond, 0.9);
  std::fill(scene.people().grid.share.begin(), scene.people().grid.share.end(), 2);
  EXPECT_NEAR(scene.seen({0, 0, 3}).first, 2, 1e-5);
  EXPECT_EQ(scene.seen({0.8F, 0, 3}).first, by_map);
}

TEST(PeopleGrid, APointLampIsLookedUpInItsMap) {
  PanelScene scene(0);
  scene.stand(-1);
  EXPECT_EQ(scene.people().reach, 1U);
  EXPECT_EQ(scene.people().grid.lamps, 0U);
  EXPECT_EQ(scene.seen({0, 0, 3.2F}).first, 0) << "in the middle of the shadow";
}

TEST(PeopleShadow, WhoIsNotBetweenALampAndTheObjectsIsLeftOut) {
  PanelScene scene(0.7);
  scene.stand(-1, 5);  // by the far wall
  EXPECT_EQ(scene.people().reach, 0U);
  EXPECT_TRUE(scene.people().drawn.empty());
  EXPECT_EQ(scene.people().grid.lamps, 0U);
  scene.stand(-1);
  EXPECT_EQ(scene.people().reach, 1U);
}

/// In a large picture a quarter of the blocks has balls, twice as large; the shadow must be the
/// same.
TEST(PeopleShadow, OfSmallBlocksEverySecondOneHasABall) {
  PanelScene coarse(0.7), fine(0.7, 1080);
  coarse.stand(-1), fine.stand(-1);
  const int columns = (1440 + 7) / 8;
  for (std::size_t i = 0; i < fine.people().balls.size(); ++i) {
    const int bx = static_cast<int>(i) % columns, by = static_cast<int>(i) / columns;
    if (((bx | by) & 1) == 0) continue;
    ASSERT_EQ(fine.people().balls[i].radius_m, 0) << bx << " " << by;
  }
  ASSERT_FALSE(fine.people().drawn.empty());
  for (const render::cpu::Ball& ball : fine.people().drawn)
    EXPECT_GE(ball.radius_m, 0.99 * 2 * render::kLeastBallBlocks * 8 * 3 / 1080);
  for (const float y : {-0.25F, -0.1F, 0.0F, 0.2F})
    EXPECT_NEAR(fine.seen({0, y, 3}).first, coarse.seen({0, y, 3}).first, 0.2) << y;
}

/// The memory for the objects' shading depends on their number of pixels.
TEST(PeopleShadow, ACameraThatComesNearerAllocatesNothing) {
  for (const bool for_each_pose : {true, false}) {
    RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
    room.setup.people_cast_shadows = true;
    if (for_each_pose) room.draw_background_for_each_pose();
    auto compositor = render::make_cpu_compositor(room.setup, 1);
    ASSERT_TRUE(compositor);
    render::FrameOutput out;
    render::FrameInput frame = room.frame();
    for (const double z_m : {0.0, 0.01, 0.02}) {
      frame.world_from_target.translation_m.z() = z_m;
      ASSERT_TRUE((*compositor)->compose(frame, out));
    }
    frame.world_from_target.translation_m.z() = 0.9;
    const long before = allocations;
    ASSERT_TRUE((*compositor)->compose(frame, out));
    EXPECT_EQ(allocations - before, 0) << for_each_pose;
  }
}

}  // namespace
}  // namespace mixrig::test
