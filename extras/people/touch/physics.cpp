// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/physics.h"

#include <algorithm>
#include <cmath>

#include <btBulletDynamicsCommon.h>

#include "extras/people/touch/hit_finder.h"

namespace mixrig::touch {
namespace {

constexpr float kGravity_m_s2 = 9.81F;
constexpr float kRoomFriction = 0.6F, kRoomBounce = 1;  ///< bounces multiply
constexpr float kPusherBounce = 0.6F;
constexpr float kLowest_m = 0.06F;                       ///< of what stands in the room
constexpr float kWall_m = 2.5F;                          ///< height of what is as high as a person
constexpr double kSideDepth_m = 0.1, kSideEnd_m = 0.05;  ///< behind its face; beyond each end
/// Bullet takes things as touching from so near on, and an impact in such a gap loses up to the gap
/// in a step of its speed.
constexpr float kTouching_m = 2e-4F;

btVector3 to_bt(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
btVector3 to_bt(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

float top_of(float top_m) {
  return top_m < kLowest_m ? 0 : top_m > 0.6F * kWall_m ? kWall_m : top_m;
}
RoomPart part_of(float top_m) {
  return top_m > 0.6F * kWall_m ? RoomPart::kWall : RoomPart::kFurniture;
}

/// Whether a side's box covers a cell.
bool covers(const RoomSide& side, const Eigen::Vector2d& at_m, double cell_m, double top_m) {
  const Eigen::Vector2d along = (side.to_m - side.from_m).normalized();
  const double t = along.dot(at_m - side.from_m), end = (side.to_m - side.from_m).norm();
  const double before_m = side.normal.dot(at_m - side.from_m);
  return t > -cell_m && t < end + cell_m && before_m < cell_m && before_m > -kSideDepth_m &&
         top_of(static_cast<float>(top_m)) < top_of(static_cast<float>(side.top_m)) + 0.05F;
}

/// Parts of a shape with `middle` as origin.
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

btTransform world_from_middle(const geometry::Pose& world_from_object,
                              const Eigen::Vector3f& middle_m) {
  const Eigen::Quaternionf q = world_from_object.rotation.cast<float>();
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()),
                     to_bt(Eigen::Vector3d(world_from_object * middle_m.cast<double>())));
}

}  // namespace

struct Physics::State {
  /// A dispatcher whose contacts begin at kTouching_m.
  struct Dispatcher : btCollisionDispatcher {
    using btCollisionDispatcher::btCollisionDispatcher;
    btPersistentManifold* getNewManifold(const btCollisionObject* a,
                                         const btCollisionObject* b) override {
      btPersistentManifold* const manifold = btCollisionDispatcher::getNewManifold(a, b);
      manifold->setContactBreakingThreshold(kTouching_m);
      return manifold;
    }
  };
  struct Moved {
    btRigidBody* body = nullptr;
    Eigen::Vector3f middle_m = Eigen::Vector3f::Zero();  ///< of the body, in object axes
    bool moves = false;
  };
  btRigidBody* keep(std::unique_ptr<btCollisionShape> shape, double mass_kg, const btTransform& at,
                    double friction, double bounce, int number = -1);
  void add_box(const Eigen::Vector3d& middle_m, const Eigen::Vector3d& half_m, double yaw_rad,
               RoomPart part);
  void step();

  btDefaultCollisionConfiguration configuration;
  Dispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<Moved> objects;
  std::vector<geometry::Pose> poses;
  HitFinder hits;
  std::vector<btRigidBody*> pushers;  ///< those in use first
  std::size_t used = 0;
  long steps_of_pushers = 0;
  double time_s = 0;
  bool has_time = false;
  long steps = 0;  ///< since the first time
  double first_s = 0;
};

btRigidBody* Physics::State::keep(std::unique_ptr<btCollisionShape> shape, double mass_kg,
                                  const btTransform& at, double friction, double bounce,
                                  int number) {
  btVector3 inertia(0, 0, 0);
  if (mass_kg > 0) shape->calculateLocalInertia(static_cast<float>(mass_kg), inertia);
  btRigidBody::btRigidBodyConstructionInfo info(static_cast<float>(mass_kg), nullptr, shape.get(),
                                                inertia);
  info.m_startWorldTransform = at;
  info.m_friction = static_cast<float>(friction);
  info.m_restitution = static_cast<float>(bounce);
  shapes.push_back(std::move(shape));
  bodies.push_back(std::make_unique<btRigidBody>(info));
  bodies.back()->setUserIndex(number);
  world.addRigidBody(bodies.back().get());
  return bodies.back().get();
}

Physics::Physics() : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.world.setGravity({0, 0, -kGravity_m_s2});
  s.solver.setRandSeed(0);
  // Resolving an overlap adds no speed.
  s.world.getSolverInfo().m_splitImpulse = 1;
  s.world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
  s.keep(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0.0F), 0,
         btTransform::getIdentity(), kRoomFriction, kRoomBounce,
         static_cast<int>(RoomPart::kFloor));
}

Physics::~Physics() {
  for (const auto& body : state_->bodies) state_->world.removeRigidBody(body.get());
}

