// SPDX-License-Identifier: Apache-2.0
// mixrig info: describes a take or a scanned room.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <vector>

#include <nlohmann/json.hpp>

#include "hal/base/output_folder.h"
#include "hal/base/percentile.h"
#include "host/capture/take/repair.h"
#include "host/capture/take/take.h"
#include "host/capture/take/take_source.h"
#include "host/output/sheet/contact_sheet.h"
#include "host/room/scan/room_file.h"
#include "host/run/report/run_report.h"
#include "host/run/session/session.h"
#include "host/tools/command.h"
#include "host/tools/info_depth.h"
#include "host/tools/rig/registration_figures.h"
#include "host/tools/room/info_room.h"

namespace mixrig::tools {
namespace {

constexpr int kRegistrationFrames = 10;

/// Depth statistics over frames spread through the take.
struct DepthStatistics {
  int frames = 0;
  double unknown_pct = 0;
  double nearest_m = 0, median_m = 0, farthest_m = 0;  ///< 1st, 50th and 99th percentile
};

Result<DepthStatistics> depth_statistics(capture::CaptureSource& source) {
  constexpr int kFrames = 10;
  capture::Capture frame;
  std::vector<float> known_m;
  std::size_t pixels = 0, unknown = 0;
  DepthStatistics out;
  for (int number : output::spread(1, source.info().frames, kFrames)) {
    MIXRIG_TRY(source.read(number, frame));
    ++out.frames;
    for (int y = 0; y < frame.depth_m.height(); ++y) {
      for (int x = 0; x < frame.depth_m.width(); ++x, ++pixels) {
        const float z = frame.depth_m.row(y)[x];
        if (!std::isfinite(z) || z <= 0.0F)
          ++unknown;
        else if ((x + y) % 4 == 0)
          known_m.push_back(z);
      }
    }
  }
  out.unknown_pct = 100.0 * static_cast<double>(unknown) / static_cast<double>(pixels);
  out.nearest_m = measure::quantile(known_m, 0.01);
  out.median_m = measure::quantile(known_m, 0.5);
  out.farthest_m = measure::quantile(known_m, 0.99);
  return out;
}

double field_deg(const geometry::Pinhole& p) {
  return 2.0 * std::atan(0.5 * p.size_px.width / p.fx_px) * 180.0 / std::numbers::pi;
}

nlohmann::json camera_json(const geometry::CameraModel& camera) {
  const geometry::Pinhole& p = camera.pinhole;
  return {{"size", session::text(p.size_px)},
          {"fx", p.fx_px},
          {"fy", p.fy_px},
          {"cx", p.cx_px},
          {"cy", p.cy_px},
          {"horizontal_field_deg", field_deg(p)},
          {"distortion", camera.lens.coefficients()}};
}

nlohmann::json stream_json(const take::StreamInfo& stream) {
  return {{"path", stream.path}, {"count", stream.count}, {"rate_hz", stream.rate_hz}};
}

nlohmann::json report_of(const take::TakeInfo& info, const DepthStatistics& depth) {
  nlohmann::json report = {
      {"name", info.name},
      {"frames", info.frames},
      {"segments", info.segments},
      {"streams", {{"color", stream_json(info.color)}, {"depth", stream_json(info.depth)}}},
      {"target", camera_json(info.target)},
      {"tof", camera_json(info.tof)},
      {"depth_kind", info.depth_kind == capture::DepthKind::kZ ? "z" : "distance"},
      {"depth_unit_m", info.depth_unit_m},
      {"has_poses", info.has_poses},
      {"has_truth", info.has_truth},
      {"depth",
       {{"frames", depth.frames},
        {"unknown_pct", depth.unknown_pct},
        {"p1_m", depth.nearest_m},
        {"p50_m", depth.median_m},
        {"p99_m", depth.farthest_m}}}};
  if (info.amplitude) report["streams"]["amplitude"] = stream_json(*info.amplitude);
  if (info.depth2) {
    report["streams"]["depth2"] = stream_json(info.depth2->depth);
    if (info.depth2->amplitude)
      report["streams"]["amplitude2"] = stream_json(*info.depth2->amplitude);
    report["tof2"] = camera_json(info.tof2->model);
    report["depth2_after_depth_ms"] = 1e3 * (info.depth2->depth.delay_s - info.depth.delay_s);
  }
  if (info.fisheye) report["streams"]["fisheye"] = stream_json(*info.fisheye);
  return report;
}

void print_stream(const char* name, const take::StreamInfo& stream) {
  std::printf("  %-10s %5d pictures, %s, %s\n", name, stream.count,
              stream.rate_hz > 0 ? (std::to_string(std::lround(stream.rate_hz)) + " Hz").c_str()
                                 : "rate unknown",
              stream.path.c_str());
}

void print_camera(const char* name, const geometry::CameraModel& camera) {
  const geometry::Pinhole& p = camera.pinhole;
  std::printf("  %-10s %s, f %.1f %.1f, centre %.1f %.1f px, %.1f degrees wide, %s\n", name,
              session::text(p.size_px).c_str(), p.fx_px, p.fy_px, p.cx_px, p.cy_px, field_deg(p),
              camera.lens.is_ideal() ? "no distortion" : "distorted");
}

void print_base(const char* name, const geometry::Pose& target_from_tof) {
  std::printf("  %-10s %.1f mm, %.2f degrees apart\n", name,
              target_from_tof.translation_m.norm() * 1e3,
              target_from_tof.rotation.angularDistance(Eigen::Quaterniond::Identity()) * 180.0 /
                  std::numbers::pi);
}

void print(const take::TakeInfo& info, const DepthStatistics& depth) {
  std::printf("%s: %d frames\n", info.name.c_str(), info.frames);
  if (info.segments > 1) std::printf("  segments   %d takes, read as one\n", info.segments);
  print_stream("color", info.color);
  print_stream("depth", info.depth);
  if (info.amplitude) print_stream("amplitude", *info.amplitude);
  if (info.depth2) {
    print_stream("depth2", info.depth2->depth);
    if (info.depth2->amplitude) print_stream("amplitude2", *info.depth2->amplitude);
  }
  if (info.fisheye) print_stream("fisheye", *info.fisheye);
  print_camera("target", info.target);
  print_camera("tof", info.tof);
  print_base("base line", info.target_from_tof);
  if (info.tof2) {
    print_camera("tof2", info.tof2->model);
    print_base("base line2", info.tof2->target_from_tof);
    const double apart_ms = 1e3 * (info.depth2->depth.delay_s - info.depth.delay_s);
    if (apart_ms != 0)
      std::printf("  time       depth2 is exposed %+.1f ms after depth\n", apart_ms);
    else
      std::printf("  time       of depth2 after depth: not stated, or none; see ticks.csv\n");
  }
  std::printf(
      "  depth      %s, steps of %g mm, %.1f %% unknown, %.2f / %.2f / %.2f m "
      "(1st, 50th, 99th percentile of %d frames)\n",
      info.depth_kind == capture::DepthKind::kZ ? "z" : "distance", info.depth_unit_m * 1e3,
      depth.unknown_pct, depth.nearest_m, depth.median_m, depth.farthest_m, depth.frames);
  std::printf("  poses      %s\n  truth      %s\n", info.has_poses ? "yes" : "none",
              info.has_truth ? "yes" : "none");
}

Result<nlohmann::json> info_take(const std::string& folder, bool figures) {
  MIXRIG_ASSIGN(const take::TakeReader reader, take::TakeReader::open(folder));
  MIXRIG_ASSIGN(const auto source, take::open_take_source(folder));
  MIXRIG_ASSIGN(const DepthStatistics depth, depth_statistics(*source));
  const auto registered =
      registration_of(*source, output::spread(1, source->info().frames, kRegistrationFrames));
  print(reader.info(), depth);
  nlohmann::json report = report_of(reader.info(), depth);
  if (figures) {
    MIXRIG_ASSIGN(report["depth_camera"], info_depth(*source));
  }
  if (!registered) return report;  // such as a take without a plate
  std::printf("  registered %s\n", registration_text(*registered).c_str());
  report["registration"] = registration_json(*registered);
  return report;
}

struct InfoArguments {
  std::string of, truth, picture;
  bool repair = false, depth = false;
};

/// Makes a take of what a recording has left, then describes it.
Result<nlohmann::json> repair(const InfoArguments& arguments) {
  if (!arguments.truth.empty() || !arguments.picture.empty())
    return Error{ErrorCode::kUsage,
                 "--repair takes a recording alone: leave --truth and --picture out"};
  MIXRIG_ASSIGN(const take::Repaired made, take::repair(arguments.of));
  std::printf("%s\n", made.what.c_str());
  MIXRIG_ASSIGN(nlohmann::json report, info_take(made.take.string(), arguments.depth));
  report["repaired"] = made.folder.string();
  return with_end(std::move(report), made.take.string(), {});
}

Result<nlohmann::json> info(const InfoArguments& arguments) {
  if (arguments.repair) return repair(arguments);
  MIXRIG_TRY(check_output_file(arguments.picture, kPngBegin, "--picture"));
  if (model::is_room(arguments.of)) {
    if (arguments.depth)
      return Error{ErrorCode::kUsage, "'" + arguments.of +
                                          "' is a scanned room: --depth is for a take: give the "
                                          "take that it was scanned from"};
    MIXRIG_ASSIGN(nlohmann::json report,
                  info_room({arguments.of, arguments.truth, arguments.picture}));
    return with_end(std::move(report), arguments.picture, {});
  }
  if (!arguments.truth.empty() || !arguments.picture.empty())
    return Error{ErrorCode::kUsage,
                 "'" + arguments.of +
                     "' is not a scanned room: --truth and --picture are for one alone: leave them "
                     "out"};
  return info_take(arguments.of, arguments.depth);
}

}  // namespace

void add_info_command(Command app, Context& context) {
  auto arguments = std::make_shared<InfoArguments>();
  Command command = app.add_subcommand(
      "info", "describe a take (streams, cameras, depth) or a scanned room (size, uncertainty)");
  command.add_option("TAKE|ROOM", arguments->of, "folder or take.toml; folder of a room")
      .required();
  command.add_option("--truth", arguments->truth, "of a room: the take it was scanned from");
  command.add_option("--picture", arguments->picture, "of a room: PNG of plan and elevation");
  command.add_flag("--depth", arguments->depth,
                   "of a take: the depth camera's noise, flatness of planes, error in corners, "
                   "flying pixels");
  command.add_flag("--repair", arguments->repair,
                   "of NAME.partial, left by a recording that was cut off: make it the take NAME");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return info(*arguments); }; });
}

}  // namespace mixrig::tools
