// SPDX-License-Identifier: Apache-2.0
// A room is learned from the pictures of a swinging camera. The camera is then located in it in the
// same take, on another day and after the lens was covered, but not in another room; the map is
// aligned with a scan of the room. Maps that the motion does not let join are refused; those of a
// carried rig are joined.
#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class LearnedRun : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    ASSERT_EQ(studio("take", std::string(kRig) + " --frames 120 --size 320x256"), 0);
  }

  int learn(const std::string& camera) const {
    return mixrig("learn --take " + path("take") + kCalibrated +
                  path("take/truth/calibration.toml") + " --camera " + camera + " " +
                  path(camera + "_map") + " --json " + path(camera + ".json"));
  }
  std::string track_words(const std::string& take, const std::string& json) const {
    return "track --map " + path("fisheye_map") + " --take " + path(take) + kCalibrated +
           path("take/truth/calibration.toml") + " " + path(json + ".tum") + " --json " +
           path(json);
  }
  /// Copies a take and changes the fisheye's pictures.
  template <typename Change>
  void copy_take(const std::string& from, const std::string& to, Change&& change) const {
    std::filesystem::copy(path(from), path(to), std::filesystem::copy_options::recursive);
    int number = 0;
    for (;; ++number) {
      char name[32];
      std::snprintf(name, sizeof name, "/fisheye/%06d.png", number + 1);
      Image<Rgb8> picture;
      if (!std::filesystem::exists(path(to + name))) break;
      ASSERT_TRUE(image_io::read_rgb8(path(to + name), picture));
      change(number, picture);
      ASSERT_TRUE(image_io::write_png(path(to + name), picture.view()));
    }
    ASSERT_GT(number, 10);
  }

  void check_another_day() const;
  void check_another_room() const;
  void check_join() const;
  void check_room() const;

  static constexpr const char* kRig =
      " --scenario pendulum --rig sr3000 --seed 34 --plain --fisheye --fisheye-size 320x256";
  static constexpr const char* kCalibrated = " --calibration ";
};

void cover(int number, Image<Rgb8>& picture) {
  if (number >= 6 && number < 9) picture.fill({});
}

/// Mirrors the picture: a mirrored room is another room.
void mirror(int, Image<Rgb8>& picture) {
  for (int y = 0; y < picture.height(); ++y)
    std::reverse(picture.row(y), picture.row(y) + picture.width());
}

/// Other light, one more person, the chair elsewhere; then the lens is covered for a while.
void LearnedRun::check_another_day() const {
  ASSERT_EQ(studio("day", std::string(kRig) +
                              " --frames 60 --size 160x128 --moved-chair --lamps 0.5 --crowd 1"),
            0);
  ASSERT_EQ(mixrig(track_words("day", "day.json")), 0);
  EXPECT_LT(report("day.json").at("lost_pct").get<double>(), 10);
  EXPECT_LT(report("day.json").at("rms_mm").get<double>(), 8);
  copy_take("day", "covered", cover);
  ASSERT_EQ(mixrig(track_words("covered", "covered.json")), 0);
  const auto covered = report("covered.json");
  const double black_pct = 100 * 3.0 / covered.at("frames").get<double>();
  EXPECT_GE(covered.at("lost_pct").get<double>(), black_pct - 1e-9);
  EXPECT_LT(covered.at("lost_pct").get<double>(), black_pct + 15);
  EXPECT_LT(covered.at("rms_mm").get<double>(), 8);
}

