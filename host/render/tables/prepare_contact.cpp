// SPDX-License-Identifier: Apache-2.0
// Ambient light that objects hide, and the light that they send instead, in a frame.
#include <algorithm>
#include <cmath>

#include "host/math/geometry/lamp.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {
namespace {

/// Irradiance of a surface, without shadows.
glm::vec3 light_on(const geometry::Light& light, const glm::dvec3& at_m, const glm::dvec3& normal) {
  glm::dvec3 sum(to_glm(light.ambient));
  for (const geometry::Lamp& lamp : light.lamps)
    sum += glm::dvec3(to_glm(lamp.intensity)) *
           geometry::irradiance(lamp, to_eigen(at_m), to_eigen(normal));
  return glm::vec3(sum);
}

}  // namespace

void FramePreparer::find_contacts() {
  for (std::size_t i = 0; i < setup_.objects.size(); ++i) {
    if (contacts_.size() == kMostContacts || !has_contact(setup_, setup_.objects[i])) continue;
    const ContactShade shade = make_contact_shade(setup_.objects[i]);
    if (shade.hidden.empty()) continue;
    contacts_.push_back({i, shade.albedo});
    params_.contacts.push_back({glm::mat4(1), shade.low_m, shade.high_m, shade.reach_m, {}});
    contact_hidden_.insert(contact_hidden_.end(), shade.hidden.begin(), shade.hidden.end());
  }
  params_.contact_hidden = contact_hidden_;
}

void FramePreparer::update_contacts(const geometry::Pose& world_from_target) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const geometry::Pose& world_from_object = setup_.objects[contacts_[k].object].world_from_object;
    ContactParams& to = params_.contacts[k];
    to.object_from_camera =
        glm::mat4(to_glm((geometry::inverse(world_from_object) * world_from_target).matrix()));
    const glm::dmat4 world = to_glm(world_from_object.matrix());
    const glm::dvec3 middle(0.5F * (to.low_m + to.high_m)), half(0.5F * (to.high_m - to.low_m));
    for (int side = 0; side < 6; ++side) {
      glm::dvec3 normal(0);
      normal[side % 3] = side < 3 ? 1 : -1;
      const glm::dvec3 at(world * glm::dvec4(middle + half * normal, 1));
      to.sent[static_cast<std::size_t>(side)] =
          contacts_[k].albedo * light_on(setup_.light, at, glm::dmat3(world) * normal);
    }
  }
}

}  // namespace mixrig::render
