// SPDX-License-Identifier: Apache-2.0
// A folder of board views by all cameras of a rig.
#include "host/calibrate/rig/view_set.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <sstream>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "hal/base/srgb.h"
#include "host/calibrate/board/detect_board.h"
#include "host/math/config/table.h"
#include "host/math/image_io/depth_picture.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::calibration {
namespace {

constexpr int kMostViews = 500;
constexpr std::size_t kMostFileBytes = 1 << 20;

/// A pattern must hold one %06d and no other '%'.
bool is_pattern(const std::string& text) {
  const std::size_t at = text.find('%');
  return at != std::string::npos && text.compare(at, 4, "%06d") == 0 &&
         text.find('%', at + 1) == std::string::npos;
}

std::filesystem::path file_of(const ViewSet& set, const std::string& pattern, int view) {
  std::string name = pattern;
  return set.folder / name.replace(name.find('%'), 4, fmt::format("{:06}", view));
}

std::string pattern_of(const config::Table& table, const char* key, bool required) {
  const std::string text = required ? table.text(key) : table.text_or(key, "");
  if ((required || !text.empty()) && !is_pattern(text))
    table.fail(key, "must hold %06d once, like \"target/%06d.png\"");
  return text;
}

ViewCamera read_camera(const config::Table& table) {
  ViewCamera camera;
  camera.name = table.text("name");
  camera.lens = table.one_of("model", {"pinhole", "fisheye"}, 0) == 0
                    ? geometry::LensKind::kPinhole
                    : geometry::LensKind::kFisheye;
  const auto size = table.numbers("size_px", 2, 2, {16, 16384});
  if (size.size() == 2) camera.size_px = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  camera.images = pattern_of(table, "images", true);
  camera.depth = pattern_of(table, "depth", false);
  if (camera.depth.empty()) return camera;
  camera.depth_unit_m = table.number("depth_unit_m", {1e-6, 1});
  camera.depth_is_z = table.one_of("depth_kind", {"distance", "z"}, 0) == 1;
  if (table.has("depth_unknown"))
    for (const double step : table.numbers("depth_unknown", 1, 4, {0, 65535})) {
      if (step != std::floor(step)) table.fail("depth_unknown", "give whole steps");
      camera.depth_unknown.push_back(static_cast<int>(step));
    }
  return camera;
}

void read_board(const config::Table& table, ViewSet& set) {
  const bool charuco = table.one_of("kind", {"checkerboard", "charuco"}, 0) == 1;
  set.board_kind = charuco ? "charuco" : "checkerboard";
  set.columns = table.integer("columns", {3, 100});
  set.rows = table.integer("rows", {3, 100});
  set.square_m = table.number("square_mm", {0.5, 2000}) / 1000;
  if (!charuco) return;
  set.marker_m = table.number("marker_mm", {0.1, 2000}) / 1000;
  set.dictionary = table.text("dictionary");
  if (set.marker_m >= set.square_m) table.fail("marker_mm", "must be less than square_mm");
}

Result<void> check_size(const ViewCamera& camera, Size size, const std::filesystem::path& path) {
  if (size == camera.size_px) return {};
  return Error{ErrorCode::kFormat, path.string() + ": picture of " + std::to_string(size.width) +
                                       "x" + std::to_string(size.height) + ", but camera \"" +
                                       camera.name + "\" has " +
                                       std::to_string(camera.size_px.width) + "x" +
                                       std::to_string(camera.size_px.height) +
                                       ": check size_px, and that the cameras are not swapped"};
}

/// Fault of the first line of a table of angles, which must name degrees; empty: none.
std::string wrong_angle_header(const std::string& line) {
  std::string lower;
  for (const char c : line) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::string form = "write the header \"view,pan_deg,tilt_deg\" and degrees";
  if (lower.find("rad") != std::string::npos) return "the header names radians: " + form;
  const std::size_t pan = lower.find("deg");
  if (pan != std::string::npos && lower.find("deg", pan + 1) != std::string::npos) return "";
  return "the header names no unit of both angles: " + form;
}

float linear(std::uint8_t value) { return linear_from_srgb(static_cast<float>(value) / 255); }

}  // namespace

Result<std::vector<ViewSet::Angles>> parse_angles(const std::string& text, const std::string& name,
                                                  int views) {
  const auto wrong = [&](int line, const std::string& why) {
    return Error{ErrorCode::kFormat, name + ":" + std::to_string(line) + ": " + why};
  };
  std::vector<ViewSet::Angles> angles;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (number == 1)
      if (const std::string why = wrong_angle_header(line); !why.empty()) return wrong(1, why);
    if (number == 1 || line.empty()) continue;
    int view = 0, used = 0;
    double pan = 0, tilt = 0;
    if (std::sscanf(line.c_str(), "%d,%lf,%lf%n", &view, &pan, &tilt, &used) != 3 ||
        !(std::abs(pan) <= 720) || !(std::abs(tilt) <= 360))
      return wrong(number, "not \"view,pan_deg,tilt_deg\" within +-720 and +-360 degrees");
    if (view != static_cast<int>(angles.size()) + 1)
      return wrong(number, "view " + std::to_string(view) + " where " +
                               std::to_string(angles.size() + 1) + " comes next");
    angles.push_back({pan * kDeg, tilt * kDeg});
    if (static_cast<int>(angles.size()) > views) break;
  }
  if (static_cast<int>(angles.size()) != views)
    return wrong(1, "angles of " + std::to_string(angles.size()) + " views, but views.toml says " +
                        std::to_string(views));
  return angles;
}

