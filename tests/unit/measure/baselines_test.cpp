// SPDX-License-Identifier: Apache-2.0
// Plain composites against values made by hand.
#include "host/judge/measure/baselines.h"

#include <cmath>

#include <gtest/gtest.h>

#include "host/judge/measure/splat.h"
#include "host/judge/measure/srgb.h"

namespace mixrig::measure {
namespace {

/// One row: background at 3 m, plate grey, object red at 2 m.
struct Row {
  static constexpr int kWidth = 6;
  Row()
      : plate({kWidth, 1}, Rgb8{100, 100, 100}),
        object({kWidth, 1}, Rgb8{200, 0, 0}),
        coverage({kWidth, 1}, 255),
        object_m({kWidth, 1}, 2.0F),
        depth_m({kWidth, 1}, 3.0F),
        background_m({kWidth, 1}, 3.0F) {}
  PlainComposite compose(Baseline baseline, const DepthSpread& spread = {}) const {
    PlainComposite out;
    compose_plainly(baseline, {plate, object, coverage, object_m, depth_m, background_m}, spread,
                    out);
    return out;
  }
  Image<Rgb8> plate, object;
  Image<std::uint8_t> coverage;
  Image<float> object_m, depth_m, background_m;
};

TEST(Plate, IsLeftAsItIs) {
  const PlainComposite out = Row().compose(Baseline::kPlate);
  EXPECT_EQ(out.color.at(0, 0), (Rgb8{100, 100, 100}));
  EXPECT_EQ(out.layer.at(0, 0), 0);
  EXPECT_EQ(out.matte.at(0, 0), 0);
  EXPECT_EQ(out.light.at(0, 0), 1.0F);
  EXPECT_EQ(out.warped_depth_m.at(0, 0), 0.0F);
}

TEST(Pasted, LiesOverWhateverIsNearer) {
  Row row;
  row.depth_m.at(1, 0) = 1.0F;  // a person before the object
  row.coverage.at(2, 0) = 0;
  row.coverage.at(3, 0) = 128, row.object.at(3, 0) = {148, 0, 0};
  const PlainComposite out = row.compose(Baseline::kPasted);
  EXPECT_EQ(out.color.at(0, 0), (Rgb8{200, 0, 0}));
  EXPECT_EQ(out.color.at(1, 0), (Rgb8{200, 0, 0}));
  EXPECT_EQ(out.color.at(2, 0), (Rgb8{100, 100, 100}));
  EXPECT_EQ(out.layer.at(1, 0), 2);
  EXPECT_EQ(out.layer.at(2, 0), 0);
  EXPECT_EQ(out.matte.at(1, 0), 0);
  // Mixed in linear light: 0.29614 + 0.49804 0.12744 = 0.35961 is 161; 0.49804 0.12744 is 71.
  EXPECT_EQ(out.color.at(3, 0), (Rgb8{162, 71, 71}));
}

TEST(DepthKey, TakesStepsAndNothingElse) {
  Row row;
  row.object_m.fill(2.5F);
  row.depth_m.at(0, 0) = 2.94F;                                    // a step of 6 cm
  row.depth_m.at(1, 0) = 2.96F;                                    // 4 cm: none
  row.depth_m.at(2, 0) = 0.0F;                                     // unknown
  row.depth_m.at(3, 0) = 1.0F;                                     // before the object
  row.depth_m.at(4, 0) = 1.0F, row.background_m.at(4, 0) = 0.0F;   // of an unknown background
  row.depth_m.at(5, 0) = 1.5F, row.background_m.at(5, 0) = 2.47F;  // background before the object
  const PlainComposite out = row.compose(Baseline::kDepthKey);
  const int people[] = {255, 0, 0, 255, 0, 255};
  const int layers[] = {2, 2, 2, 1, 2, 1};
  for (int x = 0; x < Row::kWidth; ++x) {
    EXPECT_EQ(out.matte.at(x, 0), people[x]) << x;
    EXPECT_EQ(out.layer.at(x, 0), layers[x]) << x;
  }
  EXPECT_EQ(out.color.at(3, 0), (Rgb8{100, 100, 100}));
  EXPECT_EQ(out.warped_depth_m.at(3, 0), 1.0F);
  // sigma(3 m) = 0.001 + 0.006 + 0.009: four of them are 6.4 cm.
  EXPECT_EQ(row.compose(Baseline::kDepthKey, {0.001, 0.002, 0.001}).matte.at(0, 0), 0);
}

TEST(DepthKey, LetsTheRoomHideTheObject) {
  Row row;
  row.background_m.at(0, 0) = row.depth_m.at(0, 0) = 1.97F;  // 3 cm before the object
  row.background_m.at(1, 0) = row.depth_m.at(1, 0) = 1.99F;  // within the noise of contact
  const PlainComposite out = row.compose(Baseline::kDepthKey);
  EXPECT_EQ(out.layer.at(0, 0), 0);
  EXPECT_EQ(out.color.at(0, 0), (Rgb8{100, 100, 100}));
  EXPECT_EQ(out.layer.at(1, 0), 2);
}

TEST(Ideal, ShowsTrueObjectsAndShadowsOnThePlate) {
  const Image<Rgb8> plate({4, 1}, Rgb8{188, 100, 100});
  const Image<Rgb8> color({4, 1}, Rgb8{10, 20, 30});
  const Image<float> depth_m({4, 1}, 2.0F);
  Image<float> light({4, 1}, 1.0F);
  Image<std::uint8_t> matte({4, 1}), labels({4, 1});
  labels.at(1, 0) = kLayerVirtual | kInSilhouette;
  labels.at(2, 0) = 1 | kInSilhouette | kTofSees, matte.at(2, 0) = 200;
  light.at(3, 0) = 0.5F;
  PlainComposite out;
  compose_ideally(plate, {color, depth_m, matte, light, labels}, out);
  EXPECT_EQ(out.color.at(0, 0), (Rgb8{188, 100, 100}));
  EXPECT_EQ(out.color.at(1, 0), (Rgb8{10, 20, 30}));
  EXPECT_EQ(out.color.at(2, 0), (Rgb8{188, 100, 100})) << "a person before it";
  EXPECT_EQ(out.color.at(3, 0).r, 137) << "half of 0.5029 is 0.2514";
  EXPECT_EQ(out.matte.at(2, 0), 200);
  EXPECT_EQ(out.layer.at(2, 0), 1);
  EXPECT_EQ(out.light.at(3, 0), 0.5F);
}

/// A depth camera of 3x3 samples 0.1 apart, a view of 110 px of focal length.
struct Splat {
  Splat() : z_m({3, 3}), rays({3, 3}), out_m({41, 41}) {
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x)
        rays.at(x, y) = {0.1F * static_cast<float>(x - 1), 0.1F * static_cast<float>(y - 1)};
  }
  void draw(const Motion& motion = {}) {
    out_m.fill(0);
    add(motion);
  }
  void add(const Motion& motion) { splat(z_m, rays, motion, {110, 110, 20, 20}, out_m); }
  int known() const {
    int count = 0;
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 41; ++x) count += out_m.at(x, y) > 0;
    return count;
  }
  Image<float> z_m;
  Image<Ray> rays;
  Image<float> out_m;
};

