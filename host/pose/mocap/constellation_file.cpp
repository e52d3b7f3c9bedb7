// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/constellation_file.h"

#include "host/math/config/table.h"
#include "host/math/estimation/markers/constellation.h"

namespace mixrig::mocap {

Result<Constellation> parse_constellation(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(config::Document document, config::Document::parse(text, name));
  const config::Table root = document.root();
  Constellation constellation;
  constellation.name = root.text_or("name", "body");
  constellation.sigma_m = root.number_or("sigma_m", constellation.sigma_m, {1e-9, 1e6});
  for (const config::Table& marker : root.tables("marker")) {
    const auto p = marker.numbers("position_m", 3, 3, {-1e6, 1e6});
    if (p.size() == 3) constellation.markers_m.emplace_back(p[0], p[1], p[2]);
  }
  constexpr std::size_t kMost = 64;
  if (constellation.markers_m.size() < 3 || constellation.markers_m.size() > kMost)
    root.fail("marker", "3 to 64 [[marker]] tables with position_m = [x, y, z] are needed");
  MIXRIG_TRY(document.finish());
  const auto verdict =
      estimation::check_constellation(constellation.markers_m, constellation.sigma_m);
  if (verdict.standing == estimation::Standing::kDegenerate)
    return Error{ErrorCode::kData, name + ": " + verdict.reason + ": move a marker"};
  return constellation;
}

Result<Constellation> read_constellation(const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostBytes));
  return parse_constellation(text, path.string());
}

}  // namespace mixrig::mocap
