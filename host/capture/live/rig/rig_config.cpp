// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/rig_config.h"

#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "host/capture/calibration_file/tables.h"
#include "host/capture/live/rig/depth_phases.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"

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

/// The words of rig.toml in the order of the enumerators.
const std::vector<std::string> kTransfers = {"srgb", "bt709", "linear", "gamma"},
                               kMatrices = {"bt601", "bt709", "bt2020"},
                               kRanges = {"usual", "limited", "full"}, kKinds = {"z", "distance"};

template <typename T>
std::optional<T> optional_word(const config::Table& table, const char* key,
                               const std::vector<std::string>& words) {
  if (!table.has(key)) return std::nullopt;
  return static_cast<T>(table.one_of(key, words, 0));
}

ColorConfig parse_color(const config::Table& table) {
  ColorConfig color;
  color.transfer = optional_word<device::Transfer>(table, "transfer", kTransfers);
  color.matrix = optional_word<device::YuvMatrix>(table, "yuv", kMatrices);
  color.range = optional_word<device::SampleRange>(table, "range", kRanges);
  color.black_level = table.number_or("black_level", 0, {0, 65535});
  color.gamma = table.number_or("gamma", color.gamma, {0.5, 4});
  if ((color.transfer == device::Transfer::kGamma) != table.has("gamma"))
    table.fail("gamma", "give it with transfer = \"gamma\", and only then");
  if (table.has("white_gains")) {
    const auto gains = table.numbers("white_gains", 3, 3, {1, 16});
    std::copy(gains.begin(), gains.end(), color.white_gains.begin());
  }
  return color;
}

DepthConfig parse_depth(const config::Table& table) {
  constexpr config::Range kDepthStep{0, 65535};
  DepthConfig depth;
  depth.unit_m = optional_number(table, "unit_m", {1e-7, 10});
  depth.offset_m = optional_number(table, "offset_m", {-10, 10});
  depth.kind = optional_word<device::DepthMeaning>(table, "kind", kKinds);
  if (table.has("unknown"))
    for (const double step : table.numbers("unknown", 1, 4, kDepthStep)) {
      if (step != std::floor(step)) table.fail("unknown", "give whole steps");
      depth.unknown.push_back(static_cast<int>(step));
    }
  if (table.has("noise")) {
    const auto noise = table.numbers("noise", 3, 3, {0, 10});
    depth.noise = {noise[0], noise[1], noise[2]};
  }
  if (table.has("least_confidence"))
    depth.least_confidence = table.integer("least_confidence", kDepthStep);
  if (table.has("light")) depth.light = table.boolean_or("light", false);
  return depth;
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
  camera.request.trigger_input = table.text_or("trigger_input", "");
  camera.delay = from_ms(table.number_or("delay_ms", 0, {-1000, 1000}));
  if (const auto exposure_ms = optional_number(table, "exposure_ms", {1e-3, 1e5}))
    camera.exposure_s = *exposure_ms * 1e-3;
  camera.gain = optional_number(table, "gain", {-1e6, 1e6});
  camera.focus = optional_number(table, "focus", {-1e6, 1e6});
  camera.white_balance_k = optional_number(table, "white_balance_k", {100, 1e5});
  camera.zoom = optional_number(table, "zoom", {-1e6, 1e6});
  return camera;
}

/// Reads [depth], or [[depth]] once or twice.
void parse_depth_cameras(const config::Table& root, RigConfig& rig) {
  std::vector<config::Table> tables;
  if (root.size_of("depth") > 0)
    tables = root.tables("depth");
  else if (const config::Table one = root.table("depth"); one.present())
    tables.push_back(one);
  if (tables.size() > 2)
    root.fail("depth", fmt::format("a rig has at most two depth cameras, these are {}: remove some",
                                   tables.size()));
  for (std::size_t i = 0; i < tables.size(); ++i) {
    CameraConfig camera = parse_camera(tables[i], i == 0 ? "depth" : "depth2");
    DepthConfig steps = parse_depth(tables[i]);
    (i == 0 ? rig.depth : rig.depth2) = std::move(camera);
    (i == 0 ? rig.depth_steps : rig.depth2_steps) = std::move(steps);
  }
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
  if (!rig.depth2) return;
  check_camera(*rig.depth2);
  if (const DepthPhases phases = depth_phases(rig); phases.overlap) root.fail("depth", phases.line);
}

