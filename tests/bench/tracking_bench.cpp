// SPDX-License-Identifier: Apache-2.0
// Compares the tracker with what one would build from OpenCV, on the same pictures of a take with
// truth: SIFT features of the room, rendered once, matched to each picture; and interest points
// tracked (KLT) from the room rendered at the last pose (Schiller et al. 2010, section 5.1). Both
// solve for the pose with estimation::solve_pnp. Each uses one thread; the times of KLT are without
// those of rendering. usage: tracking_bench ROOM TAKE CALIBRATION SCENE (SCENE states where the
// room stands)
#include <chrono>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "host/capture/take/take_source.h"
#include "host/math/estimation/pose/pnp.h"
#include "host/pose/tracker/rig_camera.h"
#include "host/pose/tracker/tracker.h"
#include "host/pose/trajectory/trajectory.h"
#include "host/room/scan/room_file.h"
#include "host/scene/scene.h"

namespace {

using namespace mixrig;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Pose;

template <typename T>
T need(Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "%s\n", result.error().context.c_str());
  std::exit(1);
}

/// The room as the fisheye shows it, and the distance of each pixel.
struct Rendering {
  cv::Mat grey;
  Image<float> distance_m;  ///< from the camera; 0 unknown
};

class RoomRenderer {
 public:
  RoomRenderer(const model::Panorama& room, const geometry::FisheyeModel& camera)
      : room_(room), camera_(camera) {}

  /// Draws the room: each pixel's ray is followed until its length is the room's distance in that
  /// direction.
  Rendering draw(const Pose& room_from_camera) const {
    const Size size = camera_.size_px();
    Rendering out{cv::Mat(size.height, size.width, CV_8U, cv::Scalar(0)), Image<float>(size)};
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const auto ray = camera_.unproject({x, y});
        if (!ray) continue;
        const Vector3d along = room_from_camera.rotation * *ray;
        double t = 2;
        Vector3d at;
        bool known = true;
        constexpr int kSteps = 12;
        for (int i = 0; i < kSteps && known; ++i) {
          at = room_from_camera.translation_m + t * along;
          const float wanted_m = pixel(room_.distance_m, at);
          known = wanted_m > 0;
          t = std::max(0.1, t + 0.8 * (wanted_m - at.norm()));
        }
        if (!known) continue;
        const Rgb8 c = pixel(room_.color, at);
        out.grey.at<std::uint8_t>(y, x) =
            static_cast<std::uint8_t>(0.299 * c.r + 0.587 * c.g + 0.114 * c.b);
        out.distance_m.at(x, y) = static_cast<float>(t);
      }
    return out;
  }

 private:
  template <typename T>
  static T pixel(const Image<T>& image, const Vector3d& at) {
    using std::numbers::pi;
    const double azimuth = std::atan2(-at.x(), at.y()), elevation = std::asin(at.z() / at.norm());
    const int x = static_cast<int>((0.5 - azimuth / (2 * pi)) * image.width());
    const int y = static_cast<int>((0.5 - elevation / pi) * image.height());
    return image.at(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1));
  }
  const model::Panorama& room_;
  const geometry::FisheyeModel& camera_;
};

/// Points of the room and the bearings of the pixels that show them.
struct Matches {
  std::vector<Vector3d> points_m;
  std::vector<estimation::Bearing> bearings;

  void add(const geometry::FisheyeModel& camera, const Rendering& drawn, const Pose& drawn_from,
           const cv::Point2f& in_drawing, const cv::Point2f& in_picture) {
    const int x = static_cast<int>(std::lround(in_drawing.x));
    const int y = static_cast<int>(std::lround(in_drawing.y));
    if (x < 0 || y < 0 || x >= drawn.grey.cols || y >= drawn.grey.rows) return;
    const auto ray = camera.unproject({in_drawing.x, in_drawing.y});
    const auto bearing = estimation::bearing_of(camera, {in_picture.x, in_picture.y}, 0.5);
    const float distance_m = drawn.distance_m.at(x, y);
    if (!ray || !bearing || distance_m <= 0) return;
    points_m.push_back(drawn_from * (distance_m * *ray));
    bearings.push_back(*bearing);
  }
  std::optional<Pose> room_from_camera() const {
    constexpr std::size_t kFewest = 12;
    if (points_m.size() < kFewest) return std::nullopt;
    const auto pose = estimation::solve_pnp(points_m, bearings);
    if (!pose.usable() || pose.inliers.size() < kFewest) return std::nullopt;
    return geometry::inverse(pose.value);
  }
};

/// SIFT features of the room, as seen from where it was scanned.
class SiftPeer {
 public:
  SiftPeer(const RoomRenderer& renderer, const geometry::FisheyeModel& camera)
      : camera_(camera), drawn_(renderer.draw(tracking::looking_ahead())) {
    sift_->detectAndCompute(drawn_.grey, {}, points_, descriptors_);
  }
  std::optional<Pose> pose(const cv::Mat& picture) const {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    sift_->detectAndCompute(picture, {}, points, descriptors);
    if (descriptors.empty()) return std::nullopt;
    std::vector<std::vector<cv::DMatch>> pairs;
    cv::BFMatcher(cv::NORM_L2).knnMatch(descriptors, descriptors_, pairs, 2);
    Matches matches;
    constexpr float kRatio = 0.8F;
    for (const auto& pair : pairs)
      if (pair.size() == 2 && pair[0].distance < kRatio * pair[1].distance)
        matches.add(camera_, drawn_, tracking::looking_ahead(),
                    points_[static_cast<std::size_t>(pair[0].trainIdx)].pt,
                    points[static_cast<std::size_t>(pair[0].queryIdx)].pt);
    return matches.room_from_camera();
  }

