// SPDX-License-Identifier: Apache-2.0
// A take whose lens zooms: the encoders and the table of each frame are compared with the lens that
// rendered it.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/capture/capture/lens_track.h"
#include "host/math/geometry/lens_table.h"
#include "studio/rig.h"
#include "studio/sensors/zoom_lens.h"

namespace mixrig::studio_io {
namespace {

geometry::LensState state_of(const studio::Optics& o, double pupil_shift_m) {
  const auto& [k1, k2, p1, p2, k3] = o.distortion;
  return {{{o.size_px, o.fx_px, o.fy_px, o.cx_px, o.cy_px},
           geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})},
          pupil_shift_m};
}

TEST(ZoomTake, EncodersAndTableTellTheLensOfEachFrame) {
  studio::StudioOptions options;
  options.seed = 3, options.frames = 60, options.size_px = {1280, 1024}, options.zoom = 2;
  const auto studio = studio::Studio::create(options);
  ASSERT_TRUE(studio) << studio.error().context;
  const studio::StudioInfo& info = studio->info();
  std::vector<geometry::LensNode> nodes;
  for (const studio::LensTruth& node : studio::true_lens_table(options, info))
    nodes.push_back({{node.at.zoom, node.at.focus}, state_of(node.optics, node.pupil_shift_m), 0});
  const auto table = geometry::LensTable::make(nodes);
  ASSERT_TRUE(table) << table.error().context;
  std::vector<capture::LensSample> samples;
  for (const studio::LensSample& sample : studio::record_lens(options, info))
    samples.push_back(
        {HostTime(Duration(std::llround(1e9 * sample.time_s))), {sample.at.zoom, sample.at.focus}});
  const studio::ZoomLens lens{info.target, options.zoom};
  double most_px = 0;
  for (int number = 1; number <= options.frames; ++number) {
    const double time_s = (number - 1) / info.rate_hz;
    const auto at = capture::lens_at(samples, HostTime(Duration(std::llround(1e9 * time_s))));
    ASSERT_TRUE(at) << number;
    EXPECT_TRUE(table->contains(*at)) << number;
    const studio::LensSetting setting = studio::lens_at(info, time_s);
    const geometry::LensState exact = state_of(lens.optics(setting), lens.pupil_shift_m(setting));
    most_px = std::max(most_px, geometry::largest_shift_px(table->at(*at), exact, 2));
  }
  RecordProperty("px", std::to_string(most_px));
  // The table is 0.24 px off between its nodes, 3 counts are 0.06 px, a line between two samples of
  // a lens that doubles its focal length in 1.4 s is 0.08 px off.
  EXPECT_LT(most_px, 0.6);
}

/// The largest error between the nodes of a table of the studio's lens, 1280 x 1024.
double table_error_px(int zooms, int focuses) {
  const studio::ZoomLens lens{studio::target_optics(studio::RigPreset::kKinect2, {1280, 1024}), 2};
  std::vector<geometry::LensNode> nodes;
  const auto exact = [&](const studio::LensSetting& at) {
    return state_of(lens.optics(at), lens.pupil_shift_m(at));
  };
  for (int i = 0; i < zooms; ++i)
    for (int j = 0; j < focuses; ++j) {
      const studio::LensSetting at{i / (zooms - 1.0), 0.1 + 0.8 * j / std::max(1, focuses - 1)};
      const studio::LensCounts counts = counts_of(at);
      nodes.push_back({{counts.zoom, counts.focus}, exact(at), 0});
    }
  const auto table = geometry::LensTable::make(nodes);
  EXPECT_TRUE(table) << table.error().context;
  double most_px = 0;
  for (int i = 0; i <= 50; ++i)
    for (const double focus : {0.1, 0.23, 0.5, 0.77, 0.9}) {
      const studio::LensSetting at{i / 50.0, focus};
      const studio::LensCounts counts = counts_of(at);
      most_px = std::max(most_px, geometry::largest_shift_px(table->at({counts.zoom, counts.focus}),
                                                             exact(at), 2));
    }
  return most_px;
}

TEST(ZoomTake, ATableOfFewSettingsIsCloseBetweenThem) {
  for (const auto& [zooms, focuses, bound_px] :
       {std::tuple(3, 2, 12.0), std::tuple(5, 3, 2.0), std::tuple(9, 4, 0.3)}) {
    const double error_px = table_error_px(zooms, focuses);
    RecordProperty("px_" + std::to_string(zooms) + "x" + std::to_string(focuses),
                   std::to_string(error_px));
    EXPECT_LT(error_px, bound_px) << zooms << " x " << focuses;
  }
}

}  // namespace
}  // namespace mixrig::studio_io
