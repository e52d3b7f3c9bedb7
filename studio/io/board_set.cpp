// SPDX-License-Identifier: Apache-2.0
// Writes a folder of board views with truth from the virtual studio (docs/reference/take.md,
// views.toml).
#include "studio/io/board_set.h"

#include <cmath>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/partial_path.h"
#include "host/math/config/writer.h"
#include "host/math/image_io/image_io.h"
#include "studio/io/stopped.h"
#include "studio/io/truth_json.h"

namespace mixrig::studio_io {
namespace {

using config::Writer;
using nlohmann::json;

constexpr int kDigits = 6;  ///< of numbers in views.toml
constexpr double kTruthFrom_m = 0.5, kTruthTo_m = 4.0, kTruthStep_m = 0.01;

std::string numbered(const char* folder, int number) {
  return fmt::format("{}/{:06}.png", folder, number);
}

Writer board_table(const studio::BoardPlan& board) {
  Writer table;
  table.set("kind", name(board.kind)).set("columns", board.columns).set("rows", board.rows);
  table.set("square_mm", config::rounded(1000 * board.square_m, kDigits));
  if (board.kind != studio::BoardKind::kCharuco) return table;
  table.set("marker_mm", config::rounded(1000 * board.marker_m, kDigits));
  table.set("dictionary", "4X4_50");
  return table;
}

Writer camera_table(const char* name, const char* model, Size size, const char* images) {
  Writer table;
  table.set("name", name).set("model", model).set("size_px", size).set("images", images);
  return table;
}

Writer depth_camera_table(const std::string& name, const studio::TofSensor& sensor) {
  Writer table = camera_table(name.c_str(), "pinhole", sensor.optics.size_px,
                              (name + "/amplitude/%06d.png").c_str());
  table.set("depth", name + "/depth/%06d.png");
  table.set("depth_unit_m", config::rounded(sensor.unit_m, kDigits)).set("depth_kind", "distance");
  return table;
}

std::string manifest(const studio::BoardInfo& info) {
  const studio::Rig& rig = info.rig;
  Writer root, pan_tilt;
  root.set("format", 1).set("name", info.name).set("views", info.options.views);
  root.set("board", board_table(info.options.board));
  root.add("camera", camera_table("target", "pinhole", rig.target.size_px, "target/%06d.png"));
  root.add("camera", camera_table("fisheye", "fisheye", rig.fisheye.size_px, "fisheye/%06d.png"));
  root.add("camera", depth_camera_table("tof", rig.tof));
  if (rig.tof2) root.add("camera", depth_camera_table("tof2", *rig.tof2));
  pan_tilt.set("angles", "ptu.csv");
  pan_tilt.set("step_deg", config::rounded(rig.pan_tilt.step_rad / kDeg, kDigits));
  if (info.options.pan_tilt) root.set("pan_tilt", std::move(pan_tilt));
  return root.text();
}

/// Pairs of distance and depth error.
json curve_of(const studio::TofSensor& sensor) {
  json curve = json::array();
  for (int i = 0; i <= std::lround((kTruthTo_m - kTruthFrom_m) / kTruthStep_m); ++i) {
    const double d = kTruthFrom_m + i * kTruthStep_m;
    curve.push_back({d, depth_error_m(sensor, d)});
  }
  return curve;
}

json truth_of(const studio::BoardInfo& info) {
  const studio::Rig& rig = info.rig;
  const studio::FisheyeOptics& f = rig.fisheye;
  json truth = {
      {"target", to_json(rig.target)},
      {"tof", to_json(rig.tof.optics)},
      {"fisheye", {{"f", f.f_px}, {"cx", f.cx_px}, {"cy", f.cy_px}, {"k1", f.k1}, {"k2", f.k2}}},
      {"target_from_tof", to_json(rig.tof.target_from_tof)},
      {"target_from_fisheye", to_json(rig.target_from_fisheye)},
      {"depth_error", {{"distance_and_error_m", curve_of(rig.tof)}}},
      {"pan_tilt", to_json(rig.pan_tilt)},
      {"target_from_board", json::array()}};
  if (rig.tof2) {
    truth["tof2"] = to_json(rig.tof2->optics);
    truth["target_from_tof2"] = to_json(rig.tof2->target_from_tof);
    truth["depth_error2"] = {{"distance_and_error_m", curve_of(*rig.tof2)}};
  }
  if (info.options.lens_error_px > 0) truth["lens_error_px"] = info.options.lens_error_px;
  return truth;
}

Result<void> write_depth(const std::filesystem::path& path, const Image<float>& values,
                         double unit) {
  Image<std::uint16_t> whole(values.size());
  for (int y = 0; y < values.height(); ++y)
    for (int x = 0; x < values.width(); ++x)
      whole.at(x, y) =
          static_cast<std::uint16_t>(std::clamp(std::lround(values.at(x, y) / unit), 0L, 65535L));
  return image_io::write_png(path, whole);
}

Result<void> write_view(const std::filesystem::path& folder, const studio::BoardInfo& info,
                        const studio::BoardView& view) {
  const int n = view.number;
  MIXRIG_TRY(image_io::write_png(folder / numbered("target", n), view.target));
  MIXRIG_TRY(image_io::write_png(folder / numbered("fisheye", n), view.fisheye));
  MIXRIG_TRY(write_depth(folder / numbered("tof/amplitude", n), view.tof_amplitude, 1));
  MIXRIG_TRY(
      write_depth(folder / numbered("tof/depth", n), view.tof_distance_m, info.rig.tof.unit_m));
  if (!info.rig.tof2) return {};
  MIXRIG_TRY(write_depth(folder / numbered("tof2/amplitude", n), view.tof2_amplitude, 1));
  return write_depth(folder / numbered("tof2/depth", n), view.tof2_distance_m,
                     info.rig.tof2->unit_m);
}

Result<void> make_folders(const std::filesystem::path& folder, bool second_tof) {
  std::vector<const char*> parts = {"target", "fisheye", "tof/amplitude", "tof/depth", "truth"};
  if (second_tof) parts.insert(parts.end(), {"tof2/amplitude", "tof2/depth"});
  for (const char* part : parts) {
    std::error_code failed;
    std::filesystem::create_directories(folder / part, failed);
    if (failed)
      return system_error(ErrorCode::kIo, "cannot create " + (folder / part).string(),
                          failed.value());
  }
  return {};
}

}  // namespace

Result<void> write_board_truth(const studio::BoardInfo& info, const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder / "truth", failed);
  if (failed)
    return system_error(ErrorCode::kIo, "cannot create " + (folder / "truth").string(),
                        failed.value());
  return write_file(folder / "truth/truth.json", truth_of(info).dump(1) + "\n");
}