 private:
  const geometry::FisheyeModel& camera_;
  cv::Ptr<cv::SIFT> sift_ = cv::SIFT::create(2000);
  Rendering drawn_;
  std::vector<cv::KeyPoint> points_;
  cv::Mat descriptors_;
};

/// Pose by KLT from the rendering at the last pose, checked forward and back.
std::optional<Pose> klt_pose(const Rendering& drawn, const geometry::FisheyeModel& camera,
                             const cv::Mat& picture, const Pose& last) {
  std::vector<cv::Point2f> from, to, back;
  cv::goodFeaturesToTrack(drawn.grey, from, 300, 0.01, 8);
  if (from.empty()) return std::nullopt;
  std::vector<std::uint8_t> there, again;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(drawn.grey, picture, from, to, there, error);
  cv::calcOpticalFlowPyrLK(picture, drawn.grey, to, back, again, error);
  Matches matches;
  for (std::size_t i = 0; i < from.size(); ++i)
    if (there[i] != 0 && again[i] != 0 &&
        std::hypot(from[i].x - back[i].x, from[i].y - back[i].y) < 0.5)
      matches.add(camera, drawn, last, from[i], to[i]);
  return matches.room_from_camera();
}

struct Score {
  std::vector<double> mm, ms;
  double squares_mm2 = 0, squares_deg2 = 0;
  int pictures = 0;

  void add(const std::optional<Pose>& pose, const Pose& truth, double took_ms) {
    ++pictures, ms.push_back(took_ms);
    if (!pose) return;
    const double off_mm = 1e3 * (pose->translation_m - truth.translation_m).norm();
    mm.push_back(off_mm);
    squares_mm2 += off_mm * off_mm;
    squares_deg2 +=
        std::pow(pose->rotation.angularDistance(truth.rotation) * 180 / std::numbers::pi, 2);
  }
  void print(const char* name) {
    const auto n = static_cast<double>(mm.size());
    std::sort(mm.begin(), mm.end()), std::sort(ms.begin(), ms.end());
    std::printf(
        "%-30s %3zu of %3d: %7.2f mm %7.4f deg RMS, median %6.2f, largest %8.1f mm; %6.1f ms\n",
        name, mm.size(), pictures, n > 0 ? std::sqrt(squares_mm2 / n) : 0,
        n > 0 ? std::sqrt(squares_deg2 / n) : 0, mm.empty() ? 0 : mm[mm.size() / 2],
        mm.empty() ? 0 : mm.back(), ms[ms.size() / 2]);
  }
};

template <typename Body>
double timed_ms(const Body& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: tracking_bench ROOM TAKE CALIBRATION SCENE\n", stderr);
    return 2;
  }
  cv::setNumThreads(1);
  const auto rooms = need(model::load_rooms(argv[1]));
  const model::Panorama& room = rooms.front().room.panorama;
  const auto source = need(take::open_take_source(argv[2]));
  const auto rig = need(session::rig_camera(argv[3], "fisheye"));
  const scene::Scene scene = need(scene::load_scene(argv[4]));
  const Pose base_from_world =
      geometry::inverse(scene.background.world_from_base.value_or(scene.camera.world_from_base));
  const auto truth = need(trajectory::read_samples(std::string(argv[2]) + "/truth/fisheye.tum"));
  const auto* camera = std::get_if<geometry::FisheyeModel>(&rig.model);
  if (camera == nullptr) return std::fputs("tracking_bench: no fisheye\n", stderr), 1;
  Crew crew(1);
  tracking::Tracker tracker(room, rig.model, {}, crew);
  const RoomRenderer renderer(room, *camera);
  const SiftPeer sift(renderer, *camera);
  Score ours, by_sift, by_klt;
  std::optional<Pose> last;
  capture::Capture capture;
  std::size_t picture = 0;
  for (int number = 1; number <= source->info().frames; ++number) {
    need(source->read(number, capture));
    if (capture.status_of(capture::Stream::kFisheye) != capture::StreamStatus::kFresh) continue;
    const Pose is = base_from_world * truth.at(picture).world_from_body;
    const double time_s = truth.at(picture++).t_s;
    std::optional<Pose> found;
    double ms = timed_ms([&] {
      const auto tracked = tracker.track(capture.fisheye, time_s);
      if (tracked.known) found = tracked.room_from_camera;
    });
    ours.add(found, is, ms);
    cv::Mat grey;
    const cv::Mat rgb(capture.fisheye.height(), capture.fisheye.width(), CV_8UC3,
                      static_cast<void*>(capture.fisheye.row(0)),
                      static_cast<std::size_t>(capture.fisheye.stride()) * sizeof(Rgb8));
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    ms = timed_ms([&] { found = sift.pose(grey); });
    by_sift.add(found, is, ms);
    if (!last) last = is;                          // a chain needs a start: it gets the true pose
    const Rendering drawn = renderer.draw(*last);  // not timed: it is a plain loop here
    ms = timed_ms([&] { found = klt_pose(drawn, *camera, grey, *last); });
    if (found) last = found;
    by_klt.add(found, is, ms);
  }
  ours.print("mixrig");
  by_sift.print("SIFT 2000, PnP");
  by_klt.print("KLT 300 from a rendering, PnP");
  return 0;
}
