// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/room_scan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <future>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "hal/base/partial_path.h"
#include "hal/base/percentile.h"
#include "hal/base/srgb.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/calibration_file/depth_sigma.h"
#include "host/capture/capture/calibrated_source.h"
#include "host/capture/capture/unwrapped_source.h"
#include "host/capture/take/take_source.h"
#include "host/math/image_io/image_io.h"
#include "host/output/report/picture.h"
#include "host/room/scan/room_file.h"
#include "host/room/sweep/sweep_views.h"
#include "host/scene/gltf/glb_writer.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

constexpr int kLengths = 100;  ///< per axis (Schiller et al. 2010, table 1)
constexpr float kLargestShown_mm = 40;
constexpr double kLeastTurn_rad = kLeastTurn_deg * kDeg;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

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

/// The calibration with its unit, none where no file was given: then frames need poses.
Result<std::optional<calibration_file::Calibration>> known_rig(const fs::path& calibration) {
  if (calibration.empty()) return std::optional<calibration_file::Calibration>();
  MIXRIG_ASSIGN(auto known, calibration_file::read_calibration(calibration));
  if (!known.pan_tilt)
    return Error{ErrorCode::kFormat,
                 "'" + calibration.string() + "' has no pan-tilt unit: run mixrig calibrate ptu"};
  return std::optional(std::move(known));
}

/// Folder of a take that is given as a folder or as its take.toml.
fs::path folder_of(const fs::path& take) {
  std::error_code error;
  return fs::is_directory(take, error) ? take : take.parent_path();
}

DepthReach depth_reach(const calibration_file::DepthError& error, const model::Panorama& p) {
  constexpr double kAlike_m = 0.1;  // the error hardly changes over it; the camera is as far off
  DepthReach reach{error.knots_m.back(), 0};
  const model::Directions directions(p.size());
  double known = 0, beyond = 0;
  for (int y = 0; y < p.size().height; ++y)
    for (int x = 0; x < p.size().width; ++x) {
      const float distance_m = p.distance_m.row(y)[x];
      if (distance_m <= 0) continue;
      known += directions.across(y);
      if (distance_m > reach.far_m + kAlike_m) beyond += directions.across(y);
    }
  reach.beyond_pct = known > 0 ? 100 * beyond / known : 0;
  return reach;
}

/// Distances of the pixels of another size. Inverse distances are interpolated: on a plane they are
/// linear in the ray, and nearly so in the angles of a pixel.
Image<float> at_size(const Image<float>& distance_m, Size size) {
  const Size from = distance_m.size();
  Image<float> out(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double u = (x + 0.5) * from.width / size.width - 0.5;
      const double v =
          std::clamp((y + 0.5) * from.height / size.height - 0.5, 0.0, from.height - 1.001);
      const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(v);
      const double right = u - left, down = v - top;
      const auto at = [&](int dx, int dy) {
        return distance_m.row(top + dy)[(left + dx + from.width) % from.width];
      };
      const auto [low, high] = std::minmax({at(0, 0), at(1, 0), at(0, 1), at(1, 1)});
      const float nearest = at(right > 0.5 ? 1 : 0, down > 0.5 ? 1 : 0);
      const bool edge = low <= 0 || model::is_depth_step(low, high);
      const auto row = [&](int dy) { return (1 - right) / at(0, dy) + right / at(1, dy); };
      out.row(y)[x] =
          edge ? nearest : static_cast<float>(1 / ((1 - down) * row(0) + down * row(1)));
    }
  return out;
}

/// Relative distance error that the calibration's depth error leaves, at the median distance.
Result<double> distance_sigma(const model::Panorama& panorama, const fs::path& calibration) {
  if (calibration.empty()) return 0.0;
  MIXRIG_ASSIGN(const auto known, calibration_file::read_calibration(calibration));
  std::vector<float> distances_m;
  for (int y = 0; y < panorama.size().height; ++y)
    std::copy_if(panorama.distance_m.row(y), panorama.distance_m.row(y) + panorama.size().width,
                 std::back_inserter(distances_m), [](float d) { return d > 0; });
  if (!known.depth_error || distances_m.empty()) return 0.0;
  const double median_m = measure::quantile(std::move(distances_m), 0.5);
  return calibration_file::depth_sigma_m(*known.depth_error, median_m) / median_m;
}

