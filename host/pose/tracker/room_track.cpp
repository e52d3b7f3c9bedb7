// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/room_track.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "host/capture/take/take_source.h"
#include "host/math/geometry/linear.h"
#include "host/math/image_io/image_io.h"
#include "host/pose/source/smooth_poses.h"
#include "host/pose/tracker/take_pictures.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

/// Returns e^T C^-1 e of the camera's pose in the room.
double nees_of(const tracking::TrackedPose& pose, const geometry::Pose& true_room_from_camera) {
  const Eigen::AngleAxisd turn(true_room_from_camera.rotation *
                               pose.room_from_camera.rotation.conjugate());
  Eigen::Matrix<double, 6, 1> e;
  e << turn.angle() * turn.axis(),
      true_room_from_camera.translation_m - pose.room_from_camera.translation_m;
  return e.dot(geometry::SymmetricSolver<6>(pose.covariance).solve(e));
}

/// Computes the values that follow from a picture's pose.
class Placed {
 public:
  Placed(const std::optional<geometry::Pose>& world_from_base,
         const geometry::Pose& camera_from_target)
      : world_from_base_(world_from_base.value_or(geometry::Pose{})),
        camera_from_target_(camera_from_target) {}
  void place(TrackedPicture& p) const {
    p.world_from_target = world_from_base_ * p.pose.room_from_camera * camera_from_target_;
    if (p.truth && p.pose.known)
      p.nees = nees_of(p.pose, geometry::inverse(world_from_base_) * *p.truth *
                                   geometry::inverse(camera_from_target_));
  }

 private:
  const geometry::Pose world_from_base_, camera_from_target_;
};

/// Returns the pictures with each pose smoothed over those up to `reach_s` before and after it,
/// without a lost one between.
std::vector<TrackedPicture> smoothed(const std::vector<TrackedPicture>& pictures, double reach_s,
                                     const Placed& placed) {
  std::vector<TrackedPicture> all = pictures;
  std::vector<pose::MeasuredPose> around;
  const auto near = [&](std::size_t i, std::size_t k) {
    return pictures[k].pose.known && std::abs(pictures[k].time_s - pictures[i].time_s) <= reach_s;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].pose.known) continue;
    constexpr std::size_t kMostToASide = (pose::kMostSmoothed - 1) / 2;
    std::size_t begin = i, end = i + 1;
    while (begin > 0 && i - begin < kMostToASide && near(i, begin - 1)) --begin;
    while (end < all.size() && end - i <= kMostToASide && near(i, end)) ++end;
    around.clear();
    for (std::size_t k = begin; k < end; ++k)
      around.push_back(
          {pictures[k].time_s, pictures[k].pose.room_from_camera, pictures[k].pose.covariance});
    const pose::MeasuredPose pose = pose::smooth_at(around, all[i].time_s);
    all[i].pose.room_from_camera = pose.room_from_body;
    all[i].pose.covariance = pose.covariance;
    placed.place(all[i]);
  }
  return all;
}

/// Returns the number of the frame that is played at `step`, forwards and backwards.
int played_frame(int step, int frames) {
  const int pass = step / frames, at = step % frames;
  return pass % 2 == 0 ? at + 1 : frames - at;
}

/// Returns the time of a picture when the take is played forwards and backwards, begin_s to end_s;
/// it grows.
double played_s(double time_s, int pass, double begin_s, double end_s) {
  const double before_s = pass * (end_s - begin_s);
  return pass % 2 == 0 ? before_s + time_s : before_s + begin_s + end_s - time_s;
}

