// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lights_bracket.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/math/image_io/image_io.h"
#include "host/room/lamps/bracket.h"

namespace mixrig::session {
namespace {

/// Largest share of a lamp's region that may saturate in all pictures; beyond it the lamp's light
/// is unknown.
constexpr double kMostSaturated = 0.02;

Result<std::vector<Image<Rgb8>>> read_pictures(std::span<const BracketFile> files, Size size) {
  std::vector<Image<Rgb8>> pictures(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = files[i].picture.string();
    MIXRIG_TRY(image_io::read_rgb8(files[i].picture, pictures[i]));
    if (pictures[i].size() != size)
      return Error{ErrorCode::kData,
                   fmt::format("{}: is {}x{}, the fisheye {}x{}: give its own pictures", name,
                               pictures[i].width(), pictures[i].height(), size.width, size.height)};
  }
  return pictures;
}

}  // namespace

Result<std::vector<double>> radiance_by_bracket(std::span<const BracketFile> files,
                                                const geometry::AnyCamera& camera,
                                                std::span<const lights::LampView> views, int view,
                                                std::span<const lights::FoundLamp> lamps) {
  if (files.size() < 2)
    return Error{ErrorCode::kUsage,
                 "lights: --bracket needs two pictures at least: give one for each exposure"};
  MIXRIG_ASSIGN(const auto pictures, read_pictures(files, geometry::size_px(camera)));
  std::vector<lights::BracketShot> shots;
  for (std::size_t i = 0; i < files.size(); ++i) shots.push_back({pictures[i], files[i].exposure});
  const lights::BracketLight light = lights::light_of_bracket(shots);
  const auto pixel = [&](const Eigen::Vector3d& ray) { return geometry::project(camera, ray); };
  std::vector<double> radiance;
  for (std::size_t k = 0; k < lamps.size(); ++k) {
    const auto& seen = lamps[k].seen;
    const auto at = std::find_if(seen.begin(), seen.end(),
                                 [&](const lights::Sighting& s) { return s.view == view; });
    if (at == seen.end())
      return Error{ErrorCode::kData,
                   fmt::format("lights: the picture of --bracket-frame does not show found lamp "
                               "{}: take the bracket where all lamps are seen",
                               k + 1)};
    const auto& region =
        views[static_cast<std::size_t>(view)].regions[static_cast<std::size_t>(at->region)];
    const lights::RegionLight of_lamp = lights::light_of_region(light, region, pixel);
    if (!(of_lamp.radiance > 0))
      return Error{ErrorCode::kData,
                   fmt::format("lights: found lamp {} is black in the pictures of --bracket: take "
                               "them from the place of --bracket-frame",
                               k + 1)};
    if (of_lamp.saturated_share > kMostSaturated)
      return Error{ErrorCode::kData,
                   fmt::format("lights: found lamp {} is saturated in all pictures of --bracket: "
                               "add one of a shorter exposure",
                               k + 1)};
    radiance.push_back(of_lamp.radiance);
  }
  return radiance;
}

}  // namespace mixrig::session
