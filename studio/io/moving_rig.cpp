// SPDX-License-Identifier: Apache-2.0
#include "studio/io/moving_rig.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "host/math/config/writer.h"
#include "studio/io/truth_json.h"

namespace mixrig::studio_io {
namespace {

constexpr double kMaster_hz = 100;

/// Base axes of the unit in the target camera's at rest: z is the pan axis, x the tilt axis's part
/// across it, the origin the pan axis's point nearest to the tilt axis.
geometry::Pose rest_from_base(const studio::PanTiltUnit& unit) {
  const Eigen::Vector3d z = unit.pan.direction;
  const Eigen::Vector3d x = (unit.tilt.direction - unit.tilt.direction.dot(z) * z).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return {Eigen::Quaterniond(axes).normalized(), unit.pan.point_m};
}

calibration_file::PanTilt true_unit(const studio::PanTiltUnit& unit) {
  calibration_file::PanTilt known;
  known.head_from_target = geometry::inverse(rest_from_base(unit));
  const auto axis = [&](const studio::TurnAxis& a) {
    calibration_file::PanTilt::Axis in_base;
    in_base.direction = (known.head_from_target.rotation * a.direction).normalized();
    in_base.point_m = known.head_from_target * a.point_m;
    in_base.scale = a.scale;
    in_base.step_rad = unit.step_rad;
    return in_base;
  };
  known.pan = axis(unit.pan), known.tilt = axis(unit.tilt);
  known.repeatability_rad = unit.repeatability_rad;
  return known;
}

Result<void> write_head(const std::vector<studio::HeadAngles>& head,
                        const std::filesystem::path& folder) {
  std::string angles = "frame,pan_rad,tilt_rad\n";
  std::string ticks = "frame,stream,tick,counter,mid_exposure_ns,residual_us\n";
  int number = 0;
  for (const auto& [pan_rad, tilt_rad] : head) {
    ++number;
    fmt::format_to(std::back_inserter(angles), "{},{:.9f},{:.9f}\n", number, pan_rad, tilt_rad);
    const auto mid_exposure_ns = std::llround((number - 1) / studio::kFrameRate_hz * 1e9);
    for (const char* stream : {"color", "depth"})
      fmt::format_to(std::back_inserter(ticks), "{},{},{},{},{},0.0\n", number, stream,
                     tick_of(number), number, mid_exposure_ns);
  }
  MIXRIG_TRY(write_file(folder / "pan_tilt.csv", angles));
  return write_file(folder / "ticks.csv", ticks);
}

/// Poses of the tracked body times `body_from_frame`.
Result<void> write_mocap(const std::vector<studio::MocapSample>& samples, const char* frame,
                         const geometry::Pose& body_from_frame, const std::filesystem::path& path) {
  std::string text =
      fmt::format("# t x y z qx qy qz qw of world_from_{}, t on the clock of the system\n", frame);
  for (const studio::MocapSample& sample : samples) {
    const geometry::Pose pose = sample.world_from_body * body_from_frame;
    const Eigen::Vector3d& t = pose.translation_m;
    const Eigen::Vector4d q = pose.rotation.coeffs();
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.7f} {:.7f} {:.7f}", sample.stamp_s, t.x(),
                   t.y(), t.z());
    fmt::format_to(std::back_inserter(text), " {:.8f} {:.8f} {:.8f} {:.8f}\n", q[0], q[1], q[2],
                   q[3]);
  }
  return write_file(path, text);
}

Result<void> write_markers(const std::vector<studio::MocapSample>& samples,
                           const std::filesystem::path& path) {
  std::string text = "frame,t_s,x_m,y_m,z_m\n";
  int frame = 0;
  for (const studio::MocapSample& sample : samples) {
    ++frame;
    for (const Eigen::Vector3d& m : sample.markers_m)
      fmt::format_to(std::back_inserter(text), "{},{:.6f},{:.7f},{:.7f},{:.7f}\n", frame,
                     sample.stamp_s, m.x(), m.y(), m.z());
  }
  return write_file(path, text);
}

std::string constellation_text(const studio::MocapSystem& system) {
  config::Writer root;
  root.set("name", "camera").set("sigma_m", system.marker_sigma_m);
  for (const Eigen::Vector3d& m : system.markers_m) {
    config::Writer marker;
    marker.set("position_m", std::vector<double>{m.x(), m.y(), m.z()});
    root.add("marker", std::move(marker));
  }
  return root.text();
}

