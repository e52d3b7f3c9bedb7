// SPDX-License-Identifier: Apache-2.0
#include "host/touch/physics.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <btBulletDynamicsCommon.h>

namespace mixrig::touch {
namespace {

constexpr float kGravity_m_s2 = 9.81F;
constexpr float kRoomFriction = 0.6F, kRoomBounce = 0.6F;
constexpr float kLowest_m = 0.06F;  ///< of what stands in the room
constexpr float kWall_m = 2.5F;     ///< height of what is as high as a person
constexpr float kCell_m = 0.03F;    ///< of the surface of people
constexpr int kLeastPointsOfCell = 2;
constexpr float kFarthest_m = 0.3F;  ///< from a cell to that of the frame before
constexpr float kFastestPusher_m_s = 8;
constexpr double kLongestFrame_s = 0.1;  ///< between frames of which velocities are found

btVector3 to_bt(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
btVector3 to_bt(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

/// About the middle of the shape's box.
std::unique_ptr<btCompoundShape> parts_about(const Shape& shape, const Eigen::Vector3f& middle,
                                             std::vector<std::unique_ptr<btCollisionShape>>& keep) {
  auto compound = std::make_unique<btCompoundShape>();
  for (const Convex& part : shape.parts) {
    auto hull = std::make_unique<btConvexHullShape>();
    for (const auto& corner : part.corners_m)
      hull->addPoint(to_bt(Eigen::Vector3f(corner - middle)), false);
    hull->recalcLocalAabb();
    hull->setMargin(0.002F);
    compound->addChildShape(btTransform::getIdentity(), hull.get());
    keep.push_back(std::move(hull));
  }
  return compound;
}

}  // namespace

struct Physics::State {
  struct Moved {
    btRigidBody* body = nullptr;
    Eigen::Vector3f middle_m = Eigen::Vector3f::Zero();  ///< of the body, in object axes
    bool moves = false;
  };
  btRigidBody* keep(std::unique_ptr<btCollisionShape> shape, double mass_kg, const btTransform& at,
                    double friction, double bounce);
  void step();

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<Moved> objects;
  std::vector<geometry::Pose> poses;
  std::vector<btRigidBody*> pushers;  ///< those in use first
  std::size_t used = 0;
  long steps_of_pushers = 0;
  double time_s = 0;
  bool has_time = false;
  long steps = 0;  ///< since the first time
  double first_s = 0;
};

btRigidBody* Physics::State::keep(std::unique_ptr<btCollisionShape> shape, double mass_kg,
                                  const btTransform& at, double friction, double bounce) {
  btVector3 inertia(0, 0, 0);
  if (mass_kg > 0) shape->calculateLocalInertia(static_cast<float>(mass_kg), inertia);
  btRigidBody::btRigidBodyConstructionInfo info(static_cast<float>(mass_kg), nullptr, shape.get(),
                                                inertia);
  info.m_startWorldTransform = at;
  info.m_friction = static_cast<float>(friction);
  info.m_restitution = static_cast<float>(bounce);
  shapes.push_back(std::move(shape));
  bodies.push_back(std::make_unique<btRigidBody>(info));
  world.addRigidBody(bodies.back().get());
  return bodies.back().get();
}

Physics::Physics() : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.world.setGravity({0, 0, -kGravity_m_s2});
  s.solver.setRandSeed(0);
  s.keep(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0.0F), 0,
         btTransform::getIdentity(), kRoomFriction, kRoomBounce);
}

Physics::~Physics() {
  for (const auto& body : state_->bodies) state_->world.removeRigidBody(body.get());
}

int Physics::add(const Shape& shape, const geometry::Pose& world_from_object, const Body* body) {
  State& s = *state_;
  State::Moved object;
  object.middle_m = shape.box_m.center();
  object.moves = body != nullptr;
  const Eigen::Quaternionf q = world_from_object.rotation.cast<float>();
  const btTransform at(btQuaternion(q.x(), q.y(), q.z(), q.w()),
                       to_bt(Eigen::Vector3d(world_from_object * object.middle_m.cast<double>())));
  std::unique_ptr<btCollisionShape> form;
  if (body != nullptr && body->is_ball)
    form = std::make_unique<btSphereShape>(0.5F * shape.box_m.sizes().maxCoeff());
  else
    form = parts_about(shape, object.middle_m, s.shapes);
  const Body still;
  const Body& of = body != nullptr ? *body : still;
  object.body =
      s.keep(std::move(form), body != nullptr ? of.mass_kg : 0, at, of.friction, of.bounce);
  if (body != nullptr) {
    object.body->setDamping(static_cast<float>(of.drag), static_cast<float>(of.drag));
    object.body->setRollingFriction(0.002F);
    object.body->setActivationState(DISABLE_DEACTIVATION);
    // What moves faster than its own size in a step is swept.
    object.body->setCcdMotionThreshold(0.25F * shape.box_m.sizes().minCoeff());
    object.body->setCcdSweptSphereRadius(0.2F * shape.box_m.sizes().minCoeff());
  }
  s.objects.push_back(object);
  s.poses.push_back(world_from_object);
  return static_cast<int>(s.objects.size()) - 1;
}

/// Runs of cells along x as boxes.
void Physics::set_room(const plan::FloorMap& room) {
  State& s = *state_;
  const auto top = [&](int x, int y) {
    const float t = room.top_m.at(x, y);
    return t < kLowest_m ? 0 : t > 0.6F * kWall_m ? kWall_m : t;
  };
  for (int y = 0; y < room.size().height; ++y)
    for (int x = 0, end = 0; x < room.size().width; x = end) {
      for (end = x + 1; end < room.size().width && std::abs(top(end, y) - top(x, y)) < 0.05F;)
        ++end;
      if (top(x, y) <= 0) continue;
      const Eigen::Vector2d first = room.middle_m(x, y), last = room.middle_m(end - 1, y);
      const Eigen::Vector3d half(0.5 * (last.x() - first.x() + room.cell_m), 0.5 * room.cell_m,
                                 0.5 * static_cast<double>(top(x, y)));
      btTransform at = btTransform::getIdentity();
      at.setOrigin(to_bt(Eigen::Vector3d(0.5 * (first.x() + last.x()), first.y(), half.z())));
      s.keep(std::make_unique<btBoxShape>(to_bt(half)), 0, at, kRoomFriction, kRoomBounce);
    }
}

void Physics::set_pushers(std::span<const Pusher> pushers) {
  State& s = *state_;
  const std::size_t count = std::min(pushers.size(), kMostPushers);
  while (s.pushers.size() < count) {
    s.pushers.push_back(s.keep(std::make_unique<btSphereShape>(Pusher::kRadius_m), 0,
                               btTransform::getIdentity(), kRoomFriction, kRoomBounce));
    s.pushers.back()->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    s.pushers.back()->setActivationState(DISABLE_DEACTIVATION);
  }
  for (std::size_t i = 0; i < std::max(count, s.used); ++i) {
    btTransform at = btTransform::getIdentity();
    // Out of the way.
    at.setOrigin(i < count ? to_bt(pushers[i].at_m)
                           : btVector3(0, 0, -100.0F - static_cast<float>(i)));
    s.pushers[i]->setWorldTransform(at);
    s.pushers[i]->setInterpolationWorldTransform(at);
    s.pushers[i]->setLinearVelocity(i < count ? to_bt(pushers[i].velocity_m_s)
                                              : btVector3(0, 0, 0));
  }
  s.used = count;
  s.steps_of_pushers = s.steps;
}

void Physics::State::step() {
  const bool stale = static_cast<double>(steps - steps_of_pushers) * kStep_s > 0.5 * kLongestGap_s;
  for (std::size_t i = 0; i < used; ++i) {
    btTransform at = pushers[i]->getWorldTransform();
    const btVector3 velocity = pushers[i]->getLinearVelocity();
    at.setOrigin(stale ? btVector3(0, 0, -100.0F - static_cast<float>(i))
                       : at.getOrigin() + static_cast<float>(kStep_s) * velocity);
    // Bullet takes the velocity of what is moved by hand from the two transforms.
    pushers[i]->setInterpolationWorldTransform(stale ? at : pushers[i]->getWorldTransform());
    pushers[i]->setWorldTransform(at);
  }
  world.stepSimulation(static_cast<float>(kStep_s), 0);
  for (const Moved& object : objects) {
    if (!object.moves) continue;
    const btVector3 v = object.body->getLinearVelocity();
    constexpr auto kMost = static_cast<float>(kFastest_m_s);
    if (v.length2() > kMost * kMost) object.body->setLinearVelocity(v * (kMost / v.length()));
  }
  ++steps;
}

void Physics::advance(double time_s) {
  State& s = *state_;
  if (!s.has_time || time_s - s.time_s > kLongestGap_s || time_s < s.time_s) {
    s.first_s = time_s - static_cast<double>(s.steps) * kStep_s;
    s.has_time = true;
  }
  s.time_s = time_s;
  const long wanted = std::lround((time_s - s.first_s) / kStep_s);
  while (s.steps < wanted) s.step();
  for (std::size_t i = 0; i < s.objects.size(); ++i) {
    if (!s.objects[i].moves) continue;
    const btTransform& at = s.objects[i].body->getWorldTransform();
    const btQuaternion q = at.getRotation();
    const Eigen::Quaterniond rotation =
        Eigen::Quaternionf(q.w(), q.x(), q.y(), q.z()).cast<double>().normalized();
    const btVector3& o = at.getOrigin();
    s.poses[i] = {rotation, Eigen::Vector3d(o.x(), o.y(), o.z()) -
                                rotation * s.objects[i].middle_m.cast<double>()};
  }
}

std::span<const geometry::Pose> Physics::world_from_object() const { return state_->poses; }

bool Physics::is_moving(int object) const {
  return state_->objects[static_cast<std::size_t>(object)].moves;
}

std::span<const Pusher> PusherFinder::find(std::span<const Eigen::Vector3f> surface_m,
                                           const Eigen::Vector3d& eye_m, double time_s) {
  cells_.clear(), now_m_.clear(), pushers_.clear();
  for (const auto& p : surface_m) {
    const auto cell = [](float v) { return (std::lround(v / kCell_m) + 4096) & 0x1fff; };
    cells_.push_back({cell(p.x()) << 26 | cell(p.y()) << 13 | cell(p.z()), p, 1});
  }
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
    if (a.key != b.key) return a.key < b.key;
    return std::lexicographical_compare(a.sum_m.data(), a.sum_m.data() + 3, b.sum_m.data(),
                                        b.sum_m.data() + 3);
  });
  for (std::size_t i = 0; i < cells_.size();) {
    Cell sum{cells_[i].key, Eigen::Vector3f::Zero(), 0};
    for (; i < cells_.size() && cells_[i].key == sum.key; ++i)
      sum.sum_m += cells_[i].sum_m, ++sum.count;
    if (sum.count >= kLeastPointsOfCell)
      now_m_.push_back(sum.sum_m / static_cast<float>(sum.count));
  }
  const double step_s = time_s - before_s_;
  const bool known = has_before_ && step_s > 0 && step_s <= kLongestFrame_s;
  for (const auto& p : now_m_) {
    Pusher pusher;
    // The seen point lies on the ball.
    pusher.at_m = p + Pusher::kRadius_m * (p - eye_m.cast<float>()).normalized();
    float least = kFarthest_m * kFarthest_m;
    for (std::size_t i = 0; known && i < before_m_.size(); ++i)
      if (const float d2 = (before_m_[i] - p).squaredNorm(); d2 < least)
        least = d2, pusher.velocity_m_s = (p - before_m_[i]) / static_cast<float>(step_s);
    if (pusher.velocity_m_s.norm() > kFastestPusher_m_s)
      pusher.velocity_m_s *= kFastestPusher_m_s / pusher.velocity_m_s.norm();
    pushers_.push_back(pusher);
  }
  before_m_ = now_m_;
  before_s_ = time_s, has_before_ = true;
  return pushers_;
}

}  // namespace mixrig::touch
