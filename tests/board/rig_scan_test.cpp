// SPDX-License-Identifier: Apache-2.0
// The command sweeps the emulated pan-tilt unit through the box room, which both cameras see at the
// unit's current angles; the written room is compared with the box.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take.h"
#include "host/math/image_io/image_io.h"
#include "tests/board/rig_bench.h"
#include "tests/support/box_head.h"
#include "tests/support/child_process.h"

namespace mixrig::board {
namespace {

constexpr const char *kBoxRoom = "/tmp/box", *kBoxSweep = "/tmp/box.sweep";
constexpr const char* kBoxCalibration = "/tmp/box.toml";
constexpr int kFieldPan_deg = 100, kFieldTilt_deg = 60, kBoxViewFrames = 4;

/// Shows the cameras the room. After each move the head oscillates for some tenths of a second,
/// which its encoders do not measure. Pictures are drawn only where something has changed.
class BoxLook {
 public:
  explicit BoxLook(VirtualRig& rig) : rig_(rig) {
    draw(kColorLine, {}), draw(kDepthLine, {});  // the ToF camera then reports what its steps mean
  }
  void operator()(int line, device::PanTiltAngles at, HostTime now) {
    if (at.pan_rad != at_.pan_rad || at.tilt_rad != at_.tilt_rad) at_ = at, moved_ = now;
    least_pan_rad = std::min(least_pan_rad, at.pan_rad);
    most_pan_rad = std::max(most_pan_rad, at.pan_rad);
    at.pan_rad += swing_rad(seconds(now - moved_));
    device::PanTiltAngles& drawn = line == kColorLine ? color_drawn_ : depth_drawn_;
    if (at.pan_rad == drawn.pan_rad && at.tilt_rad == drawn.tilt_rad) return;
    drawn = at;
    draw(line, at);
  }
  double least_pan_rad = 0, most_pan_rad = 0;
  int pictures = 0;

 private:
  static double swing_rad(double rest_s) {
    constexpr double kSwing_rad = 0.01, kSwing_hz = 4, kDecay_s = 0.1, kOver_s = 1;
    if (rest_s > kOver_s) return 0;
    return kSwing_rad * std::exp(-rest_s / kDecay_s) *
           std::sin(2 * std::numbers::pi * kSwing_hz * rest_s);
  }
  void draw(int line, device::PanTiltAngles at) {
    ++pictures;
    if (line == kColorLine)
      rig_.color.show_picture(head_.yuyv(at.pan_rad, at.tilt_rad));
    else
      rig_.depth.show(head_.distances_mm(at.pan_rad, at.tilt_rad));
  }