Result<void> write_tracked_body(const studio::StudioOptions& options,
                                const studio::MocapSystem& system,
                                const std::filesystem::path& folder) {
  const std::vector<studio::MocapSample> samples = record_mocap(options, system);
  MIXRIG_TRY(write_mocap(samples, "body", {}, folder / "mocap.txt"));
  MIXRIG_TRY(write_mocap(samples, "target", system.body_from_target, folder / "mocap_target.txt"));
  MIXRIG_TRY(write_markers(samples, folder / "mocap_markers.csv"));
  return write_file(folder / "constellation.toml", constellation_text(system));
}

Result<geometry::LensTable> true_lens(const studio::StudioOptions& options,
                                      const studio::StudioInfo& info) {
  std::vector<geometry::LensNode> nodes;
  for (const studio::LensTruth& node : studio::true_lens_table(options, info)) {
    const studio::Optics& o = node.optics;
    const auto& [k1, k2, p1, p2, k3] = o.distortion;
    const geometry::Pinhole pinhole{o.size_px, o.fx_px, o.fy_px, o.cx_px, o.cy_px};
    nodes.push_back({{node.at.zoom, node.at.focus},
                     {{pinhole, geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})}, node.pupil_shift_m},
                     0});
  }
  return geometry::LensTable::make(std::move(nodes));
}

std::string rig_truth(const studio::StudioInfo& info) {
  nlohmann::json truth{{"world_from_rest", to_json(info.world_from_rest)},
                       {"room_m", {info.room_m.x(), info.room_m.y(), info.room_m.z()}}};
  if (info.mocap) truth["mocap"] = to_json(*info.mocap);
  if (info.pan_tilt) {
    truth["pan_tilt"] = to_json(*info.pan_tilt);
    truth["world_from_base"] = to_json(world_from_base(info));
  }
  return truth.dump(1) + "\n";
}

}  // namespace

std::uint64_t tick_of(int number) {
  return static_cast<std::uint64_t>(std::lround(number * kMaster_hz / studio::kFrameRate_hz));
}

geometry::Pose world_from_base(const studio::StudioInfo& info) {
  return info.world_from_rest * rest_from_base(*info.pan_tilt);
}

double mocap_time_offset_s(const studio::StudioInfo& info) {
  const double middle_s = 0.5 * (info.frames - 1) / info.rate_hz;
  return middle_s - (info.mocap->clock_offset_s +
                     (1 + info.mocap->clock_drift) * (middle_s + info.mocap->delay_s));
}

calibration_file::Calibration true_calibration(const studio::StudioInfo& info,
                                               const take::TakeInfo& take) {
  calibration_file::Calibration known;
  known.cameras = {{"target", take.target, {}, 0, 0, 0, {}}, {"tof", take.tof, {}, 0, 0, 0, {}}};
  known.poses.push_back({"tof", take.target_from_tof, {}, 0, 0, {}});
  if (take.fisheye) {
    const studio::FisheyeOptics& f = info.fisheye.optics;
    const geometry::FisheyeModel model(
        {f.size_px, f.f_px, f.f_px, f.cx_px, f.cy_px, {f.k1, f.k2, 0, 0}, 0.5 * f.field_rad});
    known.cameras.push_back({"fisheye", model, {}, 0, 0, 0, {}});
    known.poses.push_back({"fisheye", info.fisheye.target_from_fisheye, {}, 0, 0, {}});
  }
  if (info.mocap)
    known.poses.push_back({"body", geometry::inverse(info.mocap->body_from_target), {}, 0, 0, {}});
  if (info.pan_tilt) known.pan_tilt = true_unit(*info.pan_tilt);
  return known;
}

Result<void> write_moving_rig(const studio::StudioOptions& options, const studio::StudioInfo& info,
                              const take::TakeInfo& take,
                              const std::vector<studio::HeadAngles>& head,
                              const std::filesystem::path& folder) {
  if (!head.empty()) MIXRIG_TRY(write_head(head, folder));
  if (info.mocap) MIXRIG_TRY(write_tracked_body(options, *info.mocap, folder));
  const bool moving = info.mocap || info.pan_tilt;
  if (!moving && !take.fisheye && options.zoom == 1) return {};
  if (moving) MIXRIG_TRY(write_file(folder / "truth/rig.json", rig_truth(info)));
  calibration_file::Calibration known = true_calibration(info, take);
  if (options.zoom > 1) {
    MIXRIG_ASSIGN(known.cameras.front().lens, true_lens(options, info));
  }
  return calibration_file::write_calibration(folder / "truth/calibration.toml", known);
}

}  // namespace mixrig::studio_io
