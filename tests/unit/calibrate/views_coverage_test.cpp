// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate views before a board that is shown everywhere: it ends by itself.
#include <array>

#include <gtest/gtest.h>

#include "host/calibrate/rig/view_set.h"
#include "host/tools/calibrate/collect_views.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/calibrate/drawn_capture.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;

constexpr int kPlaceFrames = 4;  ///< at each place; three make a view
constexpr int kMostFrames = 60 * kPlaceFrames;

/// Ninths of the pictures, then far and near in the middle; tilted to one side after the other.
class ShownEverywhere final : public capture::CaptureSource {
 public:
  ShownEverywhere() { info_.frames = capture::kEndless; }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    constexpr std::array<std::pair<double, double>, 4> kTilts{
        {{0.4, 0.0}, {-0.4, 0.0}, {0.0, 0.4}, {0.0, -0.4}}};
    constexpr int kPlaces = 13;
    const int place = (number - 1) / kPlaceFrames, at = place % kPlaces, round = place / kPlaces;
    const auto [down, aside] = kTilts[static_cast<std::size_t>(at + round) % kTilts.size()];
    const Eigen::Vector3d turn(down, aside, 0.1 * round);
    const auto pose =
        at >= 9 ? facing(0.06 * (at % 2), 0.05 * round, at < 11 ? 1.05 : 0.54, turn)
                : facing(0.22 * (at % 3 - 1), 0.15 * (at / 3 - 1), 0.75 + 0.07 * round, turn);
    capture = frame(number, pose);
    frames = number;
    return number < kMostFrames;
  }
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "no truth"};
  }

  int frames = 0;

 private:
  capture::SourceInfo info_ = source_info();
};

TEST(ViewsCoverage, EndsThemByItself) {
  const TemporaryFolder folder;
  tools::CollectArguments arguments;
  arguments.out = folder.path() / "out";
  arguments.settings.board = kDrawnBoard;
  arguments.settings.frames = 3, arguments.settings.still_time = 80ms;
  arguments.settings.views = 8;
  ShownEverywhere source;
  const std::atomic<bool> stop = false;
  const auto report = tools::collect_views(source, arguments, stop);
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->at("ended"), "coverage") << report->dump(1);
  EXPECT_EQ(report->at("enough"), true);
  EXPECT_LT(source.frames, kMostFrames);
  const auto set = calibration::read_view_set(arguments.out);
  ASSERT_TRUE(set) << to_line(set.error());
  EXPECT_EQ(set->views, report->at("views").get<int>());
}

}  // namespace
}  // namespace mixrig::test