Writer camera_table(const CameraConfig& camera) {
  Writer table;
  table.set("name", camera.name).set("uri", camera.uri);
  if (!camera.request.size.empty()) table.set("size_px", camera.request.size);
  if (camera.request.format != device::PixelFormat::kUnknown)
    table.set("format", device::name(camera.request.format));
  if (camera.request.rate_hz > 0) table.set("rate_hz", camera.request.rate_hz);
  if (camera.trigger_line >= 0) table.set("trigger_line", camera.trigger_line);
  if (!camera.request.trigger_input.empty())
    table.set("trigger_input", camera.request.trigger_input);
  if (camera.delay != Duration(0)) table.set("delay_ms", to_ms(camera.delay));
  if (camera.exposure_s) table.set("exposure_ms", *camera.exposure_s * 1e3);
  if (camera.gain) table.set("gain", *camera.gain);
  if (camera.focus) table.set("focus", *camera.focus);
  if (camera.white_balance_k) table.set("white_balance_k", *camera.white_balance_k);
  if (camera.zoom) table.set("zoom", *camera.zoom);
  return table;
}

template <typename T>
void set_word(Writer& table, const char* key, const std::vector<std::string>& words,
              const std::optional<T>& value) {
  if (value) table.set(key, words[static_cast<std::size_t>(*value)]);
}

Writer color_camera_table(const CameraConfig& camera) {
  const ColorConfig& color = camera.color;
  Writer table = camera_table(camera);
  set_word(table, "transfer", kTransfers, color.transfer);
  if (color.transfer == device::Transfer::kGamma) table.set("gamma", color.gamma);
  set_word(table, "yuv", kMatrices, color.matrix);
  set_word(table, "range", kRanges, color.range);
  if (color.black_level > 0) table.set("black_level", color.black_level);
  if (color.white_gains != ColorConfig().white_gains)
    table.set("white_gains", std::span<const double>(color.white_gains));
  return table;
}

Writer depth_camera_table(const CameraConfig& camera, const DepthConfig& depth) {
  Writer table = camera_table(camera);
  if (depth.unit_m) table.set("unit_m", *depth.unit_m);
  if (depth.offset_m) table.set("offset_m", *depth.offset_m);
  set_word(table, "kind", kKinds, depth.kind);
  if (!depth.unknown.empty()) table.set("unknown", std::span<const int>(depth.unknown));
  if (const auto& noise = depth.noise)
    table.set("noise",
              std::array<double, 3>{noise->floor_m, noise->linear, noise->quadratic_per_m});
  if (depth.least_confidence) table.set("least_confidence", *depth.least_confidence);
  if (depth.light) table.set("light", *depth.light);
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

device::DepthInfo DepthConfig::applied_to(device::DepthInfo told) const {
  told.metres_per_step = unit_m.value_or(told.metres_per_step);
  told.unit_known |= unit_m.has_value();
  told.offset_m = offset_m.value_or(told.offset_m);
  told.meaning = kind.value_or(told.meaning);
  if (!unknown.empty()) told.unknown_steps = unknown;
  told.least_confidence = least_confidence.value_or(told.least_confidence);
  told.amplitude_is_light = light.value_or(told.amplitude_is_light);
  return told;
}

const TriggerLine* RigConfig::line(int number) const {
  for (const TriggerLine& line : lines)
    if (line.line == number) return &line;
  return nullptr;
}

std::string_view transfer_word(device::Transfer transfer) {
  return kTransfers.at(static_cast<std::size_t>(transfer));
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
  for (const config::Table& table : root.tables("camera")) {
    rig.cameras.push_back(parse_camera(table, "camera" + std::to_string(++number)));
    rig.cameras.back().color = parse_color(table);
  }
  parse_depth_cameras(root, rig);
  if (const config::Table head = root.table("pan_tilt"); head.present())
    rig.pan_tilt_uri = head.text("uri");
  parse_lens(root.table("lens"), rig);
  if (const auto at_s = optional_number(root, "play_at_s", {0, 1e9}))
    rig.play_at = HostTime(Duration(std::llround(*at_s * 1e9)));
  rig.target = parse_model(root.table("target"));
  rig.tof = parse_model(root.table("tof"));
  if (const config::Table pose = root.table("target_from_tof"); pose.present())
    rig.target_from_tof = calibration_file::parse_calibrated_pose(pose, "tof").target_from;
  rig.tof2 = parse_model(root.table("tof2"));
  if (const config::Table pose = root.table("target_from_tof2"); pose.present())
    rig.target_from_tof2 = calibration_file::parse_calibrated_pose(pose, "tof2").target_from;
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
  for (const CameraConfig& camera : rig.cameras) root.add("camera", color_camera_table(camera));
  if (rig.depth && !rig.depth2) root.set("depth", depth_camera_table(*rig.depth, rig.depth_steps));
  if (rig.depth2) {
    root.add("depth", depth_camera_table(*rig.depth, rig.depth_steps));
    root.add("depth", depth_camera_table(*rig.depth2, rig.depth2_steps));
  }
  if (!rig.pan_tilt_uri.empty())
    root.set("pan_tilt", std::move(Writer().set("uri", rig.pan_tilt_uri)));
  if (!rig.lens_uri.empty())
    root.set("lens",
             std::move(Writer().set("uri", rig.lens_uri).set("delay_ms", to_ms(rig.lens_delay))));
  return root.text();
}

}  // namespace mixrig::live
