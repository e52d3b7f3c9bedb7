// SPDX-License-Identifier: Apache-2.0
// Tracks the people of a run on the floor, and keeps their paths.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "extras/people/plan/dwell_map.h"
#include "extras/people/plan/people_tracker.h"
#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "host/judge/measure/people.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/frame_times.h"

namespace mixrig::session {

class TouchStage;

/// A place of a path, at least kPathStep_m from the one before.
struct PathPlace {
  double time_s = 0;
  Eigen::Vector2d on_floor_m = Eigen::Vector2d::Zero();
  bool was_seen = true;
};

/// One person over the whole run.
struct PersonPath {
  int id = 0;
  double first_s = 0, last_s = 0, height_m = 0, length_m = 0;
  std::uint64_t frames = 0, seen_frames = 0;
  std::vector<PathPlace> places;
};

struct PeopleReport {
  bool keeps_places = false;  ///< keeps the positions of the paths; memory grows with them
  std::uint64_t frames = 0;
  std::size_t most_at_once = 0;
  std::vector<PersonPath> people;  ///< in the order of their ids
  plan::DwellMap dwell;
  measure::QuantileSketch track_ms;
  std::optional<measure::PeopleErrors> error;  ///< absent unless true positions are known
  std::optional<geometry::Pose> first_pose;    ///< pose of the camera
  geometry::Pinhole view;
  Image<Rgb8> first_picture;
};
/// Report without the positions of the paths.
nlohmann::json to_json(const PeopleReport& report);

/// Tracks people in each frame; frames without a camera pose are skipped.
class PeopleSink final : public output::CompositeSink {
 public:
  static constexpr double kPathStep_m = 0.02;
  static constexpr double kLongestStep_s = 0.5;  ///< longer gaps between frames count as this
  static constexpr const char* kTable = "people.csv";

  /// Makes a sink that writes kTable into `folder`, which must exist, with a row for each person
  /// and frame; without a folder it writes nothing. `report` is complete after finish(), and must
  /// outlive the sink. Errors: kIo.
  static Result<std::unique_ptr<PeopleSink>> create(
      const std::optional<std::filesystem::path>& folder, const plan::PeopleOptions& options,
      PeopleReport& report);
  /// Also detects what people touch.
  void watch_touch(std::unique_ptr<TouchStage> touch);
  ~PeopleSink() override;

  std::string_view name() const override { return "people"; }
  render::OutputMask wanted(int) const override {
    return render::kSegmentedDepth | render::kMixedDepth | render::kColor;
  }
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override;

 private:
  PeopleSink(const std::optional<std::filesystem::path>& folder, const plan::PeopleOptions& options,
             PeopleReport& report);
  void keep(const plan::Person& person, const output::Composite& composite, double time_s);
  void dwell(std::span<const plan::Person> people, double time_s);
  void judge(std::span<const plan::Person> people, const output::Composite& composite,
             double time_s);

  std::filesystem::path file_;
  std::ofstream table_;
  plan::PeopleTracker tracker_;
  SystemClock clock_;
  FrameTimes times_;
  std::optional<double> dwelt_s_;      ///< dwelling is counted up to this time
  std::unique_ptr<TouchStage> touch_;  ///< may be null
  std::map<int, PersonPath> paths_;
  std::vector<measure::PersonThere> there_;
  std::vector<measure::PersonFound> found_;
  measure::PeopleJudge judge_;
  bool is_judged_ = false;
  PeopleReport& report_;
};

}  // namespace mixrig::session
