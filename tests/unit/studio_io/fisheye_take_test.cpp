// SPDX-License-Identifier: Apache-2.0
// The fisheye of a studio take, read back: its own times, and the pixels where the pipeline's lens
// model puts the lamps by the true pose.
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take.h"
#include "host/pose/trajectory/trajectory.h"
#include "studio/io/studio_take.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::studio_io {
namespace {

using capture::Stream;
using capture::StreamStatus;
namespace fs = std::filesystem;

studio::StudioOptions fisheye_options(studio::Scenario scenario, int frames) {
  studio::StudioOptions options;
  options.scenario = scenario;
  options.rig = studio::RigPreset::kSr3000;
  options.seed = 14;
  options.frames = frames;
  options.size_px = {32, 32};
  options.tolerance = 1;
  options.threads = 1;
  options.fisheye = true;
  options.fisheye_px = {96, 80};
  return options;
}

std::string bytes_of(const fs::path& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

struct Seen {
  capture::Capture capture;
  geometry::Pose world_from_fisheye;
};

class FisheyeOfStudio : public ::testing::Test {
 protected:
  studio::StudioInfo make(const studio::StudioOptions& options, const char* name = "take") {
    auto written = write_studio_take(options, folder_ / name, take::StreamFormat::kPng, [](int) {});
    EXPECT_TRUE(written) << written.error().context;
    return *std::move(written);
  }
  /// The captures with a fresh picture, and the true poses, which must have the pictures' stamps.
  std::vector<Seen> fresh() {
    std::vector<Seen> seen;
    auto reader = take::TakeReader::open(folder_ / "take");
    EXPECT_TRUE(reader) << reader.error().context;
    const auto truth = trajectory::read_samples(folder_ / "take/truth/fisheye.tum");
    EXPECT_TRUE(truth) << truth.error().context;
    for (int number = 1; number <= reader->info().frames; ++number) {
      Seen one;
      const auto read = reader->read(number, one.capture);
      EXPECT_TRUE(read) << read.error().context;
      if (one.capture.status_of(Stream::kFisheye) != StreamStatus::kFresh) continue;
      const auto& sample = truth->at(seen.size());
      EXPECT_NEAR(
          sample.t_s,
          1e-9 * static_cast<double>(one.capture.fisheye_mid_exposure.time_since_epoch().count()),
          2e-9);
      one.world_from_fisheye = sample.world_from_body;
      seen.push_back(std::move(one));
    }
    EXPECT_EQ(seen.size(), truth->size());
    return seen;
  }
  geometry::FisheyeModel model() {
    const auto known = calibration_file::read_calibration(folder_ / "take/truth/calibration.toml");
    EXPECT_TRUE(known) << known.error().context;
    const calibration_file::CalibratedCamera* camera = known->camera("fisheye");
    EXPECT_NE(camera, nullptr);
    return camera != nullptr ? std::get<geometry::FisheyeModel>(camera->model)
                             : geometry::FisheyeModel{};
  }

  const test::TemporaryFolder folder_;
};

TEST_F(FisheyeOfStudio, HasItsOwnRateAndTimes) {
  const studio::StudioInfo info = make(fisheye_options(studio::Scenario::kPan, 10));
  const std::vector<Seen> seen = fresh();
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_EQ(info.fisheye_pictures, 4);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const capture::Capture& c = seen[k].capture;
    EXPECT_EQ(c.fisheye_counter, k + 1);
    EXPECT_NEAR(seconds(c.fisheye_mid_exposure - seen[0].capture.fisheye_mid_exposure),
                0.1 * static_cast<double>(k), 1e-8);
    EXPECT_GT(std::abs(seconds(c.fisheye_mid_exposure - c.mid_exposure)), 1e-3);
    EXPECT_LT(std::abs(seconds(c.fisheye_mid_exposure - c.mid_exposure)), 0.02);
  }
}

TEST_F(FisheyeOfStudio, LeavesTheRestOfTheTakeAsItWas) {
  studio::StudioOptions options = fisheye_options(studio::Scenario::kHandheld, 4);
  options.realism.motion_blur = true;
  make(options);
  options.fisheye = false;
  make(options, "without");
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "without")) {
    if (!entry.is_regular_file()) continue;
    const fs::path name = fs::relative(entry.path(), folder_ / "without");
    if (name == "take.toml" || name == "truth/calibration.toml") continue;
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder_ / "take" / name)) << name;
    ++files;
  }
  EXPECT_GT(files, 30);
  EXPECT_FALSE(fs::exists(folder_ / "without/fisheye.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "without/truth/fisheye.tum"));
  EXPECT_EQ(bytes_of(folder_ / "without/take.toml").find("fisheye"), std::string::npos);
}

/// Mean of the pixels that show a lamp, by the picture or by the lens model and the true pose.
struct Blob {
  double x_px = 0, y_px = 0;
  int pixels = 0;
  void add(int x, int y) { x_px += x, y_px += y, ++pixels; }
  Eigen::Vector2d centre() const { return Eigen::Vector2d(x_px, y_px) / pixels; }
};

/// The lamps are panels whose sides lie along x and y of the world. What is seen of one lies 2 mm
/// above the plane that it shines from.
bool looks_at(const studio::Panel& lamp, const Eigen::Vector3d& eye, const Eigen::Vector3d& ray,
              double margin) {
  constexpr double kSeenAbove_m = 0.002;
  const double t = (lamp.position_m.z() + kSeenAbove_m - eye.z()) / ray.z();
  if (!(t > 0)) return false;
  const Eigen::Vector3d off = eye + t * ray - lamp.position_m;
  return std::abs(off.x()) < margin * 0.5 * lamp.size_m.x() &&
         std::abs(off.y()) < margin * 0.5 * lamp.size_m.y();
}

TEST_F(FisheyeOfStudio, ShowsTheLampsWhereTheLensModelAndTheTruePosePutThem) {
  studio::StudioOptions options = fisheye_options(studio::Scenario::kPan, 4);
  options.fisheye_px = {640, 512};
  const studio::StudioInfo info = make(options);
  const geometry::FisheyeModel lens = model();
  int compared = 0;
  for (const Seen& seen : fresh()) {
    const Image<Rgb8>& picture = seen.capture.fisheye;
    ASSERT_EQ(picture.size(), lens.size_px());
    for (const studio::Panel& lamp : info.light.lamps) {
      Blob shown, projected;
      for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
          const auto ray = lens.unproject(Eigen::Vector2d(x, y));
          if (!ray) continue;
          const Eigen::Vector3d in_world = seen.world_from_fisheye.rotation * *ray;
          const Eigen::Vector3d& eye = seen.world_from_fisheye.translation_m;
          if (!looks_at(lamp, eye, in_world, 1.5)) continue;
          if (looks_at(lamp, eye, in_world, 1)) projected.add(x, y);
          if (picture.at(x, y) == Rgb8{255, 255, 255}) shown.add(x, y);
        }
      // A lamp that the rim cuts, or that furniture hides, shows fewer pixels.
      if (projected.pixels < 30 ||
          std::abs(shown.pixels - projected.pixels) > 0.2 * projected.pixels)
        continue;
      ++compared;
      EXPECT_LT((shown.centre() - projected.centre()).norm(), 0.1)
          << lamp.name << " " << shown.pixels << " of " << projected.pixels;
    }
  }
  EXPECT_GE(compared, 2);
}

}  // namespace
}  // namespace mixrig::studio_io
