// SPDX-License-Identifier: Apache-2.0
#include "host/rig/rig_config.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "host/config/table.h"
#include "host/config/toml_text.h"

namespace mixrig::rig {
namespace {

constexpr config::Range kSide{1, 16384}, kRate{0, 10000}, kLine{0, 31};

Duration from_ms(double ms) { return Duration(std::llround(ms * 1e6)); }
double to_ms(Duration d) { return milliseconds(d); }

/// Names of the formats in the order of PixelFormat.
std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (int i = 0; i < device::kPixelFormats; ++i)
    names.emplace_back(device::name(static_cast<device::PixelFormat>(i)));
  return names;
}

std::optional<double> optional_number(const config::Table& table, const char* key,
                                      config::Range range) {
  if (!table.has(key)) return std::nullopt;
  return table.number(key, range);
}

CameraConfig parse_camera(const config::Table& table, const std::string& fallback_name) {
  CameraConfig camera;
  camera.name = table.text_or("name", fallback_name);
  camera.uri = table.text("uri");
  if (table.has("size_px")) {
    const auto size = table.numbers("size_px", 2, 2, kSide);
    if (size.size() == 2)
      camera.request.size = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  }
  camera.request.format =
      static_cast<device::PixelFormat>(table.one_of("format", format_names(), 0));
  camera.request.rate_hz = table.number_or("rate_hz", 0, kRate);
  camera.trigger_line = table.integer_or("trigger_line", -1, {-1, 31});
  camera.request.hardware_trigger = camera.trigger_line >= 0;
  camera.delay = from_ms(table.number_or("delay_ms", 0, {-1000, 1000}));
  if (const auto exposure_ms = optional_number(table, "exposure_ms", {1e-3, 1e5}))
    camera.exposure_s = *exposure_ms * 1e-3;
  camera.gain = optional_number(table, "gain", {-1e6, 1e6});
  camera.focus = optional_number(table, "focus", {-1e6, 1e6});
  camera.white_balance_k = optional_number(table, "white_balance_k", {100, 1e5});
  return camera;
}

void parse_trigger(const config::Table& table, RigConfig& rig) {
  if (!table.present()) return;
  const config::Table edges = table.table("edges");
  if (edges.present()) {
    rig.edges_uri = edges.text("uri");
    rig.edges_line = edges.integer("line", kLine);
  }
  if (!edges.present() || table.has("uri")) rig.trigger_uri = table.text("uri");
  for (const config::Table& entry : table.tables("line")) {
    TriggerLine line;
    line.line = entry.integer("line", kLine);
    line.channel.divider = entry.integer("divider", {1, 65535});
    line.channel.phase = from_ms(entry.number_or("phase_ms", 0, {0, 655350}));
    line.channel.width = from_ms(entry.number_or("width_ms", 1, {0.001, 655350}));
    line.channel.active_low = entry.boolean_or("active_low", false);
    rig.lines.push_back(line);
  }
}

std::optional<geometry::CameraModel> parse_model(const config::Table& table) {
  if (!table.present()) return std::nullopt;
  geometry::CameraModel model;
  const auto size = table.numbers("size_px", 2, 2, kSide);
  if (size.size() == 2)
    model.pinhole.size_px = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  model.pinhole.fx_px = table.number("fx", config::kPositive);
  model.pinhole.fy_px = table.number("fy", config::kPositive);
  model.pinhole.cx_px = table.number("cx");
  model.pinhole.cy_px = table.number("cy");
  geometry::Lens::Coefficients coefficients{};
  if (table.has("distortion")) {
    const auto given = table.numbers("distortion", 4, 8);
    std::copy_n(given.begin(), std::min(given.size(), coefficients.size()), coefficients.begin());
  }
  model.lens = geometry::Lens(coefficients);
  return model;
}

std::optional<geometry::Pose> parse_pose(const config::Table& table) {
  if (!table.present()) return std::nullopt;
  const auto r = table.matrix("rotation", 3, 3);
  const auto t = table.numbers("translation_m", 3, 3, {-1e6, 1e6});
  if (r.size() != 9 || t.size() != 3) return std::nullopt;
  const Eigen::Matrix3d rotation =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
  auto pose = geometry::pose_from_matrix(rotation, {t[0], t[1], t[2]});
  if (pose) return *pose;
  table.fail("rotation", pose.error());
  return std::nullopt;
}

void check(const config::Table& root, const RigConfig& rig) {
  std::set<std::string> names;
  const auto check_camera = [&](const CameraConfig& camera) {
    if (!names.insert(camera.name).second)
      root.fail("camera",
                "two devices are named \"" + camera.name + "\": give each a name of its own");
    if (camera.trigger_line >= 0 && rig.line_of(camera) == nullptr)
      root.fail("camera", camera.name + ": no [[trigger.line]] has line = " +
                              std::to_string(camera.trigger_line));
  };
  if (!rig.edges_uri.empty() && rig.line(rig.edges_line) == nullptr)
    root.fail("trigger", "edges: no [[trigger.line]] has line = " + std::to_string(rig.edges_line));
  for (const CameraConfig& camera : rig.cameras) check_camera(camera);
  if (rig.depth) check_camera(*rig.depth);
}

void write_camera(std::ostream& out, const CameraConfig& camera, const char* header) {
  out << "\n"
      << header << "\nname = " << config::toml_text(camera.name)
      << "\nuri = " << config::toml_text(camera.uri) << "\n";
  if (!camera.request.size.empty())
    out << "size_px = [" << camera.request.size.width << ", " << camera.request.size.height
        << "]\n";
  if (camera.request.format != device::PixelFormat::kUnknown)
    out << "format = \"" << device::name(camera.request.format) << "\"\n";
  const auto number = [&](const char* key, double value) {
    out << key << " = " << config::toml_number(value) << "\n";
  };
  if (camera.request.rate_hz > 0) number("rate_hz", camera.request.rate_hz);
  if (camera.trigger_line >= 0) out << "trigger_line = " << camera.trigger_line << "\n";
  if (camera.delay != Duration(0)) number("delay_ms", to_ms(camera.delay));
  if (camera.exposure_s) number("exposure_ms", *camera.exposure_s * 1e3);
  if (camera.gain) number("gain", *camera.gain);
  if (camera.focus) number("focus", *camera.focus);
  if (camera.white_balance_k) number("white_balance_k", *camera.white_balance_k);
}

}  // namespace

