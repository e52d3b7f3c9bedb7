// SPDX-License-Identifier: Apache-2.0
// Out to which angle a solved lens is used. Private to this module.
#pragma once

#include <optional>

#include "hal/base/result.h"
#include "host/calibrate/board/image_circle.h"
#include "host/calibrate/intrinsics/bundle.h"

namespace mixrig::calibration {

/// How far beyond the outermost point in use a lens without an image circle is used, where it folds
/// inside the picture: about one square of a board, which the pictures show beyond its corners.
inline constexpr double kBeyondPoints_rad = 0.05;

/// Largest angle from the axis of a point in use.
double largest_point_angle_rad(const Bundle& bundle);

/// The camera of a solved bundle that is valid where its picture has an image. Pinholes, and
/// fisheyes without a circle: in the whole picture (geometry::validate). With a circle: inside it;
/// its largest angle is the smallest angle on the rim inside the picture, so that every ray has an
/// image. Errors: kData where the lens folds there.
Result<geometry::AnyCamera> camera_in_image(const Bundle& bundle, Size size_px,
                                            const std::optional<ImageCircle>& circle);

/// A fisheye that is valid out to kBeyondPoints_rad beyond its outermost point, which is its
/// largest angle. Errors: kData where it folds before.
Result<geometry::AnyCamera> camera_near_points(const Bundle& bundle, Size size_px);

}  // namespace mixrig::calibration