/// Luminance of the room's light in the pixels of the distances: -1 where it is not known.
Image<float> luminance_at(const model::Panorama& p, Size size, Image<float>& saturated) {
  const int factor = p.light.height() / size.height;
  Image<float> out(size);
  saturated.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const int u = factor * x + factor / 2, v = factor * y + factor / 2;
      const RgbHalf& c = p.light.row(v)[u];
      const bool known = !(p.color.row(v)[u] == Rgb8{});
      out.row(y)[x] = known ? kRec709Red * float_of_half(c.r) + kRec709Green * float_of_half(c.g) +
                                  kRec709Blue * float_of_half(c.b)
                            : -1.0F;
      saturated.row(y)[x] = p.light_saturated.row(v)[u];
    }
  return out;
}

Result<std::optional<measure::RoomLightErrors>> judge_light(const model::Panorama& panorama,
                                                            const fs::path& take) {
  std::optional<measure::RoomLightErrors> errors;
  const fs::path path = take / "truth/light.exr";
  std::error_code missing;
  if (panorama.light.empty() || !fs::exists(path, missing)) return errors;
  MIXRIG_ASSIGN(const auto truth, image_io::read_exr(path));  // B, G, R: in order of their names
  if (truth.size() != 3 || panorama.light.height() % truth[0].pixels.height() != 0) return errors;
  Image<float> is(truth[0].pixels.size()), saturated;
  for (int y = 0; y < is.height(); ++y)
    for (int x = 0; x < is.width(); ++x)
      is.row(y)[x] = kRec709Blue * truth[0].pixels.row(y)[x] +
                     kRec709Green * truth[1].pixels.row(y)[x] +
                     kRec709Red * truth[2].pixels.row(y)[x];
  const Image<float> found = luminance_at(panorama, is.size(), saturated);
  errors = measure::room_light_errors(found.view(), std::as_const(saturated).view(),
                                      std::as_const(is).view());
  return errors;
}

}  // namespace

Result<JudgedRoom> judge_room(const model::Panorama& panorama, const fs::path& take) {
  MIXRIG_ASSIGN(const measure::RoomFrame frame, true_frame(take / "truth/rig.json"));
  MIXRIG_ASSIGN(const auto truth, image_io::read_exr(take / "truth/room.exr"));
  if (truth.empty())
    return Error{ErrorCode::kData, "'" + (take / "truth/room.exr").string() + "' has no picture"};
  const bool same = truth[0].pixels.size() == panorama.size();
  const Image<float> resized = same ? Image<float>() : at_size(truth[0].pixels, panorama.size());
  const auto model_m = panorama.distance_m.view();
  const auto true_m = (same ? truth[0].pixels : resized).view();
  return JudgedRoom{measure::room_errors(model_m, true_m, frame, kLengths),
                    measure::off_surface_mm(model_m, true_m)};
}

