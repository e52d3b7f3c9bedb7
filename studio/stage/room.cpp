// SPDX-License-Identifier: Apache-2.0
// The room and its furniture.
#include "studio/stage/room.h"

#include <array>
#include <cmath>

#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

constexpr double kLampSize_m = 0.6, kLampZ_m = 2.945;
constexpr std::array<std::array<double, 2>, 4> kLampXy{
    {{1.45, 1.1}, {1.45, 3.2}, {3.75, 1.1}, {3.75, 3.2}}};

void add_shell(Mesh& m) {
  const Vec3 x(kRoomX_m, 0, 0), y(0, kRoomY_m, 0), z(0, 0, kRoomZ_m), o(0, 0, 0);
  add_quad(m, o, x, y, {Kind::kFloor});
  add_quad(m, z + y, x, -y, {Kind::kCeiling});
  add_quad(m, x, y, z, {Kind::kWall, 0});
  add_quad(m, x + y, -x, z, {Kind::kWall, 1});
  add_quad(m, y, -y, z, {Kind::kWall, 2});
  add_quad(m, o, x, z, {Kind::kWall, 3});
}

void add_skirting(Mesh& m) {
  constexpr float kHigh = 0.085F, kDeep = 0.016F;
  const Material paint{Kind::kPaint};
  add_box(m, {kRoomX_m - kDeep / 2, kRoomY_m / 2, 0}, {kDeep, kRoomY_m, kHigh}, 0, paint);
  add_box(m, {kDeep / 2, kRoomY_m / 2, 0}, {kDeep, kRoomY_m, kHigh}, 0, paint);
  add_box(m, {kRoomX_m / 2, kDeep / 2, 0}, {kRoomX_m, kDeep, kHigh}, 0, paint);
  add_box(m, {kRoomX_m / 2, kRoomY_m - kDeep / 2, 0}, {kRoomX_m, kDeep, kHigh}, 0, paint);
}

/// The housings count as ceiling, which casts no shadow: no lit surface is above them.
void add_lamps(Mesh& m) {
  const auto size = static_cast<float>(kLampSize_m), z = static_cast<float>(kLampZ_m);
  for (const auto& xy : kLampXy) {
    const auto x = static_cast<float>(xy[0]), y = static_cast<float>(xy[1]);
    add_box(m, {x, y, z + 0.004F}, {size + 0.04F, size + 0.04F, 0.038F}, 0, {Kind::kCeiling});
    add_quad(m, {x - size / 2, y + size / 2, z + 0.002F}, {size, 0, 0}, {0, -size, 0},
             {Kind::kLamp});
  }
}

/// A picture or mirror on the far wall with its frame; `y` is the left edge seen from inside.
void add_picture(Mesh& m, float y, float z, float width, float height, Material face) {
  add_box(m, {kRoomX_m - 0.012F, y - width / 2, z - 0.02F}, {0.024F, width + 0.04F, height + 0.04F},
          0, {Kind::kDarkWood});
  add_quad(m, {kRoomX_m - 0.025F, y, z}, {0, -width, 0}, {0, 0, height}, face);
}

void add_table(Mesh& m, const Vec3& foot, const Vec2& size, float height, float yaw) {
  const Material top{Kind::kWood, 1}, leg{Kind::kWood, 2};
  add_box(m, foot + Vec3(0, 0, height - 0.032F), {size.x(), size.y(), 0.032F}, yaw, top);
  const float c = std::cos(yaw), s = std::sin(yaw);
  for (const float i : {-1.0F, 1.0F})
    for (const float j : {-1.0F, 1.0F}) {
      const float x = i * (size.x() / 2 - 0.05F), y = j * (size.y() / 2 - 0.05F);
      add_box(m, foot + Vec3(c * x - s * y, s * x + c * y, 0), {0.05F, 0.05F, height - 0.032F}, yaw,
              leg);
    }
}

/// A chair that faces `yaw`.
void add_chair(Mesh& m, const Vec3& foot, float yaw) {
  const float c = std::cos(yaw), s = std::sin(yaw);
  const auto at = [&](float x, float y, float z) {
    return Vec3(foot + Vec3(c * x - s * y, s * x + c * y, z));
  };
  const Material wood{Kind::kWood, 3};
  add_box(m, at(0, 0, kSeatHeight_m - 0.035F), {0.42F, 0.42F, 0.035F}, yaw, {Kind::kCloth, 1});
  for (const float y : {-0.18F, 0.18F}) {
    add_box(m, at(0.18F, y, 0), {0.034F, 0.034F, kSeatHeight_m - 0.035F}, yaw, wood);
    add_box(m, at(-0.19F, y, 0), {0.034F, 0.034F, 0.90F}, yaw, wood);
  }
  for (const float z : {0.58F, 0.70F, 0.82F})
    add_box(m, at(-0.19F, 0, z), {0.02F, 0.36F, 0.06F}, yaw, wood);
}

