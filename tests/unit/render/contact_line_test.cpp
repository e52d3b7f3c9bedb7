// SPDX-License-Identifier: Apache-2.0
// A narrow shadow below the front of a box ends in an even line, not in teeth.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "host/judge/measure/stairs.h"
#include "host/render/cpu/light/light.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kContactView{320, 256};
constexpr float kTable_m = 0.6F;  // below the camera

/// World and camera are one: y points down.
struct Boxes {
  std::vector<glm::vec3> positions_m, normals;
  std::vector<std::uint32_t> triangles;

  /// A rectangle around `middle`, whose sides are twice `u` and `v`.
  void add_face(glm::vec3 middle, glm::vec3 u, glm::vec3 v, glm::vec3 normal) {
    const auto first = static_cast<std::uint32_t>(positions_m.size());
    for (const auto& [a, b] : {std::pair(-1.0F, -1.0F), {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}})
      positions_m.push_back(middle + a * u + b * v), normals.push_back(normal);
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) triangles.push_back(first + i);
  }
  render::VirtualObject object() const {
    render::VirtualObject out;
    out.meshes.push_back({positions_m, normals, {}, triangles, glm::vec3(0.5F), {}, true});
    return out;
  }
};

/// A low box on a table, turned by `turn_rad`, with a panel above and behind it.
struct ContactScene {
  explicit ContactScene(float turn_rad) : setup(plain_setup(kContactView, 300, {4, 4}, 4)) {
    const glm::vec3 up(0, -1, 0), along(std::cos(turn_rad), 0, std::sin(turn_rad));
    const glm::vec3 back(-along.z, 0, along.x), front(0, kTable_m, 1.7F);
    constexpr float kHeight_m = 0.16F;
    table.add_face({0, kTable_m, 1.9F}, {1, 0, 0}, {0, 0, 0.8F}, up);
    box.add_face(front + 0.5F * kHeight_m * up, 0.25F * along, 0.5F * kHeight_m * up, -back);
    box.add_face(front + kHeight_m * up + 0.2F * back, 0.25F * along, 0.2F * back, up);
    setup.objects = {table.object(), box.object()};
    setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
    geometry::Lamp lamp{.position_m = {0, -2.2, 2.4}};
    lamp.direction = Eigen::Vector3d(0, 1, 0);
    lamp.size_m = {0.2, 0.2};
    lamp.intensity = Eigen::Vector3f::Constant(4);
    setup.light.lamps = {lamp};
  }
  render::cpu::VirtualLayer drawn() const {
    render::FramePreparer preparer(setup);
    preparer.update({});
    const render::FrameParams& frame = preparer.params();
    Crew crew(1);
    render::cpu::VirtualScratch scratch(frame, kContactView, crew.threads());
    render::cpu::VirtualLayer layer;
    layer.reset(kContactView, false, false);
    render::cpu::draw_virtual(crew, frame, scratch, layer);
    std::vector<render::cpu::ShadowMap> maps(frame.lamps.size());
    render::cpu::draw_shadow_maps(crew, frame, maps);
    render::cpu::shade_virtual(crew, {frame, render::make_tables(setup), {}, maps}, layer);
    return layer;
  }
  Boxes table, box;
  render::CompositorSetup setup;
};

/// Row of a column at which the table, followed from its lit part up, is half as bright; nullopt
/// without a shadow of at least two pixels.
std::optional<double> end_of_shadow(const render::cpu::VirtualLayer& layer, int x) {
  const auto at = [&](int y) { return static_cast<double>(layer.color.at(x, y).g); };
  const auto is_table = [&](int y) {
    return layer.coverage.at(x, y) == 255 && layer.normal.at(x, y).y < -120;
  };
  int contact = kContactView.height - 1;
  while (contact > 0 && is_table(contact)) --contact;
  if (contact + 12 >= kContactView.height || contact < 100) return std::nullopt;
  const double lit = at(contact + 12);
  double darkest = lit;
  for (int y = contact + 1; y < contact + 6; ++y) darkest = std::min(darkest, at(y));
  if (darkest > 0.7 * lit) return std::nullopt;
  const double half = 0.5 * (lit + darkest);
  int y = contact + 12;
  while (at(y) > half) --y;
  return y + (half - at(y)) / (at(y + 1) - at(y));
}

TEST(ContactLine, the_shadow_before_a_box_has_no_teeth) {
  double worst = 0, sum = 0;
  int pieces = 0;
  for (const float turn_rad : {0.1F, 0.25F, 0.4F}) {
    const render::cpu::VirtualLayer layer = ContactScene(turn_rad).drawn();
    std::array<double, measure::kStairPiece_px> places;
    std::size_t count = 0;
    for (int x = 0; x < kContactView.width; ++x) {
      const auto end = end_of_shadow(layer, x);
      if (!end) count = 0;
      if (!end) continue;
      places[count++] = *end;
      if (count < places.size()) continue;
      const double off_px = measure::mean_off_line_px(places);
      worst = std::max(worst, off_px), sum += off_px, ++pieces;
      count = 0;
    }
  }
  EXPECT_GE(pieces, 12);
  // With one light computation per 2x2 pixels these would be 0.24 and 0.46.
  EXPECT_LT(sum / pieces, 0.13);
  EXPECT_LT(worst, 0.3);
}

}  // namespace
}  // namespace mixrig::test
