// SPDX-License-Identifier: Apache-2.0
#include "host/session/room_track.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/image_io/image_io.h"
#include "host/measure/percentile.h"
#include "host/model/room_file.h"
#include "host/session/take_pictures.h"
#include "host/take/take_source.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

/// Errors of the pictures that have a pose and truth.
struct PathErrors {
  std::vector<double> shift_mm, turn_deg, nees, number;
};

PathErrors errors_of(const RoomTrack& track) {
  PathErrors errors;
  for (std::size_t i = 0; i < track.pictures.size(); ++i) {
    const TrackedPicture& p = track.pictures[i];
    if (!p.pose.known || !p.truth) continue;
    const Eigen::Quaterniond turn = p.truth->rotation * p.world_from_target.rotation.conjugate();
    const Eigen::AngleAxisd angle(turn);
    errors.shift_mm.push_back(1e3 *
                              (p.world_from_target.translation_m - p.truth->translation_m).norm());
    errors.turn_deg.push_back(angle.angle() * 180 / std::numbers::pi);
    errors.number.push_back(static_cast<double>(i));
    errors.nees.push_back(p.nees);
  }
  return errors;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double rms_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// Of y over x by least squares; 0 for fewer than two values.
double slope_of(const std::vector<double>& x, const std::vector<double>& y) {
  const double mean_x = mean_of(x), mean_y = mean_of(y);
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
  return xx > 0 ? xy / xx : 0;
}

/// e^T C^-1 e of the camera's pose in the room.
double nees_of(const tracking::TrackedPose& pose, const geometry::Pose& true_room_from_camera) {
  const Eigen::AngleAxisd turn(true_room_from_camera.rotation *
                               pose.room_from_camera.rotation.conjugate());
  Eigen::Matrix<double, 6, 1> e;
  e << turn.angle() * turn.axis(),
      true_room_from_camera.translation_m - pose.room_from_camera.translation_m;
  return e.dot(pose.covariance.ldlt().solve(e));
}

}  // namespace

namespace {

/// Number of the frame that is played as the `step`th: to and fro.
int played_frame(int step, int frames) {
  const int pass = step / frames, at = step % frames;
  return pass % 2 == 0 ? at + 1 : frames - at;
}

/// Time of a picture when the take is played to and fro, begin_s to end_s; grows.
double played_s(double time_s, int pass, double begin_s, double end_s) {
  const double before_s = pass * (end_s - begin_s);
  return pass % 2 == 0 ? before_s + time_s : before_s + begin_s + end_s - time_s;
}

/// Squares on the places of the patches: green where they count, red where they do not.
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
  const model::RoomFile& room = rooms.front().room;  // of joined rooms the first
  MIXRIG_ASSIGN(const auto source, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const RigCamera camera,
                tracked_camera(options.camera, options.calibration, source->info()));
  const TruePath truth(options.camera, options.take, source->info(), camera);
  const auto place =
      options.world_from_base ? options.world_from_base : room.manifest.world_from_base;
  const geometry::Pose world_from_base = place.value_or(geometry::Pose{});
  Crew crew(options.threads);
  tracking::TrackerOptions tracking = options.tracker;
  tracking.distance_sigma = room.manifest.distance_sigma;
  tracking::Tracker tracker(room.panorama, camera.model, tracking, crew);
  RoomTrack track;
  track.world_known = place.has_value();
  capture::Capture capture;
  const int frames = source->info().frames, steps = frames * options.passes;
  double begin_s = 0, end_s = 0;  // of the take, half a frame before and after its pictures
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
    const auto start = std::chrono::steady_clock::now();
    tracked.pose = tracker.track(*picture.image, tracked.time_s);
    tracked.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    track.seconds += tracked.seconds;
    tracked.world_from_target =
        world_from_base * tracked.pose.room_from_camera * camera.camera_from_target;
    if (place) tracked.truth = truth.at(picture.time_s, capture);
    if (tracked.truth && tracked.pose.known)
      tracked.nees = nees_of(tracked.pose, geometry::inverse(world_from_base) * *tracked.truth *
                                               geometry::inverse(camera.camera_from_target));
    track.pictures.push_back(tracked);
    if (!options.drawings.empty())
      MIXRIG_TRY(write_drawing(options.drawings, track.pictures.size(), tracker, tracked.pose.known,
                               *picture.image));
  }
  if (track.pictures.empty())
    return Error{ErrorCode::kData, options.take.string() +
                                       ": has no pictures of that camera: record it with the "
                                       "fisheye in rig.toml, or track by --camera target"};
  track.counts = tracker.counts();
  return track;
}

nlohmann::json to_json(const RoomTrack& track) {
  const auto frames = static_cast<double>(track.pictures.size());
  std::vector<double> sigma_mm;
  std::vector<float> frame_ms, search_ms;
  for (const TrackedPicture& p : track.pictures) {
    const bool followed = p.pose.known && !p.pose.searched;
    (followed ? frame_ms : search_ms).push_back(static_cast<float>(1e3 * p.seconds));
    if (p.pose.known)
      sigma_mm.push_back(1e3 * std::sqrt(p.pose.covariance.diagonal().tail<3>().sum()));
  }
  nlohmann::json json = {{"frames", track.pictures.size()},
                         {"lost_pct", 100 * static_cast<double>(track.counts.lost) / frames},
                         {"fps", track.seconds > 0 ? frames / track.seconds : 0},
                         {"frame_ms", measure::quantile(frame_ms, 0.5)},
                         {"search_ms", measure::quantile(search_ms, 0.5)},
                         {"searches", track.counts.searches},
                         {"sigma_mm", mean_of(sigma_mm)}};
  const PathErrors errors = errors_of(track);
  if (errors.shift_mm.empty()) return json;
  json["rms_mm"] = rms_of(errors.shift_mm), json["rms_deg"] = rms_of(errors.turn_deg);
  json["p95_mm"] = measure::quantile({errors.shift_mm.begin(), errors.shift_mm.end()}, 0.95);
  json["max_mm"] = *std::max_element(errors.shift_mm.begin(), errors.shift_mm.end());
  json["drift_mm_per_1000"] = 1000 * slope_of(errors.number, errors.shift_mm);
  json["nees"] = mean_of(errors.nees);
  return json;
}

std::string to_tum(const RoomTrack& track) {
  std::string text = "# t x y z qx qy qz qw of world_from_target\n";
  for (const TrackedPicture& p : track.pictures) {
    if (!p.pose.known) continue;
    const auto& t = p.world_from_target.translation_m;
    const auto& q = p.world_from_target.rotation;
    text += fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.time_s,
                        t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

}  // namespace mixrig::session
