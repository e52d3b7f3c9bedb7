// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/contact_points.h"

#include <algorithm>
#include <array>

namespace mixrig::session {
namespace {

constexpr double kFootShare = 0.01;  ///< of the object's height

std::vector<Eigen::Vector3d> vertices_of(const render::VirtualObject& object) {
  std::vector<Eigen::Vector3d> points;
  for (const render::MeshView& mesh : object.meshes)
    for (const glm::vec3& p : mesh.positions_m)
      points.push_back(object.world_from_object * (object.scale * Eigen::Vector3d(p.x, p.y, p.z)));
  return points;
}

}  // namespace

std::vector<Eigen::Vector3d> contact_points(const std::vector<render::VirtualObject>& objects) {
  std::vector<Eigen::Vector3d> contacts;
  for (const render::VirtualObject& object : objects) {
    std::vector<Eigen::Vector3d> foot = vertices_of(object);
    if (foot.empty()) continue;
    const auto by = [](int axis) {
      return [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    };
    const auto [low, high] = std::minmax_element(foot.begin(), foot.end(), by(2));
    const double most_m = low->z() + kFootShare * (high->z() - low->z());
    std::erase_if(foot, [&](const Eigen::Vector3d& p) { return p.z() > most_m; });
    const std::size_t before = contacts.size();
    for (const int axis : {0, 1}) {
      const auto [least, greatest] = std::minmax_element(foot.begin(), foot.end(), by(axis));
      for (const Eigen::Vector3d& point : {*least, *greatest})
        if (std::find(contacts.begin() + static_cast<std::ptrdiff_t>(before), contacts.end(),
                      point) == contacts.end())
          contacts.push_back(point);
    }
  }
  return contacts;
}

}  // namespace mixrig::session
