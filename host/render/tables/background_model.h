// SPDX-License-Identifier: Apache-2.0
// What both back ends need of a background that is redrawn for each pose: its depth as a coarse
// grid, which is drawn as the ToF grid is, and its normals.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/render/tables/depth_planes.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Depths of the surfaces of a face, z in its axes; far_m 0: it has none.
struct FaceRange {
  float near_m = 0, far_m = 0;
};

/// A plane of a face that light falls on.
struct ModelPlane {
  std::size_t face = 0;
  WPlane plane;  ///< axes of the face
};

/// Built once. The model camera is that of BackgroundModel; all images but the grids' have the size
/// of its images.
struct ModelTables {
  int step_px = 1;                    ///< model pixels between samples of the grid
  Tables grid;                        ///< of passes correct and warp; camera_from_tof is left out
  std::vector<Image<float>> depth_m;  ///< grid of each face: medians of known depths, 0 unknown
  std::vector<FaceRange> range;       ///< of each grid
  PinholeParams camera;               ///< model camera
  double camera_focal_px = 1;         ///< its fx, as it came
  int face_rows = 0;                  ///< of the images
  Image<float> w;                     ///< inverse depth, 0 unknown
  /// Axes of the first face. The fourth number tells the plane of a pixel, counted from 1: that is
  /// negative where the depth has wrapped around and the plane is what lies behind it; 0: none.
  Image<PackedNormal> normal;
  std::vector<ModelPlane> planes;     ///< at most kMostLightPlanes; empty: nothing takes light
  int limit_radius_px = 1;            ///< of the key's limit in the view
};

/// Whether any of the models has colour.
bool has_model_color(const CompositorSetup& setup);

/// The grid has as many samples as the ToF camera could tell apart. Without normals `normal` is
/// empty. Where lamps light objects, normals and planes are those of light_surface(), without
/// what has wrapped around (wrapped_areas.h), and a floor goes through the objects' feet.
/// Precondition: validate(setup) holds and `model` is one of its models.
ModelTables make_model_tables(const CompositorSetup& setup, const BackgroundModel& model,
                              bool with_normals);

/// What of the tables depends on the view of `setup`. Allocates nothing.
void set_view(const CompositorSetup& setup, ModelTables& tables);

/// A face of the model and the camera of a frame.
struct FacePose {
  glm::mat4 camera_from_face{1}, face_from_camera{1};
};
FacePose face_pose(const geometry::Pose& world_from_face, const geometry::Pose& world_from_camera);

/// The planes as the camera of a frame sees them, (x/z, y/z, 1) . out[1 + k] = 1/z for number k;
/// out[0] is 0. `out` has room for all. Pure.
void planes_in_camera(const ModelTables& tables, std::span<const FacePose> of_faces,
                      std::span<glm::vec3> out);

/// Turns unit normals; what is unknown stays so.
void rotate(const glm::mat3& r, std::span<PackedNormal> normals);

/// False where no surface of a face can be in the view of `tables`, by the corners of the space
/// that its surfaces lie in.
bool may_show(const ModelTables& tables, std::size_t face, const FacePose& pose);

}  // namespace mixrig::render