void add_shelves(Mesh& m) {
  constexpr float kX = 3.05F, kWide = 1.3F, kDeep = 0.30F, kHigh = 1.92F;
  const float y = kRoomY_m - kDeep / 2 - 0.02F;
  const Material board{Kind::kWood, 4};
  for (const float x : {kX - kWide / 2, kX + kWide / 2})
    add_box(m, {x, y, 0}, {0.024F, kDeep, kHigh}, 0, board);
  add_box(m, {kX, y + kDeep / 2, 0.03F}, {kWide, 0.01F, kHigh - 0.03F}, 0, board);
  for (int shelf = 0; shelf < 5; ++shelf) {
    const float z = 0.06F + 0.44F * static_cast<float>(shelf);
    add_box(m, {kX, y, z}, {kWide, kDeep, 0.024F}, 0, board);
    if (shelf == 4) continue;
    float x = kX - kWide / 2 + 0.04F;
    for (std::uint64_t i = 0; x < kX + kWide / 2 - 0.08F; ++i) {
      const std::uint64_t key = hash_key(0xB00C, i, static_cast<std::uint64_t>(shelf));
      const float thick = 0.02F + 0.035F * uniform(key), high = 0.20F + 0.14F * uniform(key + 1);
      if (key % 7 != 0)
        add_box(m, {x + thick / 2, y - 0.02F, z + 0.024F}, {thick - 0.002F, 0.2F, high}, 0,
                {Kind::kBook, static_cast<std::uint8_t>(key >> 8)});
      x += key % 7 == 0 ? 0.09F : thick;
    }
  }
}

void add_cabinet(Mesh& m) {
  const Vec3 foot(kRoomX_m - 0.26F, 0.95F, 0);
  add_box(m, foot, {0.46F, 1.1F, 0.86F}, 0, {Kind::kDarkWood});
  for (const float y : {0.68F, 1.22F})
    add_box(m, {foot.x() - 0.235F, y, 0.08F}, {0.012F, 0.5F, 0.72F}, 0, {Kind::kDarkWood, 1});
  for (const float y : {0.91F, 0.99F})
    add_cylinder(m, {foot.x() - 0.25F, y, 0.42F}, 0.009F, 0.14F, 10, {Kind::kMetal});
  add_ellipsoid(m, {foot.x(), 0.75F, 0.99F}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.14F}, 24,
                {Kind::kBook, 40});
  add_box(m, {foot.x(), 1.2F, 0.86F}, {0.2F, 0.3F, 0.16F}, 0.3F, {Kind::kBook, 17});
}

/// A floor lamp, switched off: a pole of 24 mm with base and shade.
void add_floor_lamp(Mesh& m, float x, float y) {
  add_cylinder(m, {x, y, 0}, 0.14F, 0.022F, 32, {Kind::kMetal});
  add_cylinder(m, {x, y, 0}, 0.012F, 1.55F, 16, {Kind::kMetal});
  add_cylinder(m, {x, y, 1.50F}, 0.16F, 0.24F, 32, {Kind::kPaint});
}

/// The door in the wall y = 0: leaf, frame and handle. Behind it is dark.
void add_door(Mesh& m, float open_rad) {
  constexpr float kX = 3.55F, kWide = 0.88F, kHigh = 2.02F, kFrame = 0.07F, kDeep = 0.05F;
  for (const float side : {-1.0F, 1.0F})
    add_box(m, {kX + side * (kWide + kFrame) / 2, kDeep / 2, 0}, {kFrame, kDeep, kHigh + kFrame}, 0,
            {Kind::kPaint});
  add_box(m, {kX, kDeep / 2, kHigh}, {kWide, kDeep, kFrame}, 0, {Kind::kPaint});
  if (open_rad <= 0) {
    add_quad(m, {kX + kWide / 2, 0.018F, 0}, {-kWide, 0, 0}, {0, 0, kHigh}, {Kind::kDoor});
    add_box(m, {kX + 0.36F, 0.05F, 1.03F}, {0.12F, 0.02F, 0.02F}, 0, {Kind::kMetal});
    return;
  }
  const Vec3 hinge(kX - kWide / 2, 0.018F, 0);
  const Vec3 leaf(kWide * std::cos(open_rad), kWide * std::sin(open_rad), 0), up(0, 0, kHigh);
  const Vec3 out(0.04F * std::sin(open_rad), -0.04F * std::cos(open_rad), 0);
  add_quad(m, hinge + leaf, -leaf, up, {Kind::kDoor});
  add_quad(m, hinge + out, leaf, up, {Kind::kDoor});
  add_quad(m, hinge + leaf + out, -out, up, {Kind::kPaint});
  add_quad(m, {kX + kWide / 2, 0.002F, 0}, {-kWide, 0, 0}, up, {Kind::kDarkWood});
}

