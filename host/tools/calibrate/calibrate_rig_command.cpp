// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate rig, mixrig calibrate tof: all cameras of a rig, or its depth camera alone.
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "host/calibrate/rig/calibrate_rig.h"
#include "host/tools/calibrate/intrinsics_report.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

using nlohmann::json;

struct RigArguments {
  std::string set, out, camera;
  bool corners_only = false, bend = false, force = false;
  int threads = 0;
};

/// Reasons not to use a calibration, empty: go; and the view to take next for each camera at fault.
struct Verdict {
  std::vector<std::string> why, next;
};

/// Few views, and a rim that none reaches, are warnings: the other cameras' views count too.
Verdict verdict_of(const calibration::ViewSet& set, calibration::RigReport& report) {
  constexpr int kCellColumns = 12, kCellRows = 9;
  constexpr double kRegistered_px = 1.0, kHelps = 0.9;
  Verdict verdict;
  for (std::size_t c = 0; c < report.alone.size(); ++c) {
    const calibration::Intrinsics& in = report.alone[c];
    const std::string& name = report.model.cameras[c].name;
    const auto map = calibration::projection_uncertainty(in, kCellColumns, kCellRows);
    const auto why = objections(in, map);
    const std::size_t grave = fit_objections(in, map).size();
    for (std::size_t i = 0; i < why.size(); ++i)
      (i < grave ? verdict.why : report.warnings).push_back(name + ": " + why[i]);
    if (why.empty()) continue;
    const auto advice = calibration::advise(in, calibration::board_of(set));
    if (advice.mean_then_px < kHelps * advice.mean_now_px)
      verdict.next.push_back(fmt::format("{}: hold the board {}: {:.2f} px would become {:.2f} px",
                                         name, advice.where, advice.mean_now_px,
                                         advice.mean_then_px));
  }
  for (const calibration::Registration& r : report.registrations)
    if (!(r.median_px <= kRegistered_px))
      verdict.why.push_back(
          fmt::format("{}: what it sees {:.1f} m away is uncertain by {:.2f} px in the picture of "
                      "{}: more views that both see, near and far",
                      r.camera, r.distance_m, r.median_px, report.model.cameras[0].name));
  return verdict;
}

json to_json(const calibration::DepthFit& fit) {
  json tried = json::array();
  for (const calibration::DepthChoice& c : fit.tried)
    tried.push_back({{"knots", c.knots},
                     {"amplitude", c.amplitude},
                     {"place", c.place},
                     {"held_out_mm", 1000 * c.held_out_m}});
  return {{"knots_m", fit.error.knots_m},
          {"error_m", fit.error.error_m},
          {"amplitude_m", fit.error.amplitude_m},
          {"place_m", fit.error.place_m},
          {"uncorrected_mm", 1000 * fit.uncorrected_m},
          {"residual_mm", 1000 * fit.error.residual_m},
          {"held_out_mm", 1000 * fit.chosen.held_out_m},
          {"stretch", fit.stretch},
          {"tried", tried}};
}

json camera_json(const calibration::RigCamera& camera) {
  const geometry::Pose pose = geometry::inverse(camera.camera_from_target);
  const Eigen::Vector4d q = pose.rotation.coeffs();
  const Eigen::Vector3d& t = pose.translation_m;
  return {{"parameters", std::vector<double>(camera.parameters.begin(), camera.parameters.end())},
          {"rotation_xyzw", {q[0], q[1], q[2], q[3]}},
          {"translation_m", {t[0], t[1], t[2]}},
          {"blur_px", camera.blur_px}};
}

json report_of(const calibration::RigReport& report, const Verdict& verdict) {
  json cameras, by_corners, held_out, sigma;
  for (std::size_t c = 0; c < report.model.cameras.size(); ++c) {
    const std::string& name = report.model.cameras[c].name;
    cameras[name] = camera_json(report.model.cameras[c]);
    cameras[name]["corner_px"] = report.calibration.cameras[c].residual_px;
    cameras[name]["misfound"] = {{"views", report.misfound[c].views.size()},
                                 {"corners", report.misfound[c].corners}};
    cameras[name]["lens_terms"] = report.alone[c].lens_terms;
    if (!report.grey_rms.empty()) cameras[name]["grey_rms"] = report.grey_rms[c];
    by_corners[name] = camera_json(report.by_corners.cameras[c]);
    by_corners[name]["corner_px"] = report.corner_px[c];
  }
  for (const calibration_file::CalibratedPose& pose : report.calibration.poses) {
    const Eigen::VectorXd s = pose.covariance.diagonal().cwiseSqrt();
    sigma[pose.name] = {{"deg", s.head<3>().norm() / kDeg}, {"mm", 1000 * s.tail<3>().norm()}};
  }
  for (const calibration::HeldOut& h : report.held_out)
    held_out[h.camera] = {
        {"corners_px", h.corners_px}, {"pixels_px", h.pixels_px}, {"views", h.views}};
  json registration;
  for (const calibration::Registration& r : report.registrations)
    registration[r.camera] = {
        {"distance_m", r.distance_m}, {"median_px", r.median_px}, {"worst_px", r.worst_px}};
  json out{{"cameras", cameras},
           {"by_corners", by_corners},
           {"extrinsic_sigma", sigma},
           {"held_out", held_out},
           {"seconds",
            {{"load", report.load_s}, {"corners", report.corners_s}, {"pixels", report.pixels_s}}},
           {"first_square", report.first_is_white ? "white" : "black"},
           {"bend_mm", 1000 * report.model.bend.norm()},
           {"registration_sigma", registration},
           {"verdict", verdict.why.empty() ? "go" : "no-go"},
           {"why", verdict.why},
           {"next_views", verdict.next},
           {"warnings", report.warnings}};
  if (report.depth) out["depth_error"] = to_json(*report.depth);
  return out;
}

