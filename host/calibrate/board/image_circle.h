// SPDX-License-Identifier: Apache-2.0
// The image circle of a fisheye, found in its pictures, and the angle of its rim.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"

namespace mixrig::calibration {

/// Circle that bounds the image of a lens: outside it no light reaches the sensor.
struct ImageCircle {
  Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  double radius_px = 0;
  double residual_px = 0;  ///< root mean square distance of the rim's points; 0 if given
  double seen = 0;         ///< share of the rim inside the picture that was found; 0 if given

  bool contains(const Eigen::Vector2d& px) const { return (px - center_px).norm() <= radius_px; }
};

/// The brightest value of each pixel over the pictures of one camera: the border outside an image
/// circle is black in all of them, while what is dark in the scene moves.
class BrightestPicture {
 public:
  /// The first picture sets the size; others of another size are left out.
  void add(ImageView<const std::uint8_t> picture);
  ImageView<const std::uint8_t> image() const { return image_.view(); }

 private:
  Image<std::uint8_t> image_;
};

/// Finds the circle outside which the picture is dark; nullopt where there is none, as in a picture
/// filled by its image, a dark room or a black picture. It counts as an image circle where
///  - the steps from dark to light, met on the way in from the picture's sides, lie on one circle,
///    on 60 % of its length inside the picture and on 60 degrees of it or more (borders of light in
///    a room lie on no circle about most of the picture);
///  - outside it, on 1 % of the picture or more, 99 % of the pixels are darker than the rim's step
///    (in a dark room lamps, windows and noise of lit surfaces lie outside any circle too);
///  - it holds the middle of the picture, and most pixels along its inner side are lit.
/// The radius is that at which the light begins: half way up the step. Pure.
std::optional<ImageCircle> find_image_circle(ImageView<const std::uint8_t> brightest);

/// Smallest angle from the axis (rad) on the part of the circle's rim that lies inside the picture,
/// so that every ray out to it has an image. nullopt where all of the rim lies outside. `lens`: a
/// fisheye without a largest angle. Errors: kData, by folds_in_circle(), where the lens folds
/// inside the circle.
Result<std::optional<double>> rim_angle_rad(const geometry::AnyCamera& lens,
                                            const ImageCircle& circle);
/// Error line for the user: a fisheye `lens` folds inside its image circle.
Error folds_in_circle(const geometry::AnyCamera& lens, const ImageCircle& circle);

}  // namespace mixrig::calibration
