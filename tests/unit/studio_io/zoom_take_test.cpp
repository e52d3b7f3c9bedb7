// SPDX-License-Identifier: Apache-2.0
// A take whose lens zooms: what the encoders and the table say of each frame, against the lens that
// it was rendered through.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/capture/calibrated_source.h"
#include "host/studio/rig.h"
#include "host/studio/sensors/zoom_lens.h"
#include "host/studio_io/studio_take.h"
#include "host/take/take_source.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::studio_io {
namespace {

geometry::LensState state_of(const studio::Optics& o, double pupil_shift_m) {
  const auto& [k1, k2, p1, p2, k3] = o.distortion;
  return {{{o.size_px, o.fx_px, o.fy_px, o.cx_px, o.cy_px},
           geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})},
          pupil_shift_m};
}

TEST(ZoomTake, TellsTheLensOfEachFrame) {
  const test::TemporaryFolder folder;
  studio::StudioOptions options;
  options.rig = studio::RigPreset::kSr3000;
  options.seed = 3, options.frames = 6, options.size_px = {64, 52}, options.zoom = 2;
  const auto info =
      write_studio_take(options, folder / "take", take::StreamFormat::kPng, [](int) {});
  ASSERT_TRUE(info) << info.error().context;
  auto source = take::open_take_source(folder / "take");
  ASSERT_TRUE(source) << source.error().context;
  source = capture::with_calibration(*std::move(source), folder / "take/truth/calibration.toml");
  ASSERT_TRUE(source) << source.error().context;
  capture::Capture frame;
  capture::Truth truth;
  double first_px = 0, last_px = 0;
  for (int number = 1; number <= options.frames; ++number) {
    ASSERT_TRUE((*source)->read(number, frame));
    ASSERT_TRUE((*source)->read_truth(number, truth));
    ASSERT_TRUE(frame.lens && truth.lens) << number;
    EXPECT_EQ(frame.lens->origin, capture::LensOrigin::kEncoded);
    // The true lens without its distortion: the bound is the noise of the encoders and the 0.05 px
    // within which a lens stands still.
    const geometry::LensState exact{{truth.lens->view, {}}, truth.lens->pupil_shift_m};
    geometry::LensState known = frame.lens->state;
    known.camera.lens = {};
    EXPECT_LT(geometry::largest_shift_px(exact, known, 2), 0.1) << number;
    last_px = truth.lens->view.fx_px;
    if (number == 1) first_px = last_px;
  }
  EXPECT_NEAR(last_px / first_px, 2, 0.07);  // with the focus's breathing
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
       {std::tuple(3, 2, 16.0), std::tuple(5, 3, 4.0), std::tuple(9, 4, 1.0)}) {
    const double error_px = table_error_px(zooms, focuses);
    RecordProperty("px_" + std::to_string(zooms) + "x" + std::to_string(focuses),
                   std::to_string(error_px));
    EXPECT_LT(error_px, bound_px) << zooms << " x " << focuses;
  }
}

}  // namespace
}  // namespace mixrig::studio_io