Result<RoomScan> scan_room(const RoomScanOptions& options) {
  MIXRIG_ASSIGN(auto recorded, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const auto known, known_rig(options.calibration));
  const fs::path calibration =
      options.calibration.empty() ? recorded->info().calibration : options.calibration;
  MIXRIG_ASSIGN(auto calibrated, capture::with_calibration(std::move(recorded), calibration));
  const auto source = capture::without_wrapped_depth(std::move(calibrated));
  if (source->info().lens)
    log_warning("scan", options.take.string() +
                            ": the encoders of the lens are recorded, but a room is scanned with "
                            "the lens as cameras.target says: it must have stood there");
  const Stopwatch reading;
  Crew crew(options.threads);
  MIXRIG_ASSIGN(SweepViews sweep, read_sweep(*source, known ? &*known->pan_tilt : nullptr, crew));
  if (!known && !source->info().moves)
    log_warning("scan", options.take.string() +
                            ": its camera stands still: the room is what all frames show of one "
                            "view, people too; --frames FIRST-LAST takes the empty ones alone");
  MIXRIG_TRY(add_brackets(folder_of(options.take), sweep, crew));
  const geometry::CameraModel &tof = source->info().tof, &target = source->info().target;
  RoomScan scan;
  scan.views = static_cast<int>(sweep.views.size()), scan.frames = sweep.frames;
  scan.world_from_base = sweep.world_from_base;
  scan.read_seconds = reading.seconds();
  const Stopwatch modelling;
  if (options.modulation_hz > 0)
    scan.bounced = take_out_bounced_light(tof, options.modulation_hz, sweep.views, crew);
  scan.alignment = model::align(sweep.views, tof, target, kLeastTurn_rad, crew);
  if (options.align)
    for (std::size_t i = 0; i < sweep.views.size(); ++i)
      model::turn(scan.alignment.views[i].turn_rad, sweep.views[i]);
  scan.align_seconds = modelling.seconds();
  scan.exposures = model::find_exposures(sweep.views);
  model::join_brackets(scan.exposures, sweep.views, crew);
  scan.panorama = model::make_panorama(sweep.views, tof, target, options.panorama, crew);
  scan.findings =
      model::find_faults({sweep.views, target, scan.alignment, scan.panorama, options.field_deg});
  if (known && known->depth_error)
    scan.depth_reach = depth_reach(*known->depth_error, scan.panorama);
  scan.model_seconds = modelling.seconds();
  const Stopwatch meshing;
  const model::RoomMesh grid = model::grid_mesh(scan.panorama);
  scan.triangles_raw = grid.indices.size() / 3;
  scan.tolerance_m = options.mesh_tolerance_m.value_or(model::mesh_tolerance_m(scan.panorama));
  scan.mesh = model::simplified(grid, scan.panorama.size(), scan.tolerance_m, crew);
  scan.mesh_seconds = meshing.seconds();
  if (options.evaluate) {
    MIXRIG_ASSIGN(JudgedRoom judged, judge_room(scan.panorama, options.take));
    MIXRIG_ASSIGN(scan.light_errors, judge_light(scan.panorama, options.take));
    scan.errors = judged.errors, scan.off_mm = std::move(judged.off_mm);
    if (!scan.mesh.indices.empty())
      scan.mesh_errors = measure::mesh_errors(
          {scan.mesh.positions_m.front().data(), 3 * scan.mesh.positions_m.size()},
          scan.mesh.indices, scan.panorama.distance_m.view());
  }
  return scan;
}

Result<void> write_mesh(const model::RoomMesh& from, const Image<Rgb8>& color,
                        const fs::path& path) {
  if (from.indices.empty()) return {};
  scene::Model file;
  scene::Mesh& mesh = file.meshes.emplace_back();
  mesh.positions_m = from.positions_m, mesh.normals = from.normals;
  mesh.uv = from.uv, mesh.indices = from.indices, mesh.texture = 0;
  file.textures.push_back(color);
  return scene::write_glb(file, "room", path);
}

Result<void> save_room(const RoomScan& scan, const fs::path& calibration, const fs::path& folder) {
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(folder, "manifest.toml"));
  calibration_file::InputHash hash;
  if (!calibration.empty()) {
    MIXRIG_TRY(hash.add_file(calibration));
  }
  model::RoomManifest manifest;
  manifest.views = scan.views, manifest.frames = scan.frames;
  manifest.triangles = static_cast<int>(scan.mesh.indices.size() / 3);
  manifest.mesh_tolerance_m = scan.tolerance_m;
  manifest.calibration_hash = calibration.empty() ? "" : hash.text();
  manifest.vignetting = scan.panorama.gains.vignetting;
  manifest.world_from_base = scan.world_from_base;
  MIXRIG_ASSIGN(manifest.distance_sigma, distance_sigma(scan.panorama, calibration));
  // The large picture is encoded twice, beside itself: it is in the model, too.
  std::future<Result<void>> mesh = std::async(std::launch::async, [&] {
    return guarded("writing room.glb", [&] {
      return write_mesh(scan.mesh, scan.panorama.color, partial.path() / "room.glb");
    });
  });
  const Result<void> pictures = model::write_room(scan.panorama, manifest, partial.path());
  if (!scan.off_mm.empty())
    MIXRIG_TRY(image_io::write_png(partial.path() / "error.png",
                                   report::error_picture(scan.off_mm, kLargestShown_mm, "mm")));
  MIXRIG_TRY(mesh.get());
  MIXRIG_TRY(pictures);
  // A folder is replaced where nothing in it is newer than its manifest.
  std::error_code ignored;
  fs::last_write_time(partial.path() / "manifest.toml", fs::file_time_type::clock::now(), ignored);
  return partial.commit();
}

}  // namespace mixrig::session