/// Draws squares on the patches: green if they count, red if not.
void draw_patches(const tracking::PatchAlign& patches, Image<Rgb8>& picture) {
  constexpr int kHalf = 2;
  for (const auto& seen : patches.seen()) {
    if (!seen.in_picture) continue;
    const Rgb8 color = seen.weight > 0 ? Rgb8{60, 255, 60} : Rgb8{255, 50, 50};
    const int x = static_cast<int>(std::lround(seen.px.x()));
    const int y = static_cast<int>(std::lround(seen.px.y()));
    for (int j = -kHalf; j <= kHalf; ++j)
      for (int i = -kHalf; i <= kHalf; ++i) {
        const bool border = std::abs(i) == kHalf || std::abs(j) == kHalf;
        if (border && x + i >= 0 && y + j >= 0 && x + i < picture.width() &&
            y + j < picture.height())
          picture.at(x + i, y + j) = color;
      }
  }
}

Result<void> write_drawing(const fs::path& folder, std::size_t number,
                           const tracking::Tracker& tracker, bool known, Image<Rgb8> picture) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    return system_error(ErrorCode::kIo, "cannot create " + folder.string(), failed.value());
  if (known) draw_patches(tracker.patches(), picture);
  return image_io::write_png(folder / fmt::format("{:06}.png", number), picture);
}

}  // namespace

Result<RoomTrack> track_room(const RoomTrackOptions& options) {
  MIXRIG_ASSIGN(const auto rooms, model::load_rooms(options.room));
  const model::RoomFile& room = rooms.front().room;  // the first of joined rooms
  MIXRIG_ASSIGN(const auto source, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const RigCamera camera,
                tracked_camera(options.camera, options.calibration, source->info()));
  const TruePath truth(options.camera, options.take, source->info(), camera);
  const auto place =
      options.world_from_base ? options.world_from_base : room.manifest.world_from_base;
  const Placed placed(place, camera.camera_from_target);
  Crew crew(options.threads);
  tracking::TrackerOptions tracking = options.tracker;
  tracking.distance_sigma = room.manifest.distance_sigma;
  tracking::Tracker tracker(room.panorama, camera.model, tracking, crew);
  RoomTrack track;
  track.world_known = place.has_value();
  capture::Capture capture;
  const int frames = source->info().frames, steps = frames * options.passes;
  double begin_s = 0, end_s = 0;  // of the take: half a frame before and after its pictures
  for (int step = 0; step < steps; ++step) {
    MIXRIG_ASSIGN(const bool there, source->read(played_frame(step, frames), capture));
    if (!there) break;
    if (options.progress) options.progress(step + 1, steps);
    const TakePicture picture = picture_of(capture, options.camera);
    if (picture.image == nullptr) continue;
    MIXRIG_TRY(check_size(picture, camera.model, options.take));
    const double half_s = 0.5 / source->info().rate_hz;
    if (track.pictures.empty()) begin_s = picture.time_s - half_s;
    if (step < frames) end_s = picture.time_s + half_s;
    TrackedPicture tracked;
    tracked.time_s = played_s(picture.time_s, step / frames, begin_s, end_s);
    if (options.anew) tracker.forget();
    const auto start = std::chrono::steady_clock::now();
    tracked.pose = tracker.track(*picture.image, tracked.time_s);
    tracked.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    track.seconds += tracked.seconds;
    if (place) tracked.truth = truth.at(picture.time_s, capture);
    placed.place(tracked);
    track.pictures.push_back(tracked);
    if (!options.drawings.empty())
      MIXRIG_TRY(write_drawing(options.drawings, track.pictures.size(), tracker, tracked.pose.known,
                               *picture.image));
  }
  if (track.pictures.empty())
    return Error{ErrorCode::kData, options.take.string() +
                                       ": has no pictures of that camera: record it with the "
                                       "fisheye in rig.toml, or track by --camera target"};
  track.counts = tracker.counts(), track.anew = options.anew;
  if (options.smooth_s > 0) {
    track.latency_s = options.smooth_s;
    track.unsmoothed = smoothed(track.pictures, options.smooth_s, placed);
    track.pictures.swap(track.unsmoothed);
  }
  return track;
}

}  // namespace mixrig::session