std::string joined(const std::vector<std::string>& parts) {
  return fmt::format("{}", fmt::join(parts, "; "));
}

void print(const Verdict& verdict) {
  for (const std::string& next : verdict.next) std::printf("next view, %s\n", next.c_str());
  std::printf("verdict: %s%s%s\n", verdict.why.empty() ? "go" : "no-go",
              verdict.why.empty() ? "" : ": ", joined(verdict.why).c_str());
}

void print(const calibration::RigReport& report) {
  if (report.first_is_white) std::printf("the board's top left square is white\n");
  std::printf("%-10s %10s %9s %9s %8s %8s\n", "camera", "f px", "corners", "pixels", "blur",
              "views");
  for (std::size_t c = 0; c < report.model.cameras.size(); ++c) {
    const auto& camera = report.model.cameras[c];
    std::printf("%-10s %10.3f %6.3f px %6.3f px %5.2f px %8d\n", camera.name.c_str(),
                camera.parameters[0], report.corner_px[c],
                report.calibration.cameras[c].residual_px, camera.blur_px,
                report.calibration.cameras[c].views);
  }
  for (std::size_t c = 0; c < report.misfound.size(); ++c) {
    const calibration::Misfound& wrong = report.misfound[c];
    if (wrong.corners == 0) continue;
    std::printf("%s: %d corners left out that no lens explains",
                report.model.cameras[c].name.c_str(), wrong.corners);
    for (const int view : wrong.views) std::printf(", view %d whole", view + 1);
    std::printf("\n");
  }
  for (const auto& pose : report.calibration.poses) {
    const Eigen::Vector3d t = 1000 * pose.target_from.translation_m;
    const Eigen::VectorXd s = pose.covariance.diagonal().cwiseSqrt();
    std::printf("%s at %.2f %.2f %.2f mm (sigma %.3f mm, %.4f deg)\n", pose.name.c_str(), t.x(),
                t.y(), t.z(), 1000 * s.tail<3>().norm(), s.head<3>().norm() / kDeg);
  }
  for (const auto& h : report.held_out)
    std::printf("held out, %s: %.4f px by corners, %.4f px by pixels (%d views)\n",
                h.camera.c_str(), h.corners_px, h.pixels_px, h.views);
  for (const auto& r : report.registrations)
    std::printf("registration, %s at %.1f m: uncertain by %.3f px, %.3f px where it is worst\n",
                r.camera.c_str(), r.distance_m, r.median_px, r.worst_px);
  if (report.depth)
    std::printf("depth error: %.2f mm before, %.2f mm after on views held out; %d knots%s%s\n",
                1000 * report.depth->uncorrected_m, 1000 * report.depth->chosen.held_out_m,
                report.depth->chosen.knots, report.depth->chosen.amplitude ? ", amplitude" : "",
                report.depth->chosen.place ? ", place" : "");
  std::printf("%.1f s to find the board, %.1f s for corners, %.1f s for pixels\n", report.load_s,
              report.corners_s, report.pixels_s);
  for (const std::string& warning : report.warnings)
    std::fprintf(stderr, "mixrig: warning: %s\n", warning.c_str());
}

Result<void> write(const calibration::ViewSet& set, const std::string& camera,
                   const std::string& out, calibration_file::Calibration& calibration) {
  if (out.empty()) return {};
  calibration_file::InputHash hash;
  for (const auto& path : calibration::files_of(set, camera)) MIXRIG_TRY(hash.add_file(path));
  const calibration_file::Origin origin = calibration_file::origin_now(hash);
  for (auto& entry : calibration.cameras) entry.origin = origin;
  for (auto& entry : calibration.poses) entry.origin = origin;
  for (auto* error : {&calibration.depth_error, &calibration.depth_error2})
    if (*error) (*error)->origin = origin;
  return calibration_file::update_calibration(out, calibration);
}

