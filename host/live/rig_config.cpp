// SPDX-License-Identifier: Apache-2.0
#include "host/live/rig_config.h"

#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "host/calibration_file/tables.h"
#include "host/config/table.h"
#include "host/config/writer.h"
#include "host/stream/freed_receiver.h"

namespace mixrig::live {
namespace {

using config::Writer;

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

void parse_lens(const config::Table& table, RigConfig& rig) {
  if (!table.present()) return;
  rig.lens_uri = table.text("uri");
  if (const auto address = stream::parse_freed_address(rig.lens_uri); !address)
    table.fail("uri", address.error());
  rig.lens_delay = from_ms(table.number_or("delay_ms", 0, {0, 1000}));
}

std::optional<geometry::CameraModel> parse_model(const config::Table& table) {
  if (!table.present()) return std::nullopt;
  return calibration_file::parse_pinhole(table);
}

std::optional<geometry::Pose> parse_pose(const config::Table& table) {
  if (!table.present()) return std::nullopt;
  return calibration_file::parse_pose(table);
}

void check(const config::Table& root, const RigConfig& rig) {
  std::set<std::string> names;
  const auto check_camera = [&](const CameraConfig& camera) {
    if (!names.insert(camera.name).second)
      root.fail("camera",
                fmt::format("two devices are named \"{}\": give each its own name", camera.name));
    if (camera.trigger_line >= 0 && rig.line_of(camera) == nullptr)
      root.fail("camera", fmt::format("{}: no [[trigger.line]] has line = {}: add one", camera.name,
                                      camera.trigger_line));
  };
  if (!rig.edges_uri.empty() && rig.line(rig.edges_line) == nullptr)
    root.fail("trigger",
              fmt::format("edges: no [[trigger.line]] has line = {}: add one", rig.edges_line));
  for (const CameraConfig& camera : rig.cameras) check_camera(camera);
  if (rig.depth) check_camera(*rig.depth);
}

Writer camera_table(const CameraConfig& camera) {
  Writer table;
  table.set("name", camera.name).set("uri", camera.uri);
  if (!camera.request.size.empty()) table.set("size_px", camera.request.size);
  if (camera.request.format != device::PixelFormat::kUnknown)
    table.set("format", device::name(camera.request.format));
  if (camera.request.rate_hz > 0) table.set("rate_hz", camera.request.rate_hz);
  if (camera.trigger_line >= 0) table.set("trigger_line", camera.trigger_line);
  if (camera.delay != Duration(0)) table.set("delay_ms", to_ms(camera.delay));
  if (camera.exposure_s) table.set("exposure_ms", *camera.exposure_s * 1e3);
  if (camera.gain) table.set("gain", *camera.gain);
  if (camera.focus) table.set("focus", *camera.focus);
  if (camera.white_balance_k) table.set("white_balance_k", *camera.white_balance_k);
  return table;
}

Writer line_table(const TriggerLine& line) {
  Writer table;
  table.set("line", line.line).set("divider", line.channel.divider);
  table.set("phase_ms", to_ms(line.channel.phase)).set("width_ms", to_ms(line.channel.width));
  if (line.channel.active_low) table.set("active_low", true);
  return table;
}

Writer trigger_table(const RigConfig& rig) {
  Writer table;
  if (!rig.trigger_uri.empty()) table.set("uri", rig.trigger_uri);
  if (!rig.edges_uri.empty())
    table.set("edges", std::move(Writer().set("uri", rig.edges_uri).set("line", rig.edges_line)));
  for (const TriggerLine& line : rig.lines) table.add("line", line_table(line));
  return table;
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
  rig.file = name;
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
  parse_lens(root.table("lens"), rig);
  if (const auto at_s = optional_number(root, "play_at_s", {0, 1e9}))
    rig.play_at = HostTime(Duration(std::llround(*at_s * 1e9)));
  rig.target = parse_model(root.table("target"));
  rig.tof = parse_model(root.table("tof"));
  if (const config::Table pose = root.table("target_from_tof"); pose.present())
    rig.target_from_tof = calibration_file::parse_calibrated_pose(pose, "tof").target_from;
  rig.world_from_target = parse_pose(root.table("world_from_target"));
  check(root, rig);
  MIXRIG_TRY(document.finish());
  return rig;
}

std::string rig_text(const RigConfig& rig) {
  Writer root;
  root.set("format", 1).set("name", rig.name);
  if (rig.play_at) root.set("play_at_s", seconds(rig.play_at->time_since_epoch()));
  if (!rig.trigger_uri.empty() || !rig.edges_uri.empty() || !rig.lines.empty())
    root.set("trigger", trigger_table(rig));
  for (const CameraConfig& camera : rig.cameras) root.add("camera", camera_table(camera));
  if (rig.depth) root.set("depth", camera_table(*rig.depth));
  if (!rig.pan_tilt_uri.empty())
    root.set("pan_tilt", std::move(Writer().set("uri", rig.pan_tilt_uri)));
  if (!rig.lens_uri.empty())
    root.set("lens",
             std::move(Writer().set("uri", rig.lens_uri).set("delay_ms", to_ms(rig.lens_delay))));
  return root.text();
}

}  // namespace mixrig::live
