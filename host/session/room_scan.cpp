// SPDX-License-Identifier: Apache-2.0
#include "host/session/room_scan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <future>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "host/calibration_file/calibration.h"
#include "host/capture/calibrated_source.h"
#include "host/image_io/image_io.h"
#include "host/model/room_file.h"
#include "host/pose/pan_tilt_poses.h"
#include "host/scene/glb_writer.h"
#include "host/take/take_source.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

constexpr int kLengths = 100;  ///< per axis (Schiller et al. 2010, table 1)

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct SweepPictures {
  std::vector<model::ScanView> views;
  int frames = 0;
};

/// Frames of a view are averaged as they are read.
Result<SweepPictures> read_sweep(capture::CaptureSource& source,
                                 const calibration_file::PanTilt& unit) {
  const capture::SourceInfo& info = source.info();
  model::ViewAverage average(info.tof, info.noise,
                             info.depth_kind == capture::DepthKind::kDistance);
  SweepPictures sweep;
  capture::Capture frame;
  std::optional<device::PanTiltAngles> at;
  const auto finish = [&] {
    if (!sweep.views.empty())
      average.finish(sweep.views.back().distance_m, sweep.views.back().sigma_m);
    average.clear();
  };
  for (int number = 1; number <= info.frames; ++number) {
    MIXRIG_ASSIGN(const bool more, source.read(number, frame));
    if (!more) break;
    if (!frame.pan_tilt)
      return Error{ErrorCode::kData, fmt::format("frame {} has no angles of the head: only a take "
                                                 "with pan_tilt.csv can be scanned",
                                                 number)};
    if (!at || at->pan_rad != frame.pan_tilt->pan_rad || at->tilt_rad != frame.pan_tilt->tilt_rad) {
      finish();
      at = frame.pan_tilt;
      model::ScanView view;
      view.base_from_target = pose::base_from_target(unit, *at);
      view.base_from_tof = view.base_from_target * info.target_from_tof;
      view.plate = frame.plate;
      sweep.views.push_back(std::move(view));
    }
    average.add(frame.depth_m.view(), frame.amplitude.view());
    ++sweep.frames;
  }
  finish();
  return sweep;
}

Result<measure::RoomFrame> true_frame(const fs::path& path) {
  std::ifstream file(path);
  const nlohmann::json truth = nlohmann::json::parse(file, nullptr, false);
  const auto missing = [&] {
    return Error{ErrorCode::kNotFound, "'" + path.string() +
                                           "' does not say how large the room is: --evaluate needs "
                                           "a take of mixrig studio --scenario sweep"};
  };
  if (truth.is_discarded() || !truth.contains("room_m") || !truth.contains("world_from_base"))
    return missing();
  try {
    measure::RoomFrame frame;
    frame.inner_m = truth["room_m"].get<std::array<double, 3>>();
    const auto& pose = truth["world_from_base"];
    frame.origin_m = pose.at("translation_m").get<std::array<double, 3>>();
    const auto q = pose.at("rotation_xyzw").get<std::array<double, 4>>();
    const Eigen::Matrix3d axes = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
    for (int i = 0; i < 9; ++i)
      frame.world_from_axes[static_cast<std::size_t>(i)] = axes(i / 3, i % 3);
    return frame;
  } catch (const nlohmann::json::exception&) {
    return missing();
  }
}

Result<measure::RoomErrors> room_errors_of(const model::Panorama& panorama, const fs::path& take) {
  MIXRIG_ASSIGN(const measure::RoomFrame frame, true_frame(take / "truth/rig.json"));
  MIXRIG_ASSIGN(const auto truth, image_io::read_exr(take / "truth/room.exr"));
  if (truth.empty() || truth[0].pixels.size() != panorama.size())
    return Error{ErrorCode::kData,
                 "'" + (take / "truth/room.exr").string() +
                     "' has another size than the panorama: scan with its height"};
  return measure::room_errors(panorama.distance_m.view(), truth[0].pixels.view(), frame, kLengths);
}

Result<void> write_mesh(const RoomScan& scan, const fs::path& path) {
  if (scan.mesh.indices.empty()) return {};
  scene::Model file;
  scene::Mesh& mesh = file.meshes.emplace_back();
  mesh.positions_m = scan.mesh.positions_m, mesh.normals = scan.mesh.normals;
  mesh.uv = scan.mesh.uv, mesh.indices = scan.mesh.indices, mesh.texture = 0;
  file.textures.push_back(scan.panorama.color);
  return scene::write_glb(file, "room", path);
}

}  // namespace

Result<RoomScan> scan_room(const RoomScanOptions& options) {
  MIXRIG_ASSIGN(auto recorded, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const auto source,
                capture::with_calibration(std::move(recorded), options.calibration));
  MIXRIG_ASSIGN(const auto known, calibration_file::read_calibration(options.calibration));
  if (!known.pan_tilt)
    return Error{ErrorCode::kFormat, "'" + options.calibration.string() +
                                         "' has no pan-tilt unit: run mixrig calibrate ptu"};
  const Stopwatch reading;
  MIXRIG_ASSIGN(const SweepPictures sweep, read_sweep(*source, *known.pan_tilt));
  RoomScan scan;
  scan.views = static_cast<int>(sweep.views.size()), scan.frames = sweep.frames;
  scan.read_seconds = reading.seconds();
  const Stopwatch modelling;
  Crew crew(options.threads);
  scan.panorama = model::make_panorama(sweep.views, source->info().tof, source->info().target,
                                       options.height_px, options.smooth, crew);
  scan.model_seconds = modelling.seconds();
  const Stopwatch meshing;
  const model::RoomMesh grid = model::grid_mesh(scan.panorama);
  scan.triangles_raw = grid.indices.size() / 3;
  scan.tolerance_m = model::mesh_tolerance_m(scan.panorama);
  scan.mesh = model::simplified(grid, scan.panorama.size(), scan.tolerance_m, crew);
  scan.mesh_seconds = meshing.seconds();
  if (options.evaluate) {
    MIXRIG_ASSIGN(scan.errors, room_errors_of(scan.panorama, options.take));
  }
  return scan;
}

Result<void> save_room(const RoomScan& scan, const fs::path& calibration, const fs::path& folder) {
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(folder, "manifest.toml"));
  calibration_file::InputHash hash;
  MIXRIG_TRY(hash.add_file(calibration));
  model::RoomManifest manifest;
  manifest.views = scan.views, manifest.frames = scan.frames;
  manifest.triangles = static_cast<int>(scan.mesh.indices.size() / 3);
  manifest.mesh_tolerance_m = scan.tolerance_m;
  manifest.calibration_hash = hash.text();
  // The large picture is encoded twice, beside itself: it is in the model, too.
  std::future<Result<void>> mesh =
      std::async(std::launch::async, [&] { return write_mesh(scan, partial.path() / "room.glb"); });
  const Result<void> pictures = model::write_room(scan.panorama, manifest, partial.path());
  MIXRIG_TRY(mesh.get());
  MIXRIG_TRY(pictures);
  return partial.commit();
}

}  // namespace mixrig::session
