// SPDX-License-Identifier: Apache-2.0
// Reading of take.toml.
#include "host/capture/take/manifest.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/capture/calibration_file/tables.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/capture/take/streams/picture_files.h"
#include "host/capture/take/streams/raw_depth.h"
#include "host/math/config/table.h"

namespace mixrig::take {
namespace {

using config::Range;
using config::Table;

constexpr Range kCount{1, 10'000'000};

StreamInfo read_stream(const Table& table) {
  StreamInfo stream;
  stream.path = table.text("path");
  stream.rate_hz = table.number_or("rate_hz", 0.0, {0.0, 1e6});
  stream.first = table.integer_or("first", 1, {0, 1e9});
  const bool counted = !is_list(stream);
  stream.delay_s = 1e-3 * table.number_or("delay_ms", 0.0, {-1000.0, 1000.0});
  stream.count = counted ? table.integer("count", kCount) : table.integer_or("count", 0, kCount);
  if (table.present() && counted && !is_matroska(stream))
    if (const auto name = NumberedName::parse(stream.path); !name) table.fail("path", name.error());
  if (is_matroska(stream) && stream.rate_hz <= 0)
    table.fail("rate_hz", "missing: a Matroska stream needs rate_hz: add it");
  return stream;
}

std::optional<geometry::Pinhole> read_view(const Table& target, Size size) {
  if (!target.has("view")) return std::nullopt;
  const auto v = target.numbers("view", 4, 4);
  const geometry::Pinhole view{size, v[0], v[1], v[2], v[3]};
  if (const auto valid = geometry::validate({view, {}}); !valid) target.fail("view", valid.error());
  return view;
}

geometry::DepthNoise read_noise(const Table& table) {
  if (!table.has("noise")) return {};
  const auto noise = table.numbers("noise", 3, 3, {0.0, 10.0});
  return {noise[0], noise[1], noise[2]};
}

capture::DepthKind read_kind(const Table& table) {
  return static_cast<capture::DepthKind>(table.one_of("kind", {"z", "distance"}, 0));
}

/// Reads one step or up to four; returns the first and puts the others into `further`.
int read_unknown(const Table& table, std::vector<int>& further) {
  if (!table.has("unknown")) return 0;
  const auto steps = table.numbers("unknown", 1, kMostUnknownSteps, {0, 65535});
  if (std::any_of(steps.begin(), steps.end(), [](double step) { return step != std::floor(step); }))
    table.fail("unknown", "give whole steps");
  further.clear();
  for (std::size_t i = 1; i < steps.size(); ++i) further.push_back(static_cast<int>(steps[i]));
  return steps.empty() ? 0 : static_cast<int>(steps[0]);
}

/// Refuses an amplitude whose rate is not that of its depth.
void check_amplitude_rate(const Table& table, const StreamInfo& amplitude,
                          const StreamInfo& depth) {
  if (amplitude.rate_hz > 0 && depth.rate_hz > 0 && amplitude.rate_hz != depth.rate_hz)
    table.fail("rate_hz", fmt::format("{} Hz, but its depth has {} Hz: amplitudes come with depth, "
                                      "give both the same",
                                      amplitude.rate_hz, depth.rate_hz));
}

/// Reads [depth2], [amplitude2], [tof2] and [target_from_tof2].
void read_second_depth(const Table& root, Manifest& manifest) {
  TakeInfo& info = manifest.info;
  const Table table = root.table("depth2"), amplitude = root.table("amplitude2");
  const Table model = root.table("tof2"), pose = root.table("target_from_tof2");
  if (!table.present()) {
    if (amplitude.present() || model.present() || pose.present())
      root.fail("depth2", "missing: [amplitude2], [tof2] and [target_from_tof2] are of its camera");
    return;
  }
  SecondDepthStream& streams = info.depth2.emplace();
  capture::SecondDepthCamera& camera = info.tof2.emplace();
  streams.depth = read_stream(table);
  if (is_list(streams.depth)) table.fail("path", "give numbered pictures or a Matroska file");
  camera.unit_m = table.number_or("unit_m", camera.unit_m, {1e-7, 10.0});
  camera.offset_m = table.number_or("offset_m", 0, {-10.0, 10.0});
  camera.unknown = read_unknown(table, manifest.further_unknown2);
  camera.kind = read_kind(table);
  camera.noise = read_noise(table);
  if (amplitude.present()) {
    streams.amplitude = read_stream(amplitude);
    check_amplitude_rate(amplitude, *streams.amplitude, streams.depth);
    camera.amplitude_is_light = amplitude.boolean_or("light", false);
  }
  camera.model = calibration_file::parse_pinhole(root.required_table("tof2"));
  camera.target_from_tof =
      calibration_file::parse_calibrated_pose(root.required_table("target_from_tof2"), "tof2")
          .target_from;
}

void read_depth(const Table& table, Manifest& manifest) {
  TakeInfo& info = manifest.info;
  info.depth = read_stream(table);
  info.depth_unit_m = table.number_or("unit_m", info.depth_unit_m, {1e-7, 10.0});
  info.depth_offset_m = table.number_or("offset_m", 0, {-10.0, 10.0});
  info.depth_unknown = read_unknown(table, manifest.further_unknown);
  info.depth_kind = read_kind(table);
  if (table.has("raw")) {
    (void)table.one_of("raw", {kRawKinect2}, 0);
    info.raw_depth = kRawKinect2;
    info.amplitude_is_light = true;
    if (info.depth_kind != capture::DepthKind::kDistance)
      table.fail("kind", "raw frames give distances: write \"distance\"");
    if (is_list(info.depth) || is_matroska(info.depth))
      table.fail("path", "raw frames are numbered files: write raw/%06d.bin");
  }
  info.noise = read_noise(table);
}

void read_pose_source(const Table& table, Manifest& manifest) {
  manifest.pose_file = table.text_or("file", "");
  const Table fixed = table.table("world_from_target");
  if (fixed.present()) manifest.fixed_pose = calibration_file::parse_pose(fixed);
  if (table.present() && fixed.present() == !manifest.pose_file.empty())
    table.fail("file", "give either file or world_from_target");
}

std::filesystem::path read_root(const Table& root, const std::filesystem::path& folder) {
  const auto expanded = config::expand_environment(root.text_or("root", "."));
  if (expanded) return (folder / *expanded).lexically_normal();
  root.fail("root", expanded.error());
  return folder;
}

}  // namespace

bool is_list(const StreamInfo& stream) { return stream.path.ends_with(".txt"); }
bool is_matroska(const StreamInfo& stream) { return stream.path.ends_with(".mkv"); }

Result<Manifest> parse_manifest(std::string_view text, const std::filesystem::path& path) {
  MIXRIG_ASSIGN(auto document, config::Document::parse(text, path.string()));
  const Table root = document.root();
  Manifest manifest;
  TakeInfo& info = manifest.info;
  info.path = path;
  root.integer("format", {1, 1});
  info.name = root.text_or("name", path.parent_path().filename().string());
  info.root = read_root(root, path.parent_path());
  manifest.unfinished = root.boolean_or("unfinished", false);
  if (root.has("calibration"))
    info.calibration = config::path_at(root, "calibration", path.parent_path());
  info.color = read_stream(root.required_table("color"));
  info.exposure_s = 1e-3 * root.table("color").number_or("exposure_ms", 0.0, {0.0, 1e4});
  read_depth(root.required_table("depth"), manifest);
  if (const Table amplitude = root.table("amplitude"); amplitude.present()) {
    info.amplitude = read_stream(amplitude);
    check_amplitude_rate(amplitude, *info.amplitude, info.depth);
    info.amplitude_is_light = amplitude.boolean_or("light", false);
  }
  read_second_depth(root, manifest);
  if (const Table fisheye = root.table("fisheye"); fisheye.present()) {
    info.fisheye = read_stream(fisheye);
    if (is_list(*info.fisheye)) fisheye.fail("path", "give numbered pictures or a Matroska file");
  }
  if (is_list(info.color) != is_list(info.depth) || (info.amplitude && is_list(info.color)))
    root.fail("depth", "lists (.txt) must name both colour and depth, and no amplitude");
  const Table target = root.required_table("target");
  info.target = calibration_file::parse_pinhole(target);
  info.view = read_view(target, info.target.size_px());
  info.tof = calibration_file::parse_pinhole(root.required_table("tof"));
  info.target_from_tof =
      calibration_file::parse_calibrated_pose(root.required_table("target_from_tof"), "tof")
          .target_from;
  read_pose_source(root.table("pose"), manifest);
  info.has_poses = !manifest.pose_file.empty() || manifest.fixed_pose.has_value();
  const Table truth = root.table("truth");
  info.has_truth = truth.present();
  info.true_poses = info.has_truth && info.has_poses;
  if (info.has_truth) manifest.truth_path = truth.text_or("path", "truth");
  info.truth_depth_unit_m = truth.number_or("depth_unit_m", info.truth_depth_unit_m, {1e-7, 10.0});
  MIXRIG_TRY(document.finish());
  return manifest;
}

}  // namespace mixrig::take
