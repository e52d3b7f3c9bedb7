// SPDX-License-Identifier: Apache-2.0
#include "extras/map/learn/map_learn.h"

#include <algorithm>
#include <chrono>
#include <variant>

#include <nlohmann/json.hpp>

#include "extras/map/learn/path_errors.h"
#include "extras/map/reconstruction/growth/map_scale.h"
#include "extras/map/reconstruction/growth/reconstruct.h"
#include "extras/map/reconstruction/maps/map_file.h"
#include "hal/base/output_folder.h"
#include "hal/base/parallel.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take_source.h"

namespace mixrig::session {
namespace {

/// A picture's time and the true pose of its camera.
struct TrueView {
  double time_s = 0;
  geometry::Pose world_from_camera;
};

/// Data of the take besides the tracks.
struct Beside {
  std::vector<TrueView> truth;
  std::vector<reconstruction::DepthView> depth;  ///< some kDepthViews, evenly over the take
};

constexpr int kDepthViews = 40;

/// Follows features through all pictures of the take.
Result<reconstruction::FeatureTracks> follow_features(const MapLearnOptions& options,
                                                      capture::CaptureSource& source,
                                                      const RigCamera& camera, Beside& beside) {
  const TruePath true_path(options.camera, options.take, source.info(), camera);
  reconstruction::TrackingOptions tracking;
  tracking.tracks = options.tracks;
  reconstruction::FeatureTracker tracker(camera.model, tracking);
  capture::Capture capture;
  int pictures = 0;
  for (int number = 1; number <= source.info().frames; ++number) {
    MIXRIG_ASSIGN(const bool there, source.read(number, capture));
    if (!there) break;
    if (options.progress) options.progress(number, source.info().frames);
    if (number % std::max(1, source.info().frames / kDepthViews) == 0 &&
        capture.status_of(capture::Stream::kDepth) == capture::StreamStatus::kFresh)
      beside.depth.push_back({capture.time_s, capture.depth_m});
    const TakePicture picture = picture_of(capture, options.camera);
    if (picture.image == nullptr) continue;
    MIXRIG_TRY(check_size(picture, camera.model, options.take));
    tracker.add(*picture.image, picture.time_s);
    ++pictures;
    if (const auto pose = true_path.at(picture.time_s, capture))
      beside.truth.push_back(
          {picture.time_s, *pose * geometry::inverse(camera.camera_from_target)});
  }
  if (pictures == 0)
    return Error{ErrorCode::kData, options.take.string() +
                                       ": has no pictures of that camera: record it with the "
                                       "fisheye in rig.toml, or learn by --camera target"};
  return tracker.finish();
}

/// The depth camera by the calibration, or by the take where that has none.
reconstruction::DepthCamera depth_camera(const MapLearnOptions& options,
                                         const capture::SourceInfo& info, const RigCamera& camera) {
  reconstruction::DepthCamera depth{info.tof, geometry::inverse(info.target_from_tof),
                                    info.depth_kind == capture::DepthKind::kDistance};
  const auto& file = options.calibration.empty() ? info.calibration : options.calibration;
  if (const auto tof = rig_camera(file, "tof"); !file.empty() && tof)
    if (const auto* model = std::get_if<geometry::CameraModel>(&tof->model))
      depth.model = *model, depth.from_camera = tof->camera_from_target;
  depth.from_camera = depth.from_camera * geometry::inverse(camera.camera_from_target);
  return depth;
}

Result<std::string> hash_of(const std::filesystem::path& calibration) {
  if (calibration.empty()) return std::string();
  calibration_file::InputHash hash;
  MIXRIG_TRY(hash.add_file(calibration));
  return hash.text();
}

nlohmann::json report_of(const reconstruction::LearnedMap& map, double seconds) {
  nlohmann::json json = {{"pictures", map.pictures},
                         {"poses", map.path.size()},
                         {"keys", map.keys.size()},
                         {"points", map.points.size()},
                         {"descriptors", map.descriptors.size()},
                         {"scale", map.scale ? "metric" : "unknown"},
                         {"residual_px", map.residual_px},
                         {"seconds", seconds}};
  if (map.scale) {
    json["scale_sigma_pct"] = 100 * map.scale->sigma;
    json["scale_measurements"] = map.scale->measurements;
  }
  return json;
}

std::vector<PosePair> pairs_of(const reconstruction::LearnedMap& map,
                               const std::vector<TrueView>& truth) {
  std::vector<PosePair> pairs;
  std::size_t t = 0;
  for (const auto& pose : map.path) {
    while (t < truth.size() && truth[t].time_s < pose.t_s) ++t;
    if (t < truth.size() && truth[t].time_s == pose.t_s)
      pairs.push_back({pose.world_from_body, truth[t].world_from_camera});
  }
  return pairs;
}

}  // namespace

Result<nlohmann::json> learn_map(const MapLearnOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  MIXRIG_TRY(check_output_folder(options.out, reconstruction::kMapManifest, Force::kChecked));
  MIXRIG_ASSIGN(const auto source, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const RigCamera camera,
                tracked_camera(options.camera, options.calibration, source->info()));
  Beside beside;
  MIXRIG_ASSIGN(const auto tracks, follow_features(options, *source, camera, beside));
  reconstruction::ReconstructOptions how;
  how.threads = Crew(options.threads).threads();
  const reconstruction::DepthRecord depth{std::move(beside.depth),
                                          depth_camera(options, source->info(), camera)};
  auto learned = reconstruction::reconstruct(tracks, camera.model, how, &depth);
  if (!learned)
    return Error{learned.error().code, options.take.string() + ": " + learned.error().context};
  reconstruction::LearnedMap& map = *learned;
  map.camera = options.camera == TrackedCamera::kFisheye ? "fisheye" : "target";
  MIXRIG_ASSIGN(
      map.calibration_hash,
      hash_of(options.calibration.empty() ? source->info().calibration : options.calibration));
  MIXRIG_TRY(reconstruction::write_map(map, options.out));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  nlohmann::json json = report_of(map, seconds);
  const nlohmann::json errors = errors_of_path(pairs_of(map, beside.truth), !map.scale);
  if (errors.is_object()) json.update(errors);
  // A metric map's own scale against the truth's.
  const nlohmann::json by_similarity = errors_of_path(pairs_of(map, beside.truth), true);
  if (map.scale && by_similarity.is_object()) {
    json["scale_error_pct"] = 100 * (1 / by_similarity["metres_per_unit"].get<double>() - 1);
    json["rms_similarity_mm"] = by_similarity["rms_mm"];
    json["rms_similarity_pct"] = by_similarity["rms_pct"];
  }
  return json;
}

}  // namespace mixrig::session
