// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate lens: several calibrations of one camera become the table of a lens that zooms.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "host/calibrate/intrinsics/left_out_node.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

using geometry::LensNode;
using geometry::LensTable;

struct LensArguments {
  std::vector<std::string> nodes;
  std::string camera = "target", out, rest;
};

constexpr const char* kNodeForm = "write FILE,zoom=COUNTS[,focus=COUNTS][,pupil_mm=SHIFT]";

/// A setting as the command line names it.
struct NamedNode {
  std::string file;
  LensNode node;
  bool has_focus = false;
};

Result<double> number_of(std::string_view text, const std::string& where) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  if (fault == std::errc() && stop == end && std::isfinite(value)) return value;
  return Error{ErrorCode::kUsage,
               fmt::format("{}: \"{}\" is no number: {}", where, text, kNodeForm)};
}

Result<NamedNode> parse_node(const std::string& text) {
  NamedNode named;
  bool has_zoom = false;
  std::size_t begin = text.find(',');
  named.file = text.substr(0, begin);
  while (begin != std::string::npos) {
    const std::size_t end = text.find(',', begin + 1);
    const std::string part = text.substr(begin + 1, end - begin - 1);
    begin = end;
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals);
    MIXRIG_ASSIGN(const double value,
                  number_of(equals == std::string::npos ? "" : part.substr(equals + 1), text));
    if (key == "zoom")
      named.node.at.zoom = value, has_zoom = true;
    else if (key == "focus")
      named.node.at.focus = value, named.has_focus = true;
    else if (key == "pupil_mm")
      named.node.lens.pupil_shift_m = 1e-3 * value;
    else
      return Error{ErrorCode::kUsage,
                   fmt::format("{}: \"{}\" is unknown: {}", text, key, kNodeForm)};
  }
  if (has_zoom && !named.file.empty()) return named;
  return Error{ErrorCode::kUsage, text + ": without file or zoom: " + kNodeForm};
}

/// The camera of a node's file, which becomes the node's lens.
Result<calibration_file::CalibratedCamera> read_node(const LensArguments& arguments,
                                                     NamedNode& named) {
  MIXRIG_ASSIGN(const auto known, calibration_file::read_calibration(named.file));
  const calibration_file::CalibratedCamera* camera = known.camera(arguments.camera);
  if (camera == nullptr)
    return Error{ErrorCode::kFormat, fmt::format("{}: cameras: \"{}\" is missing: calibrate it by "
                                                 "mixrig calibrate intrinsics, or give --camera",
                                                 named.file, arguments.camera)};
  const auto* model = std::get_if<geometry::CameraModel>(&camera->model);
  if (model == nullptr)
    return Error{ErrorCode::kFormat, fmt::format("{}: cameras.{}: a fisheye does not zoom: "
                                                 "calibrate it with --model pinhole",
                                                 named.file, arguments.camera)};
  named.node.lens.camera = *model;
  named.node.residual_px = camera->residual_px;
  return *camera;
}

nlohmann::json report_of(const LensTable& table,
                         const std::vector<calibration::LeftOutNode>& left_out) {
  nlohmann::json nodes = nlohmann::json::array(), judged = nlohmann::json::array();
  for (const LensNode& node : table.nodes())
    nodes.push_back({{"zoom", node.at.zoom},
                     {"focus", node.at.focus},
                     {"fx_px", node.lens.camera.pinhole.fx_px},
                     {"pupil_shift_m", node.lens.pupil_shift_m},
                     {"residual_px", node.residual_px}});
  for (const auto& node : left_out)
    judged.push_back({{"zoom", node.at.zoom},
                      {"focus", node.at.focus},
                      {"rms_px", node.rms_px},
                      {"max_px", node.most_px},
                      {"focal_pct", node.focal_pct}});
  return {{"nodes", std::move(nodes)}, {"left_out", std::move(judged)}};
}

