// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/hit_finder.h"

#include <algorithm>

namespace mixrig::touch {
namespace {

constexpr double kHitSigma_m = 0.001;
constexpr float kSameDirection = 0.7F;  ///< cosine

}  // namespace

void HitFinder::before_step() {
  for (Object& object : objects_)
    object.velocity_m_s = object.body->getLinearVelocity(),
    object.turn_rad_s = object.body->getAngularVelocity();
}

void HitFinder::after_step(btDispatcher& dispatcher, double begin_s) {
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i)
    strike(*dispatcher.getManifoldByIndexInternal(i), begin_s);
}

/// Velocity of a body at a place before the step.
btVector3 HitFinder::velocity_before(int number, const btVector3& at) const {
  if (number < kFirstObject) return {0, 0, 0};
  const Object& object = objects_[static_cast<std::size_t>(number - kFirstObject)];
  return object.velocity_m_s +
         object.turn_rad_s.cross(at - object.body->getWorldTransform().getOrigin());
}

bool HitFinder::is_known(const Struck& now) {
  std::erase_if(struck_, [&](const Struck& s) { return now.time_s - s.time_s > kOneHit_s; });
  const bool known = std::any_of(struck_.begin(), struck_.end(), [&](const Struck& s) {
    return s.object == now.object && s.other == now.other &&
           s.normal.dot(now.normal) > kSameDirection;
  });
  struck_.push_back(now);
  return known;
}

/// Makes an event of the fastest touching point, where it is fast enough. Bullet finds the points
/// by the places at the beginning of the step.
void HitFinder::strike(const btPersistentManifold& manifold, double begin_s) {
  const int a = manifold.getBody0()->getUserIndex(), b = manifold.getBody1()->getUserIndex();
  if (a < 0 || b < 0 || std::max(a, b) < kFirstObject) return;
  const btManifoldPoint* fastest = nullptr;
  auto closing_m_s = static_cast<float>(kLeastSpeed_m_s);
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    const btVector3& at = point.getPositionWorldOnB();
    const float speed_m_s =
        (velocity_before(b, at) - velocity_before(a, at)).dot(point.m_normalWorldOnB);
    if (point.getAppliedImpulse() <= 0 || speed_m_s < closing_m_s) continue;
    fastest = &point, closing_m_s = speed_m_s;
  }
  if (fastest == nullptr) return;
  // The lower number first, as in contacts of objects; the room is the other.
  const int low = std::min(a, b), high = std::max(a, b);
  const bool is_room = low < kFirstObject;
  const btVector3 normal = fastest->m_normalWorldOnB * (a == high ? 1.0F : -1.0F);
  if (is_known({high, low, normal, begin_s})) return;
  const double depth_m = -static_cast<double>(fastest->getDistance());
  Event hit;
  hit.kind = EventKind::kHit, hit.evidence = Evidence::kShape;
  hit.against = is_room ? Against::kRoom : Against::kObject;
  hit.object = (is_room ? high : low) - kFirstObject;
  if (is_room)
    hit.part = static_cast<RoomPart>(low);
  else
    hit.other = high - kFirstObject;
  hit.time_s = begin_s - depth_m / static_cast<double>(closing_m_s);
  const btVector3& at = fastest->getPositionWorldOnB();
  hit.at_m = {at.x(), at.y(), at.z()};
  hit.depth_m = std::max(0.0, depth_m), hit.sigma_m = kHitSigma_m;
  hit.speed_m_s = static_cast<double>(closing_m_s);
  found_.push_back(hit);
}

}  // namespace mixrig::touch