Result<studio::BoardInfo> write_board_set(const studio::BoardOptions& options,
                                          const std::filesystem::path& folder,
                                          const std::function<void(int)>& progress,
                                          const std::atomic<bool>* stop) {
  MIXRIG_ASSIGN(studio::BoardStudio studio, studio::BoardStudio::create(options));
  const studio::BoardInfo& info = studio.info();
  MIXRIG_ASSIGN(PartialPath output, make_partial_folder(folder, "views.toml"));
  MIXRIG_TRY(make_folders(output.path(), info.rig.tof2.has_value()));
  json truth = truth_of(info);
  std::ostringstream angles;
  angles.precision(9);
  angles << "view,pan_deg,tilt_deg\n";
  studio::BoardView view;
  for (int number = 1; number <= options.views; ++number) {
    studio.render(number, view);
    MIXRIG_TRY(write_view(output.path(), info, view));
    truth["target_from_board"].push_back(to_json(view.target_from_board));
    angles << number << "," << view.pan_rad / kDeg << "," << view.tilt_rad / kDeg << "\n";
    progress(number);
    MIXRIG_TRY(check_stop(stop, number, options.views));
  }
  if (options.pan_tilt) MIXRIG_TRY(write_file(output.path() / "ptu.csv", angles.str()));
  MIXRIG_TRY(write_file(output.path() / "truth/truth.json", truth.dump(1) + "\n"));
  MIXRIG_TRY(write_file(output.path() / "views.toml", manifest(info)));
  MIXRIG_TRY(output.commit());
  return info;
}

}  // namespace mixrig::studio_io