void print(const LensArguments& arguments, const LensTable& table,
           const std::vector<calibration::LeftOutNode>& left_out) {
  std::printf("%s: %zu settings, %zu of zoom and %zu of focus, fx %.1f to %.1f px\n",
              arguments.camera.c_str(), table.nodes().size(), table.zooms().size(),
              table.focuses().size(), table.nodes().front().lens.camera.pinhole.fx_px,
              table.nodes().back().lens.camera.pinhole.fx_px);
  if (left_out.empty()) {
    std::printf(
        "  no setting lies between others: how good the table is between them is not "
        "known; calibrate a third zoom\n");
    return;
  }
  std::printf("  left out and predicted by the others:\n");
  for (const auto& node : left_out)
    std::printf("    zoom %-10g focus %-10g %.3f px RMS, at most %.3f px, focal length %+.3f %%\n",
                node.at.zoom, node.at.focus, node.rms_px, node.most_px, node.focal_pct);
}

Result<nlohmann::json> calibrate_lens(const LensArguments& arguments) {
  std::vector<LensNode> nodes;
  std::optional<calibration_file::CalibratedCamera> rest;
  calibration_file::InputHash hash;
  std::size_t with_focus = 0;
  for (const std::string& text : arguments.nodes) {
    MIXRIG_ASSIGN(NamedNode named, parse_node(text));
    MIXRIG_ASSIGN(auto camera, read_node(arguments, named));
    MIXRIG_TRY(hash.add_file(named.file));
    nodes.push_back(named.node);
    with_focus += named.has_focus;
    if (!rest || named.file == arguments.rest) rest = std::move(camera);
  }
  if (with_focus != 0 && with_focus != nodes.size())
    return Error{ErrorCode::kUsage, "some settings have a focus and others none: give all or none"};
  auto table = LensTable::make(std::move(nodes));
  if (!table) return Error{ErrorCode::kUsage, "NODES: " + table.error().context};
  MIXRIG_ASSIGN(const auto left_out, calibration::leave_one_out(*table));
  print(arguments, *table, left_out);
  if (!arguments.out.empty()) {
    calibration_file::Calibration calibration;
    rest->lens = *table;
    rest->origin = calibration_file::origin_now(hash);
    std::error_code code;
    // The setting that poses of the rig belong to stays the file's own.
    if (arguments.rest.empty() && std::filesystem::exists(arguments.out, code)) {
      MIXRIG_ASSIGN(const auto before, calibration_file::read_calibration(arguments.out));
      if (const auto* camera = before.camera(arguments.camera)) {
        rest = *camera;
        rest->lens = *table;
      }
    }
    calibration.cameras = {*rest};
    MIXRIG_TRY(calibration_file::update_calibration(arguments.out, calibration));
  }
  return with_end(
      report_of(*table, left_out), arguments.out,
      arguments.out.empty() ? "give --out FILE to keep the table" : in_rig_toml(arguments.out));
}

}  // namespace

void add_calibrate_lens_command(Command app, Context& context) {
  auto arguments = std::make_shared<LensArguments>();
  Command group = app.group("calibrate", "calibrate cameras and rig");
  Command command =
      group.add_subcommand("lens", "the table of a lens that zooms, from several calibrations");
  command
      .add_option("NODES", arguments->nodes,
                  "one a setting: FILE,zoom=COUNTS[,focus=COUNTS][,pupil_mm=SHIFT]; FILE is a "
                  "calibration.toml of mixrig calibrate intrinsics, COUNTS what the encoder says")
      .required();
  command.add_option("--camera", arguments->camera, "name in the calibrations").show_default();
  command.add_option("--out", arguments->out,
                     "calibration.toml to write the table into; a camera that it has stays the "
                     "setting of its poses");
  command.add_option("--rest", arguments->rest,
                     "FILE of the setting that the poses of the rig are calibrated at; the first "
                     "if not given");
  command.callback([&context, arguments] {
    context.action = [arguments] { return calibrate_lens(*arguments); };
  });
}

}  // namespace mixrig::tools
