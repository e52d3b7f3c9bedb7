// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/views/view_folder.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "host/math/config/writer.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::calibration {
namespace {

using config::Writer;

constexpr int kViewDigits = 9;  ///< of numbers in views.toml
constexpr double kTurned_rad = 1 * kDeg;

Writer board_table(const BoardSpec& board) {
  const bool charuco = board.kind == BoardKind::kCharuco;
  const int more = charuco ? 0 : 1;  // squares, not inner corners
  Writer table;
  table.set("kind", charuco ? "charuco" : "checkerboard");
  table.set("columns", board.columns + more).set("rows", board.rows + more);
  table.set("square_mm", config::rounded(1000 * board.square_m, kViewDigits));
  if (!charuco) return table;
  table.set("marker_mm", config::rounded(1000 * board.marker_m, kViewDigits));
  table.set("dictionary", board.dictionary);
  return table;
}

Writer camera_table(const char* name, const char* model, Size size, const char* images) {
  Writer table;
  table.set("name", name).set("model", model).set("size_px", size).set("images", images);
  return table;
}

std::string manifest_of(const ViewFolderInfo& info, int views, bool turned) {
  Writer root;
  root.set("format", 1).set("name", info.name).set("views", views);
  root.set("board", board_table(info.board));
  root.add("camera", camera_table("target", "pinhole", info.target_px, "target/%06d.png"));
  if (info.fisheye_px.area() > 0)
    root.add("camera", camera_table("fisheye", "fisheye", info.fisheye_px, "fisheye/%06d.png"));
  const auto add_tof = [&](const std::string& name, Size size, capture::DepthKind kind) {
    Writer tof =
        camera_table(name.c_str(), "pinhole", size, (name + "/amplitude/%06d.png").c_str());
    tof.set("depth", name + "/depth/%06d.png");
    tof.set("depth_unit_m", config::rounded(info.depth_unit_m, kViewDigits));
    tof.set("depth_kind", kind == capture::DepthKind::kZ ? "z" : "distance");
    root.add("camera", std::move(tof));
  };
  if (info.amplitude) add_tof("tof", info.tof_px, info.depth_kind);
  if (!info.tof2_px.empty()) add_tof("tof2", info.tof2_px, info.depth2_kind);
  if (!turned) return root.text();
  Writer unit;
  unit.set("angles", "ptu.csv");
  if (info.step_rad > 0) unit.set("step_deg", config::rounded(info.step_rad / kDeg, kViewDigits));
  root.set("pan_tilt", std::move(unit));
  return root.text();
}

}  // namespace

std::string angles_text(const std::vector<device::PanTiltAngles>& angles) {
  std::string text = "view,pan_deg,tilt_deg\n";
  for (std::size_t i = 0; i < angles.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{},{:.7f},{:.7f}\n", i + 1, angles[i].pan_rad / kDeg,
                   angles[i].tilt_rad / kDeg);
  return text;
}

Result<void> check_view_board(const BoardSpec& board) {
  if (board.kind == BoardKind::kAprilgrid)
    return Error{ErrorCode::kUsage,
                 "--board " + board_text(board) +
                     ": an AprilGrid is for calibrate intrinsics alone: use a checkerboard or a "
                     "ChArUco board"};
  if (board.kind == BoardKind::kCheckerboard && (board.columns + board.rows) % 2 == 0)
    return Error{ErrorCode::kUsage,
                 "--board " + board_text(board) +
                     ": looks the same when it is turned by half a turn, so cameras may disagree "
                     "about its corners: use a board with one odd and one even number of corners"};
  return {};
}

Result<ViewFolder> ViewFolder::create(const std::filesystem::path& folder, ViewFolderInfo info) {
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(folder, "views.toml"));
  std::vector<const char*> parts = {"target"};
  if (!info.fisheye_px.empty()) parts.push_back("fisheye");
  if (info.amplitude) parts.insert(parts.end(), {"tof/amplitude", "tof/depth"});
  if (!info.tof2_px.empty()) parts.insert(parts.end(), {"tof2/amplitude", "tof2/depth"});
  for (const char* part : parts) {
    std::error_code failed;
    std::filesystem::create_directories(partial.path() / part, failed);
    if (failed)
      return system_error(ErrorCode::kIo, "cannot create " + (partial.path() / part).string(),
                          failed.value());
  }
  return ViewFolder(std::move(partial), std::move(info));
}

Result<void> ViewFolder::add(const StillView& view) {
  const auto file = [&](const char* part) {
    return partial_.path() / fmt::format("{}/{:06}.png", part, views() + 1);
  };
  MIXRIG_TRY(image_io::write_png(file("target"), view.target));
  if (info_.fisheye_px.area() > 0)
    MIXRIG_TRY(image_io::write_png(file("fisheye"), view.fisheye.empty()
                                                        ? Image<Rgb8>(info_.fisheye_px, Rgb8{})
                                                        : view.fisheye));
  if (info_.amplitude) {
    MIXRIG_TRY(image_io::write_png(file("tof/amplitude"), view.amplitude));
    MIXRIG_TRY(image_io::write_png(file("tof/depth"), view.depth));
  }
  if (!info_.tof2_px.empty()) {
    const Image<std::uint16_t> nothing(info_.tof2_px, std::uint16_t{0});
    MIXRIG_TRY(image_io::write_png(file("tof2/amplitude"),
                                   view.amplitude2.empty() ? nothing : view.amplitude2));
    MIXRIG_TRY(
        image_io::write_png(file("tof2/depth"), view.depth2.empty() ? nothing : view.depth2));
  }
  angles_.push_back(view.pan_tilt);
  return {};
}

bool ViewFolder::turned() const {
  double most_rad = 0;
  for (const auto& at : angles_) {
    if (!at) return false;
    most_rad = std::max({most_rad, std::abs(at->pan_rad - angles_[0]->pan_rad),
                         std::abs(at->tilt_rad - angles_[0]->tilt_rad)});
  }
  return most_rad > kTurned_rad;
}

Result<void> ViewFolder::finish() {
  if (turned()) {
    std::vector<device::PanTiltAngles> angles;
    for (const auto& at : angles_) angles.push_back(*at);
    MIXRIG_TRY(write_file(partial_.path() / "ptu.csv", angles_text(angles)));
  }
  MIXRIG_TRY(write_file(partial_.path() / "views.toml", manifest_of(info_, views(), turned())));
  return partial_.commit();
}

}  // namespace mixrig::calibration
