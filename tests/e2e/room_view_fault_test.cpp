// SPDX-License-Identifier: Apache-2.0
// Sweeps of the studio with a fault in a view or in the room go through `mixrig scan --take`. Each
// fault is reported with its place, unknown areas stay unknown, and the rest of the room is as good
// as without the fault.
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RoomViewFault : public CommandTest {
 protected:
  static constexpr int kFrames = 2;  ///< frames per view

  void sweep(const std::string& options) const {
    std::filesystem::remove_all(path("take"));
    ASSERT_EQ(
        studio(
            "take",
            "--scenario sweep --size 64x48 --rig sr3000 --seed 31 --overlap 0.2 --view-frames 2 " +
                options),
        0);
  }
  nlohmann::json scanned(const std::string& options = "") const {
    EXPECT_EQ(mixrig("scan --take " + path("take") + " --calibration " +
                     path("take/truth/calibration.toml") + " " + path("room") + " --evaluate " +
                     options + " --json " + path("room.json")),
              0);
    return report("room.json");
  }
  static std::vector<nlohmann::json> named(const nlohmann::json& report, const std::string& kind) {
    std::vector<nlohmann::json> found;
    for (const auto& finding : report.at("findings"))
      if (finding.at("kind") == kind) found.push_back(finding);
    return found;
  }
  static double surface(const nlohmann::json& report, const char* key) {
    return report.at("evaluate").at("surface").at(key).get<double>();
  }
  /// Replaces a view by a copy of the one before it: pictures and angles of its frames.
  void drop_view(int view) const {
    const int last = kFrames * (view - 1);
    for (int frame = last + 1; frame <= last + kFrames; ++frame)
      for (const char* stream : {"color", "depth", "amplitude"})
        std::filesystem::copy_file(picture(stream, last), picture(stream, frame),
                                   std::filesystem::copy_options::overwrite_existing);
    std::ifstream in(path("take/pan_tilt.csv"));
    std::ostringstream out;
    std::string line, angles_of_last;
    for (int frame = 0; std::getline(in, line); ++frame) {  // line 0 is the header
      const std::string angles = line.substr(line.find(','));
      if (frame == last) angles_of_last = angles;
      const bool dropped = frame > last && frame <= last + kFrames;
      out << (dropped ? std::to_string(frame) + angles_of_last : line) << '\n';
    }
    in.close();
    std::ofstream(path("take/pan_tilt.csv")) << out.str();
  }

 private:
  std::string picture(const std::string& stream, int frame) const {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "/%06d.png", frame);
    return path("take/" + stream + name.data());
  }
};

/// At the border of a sweep, a missing view is reported if the field is known. For a view inside
/// the sweep see RoomFindings.ADroppedViewLeavesAnAreaThatNoViewShows.
TEST_F(RoomViewFault, ADroppedViewIsMissedWhereItWas) {
  ASSERT_NO_FATAL_FAILURE(sweep("--plain --field 120x90"));
  const auto sound = scanned("--field 120x90");
  EXPECT_TRUE(named(sound, "unseen").empty()) << sound.at("findings");
  constexpr int kDropped = 17, kViews = 18;  // the middle view of the upper row
  ASSERT_EQ(sound.at("views").get<int>(), kViews);
  drop_view(kDropped);
  const auto without = scanned("--field 120x90");
  EXPECT_EQ(without.at("views").get<int>(), kViews - 1);
  const auto missed = named(without, "unseen");
  ASSERT_EQ(missed.size(), 1U) << without.at("findings");
  EXPECT_NEAR(missed[0].at("azimuth_deg").get<double>(), 0, 8);
  EXPECT_NEAR(missed[0].at("elevation_deg").get<double>(), 41, 6);
  EXPECT_LT(surface(without, "p95_mm"), 1.1 * surface(sound, "p95_mm"));
  EXPECT_LT(without.at("evaluate").at("max_mm").at("depth").get<double>(), 12);
}

/// The studio's four lamps are panels under the ceiling: in the sweep two are in sight.
TEST_F(RoomViewFault, SaturatedLampsAreNamedWhereTheyAre) {
  ASSERT_NO_FATAL_FAILURE(sweep("--plain --field 120x60"));
  const auto room = scanned();
  const auto lamps = named(room, "saturated_view");
  ASSERT_FALSE(lamps.empty());
  for (const auto& lamp : lamps) {
    if (lamp.at("value").get<double>() < 1) continue;  // the rim of a lamp, and bright spots
    EXPECT_GT(lamp.at("elevation_deg").get<double>(), 15) << lamp;
    EXPECT_LT(lamp.at("elevation_deg").get<double>(), 45) << lamp;
  }
  EXPECT_EQ(room.at("fill_pct").get<double>(), 100);
  EXPECT_LT(room.at("evaluate").at("max_mm").at("depth").get<double>(), 12);
}

/// A window or mirror of 0.95 x 1.1 m replaces a picture straight ahead, 4 m away. Here it is
/// glass.
TEST_F(RoomViewFault, GlassWithoutDepthStaysUnknownAndIsNamed) {
  ASSERT_NO_FATAL_FAILURE(sweep("--plain --field 120x60"));
  const auto without = scanned();
  ASSERT_NO_FATAL_FAILURE(sweep("--plain --window --field 120x60"));
  const auto with = scanned();
  const auto unknown = named(with, "without_depth");
  ASSERT_EQ(unknown.size(), 1U) << with.at("findings");
  EXPECT_NEAR(unknown[0].at("azimuth_deg").get<double>(), 2, 4);
  EXPECT_NEAR(unknown[0].at("elevation_deg").get<double>(), 0, 4);
  EXPECT_TRUE(named(without, "without_depth").empty());
  EXPECT_LT(with.at("fill_pct").get<double>(), 99.9);
  EXPECT_LT(with.at("evaluate").at("max_mm").at("depth").get<double>(), 12);
  EXPECT_LT(surface(with, "p50_mm"), 1.1 * surface(without, "p50_mm"));
}

/// Through the mirror the sr3000 sees a surface at 9 m, beyond its range of 7.5 m, and measures 2
/// m.
TEST_F(RoomViewFault, DepthOfAMirrorThatWrapsAroundIsNamedAndLeftOut) {
  ASSERT_NO_FATAL_FAILURE(sweep("--plain --field 120x60"));
  const auto without = scanned();
  ASSERT_NO_FATAL_FAILURE(sweep("--only mirror --field 120x60"));
  const auto with = scanned();
  const auto wrapped = named(with, "wrapped");
  ASSERT_EQ(wrapped.size(), 1U) << with.at("findings");
  EXPECT_NEAR(wrapped[0].at("azimuth_deg").get<double>(), 2, 4);
  EXPECT_NEAR(wrapped[0].at("elevation_deg").get<double>(), 0, 4);
  EXPECT_GT(wrapped[0].at("value").get<double>(), 100);
  EXPECT_TRUE(named(without, "wrapped").empty());
  EXPECT_EQ(named(with, "without_depth").size(), 1U) << with.at("findings");
  EXPECT_LT(with.at("evaluate").at("max_mm").at("depth").get<double>(), 12);
  EXPECT_LT(surface(with, "over_20mm_pct"), surface(without, "over_20mm_pct") + 2);
}

}  // namespace
}  // namespace mixrig::test