Result<ViewSet> parse_view_set(std::string_view text, const std::string& name,
                               std::string& angles) {
  MIXRIG_ASSIGN(config::Document document, config::Document::parse(text, name));
  const config::Table root = document.root();
  ViewSet set;
  root.integer("format", {1, 1});
  set.name = root.text_or("name", "");
  set.views = root.integer("views", {1, kMostViews});
  read_board(root.required_table("board"), set);
  for (const config::Table& table : root.tables("camera")) {
    set.cameras.push_back(read_camera(table));
    for (std::size_t i = 0; i + 1 < set.cameras.size(); ++i)
      if (set.cameras[i].name == set.cameras.back().name)
        table.fail("name", "is the name of two cameras");
  }
  if (set.cameras.empty()) root.fail("camera", "there must be a [[camera]]");
  const config::Table unit = root.table("pan_tilt");
  angles = unit.present() ? unit.text("angles") : "";
  if (unit.present()) set.step_rad = unit.number_or("step_deg", 0, {0, 10}) * kDeg;
  MIXRIG_TRY(document.finish());
  return set;
}

Result<ViewSet> read_view_set(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "views.toml";
  std::string angles;
  std::error_code code;
  if (!std::filesystem::exists(file, code))
    return Error{ErrorCode::kNotFound, "'" + folder.string() +
                                           "' is no folder of views (no views.toml): name one, or "
                                           "make one by mixrig calibrate views"};
  MIXRIG_ASSIGN(const std::string views, config::read_text(file, kMostFileBytes));
  MIXRIG_ASSIGN(ViewSet set, parse_view_set(views, file.string(), angles));
  set.folder = folder;
  if (angles.empty()) return set;
  MIXRIG_ASSIGN(const std::string text, config::read_text(folder / angles, kMostFileBytes));
  MIXRIG_ASSIGN(set.angles, parse_angles(text, (folder / angles).string(), set.views));
  return set;
}

Result<ViewPictures> load_view(const ViewSet& set, const ViewCamera& camera, int view) {
  const auto path = file_of(set, camera.images, view);
  ViewPictures out;
  if (camera.depth.empty()) {
    Image<Rgb8> color;
    MIXRIG_TRY(image_io::read_rgb8(path, color));
    MIXRIG_TRY(check_size(camera, color.size(), path));
    std::array<float, 256> curve;
    for (int i = 0; i < 256; ++i) curve[i] = linear(static_cast<std::uint8_t>(i));
    out.picture.reset(color.size());
    for (int y = 0; y < color.height(); ++y)
      for (int x = 0; x < color.width(); ++x) out.picture.at(x, y) = curve[color.at(x, y).g];
    out.gray = gray_of(color);
    return out;
  }
  Image<std::uint16_t> counts;
  MIXRIG_TRY(image_io::read_gray16(path, counts));
  MIXRIG_TRY(check_size(camera, counts.size(), path));
  out.gray = gray_of(counts);
  out.picture.reset(counts.size());
  for (int y = 0; y < counts.height(); ++y)
    for (int x = 0; x < counts.width(); ++x) out.picture.at(x, y) = counts.at(x, y);
  const auto depth_path = file_of(set, camera.depth, view);
  MIXRIG_TRY(image_io::read_depth16(depth_path, counts));
  MIXRIG_TRY(check_size(camera, counts.size(), depth_path));
  out.depth_m.reset(counts.size());
  out.depth_is_z = camera.depth_is_z;
  const auto unit = static_cast<float>(camera.depth_unit_m);
  const auto& none = camera.depth_unknown;
  for (int y = 0; y < counts.height(); ++y)
    for (int x = 0; x < counts.width(); ++x) {
      const bool unknown = std::find(none.begin(), none.end(), counts.at(x, y)) != none.end();
      out.depth_m.at(x, y) = unknown ? 0.0F : unit * counts.at(x, y);
    }
  return out;
}

Result<int> find_camera(const ViewSet& set, const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < set.cameras.size(); ++i) {
    if (set.cameras[i].name == name) return static_cast<int>(i);
    known += (known.empty() ? "" : ", ") + set.cameras[i].name;
  }
  return Error{ErrorCode::kUsage, "there is no camera \"" + name + "\" in " +
                                      (set.folder / "views.toml").string() + ": use one of " +
                                      known};
}

std::vector<std::filesystem::path> files_of(const ViewSet& set, const std::string& only_camera) {
  std::vector<std::filesystem::path> files{set.folder / "views.toml"};
  for (const ViewCamera& camera : set.cameras) {
    if (!only_camera.empty() && camera.name != only_camera) continue;
    for (int view = 1; view <= set.views; ++view) {
      files.push_back(file_of(set, camera.images, view));
      if (!camera.depth.empty()) files.push_back(file_of(set, camera.depth, view));
    }
  }
  return files;
}

}  // namespace mixrig::calibration
