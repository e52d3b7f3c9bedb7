// SPDX-License-Identifier: Apache-2.0
// The table of a lens that zooms, as [[lens]] of a camera.
#include <algorithm>
#include <array>
#include <vector>

#include "host/capture/calibration_file/tables.h"

namespace mixrig::calibration_file {
namespace {

using config::Range;
using config::Table;
using config::Writer;

constexpr Range kEncoder{-1e12, 1e12}, kNodeFocal{1, 1e6}, kNodeCenter{-1e5, 1e5};
constexpr Range kNodeLens{-1e9, 1e9}, kPupil_m{-1, 1}, kNodeResidual_px{0, 1e6};

geometry::LensNode parse_node(const Table& table, Size size_px) {
  geometry::LensNode node;
  node.at = {table.number("zoom", kEncoder), table.number_or("focus", 0, kEncoder)};
  const geometry::Pinhole pinhole{size_px, table.number("fx", kNodeFocal),
                                  table.number("fy", kNodeFocal), table.number("cx", kNodeCenter),
                                  table.number("cy", kNodeCenter)};
  geometry::Lens::Coefficients k{};
  if (table.has("distortion")) {
    const auto values = table.numbers("distortion", 4, k.size(), kNodeLens);
    std::copy(values.begin(), values.end(), k.begin());
  }
  node.lens = {{pinhole, geometry::Lens(k)}, table.number_or("pupil_shift_m", 0, kPupil_m)};
  node.residual_px = table.number_or("residual_px", 0, kNodeResidual_px);
  return node;
}

}  // namespace

std::optional<geometry::LensTable> parse_lens_table(const Table& table, Size size_px) {
  std::vector<geometry::LensNode> nodes;
  for (const Table& node : table.tables("lens")) nodes.push_back(parse_node(node, size_px));
  if (nodes.empty()) return std::nullopt;
  auto lens = geometry::LensTable::make(std::move(nodes));
  if (lens) return *std::move(lens);
  table.fail("lens", lens.error());
  return std::nullopt;
}

void add_lens_table(Writer& table, const geometry::LensTable& lens) {
  for (const geometry::LensNode& node : lens.nodes()) {
    const geometry::Pinhole& p = node.lens.camera.pinhole;
    Writer out;
    out.set("zoom", node.at.zoom).set("focus", node.at.focus);
    out.set("fx", p.fx_px).set("fy", p.fy_px).set("cx", p.cx_px).set("cy", p.cy_px);
    out.set("distortion", std::span<const double>(node.lens.camera.lens.coefficients()));
    out.set("pupil_shift_m", node.lens.pupil_shift_m).set("residual_px", node.residual_px);
    table.add("lens", std::move(out));
  }
}

}  // namespace mixrig::calibration_file
