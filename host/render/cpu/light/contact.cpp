// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/contact.h"

#include <algorithm>
#include <array>

namespace mixrig::render::cpu {
namespace {

constexpr FloatLanes kZero{};
constexpr float kLeastAxisPart = 0.05F;  ///< smaller components of a normal count as 0

using Three = std::array<FloatLanes, 3>;

Three turned(const glm::mat4& m, const VectorLanes& v) {
  Three out;
  for (int row = 0; row < 3; ++row)
    out[static_cast<std::size_t>(row)] = m[0][row] * v.x + m[1][row] * v.y + m[2][row] * v.z;
  return out;
}

/// Cell below a grid position, and the fraction of the way to the next cells.
struct GridPlace {
  IntLanes first{};
  Three share;
};

/// Grid position along an axis of a point whose nearest place in the box is `in_box_m`, `off_m`
/// beyond it.
FloatLanes along_axis(const ContactParams& p, int axis, FloatLanes in_box_m, FloatLanes off_m) {
  const float low = p.low_m[axis], high = p.high_m[axis];
  const FloatLanes root = sqrt(abs(off_m) / p.reach_m);
  return kContactOutside + (in_box_m - low) * (kContactInside / std::max(high - low, 1e-6F)) +
         kContactOutside * (off_m < 0 ? -root : root);
}

FloatLanes byte_of(IntLanes packed, int k) { return to_float((packed >> (8 * k)) & 255); }

/// Hidden share for normals whose squared components along and against each axis are `up` and
/// `down`.
FloatLanes hidden_at(const HiddenShares* shares, const GridPlace& at, const Three& up,
                     const Three& down) {
  const auto* const words = reinterpret_cast<const float*>(shares);  // two words a grid point
  const auto needed = [](const Three& t) { return any(max(max(t[0], t[1]), t[2]) > 0); };
  const bool some_up = needed(up), some_down = needed(down);
  FloatLanes sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const auto part = [&](std::size_t axis, int far) {
      return far != 0 ? at.share[axis] : 1 - at.share[axis];
    };
    const FloatLanes weight = part(0, x) * part(1, y) * part(2, z);
    const IntLanes index = 2 * (at.first + (x + kContactNodes * (y + kContactNodes * z)));
    FloatLanes share{};
    const auto add = [&](const Three& squares, int word) {
      const auto packed = std::bit_cast<IntLanes>(gather(words, index + word));
      for (int k = 0; k < 3; ++k)
        share += squares[static_cast<std::size_t>(k)] * byte_of(packed, k);
    };
    if (some_up) add(up, 0);
    if (some_down) add(down, 1);
    sum += weight * share;
  }
  return sum * (1.0F / 255);
}

/// Light of the box's sides that face a point `off` the box.
VectorLanes light_sent(const ContactParams& p, const Three& off) {
  const FloatLanes all = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
  VectorLanes sum{};
  const auto add = [&](FloatLanes part, const glm::vec3& light) {
    sum.x += part * light.r, sum.y += part * light.g, sum.z += part * light.b;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const FloatLanes square = off[k] * off[k] / max(all, kZero + 1e-12F);
    add(all > 0 ? (off[k] > 0 ? square : kZero) : kZero + 1.0F / 6, p.sent[k]);
    add(all > 0 ? (off[k] < 0 ? square : kZero) : kZero + 1.0F / 6, p.sent[k + 3]);
  }
  return sum;
}

/// Position of points relative to an object's box, along its axes.
struct BesideBox {
  Three in_box_m;       ///< nearest point of the box
  Three off_m;          ///< vector from that point
  FloatLanes farthest;  ///< largest component of off_m
};
BesideBox beside_box(const ContactParams& p, const Three& at_m) {
  BesideBox out{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    out.in_box_m[k] = min(max(at_m[k], kZero + p.low_m[axis]), kZero + p.high_m[axis]);
    out.off_m[k] = at_m[k] - out.in_box_m[k];
    out.farthest = max(out.farthest, abs(out.off_m[k]));
  }
  return out;
}

void add_contact(const ContactParams& p, const HiddenShares* shares, const VectorLanes& position_m,
                 const VectorLanes& normal, Receiver receiver, ContactLanes& sum) {
  Three at = turned(p.object_from_camera, position_m);
  const Three n = turned(p.object_from_camera, normal);
  const glm::vec3 half_cell = 0.5F / kContactInside * (p.high_m - p.low_m);
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    at[k] += p.object_from_camera[3][axis];
    if (receiver == Receiver::kObject) at[k] += n[k] * half_cell[axis];
  }
  const auto [in_box, off, farthest] = beside_box(p, at);
  if (!any(farthest < p.reach_m)) return;
  Three up, down;
  GridPlace place;
  int stride = 1;
  for (int axis = 0; axis < 3; ++axis, stride *= kContactNodes) {
    const auto k = static_cast<std::size_t>(axis);
    up[k] = n[k] > kLeastAxisPart ? n[k] * n[k] : kZero;
    down[k] = n[k] < -kLeastAxisPart ? n[k] * n[k] : kZero;
    const FloatLanes in_grid =
        min(max(along_axis(p, axis, in_box[k], off[k]), kZero), kZero + (kContactNodes - 1.001F));
    const IntLanes cell = truncate(in_grid);
    place.first += cell * stride, place.share[k] = in_grid - to_float(cell);
  }
  const FloatLanes found = hidden_at(shares, place, up, down);
  const FloatLanes hidden = sum.open * min(farthest < p.reach_m ? found : kZero, kZero + 1.0F);
  const VectorLanes sent = light_sent(p, off);
  const FloatLanes part = receiver == Receiver::kReal ? kSentPart * hidden : hidden;
  sum.open -= hidden;
  sum.sent.x += part * sent.x, sum.sent.y += part * sent.y, sum.sent.z += part * sent.z;
}

}  // namespace

ContactLanes contact_at(const FrameParams& frame, const VectorLanes& position_m,
                        const VectorLanes& normal, Receiver receiver) {
  ContactLanes sum{kZero + 1.0F, {}};
  constexpr std::size_t kCells = std::size_t{kContactNodes} * kContactNodes * kContactNodes;
  for (std::size_t i = 0; i < frame.contacts.size(); ++i)
    add_contact(frame.contacts[i], frame.contact_hidden.data() + i * kCells, position_m, normal,
                receiver, sum);
  return sum;
}

bool may_be_near(const FrameParams& frame, const Corners& corners) {
  const auto& [near_face, far_face] = corners.faces;
  return std::any_of(frame.contacts.begin(), frame.contacts.end(), [&](const ContactParams& p) {
    const glm::mat4& m = p.object_from_camera;
    for (int axis = 0; axis < 3; ++axis) {
      const auto along = [&](const Corners::Face& f) {
        return f.x_m * m[0][axis] + f.y_m * m[1][axis] + f.z_m * m[2][axis] + m[3][axis];
      };
      const F4 a = along(near_face), b = along(far_face);
      const float low = least_of4(min4(a, b)), high = -least_of4(min4(-a, -b));
      if (!(low < p.high_m[axis] + p.reach_m && high > p.low_m[axis] - p.reach_m)) return false;
    }
    return true;
  });
}

}  // namespace mixrig::render::cpu