void add_desk(Mesh& m, const RoomPlan& plan) {
  add_table(m, {4.72F, 3.3F, 0}, {0.75F, 1.35F}, 0.74F, 0);
  add_box(m, {4.75F, 3.45F, 0.74F}, {0.24F, 0.34F, 0.018F}, 0.2F, {Kind::kMetal});
  add_box(m, {4.88F, 3.48F, 0.758F}, {0.012F, 0.34F, 0.22F}, 0.2F, {Kind::kPaint, 1});
  add_cylinder(m, {4.5F, 2.95F, 0.74F}, 0.04F, 0.095F, 20, {Kind::kBook, 3});
  add_box(m, {4.9F, 2.85F, 0.74F}, {0.22F, 0.3F, 0.06F}, -0.3F, {Kind::kBook, 91});
  add_box(m, {4.9F, 2.85F, 0.80F}, {0.2F, 0.28F, 0.04F}, -0.1F, {Kind::kBook, 140});
  if (!plan.desk_chair) return;
  if (plan.moved_chair)
    add_chair(m, {3.5F, 3.0F, 0}, 1.2F);
  else
    add_chair(m, {4.2F, 3.55F, 0}, 0.25F);
}

void add_thin_things(Mesh& m) {
  add_table(m, {2.1F, 3.05F, 0}, {0.6F, 0.9F}, 1.28F, 0.15F);
  add_cylinder(m, {2.05F, 2.85F, 1.28F}, 0.006F, 0.3F, 12, {Kind::kMetal});
  add_cylinder(m, {3.9F, 1.35F, 0}, 0.012F, 2.1F, 16, {Kind::kPaint});
  add_cylinder(m, {3.9F, 1.60F, 0}, 0.008F, 2.1F, 12, {Kind::kPaint, 1});
  for (int i = 0; i < 5; ++i)
    add_cylinder(m, {4.35F, 2.0F + 0.09F * static_cast<float>(i), 0}, 0.01F, 1.4F, 12,
                 {Kind::kMetal});
}

}  // namespace

Mesh build_room(const RoomPlan& plan) {
  Mesh m;
  add_shell(m);
  add_skirting(m);
  add_lamps(m);
  add_picture(m, 3.75F, 1.25F, 0.62F, 0.86F, {Kind::kPoster, 1});
  if (plan.mirror || plan.window)
    add_picture(m, 2.75F, 0.95F, 0.95F, 1.1F, {plan.mirror ? Kind::kMirror : Kind::kGlass});
  else
    add_picture(m, 2.75F, 1.05F, 0.95F, 0.7F, {Kind::kPoster, 2});
  add_picture(m, 1.35F, 1.30F, 0.5F, 0.7F, {Kind::kPoster, 3});
  add_quad(m, {2.35F, 1.35F, 0.004F}, {1.8F, 0, 0}, {0, 1.8F, 0}, {Kind::kCloth, 0});
  add_shelves(m);
  add_cabinet(m);
  add_floor_lamp(m, 4.75F, 1.85F);
  add_door(m, plan.door_rad);
  add_desk(m, plan);
  if (plan.seat) add_chair(m, plan.seat_foot, plan.seat_yaw_rad);
  if (plan.guest_seat) add_chair(m, plan.guest_foot, plan.seat_yaw_rad);
  if (plan.thin_things) add_thin_things(m);
  return m;
}

std::vector<Panel> ceiling_lamps(float level) {
  // The lamps in the far half are brighter, so that shadows fall towards the camera.
  constexpr std::array<float, 4> kShare{0.6F, 0.45F, 1.7F, 1.25F};
  std::vector<Panel> lamps;
  for (const auto& [x, y] : kLampXy) {
    const std::size_t i = lamps.size();
    lamps.push_back({"ceiling " + std::to_string(i + 1),
                     {x, y, kLampZ_m},
                     {0, 0, -1},
                     {kLampSize_m, kLampSize_m},
                     level * kShare[i] * Vec3(3.3F, 3.2F, 3.0F)});
  }
  return lamps;
}

Mesh furniture_of(const Mesh& room) {
  Mesh furniture = room;
  furniture.indices.clear(), furniture.materials.clear();
  for (std::size_t t = 0; t < room.materials.size(); ++t) {
    const Kind kind = room.materials[t].kind;
    if (kind == Kind::kFloor || kind == Kind::kWall || kind == Kind::kCeiling ||
        kind == Kind::kLamp)
      continue;
    furniture.materials.push_back(room.materials[t]);
    furniture.indices.insert(furniture.indices.end(), room.indices.begin() + 3 * t,
                             room.indices.begin() + 3 * t + 3);
  }
  return furniture;
}

}  // namespace mixrig::studio