int Physics::add(const Shape& shape, const geometry::Pose& world_from_object, const Body* body) {
  State& s = *state_;
  State::Moved object;
  object.middle_m = shape.box_m.center();
  object.moves = body != nullptr;
  const btTransform at = world_from_middle(world_from_object, object.middle_m);
  std::unique_ptr<btCollisionShape> form;
  if (body != nullptr && body->is_ball)
    form = std::make_unique<btSphereShape>(0.5F * shape.box_m.sizes().maxCoeff());
  else
    form = parts_about(shape, object.middle_m, s.shapes);
  const Body still{.bounce = 1};
  const Body& of = body != nullptr ? *body : still;
  object.body = s.keep(std::move(form), body != nullptr ? of.mass_kg : 0, at, of.friction,
                       of.bounce, HitFinder::kFirstObject + static_cast<int>(s.objects.size()));
  if (body != nullptr) {
    object.body->setDamping(static_cast<float>(of.drag), static_cast<float>(of.drag));
    object.body->setRollingFriction(0.002F);
    object.body->setActivationState(DISABLE_DEACTIVATION);
    // A body that moves farther than its size in a step is swept.
    object.body->setCcdMotionThreshold(0.25F * shape.box_m.sizes().minCoeff());
    object.body->setCcdSweptSphereRadius(0.2F * shape.box_m.sizes().minCoeff());
  }
  s.objects.push_back(object);
  s.hits.add(*object.body);
  s.poses.push_back(world_from_object);
  return static_cast<int>(s.objects.size()) - 1;
}

void Physics::State::add_box(const Eigen::Vector3d& middle_m, const Eigen::Vector3d& half_m,
                             double yaw_rad, RoomPart part) {
  const btTransform at(btQuaternion(btVector3(0, 0, 1), static_cast<float>(yaw_rad)),
                       to_bt(middle_m));
  keep(std::make_unique<btBoxShape>(to_bt(half_m)), 0, at, kRoomFriction, kRoomBounce,
       static_cast<int>(part));
}

void Physics::set_velocity(int object, const Eigen::Vector3d& velocity_m_s) {
  state_->objects[static_cast<std::size_t>(object)].body->setLinearVelocity(to_bt(velocity_m_s));
}

void Physics::place(int object, const geometry::Pose& world_from_object) {
  State& s = *state_;
  State::Moved& moved = s.objects[static_cast<std::size_t>(object)];
  const btTransform at = world_from_middle(world_from_object, moved.middle_m);
  moved.body->setWorldTransform(at);
  moved.body->setInterpolationWorldTransform(at);
  moved.body->setLinearVelocity({0, 0, 0});
  moved.body->setAngularVelocity({0, 0, 0});
  s.broadphase.getOverlappingPairCache()->cleanProxyFromPairs(moved.body->getBroadphaseHandle(),
                                                              &s.dispatcher);
  s.world.updateSingleAabb(moved.body);
  s.poses[static_cast<std::size_t>(object)] = world_from_object;
}

/// Makes boxes of the map's occupied cells that no side covers, in runs along x, and of the sides.
void Physics::set_room(const plan::FloorMap& room, std::span<const RoomSide> sides) {
  State& s = *state_;
  const auto top = [&](int x, int y) {
    const double top_m = room.top_m.at(x, y);
    const bool covered = std::any_of(sides.begin(), sides.end(), [&](const RoomSide& side) {
      return covers(side, room.middle_m(x, y), room.cell_m, top_m);
    });
    return covered ? 0 : top_of(room.top_m.at(x, y));
  };
  for (int y = 0; y < room.size().height; ++y)
    for (int x = 0, end = 0; x < room.size().width; x = end) {
      const float height_m = top(x, y);
      for (end = x + 1; end < room.size().width && std::abs(top(end, y) - height_m) < 0.05F;) ++end;
      if (height_m <= 0) continue;
      const Eigen::Vector2d first = room.middle_m(x, y), last = room.middle_m(end - 1, y);
      const Eigen::Vector3d half(0.5 * (last.x() - first.x() + room.cell_m), 0.5 * room.cell_m,
                                 0.5 * static_cast<double>(height_m));
      s.add_box({0.5 * (first.x() + last.x()), first.y(), half.z()}, half, 0, part_of(height_m));
    }
  for (const RoomSide& side : sides) {
    const Eigen::Vector2d across = side.to_m - side.from_m;
    const Eigen::Vector2d middle =
        0.5 * (side.from_m + side.to_m) - 0.5 * kSideDepth_m * side.normal;
    const auto top_m = static_cast<float>(side.top_m);
    const Eigen::Vector3d half(0.5 * across.norm() + kSideEnd_m, 0.5 * kSideDepth_m,
                               0.5 * static_cast<double>(top_of(top_m)));
    s.add_box({middle.x(), middle.y(), half.z()}, half, std::atan2(across.y(), across.x()),
              part_of(top_m));
  }
}

void Physics::set_pushers(std::span<const Pusher> pushers) {
  State& s = *state_;
  const std::size_t count = std::min(pushers.size(), kMostPushers);
  while (s.pushers.size() < count) {
    s.pushers.push_back(s.keep(std::make_unique<btSphereShape>(Pusher::kRadius_m), 0,
                               btTransform::getIdentity(), kRoomFriction, kPusherBounce));
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
  hits.before_step();
  world.stepSimulation(static_cast<float>(kStep_s), 0);
  hits.after_step(dispatcher, first_s + static_cast<double>(steps) * kStep_s);
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
  s.hits.forget();
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

std::span<const Event> Physics::hits() const { return state_->hits.found(); }

bool Physics::is_moving(int object) const {
  return state_->objects[static_cast<std::size_t>(object)].moves;
}

}  // namespace mixrig::touch