const calibration::ViewCamera* second_depth_camera(const calibration::ViewSet& set) {
  for (const calibration::ViewCamera& camera : set.cameras)
    if (camera.name == calibration::kSecondDepthCamera && !camera.depth.empty()) return &camera;
  return nullptr;
}

std::vector<std::string> all_but_second(const calibration::ViewSet& set) {
  std::vector<std::string> names;
  for (const calibration::ViewCamera& camera : set.cameras)
    if (&camera != second_depth_camera(set)) names.push_back(camera.name);
  return names;
}

/// Keeps only the second depth camera of its run's calibration.
void keep_second(calibration_file::Calibration& calibration) {
  std::erase_if(calibration.cameras,
                [](const auto& c) { return c.name != calibration::kSecondDepthCamera; });
}

/// Calibrates the cameras of the options, writes and prints the result.
Result<json> run(const calibration::ViewSet& set, const calibration::RigOptions& options,
                 const RigArguments& arguments) {
  keep_freed_memory();
  Progress bar("finding the board", set.views);
  MIXRIG_ASSIGN(calibration::RigReport report,
                calibration::calibrate_rig(set, options, [&](const char* what, int done, int) {
                  if (std::string_view(what) == "views") bar.step(done);
                }));
  const bool second = arguments.camera.empty() && !options.cameras.empty() &&
                      options.cameras.back() == calibration::kSecondDepthCamera;
  const Verdict verdict = verdict_of(set, report);
  print(report);
  print(verdict);
  json out = report_of(report, verdict);
  if (!verdict.why.empty() && !arguments.out.empty() && !arguments.force)
    return Error{ErrorCode::kData, arguments.out + " is not written, no-go: " +
                                       joined(verdict.why) + ": add views, or give --force"};
  if (second) keep_second(report.calibration);
  MIXRIG_TRY(write(set, arguments.camera, arguments.out, report.calibration));
  return out;
}

Result<json> calibrate(const RigArguments& arguments) {
  MIXRIG_ASSIGN(const calibration::ViewSet set, calibration::read_view_set(arguments.set));
  calibration::RigOptions options;
  if (!arguments.camera.empty()) {
    MIXRIG_ASSIGN(const int index, calibration::find_camera(set, arguments.camera));
    if (set.cameras[static_cast<std::size_t>(index)].depth.empty())
      return Error{ErrorCode::kUsage, "camera \"" + arguments.camera +
                                          "\" has no depth in views.toml: name the depth camera "
                                          "with --camera"};
    options.cameras = {arguments.camera};
  } else if (set.cameras.size() < 2) {
    return Error{
        ErrorCode::kUsage,
        arguments.set +
            ": has only one camera, a rig has two or more: use mixrig calibrate intrinsics"};
  }
  options.pixels = !arguments.corners_only, options.bend = arguments.bend,
  options.threads = arguments.threads;
  const bool two = arguments.camera.empty() && second_depth_camera(set) != nullptr;
  if (two) options.cameras = all_but_second(set);
  MIXRIG_ASSIGN(json report, run(set, options, arguments));
  const std::string next = arguments.out.empty() ? "give --out FILE to keep the calibration"
                                                 : in_rig_toml(arguments.out);
  if (!two) return with_end(std::move(report), arguments.out, next);
  // The first camera of the rig keeps the lens that all of its views gave.
  options.cameras = {set.cameras.front().name, second_depth_camera(set)->name};
  MIXRIG_ASSIGN(report["second"], run(set, options, arguments));
  return with_end(std::move(report), arguments.out, next);
}

void add_options(Command command, RigArguments& arguments) {
  command.add_option("SET", arguments.set, "folder of views (views.toml)").required();
  command.add_option("--out", arguments.out, "calibration.toml to write the result into");
  command.add_flag("--corners-only", arguments.corners_only,
                   "leave out the analysis of all pixels");
  command.add_flag("--bend", arguments.bend,
                   "solve for the board's bend even where corners show none");
  command.add_flag("--force", arguments.force, "write a result that is no-go too");
  command.add_option("--threads", arguments.threads, "0: one per core");
}

}  // namespace

void add_calibrate_rig_command(Command app, Context& context) {
  Command group = app.group("calibrate", "calibrate cameras and rig");
  auto rig = std::make_shared<RigArguments>();
  Command command = group.add_subcommand("rig", "all cameras of a rig from views of a board");
  add_options(command, *rig);
  command.callback([rig, &context] { context.action = [rig] { return calibrate(*rig); }; });

  auto tof = std::make_shared<RigArguments>();
  tof->camera = "tof";
  command = group.add_subcommand("tof", "lens and depth error of a depth camera");
  add_options(command, *tof);
  command.add_option("--camera", tof->camera, "name in views.toml").show_default();
  command.callback([tof, &context] { context.action = [tof] { return calibrate(*tof); }; });
}

}  // namespace mixrig::tools
