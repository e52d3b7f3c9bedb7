// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/fitted_model.h"

#include <algorithm>

#include "host/math/config/writer.h"

namespace mixrig::session {

double largest_m(const scene::Model& model) {
  const scene::Bounds box = scene::bounds(model);
  return static_cast<double>((box.max_m - box.min_m).maxCoeff());
}

void fit(scene::Object& object, const SeenFrom& from, const Eigen::Vector3d& place) {
  constexpr double kMostOfView = 0.8, kLeast_m = 0.05, kWantedLarge = 0.5, kWantedSmall = 0.1;
  const scene::Bounds box = scene::bounds(object.model);
  const double size_m = largest_m(object.model);
  const double away_m = std::max(0.1, (inverse(from.world_from_view) * place).z());
  const double shown_m = away_m * std::min(from.view.size_px.width / from.view.fx_px,
                                           from.view.size_px.height / from.view.fy_px);
  double scale = 1;
  if (size_m > kMostOfView * shown_m) scale = kWantedLarge * shown_m / size_m;
  if (size_m > 0 && size_m < kLeast_m) scale = kWantedSmall * shown_m / size_m;
  object.scale = std::clamp(config::rounded(scale, 2), 1e-6, 1e6);
  const Eigen::Vector3d middle = 0.5 * (box.min_m + box.max_m).cast<double>();
  object.world_from_object.rotation.setIdentity();
  object.world_from_object.translation_m =
      place -
      object.scale * Eigen::Vector3d(middle.x(), middle.y(), static_cast<double>(box.min_m.z()));
}

}  // namespace mixrig::session
