// SPDX-License-Identifier: Apache-2.0
// The people of a take.
#include "studio/people/cast.h"

#include <algorithm>
#include <cmath>

#include "hal/base/angles.h"
#include "studio/people/attire.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {
namespace {

constexpr unsigned kSecond = 7001, kThird = 7002, kCrowd = 7003;  ///< added to the seed

const Eigen::Vector2f kBehind_m(3.95F, 2.95F);  ///< where the third stands, if not walking

/// Place of person `i` of `of` in the crowd, on an arc before the camera.
Eigen::Vector2f crowd_spot(const Layout& layout, int i, int of) {
  constexpr double kAway_m = 0.8, kField_rad = 160 * kDeg;
  const Eigen::Vector2d ahead = (layout.look_at_m - layout.eye_m).head<2>();
  const double bearing =
      std::atan2(ahead.y(), ahead.x()) + kField_rad * ((i + 0.5) / std::max(1, of) - 0.5);
  const Eigen::Vector2d at =
      layout.eye_m.head<2>() + kAway_m * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
  return at.cast<float>();
}

}  // namespace

Cast::Cast(const StudioOptions& options, const Layout& layout, double start_s) : options_(options) {
  people_.emplace_back(options.scenario, options.seed, layout.stage, start_s);
  Stage stage = layout.stage;
  if (options.people >= 2) {
    stage.spot = {layout.room.guest_foot.x(), layout.room.guest_foot.y()};
    people_.emplace_back(Scenario::kStill, options.seed + kSecond, stage, start_s);
  }
  if (options.people >= 3) add_third(options, layout, start_s);
  for (int i = 0; i < options.day.crowd; ++i) {
    stage.spot = crowd_spot(layout, i, options.day.crowd);
    const unsigned seed = options.seed + kCrowd + static_cast<unsigned>(i);
    people_.emplace_back(Scenario::kTalk, 2 * seed + 1, stage, start_s);  // odd: they stand
  }
}

void Cast::add_third(const StudioOptions& options, const Layout& layout, double start_s) {
  Stage stage = layout.stage;
  if (!people_.front().walks()) {  // and would block the path
    stage.spot = kBehind_m;
    people_.emplace_back(Scenario::kTalk, (options.seed + kThird) | 1U, stage, start_s);
    return;
  }
  const PersonMotion alone(Scenario::kWalk, options.seed, stage, start_s);
  people_.emplace_back(Scenario::kWalk, options.seed, stage, start_s + 0.5 * alone.lap_s());
}

void Cast::dress(const StudioOptions& options, Materials& materials) {
  const bool dark = options.scenario == Scenario::kDark;
  if (options.people >= 2) materials.add(choose_wardrobe(options.seed + kSecond, dark));
  if (options.people >= 3)
    materials.add(wall_coloured(choose_wardrobe(options.seed + kThird, dark)));
  for (unsigned i = 0; i < static_cast<unsigned>(options.day.crowd); ++i)
    materials.add(choose_wardrobe(options.seed + kCrowd + i, dark));
}

void Cast::build(double time_s, Mesh& mesh) const {
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const std::size_t first = mesh.materials.size();
    const PersonMotion& person = people_[i];
    const Posture posture = person.at(time_s);
    const BodyPoints points = build_person(person.build(), posture, mesh);
    const Realism& realism = options_.realism;
    if (realism.loose_clothes && person.walks()) add_coat(person.build(), posture, points, mesh);
    if (realism.hair)
      add_strands(person.build(), points, options_.seed + static_cast<unsigned>(i), mesh);
    if (options_.props && i == 0) add_props(posture, points, mesh);
    for (std::size_t t = first; t < mesh.materials.size(); ++t)
      mesh.materials[t].person = static_cast<std::uint8_t>(i);
  }
}

}  // namespace mixrig::studio