  VirtualRig& rig_;
  const test::BoxHead head_;
  device::PanTiltAngles at_, color_drawn_, depth_drawn_;
  HostTime moved_{};
};

std::shared_ptr<BoxLook> see_the_box(VirtualRig& rig) {
  auto look = std::make_shared<BoxLook>(rig);
  rig.set_look(
      [look](int line, device::PanTiltAngles at, HostTime now) { (*look)(line, at, now); });
  fs::remove_all(kBoxRoom), fs::remove_all(kBoxSweep);
  EXPECT_TRUE(calibration_file::write_calibration(kBoxCalibration, test::box_calibration()));
  return look;
}

std::vector<std::string> scan_words(const char* rig, const char* report) {
  return {"mixrig",        "scan",
          "--rig",         rig,
          "--calibration", kBoxCalibration,
          "--field",       std::to_string(kFieldPan_deg) + "x" + std::to_string(kFieldTilt_deg),
          "--view-frames", std::to_string(kBoxViewFrames),
          "--height",      "360",
          "--json",        report,
          kBoxRoom};
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Median differences of the written colours from the walls', in steps of luma and chroma.
struct ColorErrors {
  double luma = 0, chroma = 0;
};

ColorErrors color_errors(const Image<Rgb8>& color) {
  std::vector<double> luma, chroma;
  const int w = color.width(), h = color.height(), half_x = w * kFieldPan_deg / 720,
            half_y = h * kFieldTilt_deg / 360;
  for (int y = h / 2 - half_y; y < h / 2 + half_y; ++y)
    for (int x = w / 2 - half_x; x < w / 2 + half_x; ++x) {
      const Eigen::Vector3d ray = test::panorama_ray(x, y, w, h);
      const auto [wall, length_m] = test::BoxRoom::hit(Eigen::Vector3d::Zero(), ray);
      const Rgb8 p = color.at(x, y);
      const double cb = 128 - 0.148 * p.r - 0.291 * p.g + 0.439 * p.b;
      const double cr = 128 + 0.439 * p.r - 0.368 * p.g - 0.071 * p.b;
      luma.push_back(std::abs(16 + 0.257 * p.r + 0.504 * p.g + 0.098 * p.b -
                              test::BoxRoom::luma(wall, length_m * ray)));
      chroma.push_back(
          std::hypot(cb - test::BoxRoom::kChroma[wall][0], cr - test::BoxRoom::kChroma[wall][1]));
    }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  return {median(luma), median(chroma)};
}

/// Compares the written room with the box.
void expect_the_box() {
  const auto channels = image_io::read_exr(std::string(kBoxRoom) + "/room.exr");
  ASSERT_TRUE(channels) << to_line(channels.error());
  const auto found = std::find_if(channels->begin(), channels->end(),
                                  [](const auto& c) { return c.name == "distance_m"; });
  ASSERT_NE(found, channels->end());
  const Image<float>& distance_m = found->pixels;
  const auto errors =
      test::box_errors(distance_m.width(), distance_m.height(), kFieldPan_deg, kFieldTilt_deg,
                       [&](int x, int y) { return distance_m.at(x, y); });
  ASSERT_FALSE(errors.surface_mm.empty());
  measured("%.2f %% of the field known; from the true walls 50 %% within %.2f mm, 95 %% %.2f mm",
           errors.known_pct, errors.surface(0.5), errors.surface(0.95));
  EXPECT_EQ(errors.known_pct, 100);
  EXPECT_LT(errors.surface(0.95), 2);
  const std::array names{"width", "height", "depth"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto length =
        test::length_errors(errors, test::kBoxLengths[i][0], test::kBoxLengths[i][1]);
    measured("%s: errors of 100 lengths %.2f mm in the mean, %.2f mm at most", names[i],
             length.mean_mm, length.largest_mm);
    EXPECT_LT(length.mean_mm, 2) << names[i];
    EXPECT_LT(length.largest_mm, 4) << names[i];
  }
  Image<Rgb8> color;
  ASSERT_TRUE(image_io::read_rgb8(std::string(kBoxRoom) + "/color.png", color));
  const ColorErrors wrong = color_errors(color);
  measured("colours: luma off by %.1f, chroma by %.1f in the median", wrong.luma, wrong.chroma);
  EXPECT_LT(wrong.luma, 4);
  EXPECT_LT(wrong.chroma, 4);
}

TEST_F(Rig, ScanHasTheLengthsOfTheRoom) {
  const auto look = see_the_box(rig_);
  const std::vector<std::string> words = scan_words(kConfig, kReport);
  std::string command;
  for (const std::string& word : words) command += word + " ";
  const Ran ran = run(command);
  std::printf("%s", ran.text.c_str());
  ASSERT_EQ(ran.status, 0) << ran.text;
  rig_.set_look({});
  const Json report = read_json(kReport);
  const int views = report["views"];
  EXPECT_EQ(report["frames"], kBoxViewFrames * views);
  EXPECT_GT(report["sweep"]["covered_pct"].get<double>(), 99.9);
  EXPECT_GE(report["sweep"]["restarts"].get<int>(), 1) << "the head swings where it stops";
  measured(
      "%d views in %.1f s, %d times the picture was not at rest; pan from %.1f to %.1f deg, "
      "%d pictures drawn",
      views, report["sweep"]["seconds"].get<double>(), report["sweep"]["restarts"].get<int>(),
      look->least_pan_rad * 180 / std::numbers::pi, look->most_pan_rad * 180 / std::numbers::pi,
      look->pictures);
  EXPECT_LT(look->least_pan_rad, -0.3);
  EXPECT_GT(look->most_pan_rad, 0.3);
  expect_the_box();
  EXPECT_FALSE(fs::exists(kBoxSweep));
}

/// Whether the last picture of view `number` has been written.
bool has_view(int number) {
  char name[32];
  std::snprintf(name, sizeof name, "/color/%06d.png", number * kBoxViewFrames);
  return fs::exists(kBoxSweep + std::string(name));
}

/// Number of views in the folder of the sweep, read as a take.
int views_kept() {
  const auto take = take::TakeReader::open(kBoxSweep);
  EXPECT_TRUE(take);
  return take ? take->info().frames / kBoxViewFrames : 0;
}

TEST_F(Rig, ScanGoesOnWhereTheUnitWasUnpluggedAndAfterCtrlC) {
  (void)see_the_box(rig_);
  const std::vector<std::string> words = scan_words(kConfig, kReport);
  constexpr int kLimit_s = 60;
  const char *log = "/tmp/scan.log", *errors = "/tmp/scan.errors";
  {
    test::ChildProcess scan(words, kLimit_s, log, errors);
    ASSERT_TRUE(wait_until([] { return has_view(1); })) << text_of(errors);
    rig_.head_port.unplug();
    EXPECT_EQ(scan.wait(), 1);
  }
  const std::string lost = text_of(errors);
  std::printf("%s", lost.c_str());
  EXPECT_NE(lost.find("pan-tilt unit"), std::string::npos) << lost;
  EXPECT_NE(lost.find("the same command goes on with the next"), std::string::npos) << lost;
  EXPECT_EQ(std::count(lost.begin(), lost.end(), '\n'), 1) << lost;
  const int before = views_kept();
  EXPECT_GE(before, 1);
  EXPECT_FALSE(fs::exists(kBoxRoom));

  ASSERT_TRUE(rig_.plug_head());
  {
    test::ChildProcess scan(words, kLimit_s, log, errors);
    ASSERT_TRUE(wait_until([&] { return has_view(before + 1); })) << text_of(errors);
    scan.signal(SIGINT);
    EXPECT_EQ(scan.wait(), 1);
  }
  const std::string stopped = text_of(errors);
  std::printf("%s", stopped.c_str());
  EXPECT_NE(stopped.find("views, which are kept"), std::string::npos) << stopped;
  const int kept = views_kept();

  test::ChildProcess scan(words, kLimit_s, log, errors);
  ASSERT_EQ(scan.wait(), 0) << text_of(errors);
  const Json report = read_json(kReport);
  EXPECT_EQ(report["sweep"]["resumed"], kept);
  EXPECT_EQ(report["frames"], kBoxViewFrames * report["views"].get<int>());
  measured("%d views before the unit was unplugged, %d at Ctrl-C, %d at the end", before, kept,
           report["views"].get<int>());
  expect_the_box();
  EXPECT_FALSE(fs::exists(kBoxSweep));
}

}  // namespace
}  // namespace mixrig::board
