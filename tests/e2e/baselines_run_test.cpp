// SPDX-License-Identifier: Apache-2.0
// Validates the measures: plain composites, a composite without one lamp and a key without colour
// must each be worse than the compositor in the measure made for that defect.
#include <gtest/gtest.h>

#include "tests/e2e/command.h"
#include "tests/e2e/shadows.h"
#include "tests/support/seeds.h"

namespace mixrig::test {
namespace {

class BaselinesRun : public CommandTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(studio("take", "--plain --scenario talk --rig kinect2 --seed " +
                                 std::to_string(seeds::kBaselines) + " --size 320x256 --frames 12"),
              0);
  }
  nlohmann::json run(const std::string& scene, const std::string& words = "") const {
    EXPECT_EQ(mixrig("run " + scene + " --source take:" + path("take") + " --backend cpu --json " +
                     path("report.json") + " " + words),
              0);
    return report("report.json");
  }
  std::string without_color() const {
    std::ifstream in(path("take/scene.toml"));
    std::string scene{std::istreambuf_iterator<char>(in), {}};
    std::ofstream(path("take/no_color.toml")) << scene << "\n[quality]\nkey = \"plain\"\n";
    return path("take/no_color.toml");
  }
};

double of(const nlohmann::json& errors, const char* key) { return errors.at(key).get<double>(); }

TEST_F(BaselinesRun, PlainCompositesAndWrongOnesAreWorseInTheirOwnMeasure) {
  const std::string scene = path("take/scene.toml");
  const nlohmann::json report = run(scene, "--baselines");
  const auto& error = report.at("error");
  const auto& contested = error.at("contested");
  const double shadow = of(error, "light_shadow_rmse");
  EXPECT_LE(shadow, kMostShadowRmse);

  const auto& plate = report.at("baselines").at("plate");
  EXPECT_GT(of(plate, "order_wrong_pct"), 90);
  EXPECT_LT(of(plate.at("contested"), "color_psnr_db"), of(contested, "color_psnr_db") - 6);
  EXPECT_TRUE(plate.at("object_rmse").is_null()) << "it shows no object";

  const auto& pasted = report.at("baselines").at("pasted");
  EXPECT_GT(of(pasted, "light_shadow_rmse"), 3 * shadow);
  EXPECT_GT(of(pasted, "order_wrong_pct"), 1.5 * of(error, "order_wrong_pct"));
  EXPECT_LT(of(pasted.at("contested"), "color_psnr_db"), of(contested, "color_psnr_db") - 1.5);

  const auto& depth_key = report.at("baselines").at("depth_key");
  EXPECT_LT(of(depth_key, "key_iou"), of(error, "key_iou") - 0.1);
  EXPECT_GT(of(depth_key.at("contested"), "matte_mse"), 3 * of(contested, "matte_mse"));

  const auto& ideal = report.at("baselines").at("ideal");
  EXPECT_GT(of(ideal.at("contested"), "color_psnr_db"), of(contested, "color_psnr_db"));
  EXPECT_TRUE(ideal.at("key_iou").is_null());

  // The hard pixels ("contested") do not depend on the composite that is measured, and are a small
  // part of the picture.
  for (const auto& [name, baseline] : report.at("baselines").items())
    EXPECT_EQ(of(baseline.at("contested"), "pixels_pct"), of(contested, "pixels_pct")) << name;
  EXPECT_LT(of(contested, "pixels_pct"), 50);
  EXPECT_LT(of(contested, "color_psnr_db"), of(error, "color_psnr_db"));

  const nlohmann::json dark = run(with_lamps(scene, 0)).at("error");
  EXPECT_GT(of(dark, "light_shadow_rmse"), 2 * kMostShadowRmse);
  EXPECT_GT(of(dark, "object_rmse"), 3 * of(error, "object_rmse"));
  const nlohmann::json one_less = run(with_lamps(scene, 3)).at("error");
  EXPECT_GT(of(one_less, "light_shadow_rmse"), kMostShadowRmse);
  EXPECT_GT(of(one_less, "object_rmse"), 1.5 * of(error, "object_rmse"));
  const nlohmann::json colorless = run(without_color()).at("error");
  EXPECT_LT(of(colorless.at("contested"), "key_iou"), of(contested, "key_iou") - 0.012);
}

}  // namespace
}  // namespace mixrig::test
