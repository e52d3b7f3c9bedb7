// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/sweep_views.h"

#include <fmt/format.h>

#include "host/capture/take/bracket_files.h"
#include "host/pose/source/pan_tilt_poses.h"
#include "host/room/background/plate_median.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

/// Averages the frames of one view after the other.
class ViewReader {
 public:
  ViewReader(const capture::SourceInfo& info, SweepViews& out, Crew& crew)
      : info_(info),
        average_(info.tof, info.noise, info.depth_kind == capture::DepthKind::kDistance),
        out_(out),
        crew_(crew) {}

  void begin(const geometry::Pose& base_from_target) {
    finish();
    model::ScanView& view = out_.views.emplace_back();
    view.base_from_target = base_from_target;
    view.base_from_tof = base_from_target * info_.target_from_tof;
  }
  void add(const capture::Capture& frame) {
    average_.add(frame.depth_m.view(), frame.amplitude.view());
    plate_.add(frame.plate.view());
    ++out_.frames;
  }
  void finish() {
    if (!out_.views.empty()) {
      model::ScanView& view = out_.views.back();
      average_.finish(view.distance_m, view.sigma_m);
      plate_.finish(view.plate, crew_);
    }
    average_.clear(), plate_.clear();
  }

 private:
  const capture::SourceInfo& info_;
  model::ViewAverage average_;
  model::PlateMedian plate_;
  SweepViews& out_;
  Crew& crew_;
};

bool same(const device::PanTiltAngles& a, const device::PanTiltAngles& b) {
  return a.pan_rad == b.pan_rad && a.tilt_rad == b.tilt_rad;
}

Result<void> read_by_angles(const capture::Capture& frame, const calibration_file::PanTilt& unit,
                            ViewReader& reader, SweepViews& sweep) {
  if (!frame.pan_tilt)
    return Error{ErrorCode::kData,
                 fmt::format("frame {} has no angles of the head: scan a take with pan_tilt.csv, "
                             "or one with poses without --calibration",
                             frame.number)};
  if (sweep.angles.empty() || !same(sweep.angles.back(), *frame.pan_tilt)) {
    sweep.angles.push_back(*frame.pan_tilt);
    reader.begin(pose::base_from_target(unit, *frame.pan_tilt));
  }
  reader.add(frame);
  return {};
}

Result<void> read_by_pose(const capture::Capture& frame, ViewReader& reader) {
  if (frame.pose_origin == capture::PoseOrigin::kUnknown)
    return Error{
        ErrorCode::kUsage,
        fmt::format("frame {} has no pose: give --calibration with a pan-tilt unit to scan "
                    "by the angles of the head",
                    frame.number)};
  reader.begin(frame.world_from_target);
  reader.add(frame);
  return {};
}

/// The pictures of one exposure, rows [begin, end), of a view.
Result<void> add_bracket(const fs::path& folder, const std::vector<take::BracketRow>& rows,
                         std::size_t begin, std::size_t end, model::ScanView& view, Crew& crew) {
  model::PlateMedian median;
  Image<Rgb8> plate;
  for (std::size_t i = begin; i < end; ++i) {
    const int number = static_cast<int>(i) + 1;
    MIXRIG_TRY(take::read_bracket_plate(folder, number, plate));
    if (plate.size() != view.plate.size())
      return Error{ErrorCode::kData,
                   fmt::format("'{}': bracket picture {} is {}x{}, the plates are {}x{}: delete "
                               "{} to scan without it",
                               folder.string(), number, plate.width(), plate.height(),
                               view.plate.width(), view.plate.height(), take::kBracketTable)};
    median.add(plate.view());
  }
  const take::BracketRow& row = rows[begin];
  model::ScanView::Bracket& into = view.brackets.emplace_back();
  into.exposure = row.exposure_s / row.frames_s;
  median.finish(into.plate, crew);
  return {};
}

/// Moves the origin into the middle of the views.
void set_base(SweepViews& sweep) {
  geometry::Pose world_from_base;
  for (const model::ScanView& view : sweep.views)
    world_from_base.translation_m +=
        view.base_from_target.translation_m / static_cast<double>(sweep.views.size());
  for (model::ScanView& view : sweep.views) {
    view.base_from_target.translation_m -= world_from_base.translation_m;
    view.base_from_tof.translation_m -= world_from_base.translation_m;
  }
  sweep.world_from_base = world_from_base;
}

}  // namespace

Result<SweepViews> read_sweep(capture::CaptureSource& source, const calibration_file::PanTilt* unit,
                              Crew& crew) {
  SweepViews sweep;
  ViewReader reader(source.info(), sweep, crew);
  capture::Capture frame;
  for (int number = 1; number <= source.info().frames; ++number) {
    MIXRIG_ASSIGN(const bool more, source.read(number, frame));
    if (!more) break;
    MIXRIG_TRY(unit != nullptr ? read_by_angles(frame, *unit, reader, sweep)
                               : read_by_pose(frame, reader));
    sweep.view_of_frame.push_back(static_cast<int>(sweep.views.size()) - 1);
    if (sweep.views.size() > kMostViews)
      return Error{ErrorCode::kData,
                   fmt::format("the take has more than {} views: scan a shorter one", kMostViews)};
  }
  reader.finish();
  if (sweep.views.empty()) return Error{ErrorCode::kData, "the sweep has no frames"};
  if (unit == nullptr) set_base(sweep);
  return sweep;
}

Result<void> add_brackets(const fs::path& folder, SweepViews& sweep, Crew& crew) {
  MIXRIG_ASSIGN(const auto rows, take::read_bracket_table(folder));
  for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    end = begin + 1;
    while (end < rows.size() && rows[end] == rows[begin]) ++end;
    const auto frame = static_cast<std::size_t>(rows[begin].frame);
    if (frame >= sweep.view_of_frame.size()) continue;
    model::ScanView& view = sweep.views[static_cast<std::size_t>(sweep.view_of_frame[frame])];
    MIXRIG_TRY(add_bracket(folder, rows, begin, end, view, crew));
  }
  return {};
}

}  // namespace mixrig::session
