// SPDX-License-Identifier: Apache-2.0
// The angle out to which a solved lens is valid. Private to this module.
#pragma once

#include <optional>

#include "hal/base/result.h"
#include "host/calibrate/board/image_circle.h"
#include "host/calibrate/intrinsics/bundle.h"

namespace mixrig::calibration {

/// Angle beyond the outermost point in use at which a lens without an image circle ends, if it
/// folds inside the picture. It is about one square of a board, which the pictures show beyond its
/// corners.
inline constexpr double kBeyondPoints_rad = 0.05;

/// Largest angle from the axis of a point in use.
double largest_point_angle_rad(const Bundle& bundle);

/// Camera of a solved bundle, valid wherever its picture has an image. Pinholes and fisheyes
/// without a circle must be valid in the whole picture (geometry::validate). With a circle the lens
/// must be valid inside it, and its largest angle is the smallest angle on the rim inside the
/// picture, so that every ray has an image. Errors: kData where the lens folds there.
Result<geometry::AnyCamera> camera_in_image(const Bundle& bundle, Size size_px,
                                            const std::optional<ImageCircle>& circle);

/// Fisheye whose largest angle is kBeyondPoints_rad beyond its outermost point. Errors: kData where
/// it folds within that angle.
Result<geometry::AnyCamera> camera_near_points(const Bundle& bundle, Size size_px);

}  // namespace mixrig::calibration
