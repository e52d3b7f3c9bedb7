// SPDX-License-Identifier: Apache-2.0
// The steps of survey(), by subject: survey.cpp the pictures and their order, survey_tracks.cpp the
// alignment of tracks, survey_adjust.cpp places and poses, survey_scale.cpp metres and what is left
// out. Private to this module.
#pragma once

#include "extras/map/reconstruction/growth/survey.h"
#include "hal/base/parallel.h"
#include "host/math/estimation/points/bearing.h"

namespace mixrig::reconstruction {

/// A sighting in one of the adjusted pictures.
struct SurveyRay {
  std::size_t seen;  ///< number in the track
  estimation::Bearing ray;
};

/// Runs survey() in steps.
class Surveyor {
 public:
  Surveyor(const FeatureTracks& tracks, const geometry::AnyCamera& camera, const Growth& grown,
           const ReconstructOptions& options, const DepthRecord* depth);
  Survey run();

 private:
  void gather();
  void place_pictures(bool all);
  void choose_views();
  void align(Crew& crew);
  void align_track(FeatureTrack& track, const std::optional<Eigen::Vector3d>& place) const;
  std::optional<Eigen::Matrix2d> turned(const Sighting& from, const Sighting& to,
                                        const std::optional<Eigen::Vector3d>& place) const;
  void make_rays();
  void triangulate();
  void adjust(int iterations);
  void set_sigma();
  void drop_outliers();
  bool measure();
  void rescale_to_metres(double metres_per_unit);
  void finish();
  const geometry::Pose& pose(const Sighting& s) const { return *result_.poses[number(s)]; }
  bool has_view(const Sighting& s) const { return is_view_[number(s)] != 0; }
  static std::size_t number(const Sighting& s) { return static_cast<std::size_t>(s.picture); }
  double error_of(std::size_t track, const SurveyRay& r) const;

  const FeatureTracks& tracks_;
  const geometry::AnyCamera& camera_;
  const Growth& grown_;
  const ReconstructOptions& options_;
  const DepthRecord* depth_;
  Survey result_;
  std::vector<char> is_view_;                 ///< by picture
  std::vector<std::vector<SurveyRay>> rays_;  ///< by track, of views
  /// By track: distance by the depth camera over that in the map; 0: not measured.
  std::vector<double> measured_;
};

}  // namespace mixrig::reconstruction
