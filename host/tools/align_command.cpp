// SPDX-License-Identifier: Apache-2.0
// mixrig align: time offset and rotation between two trajectories of one rig; two maps joined; a
// map laid into a scanned room.
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/output_folder.h"
#include "hal/base/partial_path.h"
#include "host/math/image_io/image_io.h"
#include "host/output/report/plot.h"
#include "host/pose/trajectory/align.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"

namespace mixrig::tools {
namespace {

struct AlignArguments {
  std::string a, b, json, plot, join, room, calibration;
  int threads = 0;
};

/// Exactly the documented keys; null where a value is not observable.
nlohmann::json report_of(const estimation::Estimate<trajectory::Alignment>& estimate) {
  const trajectory::Alignment& v = estimate.value;
  nlohmann::json report = {{"time_offset_s", nullptr},       {"time_offset_sigma_s", nullptr},
                           {"rotation_xyzw", nullptr},       {"rotation_sigma_deg", nullptr},
                           {"median_residual_deg", nullptr}, {"verdict", nullptr}};
  report["verdict"] = estimation::name_of(estimate.verdict.standing);
  if (!estimate.usable()) return report;
  report["time_offset_s"] = v.time_offset_s;
  report["time_offset_sigma_s"] = v.time_offset_sigma_s;
  report["rotation_xyzw"] = {v.a_from_b.x(), v.a_from_b.y(), v.a_from_b.z(), v.a_from_b.w()};
  report["rotation_sigma_deg"] = v.rotation_sigma_rad / kDeg;
  report["median_residual_deg"] = v.median_residual_rad / kDeg;
  return report;
}

void print(const estimation::Estimate<trajectory::Alignment>& estimate) {
  const trajectory::Alignment& v = estimate.value;
  std::printf("time offset   t_A = t_B %+.6f s  (sigma %.6f s)\n", v.time_offset_s,
              v.time_offset_sigma_s);
  std::printf("rotation      A from B  xyzw %.6f %.6f %.6f %.6f  (sigma %.4f deg)\n",
              v.a_from_b.x(), v.a_from_b.y(), v.a_from_b.z(), v.a_from_b.w(),
              v.rotation_sigma_rad / kDeg);
  std::printf("residual      median %.4f deg over %zu relative rotations\n",
              v.median_residual_rad / kDeg, v.residuals.size());
  const auto& lever = v.lever_and_scale;
  if (lever.usable()) {
    const auto sigma = [&](int i) { return std::sqrt(lever.covariance(i, i)); };
    std::printf("lever arm     %.4f %.4f %.4f m  (sigma %.4f %.4f %.4f)\n", lever.value.lever_m.x(),
                lever.value.lever_m.y(), lever.value.lever_m.z(), sigma(0), sigma(1), sigma(2));
    std::printf("scale         %.5f  (sigma %.5f)\n", lever.value.scale, sigma(3));
  } else {
    std::printf("lever, scale  not observable: %s\n", lever.verdict.reason.c_str());
  }
  std::printf("verdict       %s%s%s\n", estimation::name_of(estimate.verdict.standing),
              estimate.verdict.reason.empty() ? "" : ": ", estimate.verdict.reason.c_str());
}

Result<void> write_plot(const std::string& path, const trajectory::Alignment& alignment) {
  report::Plot plot{"Residual of the aligned relative rotations",
                    "time of A from its start, s",
                    "residual, deg",
                    {{"residual", {}}}};
  const double start_s = alignment.residuals.empty() ? 0 : alignment.residuals.front().t_s;
  for (const auto& r : alignment.residuals)
    plot.series[0].points.push_back({r.t_s - start_s, r.angle_rad / kDeg, {}});
  return image_io::write_png(path, report::draw(plot, {960, 480}));
}

Result<trajectory::Trajectory> read(const std::string& path) {
  MIXRIG_ASSIGN(trajectory::Trajectory trajectory, trajectory::read_trajectory(path));
  if (trajectory.empty())
    return Error{ErrorCode::kData, path + ": holds no usable pose: give t x y z qx qy qz qw lines"};
  return trajectory;
}

Result<void> write_report(const AlignArguments& arguments, const nlohmann::json& report) {
  if (arguments.json == "-")
    std::printf("%s\n", report.dump(2).c_str());
  else if (!arguments.json.empty())
    return write_file(arguments.json, report.dump(2) + "\n");
  return {};
}

Result<nlohmann::json> join(const AlignArguments& arguments, const MapJobs& jobs) {
  if (jobs.join == nullptr) return live::extra_left_out("align: --join", "map");
  MIXRIG_ASSIGN(
      const nlohmann::json report,
      jobs.join(
          {.map = arguments.a, .other = arguments.b, .out = arguments.join, .calibration = {}}));
  MIXRIG_TRY(write_report(arguments, report));
  return report;
}

Result<nlohmann::json> place(const AlignArguments& arguments, const MapJobs& jobs) {
  if (arguments.calibration.empty())
    return Error{ErrorCode::kUsage,
                 "align: --room needs --calibration: give that of the camera that learned the map"};
  if (jobs.place == nullptr) return live::extra_left_out("align: --room", "map");
  MIXRIG_ASSIGN(const nlohmann::json report, jobs.place({.map = arguments.a,
                                                         .other = arguments.b,
                                                         .out = arguments.room,
                                                         .calibration = arguments.calibration,
                                                         .threads = arguments.threads}));
  MIXRIG_TRY(write_report(arguments, report));
  return report;
}

Result<nlohmann::json> act(const AlignArguments& arguments) {
  if (!arguments.join.empty() && !arguments.room.empty())
    return Error{ErrorCode::kUsage, "align: give one of --join, --room"};
  MIXRIG_TRY(check_output_file(arguments.plot, kPngBegin, "--plot"));
  if (!arguments.join.empty()) return join(arguments, map_jobs());
  if (!arguments.room.empty()) return place(arguments, map_jobs());
  MIXRIG_ASSIGN(const trajectory::Trajectory a, read(arguments.a));
  MIXRIG_ASSIGN(const trajectory::Trajectory b, read(arguments.b));
  const auto estimate = trajectory::align(a, b);
  const nlohmann::json report = report_of(estimate);
  MIXRIG_TRY(write_report(arguments, report));
  if (!estimate.usable())
    return Error{ErrorCode::kData, arguments.a + " and " + arguments.b +
                                       " cannot be aligned: " + estimate.verdict.reason};
  if (arguments.json != "-") print(estimate);
  if (!arguments.plot.empty()) MIXRIG_TRY(write_plot(arguments.plot, estimate.value));
  return with_end(report, arguments.plot, {});
}

}  // namespace

void add_align_command(Command app, Context& context) {
  auto arguments = std::make_shared<AlignArguments>();
  Command command = app.add_subcommand(
      "align", "time offset and rotation between two trajectories of one rigid body");
  command.add_option("A", arguments->a, "trajectory, TUM or CSV: t x y z qx qy qz qw").required();
  command.add_option("B", arguments->b, "trajectory of the other sensor: t_A = t_B + offset")
      .required();
  command.add_option("--join", arguments->join,
                     "A and B are maps written by learn from one take: folder that B is written "
                     "to, in axes and units of A");
  command.add_option("--room", arguments->room,
                     "A is a map written by learn, B a room written by scan: folder that A is "
                     "written to, in axes of B, in metres");
  command.add_option("--calibration", arguments->calibration,
                     "--room: calibration.toml with the camera that learned the map");
  command.add_option("--threads", arguments->threads, "--room: 0: one per core").non_negative();
  command.add_option("--plot", arguments->plot, "PNG of the residuals over time");
  command.add_option("--json", arguments->json, "FILE that the report is written to; none: stdout")
      .value_if_left_out("-");
  command.callback([&context, arguments, command] {
    if (command.count("--json") > 0 && arguments->json.empty()) arguments->json = "-";
    context.action = [arguments] { return act(*arguments); };
  });
}

}  // namespace mixrig::tools
