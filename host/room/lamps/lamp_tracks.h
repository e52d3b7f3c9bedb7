// SPDX-License-Identifier: Apache-2.0
// Finds lamps among the bright regions that a moving camera sees: which of them are places in the
// room, where they are, and why others are refused.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/lamp.h"
#include "host/math/geometry/pose.h"
#include "host/room/lamps/bright_regions.h"
#include "host/room/lamps/room_surfaces.h"

namespace mixrig::lights {

/// Bright regions of one picture.
struct LampView {
  geometry::Pose world_from_camera;
  std::vector<BrightRegion> regions;
};

/// A region of a view, by indices.
struct Sighting {
  int view = 0, region = 0;
  bool operator==(const Sighting&) const = default;
};

struct LampOptions {
  double most_surround = 0.45;    ///< largest linear light around a lamp over that inside
  double least_share = 0.15;      ///< least share of the views that must see a lamp
  double least_solid_sr = 2e-5;   ///< least median solid angle; a disk of 0.3 deg
  double common_rad = 0.5e-3;     ///< sigma of the lens's error common to all views
  double most_sigma_share = 0.1;  ///< largest sigma of a position over its distance
  bool low_lamps = false;         ///< things below every camera may be lamps
};

/// A found lamp. `intensity` is not set. Without a direction, `size_m` is its width.
struct FoundLamp : geometry::Lamp {
  Eigen::Matrix3d covariance;  ///< of the position, m^2
  double residual = 0;         ///< root mean square over the views, in sigmas
  double surround = 0;         ///< median over the views
  double solid_angle_sr = 0;   ///< median over the views
  bool by_surface = false;     ///< placed on the room's surface, not triangulated
  std::vector<Sighting> seen;
};

/// Why a bright region is not taken as a lamp.
enum class Refusal {
  kFewViews,    ///< seen in too few views to be a thing of the room
  kSmall,       ///< too small to matter
  kSoftBorder,  ///< its light fades at its border: a lit white thing
  kMoves,       ///< its place differs between views: a highlight, or something before it cuts it
  kShortPath,   ///< the views do not determine its distance
  kCut,         ///< cut by the border of the picture in all views
  kBehind,      ///< behind a wall or below the floor: a mirror image, or another room
  kFacesUp,     ///< on a surface that faces up: a reflection, or a white thing
  kLow,         ///< below every camera
  kDark,        ///< the room's shading does not show its light
};
/// A word such as "soft_border", and an explanation in one sentence.
std::string_view name(Refusal refusal);
std::string_view text_of(Refusal refusal);

struct RejectedLamp {
  Refusal refusal = Refusal::kFewViews;
  std::optional<Eigen::Vector3d> position_m;
  Eigen::Vector3d from_m, ray;  ///< position and direction of a view that saw it, world
  double surround = 0;
  std::vector<Sighting> seen;
};

struct LampSearch {
  std::vector<FoundLamp> lamps;        ///< the largest solid angle first
  std::vector<RejectedLamp> rejected;  ///< seen by the most views first
};

/// Finds lamps: joins regions of the views to tracks by their directions, triangulates each track
/// (estimation::triangulate) and checks it. The centre of a flat lamp is that of its area on its
/// plane: the room's surface there, or facing down above all cameras. With one view only, or too
/// short a path, a lamp is placed on the surface of `room`; without a room it is refused. Views
/// must be in order of time; at most kMostViews are used, evenly chosen.
LampSearch find_lamps(std::span<const LampView> views, const RoomSurfaces* room,
                      const LampOptions& options = {});
inline constexpr int kMostViews = 60;

}  // namespace mixrig::lights
