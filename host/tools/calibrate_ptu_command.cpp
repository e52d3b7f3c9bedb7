// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate ptu: axes of the pan-tilt unit and the camera on it.
#include <cstdio>
#include <memory>
#include <numbers>

#include "host/calibration/calibrate_ptu.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

using nlohmann::json;

constexpr double kDeg = std::numbers::pi / 180;

struct Words {
  std::string set, out, camera, calibration;
  int threads = 0;
};

json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Axes and origin in the camera's axes at angles zero, where no choice of base matters.
json report_of(const calibration::PtuReport& report) {
  const camera_io::PanTilt& unit = *report.calibration.pan_tilt;
  const geometry::Pose camera_from_base = geometry::inverse(unit.head_from_target);
  const auto axis = [&](const camera_io::PanTilt::Axis& a) {
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

Result<json> calibrate(const Words& words) {
  MIXRIG_ASSIGN(const calibration::ViewSet set, calibration::read_view_set(words.set));
  calibration::PtuOptions options;
  options.camera = words.camera.empty() ? set.cameras[0].name : words.camera;
  options.threads = words.threads;
  if (!words.calibration.empty()) {
    MIXRIG_ASSIGN(const camera_io::Calibration known,
                  camera_io::read_calibration(words.calibration));
    const camera_io::CalibratedCamera* camera = known.camera(options.camera);
    if (camera == nullptr)
      return Error{ErrorCode::kUsage, words.calibration + ": there is no camera \"" +
                                          options.camera + "\": calibrate it first"};
    options.lens = camera->model;
  }
  Progress bar("finding the board", set.views);
  MIXRIG_ASSIGN(calibration::PtuReport report,
                calibration::calibrate_ptu(set, options,
                                           [&](const char*, int done, int) { bar.step(done); }));
  if (!words.out.empty()) {
    camera_io::InputHash hash;
    for (const auto& path : calibration::files_of(set, options.camera))
      MIXRIG_TRY(hash.add_file(path));
    report.calibration.pan_tilt->origin = camera_io::origin_now(hash);
    MIXRIG_TRY(camera_io::update_calibration(words.out, report.calibration));
  }
  print(report);
  return report_of(report);
}

}  // namespace

void add_calibrate_ptu_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App& group = command_group(app, "calibrate", "calibrate cameras and rig");
  CLI::App* command =
      group.add_subcommand("ptu", "pan-tilt unit, from views of a board at known angles");
  command->add_option("SET", words->set, "folder of views with angles (views.toml)")->required();
  command->add_option("--calibration", words->calibration,
                      "calibration.yaml that knows the camera's lens");
  command->add_option("--camera", words->camera, "name in views.toml; the first if not given");
  command->add_option("--out", words->out, "calibration.yaml that the result is written into");
  command->add_option("--threads", words->threads, "0: one per core");
  command->callback([words, &context] { context.action = [words] { return calibrate(*words); }; });
}

}  // namespace mixrig::tools