void LearnedRun::check_another_room() const {
  copy_take("day", "mirrored", mirror);
  const std::string said = refusal(track_words("mirrored", "mirrored.json"));
  EXPECT_NE(said.find("explains none of its pictures"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(path("mirrored.json.tum")));
}

/// A pendulum turns about one axis: the maps of its two cameras cannot be joined, which must be
/// reported.
void LearnedRun::check_join() const {
  ASSERT_EQ(learn("target"), 0);
  const std::string said = refusal("align --join " + path("joined") + " " + path("target_map") +
                                   " " + path("fisheye_map"));
  EXPECT_NE(said.find("turn about one axis only"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(path("joined")));
}

/// Aligns the map with a scan of the room: the poses are then those of the target camera in the
/// world.
void LearnedRun::check_room() const {
  const std::string truth = path("take/truth/calibration.toml");
  const std::string words = "align " + path("fisheye_map") + " " + path("room") + " --room " +
                            path("placed") + " --json " + path("placed.json");
  ASSERT_EQ(studio("sweep",
                   "--scenario sweep --field 150x100 --view-frames 1 --rig sr3000 --seed 34 "
                   "--plain --size 160x128"),
            0);
  ASSERT_EQ(mixrig("scan --take " + path("sweep") + kCalibrated +
                   path("sweep/truth/calibration.toml") + " " + path("room")),
            0);
  EXPECT_NE(refusal(words).find("--room needs --calibration"), std::string::npos);
  ASSERT_EQ(mixrig(words + kCalibrated + truth), 0);
  const auto placed = report("placed.json");
  EXPECT_GE(placed.at("keys_agree").get<int>(), 3);
  EXPECT_NEAR(placed.at("metres_per_unit").get<double>(), 1, 0.03);
  ASSERT_EQ(mixrig("track --map " + path("placed") + " --take " + path("take") + kCalibrated +
                   truth + " --scene " + path("sweep/scene_pan_tilt.toml") + " " +
                   path("world.tum") + " --json " + path("world.json")),
            0);
  EXPECT_EQ(report("world.json").at("axes"), "room");
  EXPECT_LT(report("world.json").at("rms_mm").get<double>(), 10);
  EXPECT_LT(report("world.json").at("rms_deg").get<double>(), 0.3);
}

/// Joins the maps of both cameras of a carried rig: the time offset between them is zero, the
/// rotation is that of the calibration, and both maps are metric.
class CarriedRun : public CommandTest {
 protected:
  void learn(const std::string& camera) const {
    ASSERT_EQ(mixrig("learn --take " + path("take") + " --calibration " +
                     path("take/truth/calibration.toml") + " --camera " + camera + " " +
                     path(camera + "_map") + " --json " + path(camera + ".json")),
              0);
    EXPECT_EQ(report(camera + ".json").at("scale"), "metric");
  }
};

TEST_F(CarriedRun, TheMapsOfItsTwoCamerasAreJoined) {
  ASSERT_EQ(studio("take",
                   "--scenario carried --rig sr3000 --seed 34 --plain --frames 150 --size 320x256 "
                   "--fisheye --fisheye-size 320x256"),
            0);
  ASSERT_NO_FATAL_FAILURE(learn("target"));
  ASSERT_NO_FATAL_FAILURE(learn("fisheye"));
  ASSERT_EQ(mixrig("align --join " + path("joined") + " " + path("target_map") + " " +
                   path("fisheye_map") + " --json " + path("join.json")),
            0);
  const auto joined = report("join.json");
  EXPECT_LT(std::abs(joined.at("time_offset_s").get<double>()), 0.02);
  EXPECT_NEAR(joined.at("scale").get<double>(), 1, 0.05);
  EXPECT_TRUE(std::filesystem::exists(path("joined/map.toml")));
}

TEST_F(LearnedRun, TheCameraIsFoundInALearnedRoom) {
  ASSERT_EQ(learn("fisheye"), 0);
  const auto learned = report("fisheye.json");
  EXPECT_EQ(learned.at("poses"), learned.at("pictures"));
  EXPECT_EQ(learned.at("scale"), "metric");
  EXPECT_LT(learned.at("rms_similarity_pct").get<double>(), 0.6);
  EXPECT_LT(std::abs(learned.at("scale_error_pct").get<double>()),
            3 * learned.at("scale_sigma_pct").get<double>());
  ASSERT_EQ(mixrig(track_words("take", "same.json")), 0);
  EXPECT_EQ(report("same.json").at("lost_pct"), 0);
  EXPECT_LT(report("same.json").at("rms_mm").get<double>(), 4);
  check_another_day();
  check_another_room();
  check_join();
  check_room();
}

}  // namespace
}  // namespace mixrig::test
