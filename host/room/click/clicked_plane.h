// SPDX-License-Identifier: Apache-2.0
// Finds the plane under a pixel of a depth picture (Frahm, Koeser, Grest and Koch 2005, section 6).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/plane.h"
#include "host/math/geometry/pose.h"

namespace mixrig::model {

/// A depth picture and the view that was clicked.
struct ClickPicture {
  ImageView<const float> depth_m;  ///< of the depth camera; 0 = unknown
  const geometry::CameraModel* tof = nullptr;
  bool depth_is_distance = false;  ///< depth values are distances along the ray, not z
  geometry::DepthNoise noise;
  geometry::Pinhole view;
  geometry::Pose view_from_tof;
};

struct Click {
  Eigen::Vector2d px;  ///< view pixel
  /// Window around it; absent: a sixteenth of the view's width.
  std::optional<Eigen::Vector2d> rect_px;
};

/// The plane found, in axes of the view.
struct ClickedPlane {
  geometry::Plane plane;        ///< normal towards the camera
  Eigen::Vector3d point_m;      ///< point of the plane under the pixel
  double normal_sigma_rad = 0;  ///< along its worse axis
  double offset_sigma_m = 0;    ///< of the plane at `point_m`, along its normal
  double residual = 0;          ///< root mean square of the points, in sigmas of the depth
  int points = 0;               ///< number of points in the region
  double area_m2 = 0;           ///< area of the region
  Image<std::uint8_t> region;   ///< pixels of the depth picture: 1 where the plane goes on
};

/// Why no plane was found.
enum class ClickRefusal {
  kOutside,  ///< not in the view, or not in the depth camera's field
  kUnknown,  ///< no depth: glass, black, too far
  kEdge,     ///< several surfaces
  kNotFlat,  ///< curved or rough: a person, hair; or surfaces that meet
  kGrazing,  ///< seen at less than 5 degrees
  kSmall,    ///< the flat part is too small
};
/// Explains a refusal in one sentence.
std::string_view text_of(ClickRefusal refusal);

/// Finds a plane through the depths around the pixel (estimation::fit_with_consensus), grows it
/// over neighbours within three sigmas to its border, and fits it again to all of them by least
/// squares of inverse depth, which is linear in the ray, weighted by the depth's noise. What a step
/// separates from the click, even one within the noise of a depth (click_step.h), belongs to the
/// region but not to the fit. The sigma includes a share that neighbours have in common
/// (kCommonShare). Pure; time grows with the pixels of the depth picture.
std::variant<ClickedPlane, ClickRefusal> plane_under(const ClickPicture& picture,
                                                     const Click& click);

}  // namespace mixrig::model
