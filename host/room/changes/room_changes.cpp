// SPDX-License-Identifier: Apache-2.0
#include "host/room/changes/room_changes.h"

#include <fmt/format.h>

namespace mixrig::model {
namespace {

std::string place_text(const Eigen::Vector3d& p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) m", p.x(), p.y(), p.z());
}

std::string factor_text(const Eigen::Array3d& f) {
  return fmt::format("{:.2f}, {:.2f}, {:.2f} times (red, green, blue)", f.x(), f.y(), f.z());
}

std::string lights_text(const RoomChange& change) {
  return "the light is " + factor_text(change.factor) +
         (change.common ? " that of the model all over the room: lamps or the camera's exposure"
                        : " that of the model in the median and differs from place to place: a "
                          "lamp was switched");
}

}  // namespace

std::string_view name(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kAppeared:
      return "appeared";
    case ChangeKind::kGone:
      return "gone";
    case ChangeKind::kMoved:
      return "moved";
    case ChangeKind::kColor:
      return "color";
    case ChangeKind::kLights:
      return "lights";
  }
  return "";
}

std::string text(const RoomChange& change) {
  const Eigen::Vector3d& s = change.size_m;
  const std::string thing =
      fmt::format("a thing of {:.2f} x {:.2f} x {:.2f} m", s.x(), s.y(), s.z());
  switch (change.kind) {
    case ChangeKind::kAppeared:
      return thing + " appeared at " + place_text(change.center_m);
    case ChangeKind::kGone:
      return thing + " is gone from " + place_text(change.center_m);
    case ChangeKind::kMoved:
      return thing + " moved from " + place_text(*change.from_m) + " to " +
             place_text(change.center_m);
    case ChangeKind::kColor:
      return "a surface at " + place_text(change.center_m) + " has " + factor_text(change.factor) +
             " the colour of the model";
    case ChangeKind::kLights:
      return lights_text(change);
  }
  return "";
}

}  // namespace mixrig::model
