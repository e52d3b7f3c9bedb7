// SPDX-License-Identifier: Apache-2.0
// Tables of a background that is redrawn for each pose, shared by both back ends: its depth as a
// coarse grid, drawn as the ToF grid is, and its normals.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/render/tables/depth_planes.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Range of the depths of a face, z in its axes; far_m 0: no known depth.
struct FaceRange {
  float near_m = 0, far_m = 0;
};

/// A plane of a face, on which light is computed.
struct ModelPlane {
  std::size_t face = 0;
  WPlane plane;  ///< in axes of the face
};

/// Tables of one BackgroundModel, built once. The images, except those of the grid, have the size
/// of its images.
struct ModelTables {
  int step_px = 1;                    ///< model pixels between samples of the grid
  Tables grid;  ///< for passes correct and warp; camera_from_tof is not set
  std::vector<Image<float>> depth_m;  ///< grid of each face: medians of known depths, 0 unknown
  std::vector<FaceRange> range;  ///< depth range of each grid
  PinholeParams camera;  ///< the model's camera
  double camera_focal_px = 1;  ///< fx of the model's camera in double precision
  int face_rows = 0;  ///< rows of a face in the images
  Image<float> w;                     ///< inverse depth, 0 unknown
  /// Normals in axes of the first face. The fourth number is the pixel's plane, counted from 1; 0:
  /// none. It is negative where the learned depth has wrapped around and the plane lies behind it.
  Image<PackedNormal> normal;
  std::vector<ModelPlane> planes;     ///< at most kMostLightPlanes; empty: nothing takes light
  /// Radius in the view within which the nearest background limits the key.
  int limit_radius_px = 1;
};

/// Whether any model of the setup has colour.
bool has_model_color(const CompositorSetup& setup);

/// Builds the tables of `model`. The grid has as many samples as the ToF camera can resolve.
/// Without `with_normals`, `normal` is empty. Where lamps or contact shadows light objects, normals
/// and planes are those of light_surface(), without wrapped depth (wrapped_areas.h), and a floor
/// goes through the objects' feet. Precondition: validate(setup) holds and `model` is one of its
/// models.
ModelTables make_model_tables(const CompositorSetup& setup, const BackgroundModel& model,
                              bool with_normals);

/// Updates the tables that depend on the view of `setup`. Allocates nothing.
void set_view(const CompositorSetup& setup, ModelTables& tables);

/// Transforms between a face of the model and the camera of a frame.
struct FacePose {
  glm::mat4 camera_from_face{1}, face_from_camera{1};
};
FacePose face_pose(const geometry::Pose& world_from_face, const geometry::Pose& world_from_camera);

/// Writes the planes in camera axes of a frame: the dot product of (x/z, y/z, 1) and out[1 + k] is
/// 1/z on plane k; out[0] is 0. `out` must hold one entry more than there are planes. Pure.
void planes_in_camera(const ModelTables& tables, std::span<const FacePose> of_faces,
                      std::span<glm::vec3> out);

/// Rotates packed unit normals in place; unknown normals stay unknown.
void rotate(const glm::mat3& r, std::span<PackedNormal> normals);

/// False where no surface of the face can appear in the view, by the corners of the frustum between
/// its depth range.
bool may_show(const ModelTables& tables, std::size_t face, const FacePose& pose);

}  // namespace mixrig::render
