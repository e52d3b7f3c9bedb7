// SPDX-License-Identifier: Apache-2.0
// A folder of board views by all cameras of a rig: views.toml (docs/reference/take.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"

namespace mixrig::calibration {

struct ViewCamera {
  std::string name;
  geometry::LensKind lens = geometry::LensKind::kPinhole;
  Size size_px;
  std::string images, depth;  ///< patterns with one %06d; depth is empty for colour cameras
  double depth_unit_m = 0;
  std::vector<int> depth_unknown;  ///< steps without a measurement, beside 0
  bool depth_is_z = false;         ///< else the distance along the ray
};

struct ViewSet {
  std::filesystem::path folder;
  std::string name;
  int views = 0;
  std::string board_kind;     ///< "checkerboard" or "charuco"
  int columns = 0, rows = 0;  ///< squares
  double square_m = 0, marker_m = 0;
  std::string dictionary;
  std::vector<ViewCamera> cameras;  ///< the first is the target camera
  struct Angles {
    double pan_rad = 0, tilt_rad = 0;
  };
  std::vector<Angles> angles;  ///< encoder angles of each view; empty without a pan-tilt unit
  double step_rad = 0;         ///< resolution of the encoders; 0: unknown
};

/// Reads FOLDER/views.toml. Errors: kNotFound, kFormat (file:line: key).
Result<ViewSet> read_view_set(const std::filesystem::path& folder);
/// Parses the text of a views.toml, of which `name` is the file's name in errors; `angles` becomes
/// the name of the file of angles, empty without a pan-tilt unit. Pure and bounded: an entry point
/// of the fuzzer. Errors: kFormat.
Result<ViewSet> parse_view_set(std::string_view text, const std::string& name, std::string& angles);
/// Parses "view,pan_deg,tilt_deg" lines; `name` is the file's name in errors. Pure and bounded: an
/// entry point of the fuzzer. Errors: kFormat, also for a header that names radians, or no degrees.
Result<std::vector<ViewSet::Angles>> parse_angles(const std::string& text, const std::string& name,
                                                  int views);

/// Pictures of one camera in one view.
struct ViewPictures {
  Image<float> picture;      ///< linear in light: 0..1 of 8-bit sRGB (its green, the finest
                             ///< channel), counts of a 16-bit grey picture
  Image<float> depth_m;      ///< 0 = unknown; empty for a colour camera
  bool depth_is_z = false;   ///< false: depth is the distance along the ray
  Image<std::uint8_t> gray;  ///< 8-bit picture for detectors
};
/// Reads the pictures of a view. Errors: kNotFound; kFormat, also where a size is not the camera's.
Result<ViewPictures> load_view(const ViewSet& set, const ViewCamera& camera, int view);
/// Index of the camera with that name. Errors: kUsage, with the names that exist.
Result<int> find_camera(const ViewSet& set, const std::string& name);
/// Files of a set in a fixed order, to hash them.
std::vector<std::filesystem::path> files_of(const ViewSet& set, const std::string& only_camera);

}  // namespace mixrig::calibration