TEST(Splat, DrawsASampleAsWideAsItsFootprint) {
  Splat s;
  s.z_m.at(1, 1) = 2.0F;
  s.draw();
  EXPECT_EQ(s.known(), 11 * 11);  // 15..25
  EXPECT_EQ(s.out_m.at(15, 25), 2.0F);
  EXPECT_EQ(s.out_m.at(14, 20), 0.0F);
}

TEST(Splat, KeepsTheNearestAndNothingThatIsUnknown) {
  Splat s;
  s.z_m.at(1, 1) = 2.0F;
  s.z_m.at(2, 1) = 1.0F, s.rays.at(2, 1).x = 0.09F;  // 25..34 in x, 16..24 in y
  s.z_m.at(0, 0) = NAN, s.z_m.at(0, 1) = -1.0F;
  s.rays.at(2, 2) = {NAN, NAN}, s.z_m.at(2, 2) = 1.0F;
  s.draw();
  EXPECT_EQ(s.out_m.at(25, 20), 1.0F) << "both are there";
  EXPECT_EQ(s.out_m.at(24, 20), 2.0F);
  EXPECT_EQ(s.known(), 11 * 11 + 9 * 9);
}

TEST(Splat, MovesTheSamplesIntoTheView) {
  Splat s;
  s.z_m.at(1, 1) = 1.0F;
  // Turned by 90 degrees about z, then 0.1 m right and 1 m away: u = 20 + 110 0.1 / 2.
  s.draw({{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0.1, 0, 1.0}});
  EXPECT_EQ(s.out_m.at(25, 20), 2.0F);
  EXPECT_EQ(s.known(), 6 * 5);  // half as large at twice the distance
  s.draw({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -1.5}});
  EXPECT_EQ(s.known(), 0) << "behind the camera";
}

TEST(Splat, AddsToWhatOthersDrew) {
  Splat s;
  s.z_m.at(1, 1) = 2.0F;
  s.draw();
  s.z_m.at(1, 1) = 1.0F;
  s.add({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.05, 0, 0}});  // 20..30 in x
  EXPECT_EQ(s.out_m.at(16, 20), 2.0F);
  EXPECT_EQ(s.out_m.at(25, 20), 1.0F);
  s.z_m.at(1, 1) = 3.0F;
  s.add({});
  EXPECT_EQ(s.out_m.at(25, 20), 1.0F) << "the nearest stays";
}

TEST(Srgb, AreTheValuesOfTheStandard) {
  EXPECT_EQ(linear_of(0), 0.0F);
  EXPECT_EQ(linear_of(255), 1.0F);
  EXPECT_NEAR(linear_of(10), 10 / 255.0 / 12.92, 1e-7);
  EXPECT_NEAR(linear_of(188), 0.502886, 1e-5);
  for (int v = 0; v < 256; ++v) {
    const auto byte = static_cast<std::uint8_t>(v);
    EXPECT_EQ(srgb_of(linear_of(byte)), byte);
  }
  EXPECT_EQ(srgb_of(-1), 0);
  EXPECT_EQ(srgb_of(2), 255);
}

}  // namespace
}  // namespace mixrig::measure
