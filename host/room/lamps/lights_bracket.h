// SPDX-License-Identifier: Apache-2.0
// Relative brightness of found lamps, from fisheye pictures at several exposures.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"
#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::session {

/// A fisheye picture of a bracket.
struct BracketFile {
  std::filesystem::path picture;
  double exposure = 1;  ///< relative to the other pictures' exposures, above 0
};

/// Relative mean radiance of each lamp, by its region in view `view`, from whose place the pictures
/// were taken. Errors: kUsage for less than two pictures; those of reading; kData if a picture's
/// size differs from the camera's, if the view does not show a lamp, or a lamp is black or too
/// bright in all pictures.
Result<std::vector<double>> radiance_by_bracket(std::span<const BracketFile> files,
                                                const geometry::AnyCamera& camera,
                                                std::span<const lights::LampView> views, int view,
                                                std::span<const lights::FoundLamp> lamps);

}  // namespace mixrig::session
