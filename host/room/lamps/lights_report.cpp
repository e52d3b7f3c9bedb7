// SPDX-License-Identifier: Apache-2.0
// Writes the results of a search for lamps as JSON, and into a scene.
#include <cmath>

#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/room/lamps/lights.h"
#include "host/room/lamps/room_lamps.h"
#include "host/scene/scene_edit.h"

namespace mixrig::session {
namespace {

using Eigen::Vector3d;

template <typename Vector>
nlohmann::json numbers(const Vector& v) {
  nlohmann::json list = nlohmann::json::array();
  for (int i = 0; i < v.size(); ++i) list.push_back(v[i]);
  return list;
}

nlohmann::json lamp_json(const lights::FoundLamp& found, const geometry::Lamp& lamp) {
  nlohmann::json json = {{"name", lamp.name},
                         {"position_m", numbers(found.position_m)},
                         {"direction", nullptr},
                         {"size_m", numbers(found.size_m)},
                         {"intensity", numbers(lamp.intensity)},
                         {"solid_angle_sr", found.solid_angle_sr},
                         {"surround", found.surround},
                         {"pictures", found.seen.size()},
                         {"residual", found.residual},
                         {"by", found.by_surface ? "surface" : "triangulation"}};
  json["sigma_mm"] = numbers(Vector3d(1e3 * found.covariance.diagonal().cwiseSqrt()));
  if (found.direction) json["direction"] = numbers(*found.direction);
  return json;
}

nlohmann::json light_json(const estimation::Estimate<lights::RoomLight>& light) {
  if (!light.usable()) return {{"intensity", "assumed"}, {"reason", light.verdict.reason}};
  nlohmann::json sigma = nlohmann::json::array();
  for (Eigen::Index i = 0; i < light.covariance.rows(); ++i)
    sigma.push_back(std::sqrt(light.covariance(i, i)));
  return {{"intensity", "measured"},
          {"ambient", numbers(light.value.ambient)},
          {"sigma_share", sigma},
          {"largest_share", light.value.largest_share},
          {"residual", light.value.residual},
          {"samples", light.value.samples},
          {"planes", light.value.planes}};
}

nlohmann::json rejected_json(const lights::RejectedLamp& rejected) {
  nlohmann::json json = {{"reason", lights::name(rejected.refusal)},
                         {"text", lights::text_of(rejected.refusal)},
                         {"position_m", nullptr},
                         {"from_m", numbers(rejected.from_m)},
                         {"ray", numbers(rejected.ray)},
                         {"surround", rejected.surround},
                         {"pictures", rejected.seen.size()}};
  if (rejected.position_m) json["position_m"] = numbers(*rejected.position_m);
  return json;
}

}  // namespace

nlohmann::json to_json(const RoomLights& found) {
  nlohmann::json lamps = nlohmann::json::array(), rejected = nlohmann::json::array();
  for (std::size_t i = 0; i < found.lamps.size(); ++i) {
    lamps.push_back(lamp_json(found.search.lamps[i], found.lamps[i]));
    if (!found.radiance.empty()) lamps.back()["radiance"] = found.radiance[i];
  }
  for (const auto& r : found.search.rejected) rejected.push_back(rejected_json(r));
  return {{"lamps", lamps},
          {"rejected", rejected},
          {"light", light_json(found.light)},
          {"pictures", found.pictures},
          {"without_pose", found.without_pose}};
}

Result<void> write_lights(const RoomLights& found, const std::filesystem::path& scene) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(scene, kMostBytes));
  std::optional<Eigen::Vector3f> ambient;
  if (found.light.usable()) ambient = found.light.value.ambient;
  MIXRIG_ASSIGN(const std::string edited, scene::with_lamps(text, scene, found.lamps, ambient));
  return write_file(scene, edited);
}

}  // namespace mixrig::session