const TriggerLine* RigConfig::line(int number) const {
  for (const TriggerLine& line : lines)
    if (line.line == number) return &line;
  return nullptr;
}

Result<RigConfig> read_rig(const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = 1 << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostBytes));
  return parse_rig(text, path.string());
}

Result<RigConfig> parse_rig(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(config::Document document, config::Document::parse(text, name));
  config::Table root = document.root();
  RigConfig rig;
  (void)root.integer("format", {1, 1});
  rig.name = root.text_or("name", "rig");
  if (root.has("calibration"))
    rig.calibration =
        config::path_at(root, "calibration", std::filesystem::path(name).parent_path());
  parse_trigger(root.table("trigger"), rig);
  int number = 0;
  for (const config::Table& table : root.tables("camera"))
    rig.cameras.push_back(parse_camera(table, "camera" + std::to_string(++number)));
  if (const config::Table depth = root.table("depth"); depth.present())
    rig.depth = parse_camera(depth, "depth");
  if (const config::Table head = root.table("pan_tilt"); head.present())
    rig.pan_tilt_uri = head.text("uri");
  rig.target = parse_model(root.table("target"));
  rig.tof = parse_model(root.table("tof"));
  rig.target_from_tof = parse_pose(root.table("target_from_tof"));
  rig.world_from_target = parse_pose(root.table("world_from_target"));
  check(root, rig);
  MIXRIG_TRY(document.finish());
  return rig;
}

std::string rig_text(const RigConfig& rig) {
  std::ostringstream out;
  out << "format = 1\nname = " << config::toml_text(rig.name) << "\n";
  if (!rig.trigger_uri.empty())
    out << "\n[trigger]\nuri = " << config::toml_text(rig.trigger_uri) << "\n";
  if (!rig.edges_uri.empty())
    out << "\n[trigger.edges]\nuri = " << config::toml_text(rig.edges_uri)
        << "\nline = " << rig.edges_line << "\n";
  for (const TriggerLine& line : rig.lines) {
    out << "\n[[trigger.line]]\nline = " << line.line << "\ndivider = " << line.channel.divider
        << "\nphase_ms = " << config::toml_number(to_ms(line.channel.phase))
        << "\nwidth_ms = " << config::toml_number(to_ms(line.channel.width)) << "\n";
    if (line.channel.active_low) out << "active_low = true\n";
  }
  for (const CameraConfig& camera : rig.cameras) write_camera(out, camera, "[[camera]]");
  if (rig.depth) write_camera(out, *rig.depth, "[depth]");
  if (!rig.pan_tilt_uri.empty())
    out << "\n[pan_tilt]\nuri = " << config::toml_text(rig.pan_tilt_uri) << "\n";
  return out.str();
}

}  // namespace mixrig::rig
