// SPDX-License-Identifier: Apache-2.0
// Several people, what they wear and carry: sizes, places, and what the pictures show of it.
#include "studio/people/cast.h"

#include <cmath>

#include <gtest/gtest.h>

#include "studio/people/attire.h"
#include "studio/stage/layout.h"
#include "studio/stage/light.h"

namespace mixrig::studio {
namespace {

StudioOptions options_of(int people) {
  StudioOptions o;
  o.rig = RigPreset::kSr3000;
  o.seed = 7;
  o.frames = 40;
  o.size_px = {160, 128};
  o.people = people;
  return o;
}

/// The part of a mesh that is one person.
Bounds box_of(const Mesh& mesh, int person) {
  Mesh part;
  for (std::size_t t = 0; t < mesh.materials.size(); ++t)
    if (mesh.materials[t].person == person)
      for (std::size_t k = 0; k < 3; ++k)
        part.positions.push_back(mesh.positions[mesh.indices[3 * t + k]]);
  return bounds_of(part);
}

TEST(Cast, three_people_are_three_bodies_that_never_touch) {
  for (const Scenario scenario : {Scenario::kWalk, Scenario::kTalk, Scenario::kStill}) {
    StudioOptions o = options_of(3);
    o.scenario = scenario;
    const Layout layout = make_layout(o);
    const Cast cast(o, layout, 1);
    for (double t = 1; t < 12; t += 0.37) {
      Mesh mesh;
      cast.build(t, mesh);
      Bounds box[3];
      for (int i = 0; i < 3; ++i) box[i] = box_of(mesh, i);
      EXPECT_GT(box[0].high.z(), 1.1F);
      EXPECT_NEAR(box[1].high.z(), 1.3F, 0.15F) << "seated";
      EXPECT_GT(box[2].high.z(), 1.5F) << "walks";
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) {
          const Vec3 a = 0.5F * (box[i].low + box[i].high), b = 0.5F * (box[j].low + box[j].high);
          EXPECT_GT((a - b).head<2>().norm(), 0.4F) << name(scenario) << t << ' ' << i << j;
        }
    }
  }
}

TEST(Cast, strands_stand_around_the_head_and_are_thin) {
  StudioOptions o = options_of(1);
  o.realism.hair = true;
  const Layout layout = make_layout(o);
  const PersonMotion motion(o.scenario, o.seed, layout.stage, 1);
  Mesh mesh, strands;
  const BodyPoints points = build_person(motion.build(), motion.at(2), mesh);
  add_strands(motion.build(), points, 1, strands);
  EXPECT_GT(strands.materials.size(), 900U);
  float farthest = 0;
  const Vec3 middle = points.chin + 0.15F * points.up;
  for (std::size_t t = 0; t < strands.materials.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return strands.positions[strands.indices[3 * t + k]];
    };
    const Vec3 a = corner(1) - corner(0), b = corner(2) - corner(0);
    const float longest = std::max({a.norm(), b.norm(), (a - b).norm()});
    EXPECT_LT(a.cross(b).norm() / longest, 1.6e-3F) << "height of a triangle";
    for (std::size_t k = 0; k < 3; ++k) farthest = std::max(farthest, (corner(k) - middle).norm());
  }
  EXPECT_GT(farthest, 0.12F);
  EXPECT_LT(farthest, 0.19F);
}

/// Pixels with a matte between 20 and 235 in the rows of the head.
int soft_pixels(const StudioOptions& options) {
  auto studio = Studio::create(options);
  EXPECT_TRUE(studio);
  Frame frame;
  Truth truth;
  studio->render(38, frame, &truth);
  int top = 0, soft = 0;
  for (int y = 0; y < truth.matte.height() && top == 0; ++y)
    for (int x = 0; x < truth.matte.width(); ++x)
      if (truth.matte.at(x, y) > 128) top = y;
  for (int y = std::max(0, top - 12); y < top + 20; ++y)
    for (int x = 0; x < truth.matte.width(); ++x)
      soft += truth.matte.at(x, y) > 20 && truth.matte.at(x, y) < 235;
  return soft;
}

TEST(Cast, hair_makes_a_soft_edge_of_the_matte) {
  StudioOptions shell = options_of(1), hair = options_of(1);
  shell.size_px = hair.size_px = {400, 320};
  hair.realism.hair = true;
  EXPECT_GT(soft_pixels(hair), 1.5 * soft_pixels(shell));
}

TEST(Cast, a_stick_thinner_than_a_pixel_is_not_lost_between_corners) {
  StudioOptions o = options_of(1);
  o.props = true;
  const Layout layout = make_layout(o);
  const Cast cast(o, layout, 0.8);
  Mesh mesh;
  const double t = 37 / kFrameRate_hz;
  cast.build(t, mesh);
  auto studio = Studio::create(o);
  ASSERT_TRUE(studio);
  Frame frame;
  Truth truth;
  studio->render(38, frame, &truth);
  // Area of the stick by its axis: the matte must hold it wherever it is before the room alone.
  const geometry::Pose from_world = geometry::inverse(frame.world_from_target);
  int on_stick = 0, seen = 0;
  for (std::size_t k = 0; k < mesh.materials.size(); ++k) {
    if (mesh.materials[k].kind != Kind::kStick) continue;
    const Eigen::Vector3d p = from_world * mesh.positions[mesh.indices[3 * k]].cast<double>();
    const Optics& view = studio->info().view;
    const int x = static_cast<int>(std::lround(view.fx_px * p.x() / p.z() + view.cx_px));
    const int y = static_cast<int>(std::lround(view.fy_px * p.y() / p.z() + view.cy_px));
    if (x < 1 || y < 1 || x > 158 || y > 126) continue;
    ++on_stick;
    int most = 0;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        most = std::max(most, static_cast<int>(truth.matte.at(x + i, y + j)));
    seen += most > 20;
  }
  ASSERT_GT(on_stick, 10);
  EXPECT_EQ(seen, on_stick);
}

TEST(Cast, people_must_be_one_to_three) {
  EXPECT_NE(Studio::create(options_of(4)).error().context.find("people must be 1 to 3"),
            std::string::npos);
}

/// With all effects at once, the bytes are the same for any number of threads, order and cache.
TEST(Cast, everything_at_once_is_reproducible) {
  StudioOptions o = options_of(2);
  o.size_px = {80, 64};
  o.realism = Realism::all();
  o.props = true;
  o.threads = 1;
  StudioOptions other = o;
  other.threads = 3, other.cache = false;
  auto a = Studio::create(o), b = Studio::create(other);
  ASSERT_TRUE(a && b);
  Frame fa, fb;
  Truth ta, tb;
  a->render(30, fa, &ta);
  a->render(36, fa, &ta);
  b->render(36, fb, &tb);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 80; ++x) {
      ASSERT_EQ(fa.color.at(x, y), fb.color.at(x, y)) << x << ' ' << y;
      ASSERT_EQ(ta.composite.at(x, y), tb.composite.at(x, y));
      ASSERT_EQ(ta.matte.at(x, y), tb.matte.at(x, y));
      ASSERT_EQ(ta.light.at(x, y), tb.light.at(x, y));
    }
  for (int y = 0; y < fa.tof_distance_m.height(); ++y)
    for (int x = 0; x < fa.tof_distance_m.width(); ++x)
      ASSERT_EQ(fa.tof_distance_m.at(x, y), fb.tof_distance_m.at(x, y));
}

}  // namespace
}  // namespace mixrig::studio
