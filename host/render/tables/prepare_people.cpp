// SPDX-License-Identifier: Apache-2.0
// Where people's shadows are computed: the fields of the lamps' maps of people, and the grid of
// points around the objects.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/tables/prepare_axes.h"

namespace mixrig::render {
namespace {

/// Texels across a map of people: 2 cm on the floor under a lamp that sees 143 degrees. Maps around
/// the objects alone need fewer.
constexpr int kPeopleMap = 1024, kPeopleMapOfObjects = 128;
/// Without a capture volume, people are expected between these distances from the camera.
constexpr double kNearPeopleM = 0.3, kFarPeopleM = 6.0;
/// Least distance of people from a lamp, as a part of the distance from the lamp to the objects.
constexpr double kPeopleNearPart = 0.4;
/// Metres between grid points, and the factor by which they are spread while they are more than
/// kMostPeoplePoints.
constexpr double kPeopleCellM = 0.08, kPeopleCellStep = 1.1;
/// Metres that the grid may extend beyond the objects, to where their shadows fall.
constexpr double kPeopleGridBeyondM = 1;

/// Whether people matter only between the lamps and the objects: there is neither a capture volume
/// nor a set.
bool people_around_objects(const CompositorSetup& setup) {
  return !setup.capture_box &&
         std::none_of(setup.objects.begin(), setup.objects.end(),
                      [](const VirtualObject& object) { return object.in_set; });
}

/// Where the shadow of a point falls at the height of the objects' lowest point; the point itself
/// if the lamp is not above it.
glm::dvec3 shadow_of(const glm::dvec3& lamp_m, const glm::dvec3& p, double foot_m) {
  const double fall_m = lamp_m.z - p.z;
  return fall_m > kNearestM ? p + (p.z - foot_m) / fall_m * (p - lamp_m) : p;
}

}  // namespace

/// Fits the maps of people to the capture volume; without one, to what lies between a lamp and the
/// objects, or, with a set around the camera, to what the camera sees.
void FramePreparer::fit_people_maps(const geometry::Pose& world_from_target) {
  const bool around_objects = people_around_objects(setup_);
  const bool stay = setup_.capture_box || around_objects;
  if (params_.people_lamps.empty() || (stay && people_fits_[0].near_m > 0)) return;
  if (around_objects) {
    for (std::size_t i = 0; i < people_fits_.size(); ++i) {
      const geometry::Lamp& lamp = setup_.light.lamps[i];
      people_fits_[i] = fit_map(lamp, corners_m_);
      // Widened by the floor in the objects' penumbrae and the filters around it.
      if (people_fits_[i].tan_half > 0)
        people_fits_[i].tan_half =
            std::min(kLargestTanHalf,
                     people_fits_[i].tan_half + disc_radius_m(lamp) / people_fits_[i].near_m);
      people_fits_[i].near_m = std::max(kNearPeopleM, kPeopleNearPart * people_fits_[i].near_m);
    }
    return;
  }
  std::array<glm::dvec3, 8> corners_m;
  for (std::size_t i = 0; i < 8; ++i) {
    if (setup_.capture_box) {
      const CaptureBox& box = *setup_.capture_box;
      corners_m[i] = {i & 1 ? box.max_m.x : box.min_m.x, i & 2 ? box.max_m.y : box.min_m.y,
                      i & 4 ? box.max_m.z : box.min_m.z};
    } else {
      const Size size = setup_.view.size_px;
      const Eigen::Vector2d ray =
          setup_.view.unproject({i & 1 ? size.width : 0.0, i & 2 ? size.height : 0.0});
      const Eigen::Vector3d p = world_from_target * (Eigen::Vector3d(ray.x(), ray.y(), 1) *
                                                     (i & 4 ? kFarPeopleM : kNearPeopleM));
      corners_m[i] = {p.x(), p.y(), p.z()};
    }
  }
  for (std::size_t i = 0; i < people_fits_.size(); ++i) {
    people_fits_[i] = fit_map(setup_.light.lamps[i], corners_m);
    people_fits_[i].near_m = std::max(people_fits_[i].near_m, kNearPeopleM);
  }
}

/// Fits the grid around the objects and their shadows, as far as kPeopleGridBeyondM.
void FramePreparer::fit_people_grid() {
  people_grid_ = {};
  if (params_.people_lamps.empty() || corners_m_.empty() || !people_around_objects(setup_)) return;
  glm::dvec3 low = corners_m_[0], high = low;
  for (const glm::dvec3& p : corners_m_) low = glm::min(low, p), high = glm::max(high, p);
  const glm::dvec3 least = low - kPeopleGridBeyondM, most = high + kPeopleGridBeyondM;
  for (const geometry::Lamp& lamp : setup_.light.lamps)
    for (const glm::dvec3& corner_m : corners_m_) {
      const glm::dvec3 p =
          shadow_of(to_glm(lamp.position_m), corner_m, least.z + kPeopleGridBeyondM);
      low = glm::max(least, glm::min(low, p)), high = glm::min(most, glm::max(high, p));
    }
  double cell_m = kPeopleCellM;
  // One cell more on each side, because the learned floor is noisy.
  const auto cells = [&] { return glm::ivec3(glm::ceil((high - low) / cell_m)) + 3; };
  const auto points = [](const glm::ivec3& count) { return 1.0 * count.x * count.y * count.z; };
  while (points(cells()) > kMostPeoplePoints) cell_m *= kPeopleCellStep;
  people_grid_ = {low - cell_m, cell_m, cells()};
}

void FramePreparer::update_people(const glm::dmat4& world_from_camera,
                                  const glm::dmat4& camera_from_world) {
  const bool around_objects = people_around_objects(setup_);
  const int size = around_objects ? kPeopleMapOfObjects : kPeopleMap;
  for (std::size_t i = 0; i < params_.people_lamps.size(); ++i) {
    params_.people_lamps[i] = lamp_params(setup_.light.lamps[i], people_fits_[i], size,
                                          world_from_camera, camera_from_world);
    params_.people_lamps[i].is_part = around_objects;
  }
  if (people_grid_.cells.x > 0)
    params_.people_grid = grid_params(people_grid_.first_m, people_grid_.cell_m, people_grid_.cells,
                                      world_from_camera);
}

}  // namespace mixrig::render
