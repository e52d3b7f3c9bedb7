// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/left_out_node.h"

#include <algorithm>
#include <cmath>

namespace mixrig::calibration {
namespace {

using geometry::LensNode;
using geometry::LensTable;

LeftOutNode compared(const LensNode& node, const geometry::LensState& predicted) {
  constexpr int kSide = 9;
  const geometry::CameraModel& camera = node.lens.camera;
  const Size size = camera.size_px();
  LeftOutNode out{node.at, 0, 0, 100 * (predicted.camera.pinhole.fx_px / camera.pinhole.fx_px - 1)};
  double sum_px2 = 0;
  int count = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Eigen::Vector2d px((i % kSide) * (size.width - 1) / (kSide - 1.0),
                             (i / kSide) * (size.height - 1) / (kSide - 1.0));
    const auto ray = camera.unproject(px);
    const auto seen =
        ray ? predicted.camera.project({ray->x(), ray->y(), 1}) : std::optional<Eigen::Vector2d>();
    if (!seen) continue;
    const double error_px = (*seen - px).norm();
    sum_px2 += error_px * error_px, ++count;
    out.most_px = std::max(out.most_px, error_px);
  }
  out.rms_px = count > 0 ? std::sqrt(sum_px2 / count) : 0;
  return out;
}

/// The nodes of the same focus, or of the same zoom, without this one.
std::vector<LensNode> neighbours(const LensTable& table, const LensNode& node, bool along_zoom) {
  std::vector<LensNode> line;
  for (const LensNode& other : table.nodes()) {
    const bool on_line =
        along_zoom ? other.at.focus == node.at.focus : other.at.zoom == node.at.zoom;
    if (on_line && !(other.at == node.at)) line.push_back(other);
  }
  return line;
}

bool between(std::span<const double> values, double value) {
  return value > values.front() && value < values.back();
}

}  // namespace

Result<std::vector<LeftOutNode>> leave_one_out(const LensTable& table) {
  std::vector<LeftOutNode> left_out;
  for (const LensNode& node : table.nodes()) {
    const bool along_zoom = between(table.zooms(), node.at.zoom);
    if (!along_zoom && !between(table.focuses(), node.at.focus)) continue;
    MIXRIG_ASSIGN(const LensTable others, LensTable::make(neighbours(table, node, along_zoom)));
    left_out.push_back(compared(node, others.at(node.at)));
  }
  return left_out;
}

}  // namespace mixrig::calibration
