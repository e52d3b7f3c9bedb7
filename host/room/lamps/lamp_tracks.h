// SPDX-License-Identifier: Apache-2.0
// Lamps from the bright regions that a moving camera sees: which of them are places in the room,
// where they are, and why the others are none.
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

/// One picture of the camera.
struct LampView {
  geometry::Pose world_from_camera;
  std::vector<BrightRegion> regions;
};

/// Which region of which view.
struct Sighting {
  int view = 0, region = 0;
  bool operator==(const Sighting&) const = default;
};

struct LampOptions {
  double most_surround = 0.45;    ///< linear light around a lamp over that inside
  double least_share = 0.15;      ///< of the views, that must see a lamp
  double least_solid_sr = 2e-5;   ///< in the median; a disk of 0.3 deg
  double common_rad = 0.5e-3;     ///< error of the lens that all views have in common, sigma
  double most_sigma_share = 0.1;  ///< sigma of a position over its distance
  bool low_lamps = false;         ///< what lies below every camera may be a lamp
};

/// Its intensity is not known: that member has no meaning. Without a direction its size is its
/// width.
struct FoundLamp : geometry::Lamp {
  Eigen::Matrix3d covariance;  ///< of the position, m^2
  double residual = 0;         ///< root mean square of a view, in sigmas
  double surround = 0;         ///< median of the views
  double solid_angle_sr = 0;   ///< the same
  bool by_surface = false;     ///< placed on the room's surface, not triangulated
  std::vector<Sighting> seen;
};

enum class Refusal {
  kFewViews,    ///< in too few views to be a thing of the room
  kSmall,       ///< smaller than lamps that matter
  kSoftBorder,  ///< its light fades at its border: a lit white thing
  kMoves,       ///< moves with the camera: a highlight
  kShortPath,   ///< the views do not determine its distance
  kCut,         ///< cut by the border of the picture in all views
  kBehind,      ///< behind a wall, below the floor: a mirror image, or another room
  kFacesUp,     ///< on a surface that faces up: a reflection, or a white thing
  kLow,         ///< below every camera
  kDark,        ///< the room's shading does not show its light
};
/// "soft_border", and one sentence.
std::string_view name(Refusal refusal);
std::string_view text_of(Refusal refusal);

struct RejectedLamp {
  Refusal refusal = Refusal::kFewViews;
  std::optional<Eigen::Vector3d> position_m;
  Eigen::Vector3d from_m, ray;  ///< world; a view that saw it, and where
  double surround = 0;
  std::vector<Sighting> seen;
};

struct LampSearch {
  std::vector<FoundLamp> lamps;        ///< the largest solid angle first
  std::vector<RejectedLamp> rejected;  ///< the most views first
};

/// Joins the regions of the views to tracks by their directions, triangulates each
/// (estimation::triangulate) and judges it. The centre of a flat lamp is that of its area on its
/// plane: that of the room's surface there, or facing down above all cameras. With one view only,
/// or where its path is too short, a lamp lies on the surface of `room`; without a room it is
/// refused. Views in order of time; at most kMostViews of them are used, evenly chosen.
LampSearch find_lamps(std::span<const LampView> views, const RoomSurfaces* room,
                      const LampOptions& options = {});
inline constexpr int kMostViews = 60;

}  // namespace mixrig::lights
