// SPDX-License-Identifier: Apache-2.0
// How bright found lamps are for each other, from pictures of the fisheye at several exposures.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"
#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::session {

/// A picture of the fisheye.
struct BracketFile {
  std::filesystem::path picture;
  double exposure = 1;  ///< relative to that of the other ones, above 0
};

/// Mean radiance of each lamp, relative, by its region in view `view`, from whose place the
/// pictures were taken. Errors: kUsage for less than two pictures; those of reading; kData where a
/// picture has another size than the camera's, where the view does not show a lamp, and where one
/// is black, or too bright for all pictures.
Result<std::vector<double>> radiance_by_bracket(std::span<const BracketFile> files,
                                                const geometry::AnyCamera& camera,
                                                std::span<const lights::LampView> views, int view,
                                                std::span<const lights::FoundLamp> lamps);

}  // namespace mixrig::session
