// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate ptu: axes of the pan-tilt unit and the camera on it.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "host/calibrate/pan_tilt/calibrate_ptu.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

using nlohmann::json;

struct PtuArguments {
  std::string set, out, camera, calibration;
  int threads = 0;
};

json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Axes and points in camera axes at angles zero, which do not depend on the choice of the base.
json report_of(const calibration::PtuReport& report) {
  const calibration_file::PanTilt& unit = *report.calibration.pan_tilt;
  const geometry::Pose camera_from_base = geometry::inverse(unit.head_from_target);
  const auto axis = [&](const calibration_file::PanTilt::Axis& a) {
    return json{{"direction", to_json(camera_from_base.rotation * a.direction)},
                {"point_m", to_json(camera_from_base * a.point_m)},
                {"scale", a.scale}};
  };
  return {{"pan", axis(unit.pan)},
          {"tilt", axis(unit.tilt)},
          {"tool_center_point_m", to_json(unit.head_from_target.translation_m)},
          {"skew_deg", report.solved.chain.skew_rad / kDeg},
          {"offset_mm", 1000 * report.solved.chain.offset_m},
          {"repeatability_deg", report.repeatability_rad / kDeg},
          {"residual_px", report.residual_px},
          {"views", report.views},
          {"warnings", report.warnings}};
}

void print(const calibration::PtuReport& report) {
  const estimation::PanTiltChain& chain = report.solved.chain;
  const Eigen::Vector3d t = 1000 * report.calibration.pan_tilt->head_from_target.translation_m;
  const Eigen::VectorXd s = report.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  std::printf("tool centre point %.2f %.2f %.2f mm (sigma %.2f mm)\n", t.x(), t.y(), t.z(),
              1000 * s.segment<3>(7).norm());
  std::printf("axes: skew %.4f deg, offset %.3f mm; scale pan %.6f tilt %.6f\n",
              chain.skew_rad / kDeg, 1000 * chain.offset_m, chain.pan_scale, chain.tilt_scale);
  std::printf("repeatability %.4f deg, residual %.3f px over %d views\n",
              report.repeatability_rad / kDeg, report.residual_px, report.views);
  for (const std::string& warning : report.warnings)
    std::fprintf(stderr, "mixrig: warning: %s\n", warning.c_str());
}

Result<json> calibrate(const PtuArguments& arguments) {
  MIXRIG_ASSIGN(const calibration::ViewSet set, calibration::read_view_set(arguments.set));
  calibration::PtuOptions options;
  options.camera = arguments.camera.empty() ? set.cameras[0].name : arguments.camera;
  options.threads = arguments.threads;
  if (!arguments.calibration.empty()) {
    MIXRIG_ASSIGN(const calibration_file::Calibration known,
                  calibration_file::read_calibration(arguments.calibration));
    const calibration_file::CalibratedCamera* camera = known.camera(options.camera);
    if (camera == nullptr)
      return Error{ErrorCode::kUsage, arguments.calibration + ": has no camera \"" +
                                          options.camera + "\": calibrate it first"};
    options.lens = camera->model;
  }
  Progress bar("finding the board", set.views);
  MIXRIG_ASSIGN(calibration::PtuReport report,
                calibration::calibrate_ptu(set, options,
                                           [&](const char*, int done, int) { bar.step(done); }));
  if (!arguments.out.empty()) {
    calibration_file::InputHash hash;
    for (const auto& path : calibration::files_of(set, options.camera))
      MIXRIG_TRY(hash.add_file(path));
    report.calibration.pan_tilt->origin = calibration_file::origin_now(hash);
    MIXRIG_TRY(calibration_file::update_calibration(arguments.out, report.calibration));
  }
  print(report);
  return with_end(report_of(report), arguments.out,
                  arguments.out.empty() ? "give --out FILE to keep the axes"
                                        : "mixrig scan ROOM --rig RIG.TOML");
}

}  // namespace

void add_calibrate_ptu_command(Command app, Context& context) {
  auto arguments = std::make_shared<PtuArguments>();
  Command group = app.group("calibrate", "calibrate cameras and rig");
  Command command =
      group.add_subcommand("ptu", "pan-tilt unit, from views of a board at known angles");
  command.add_option("SET", arguments->set, "folder of views with angles (views.toml)").required();
  command.add_option("--calibration", arguments->calibration,
                     "calibration.toml with the lens of the camera");
  command.add_option("--camera", arguments->camera, "name in views.toml; the first if not given");
  command.add_option("--out", arguments->out, "calibration.toml to write the result into");
  command.add_option("--threads", arguments->threads, "0: one per core");
  command.callback(
      [arguments, &context] { context.action = [arguments] { return calibrate(*arguments); }; });
}

}  // namespace mixrig::tools
