// SPDX-License-Identifier: Apache-2.0
// Operator controls of a run, for the page.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "host/operator/desk/camera_desk.h"
#include "host/operator/desk/composite_recorder.h"
#include "host/operator/desk/preset_desk.h"
#include "host/operator/desk/room_sweep.h"
#include "host/operator/desk/scene_desk.h"
#include "host/operator/desk/take_list.h"
#include "host/operator/page/operator.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"

namespace mixrig::session {

struct DeskOptions {
  std::filesystem::path takes;  ///< folder for recordings
  double segment_s = 0;         ///< of recordings: output::OutputOptions
  bool live = false;            ///< the source is devices; else a recording
};

/// Learns of the run through its sink. `session`, `orders` and `clock` must outlive it; it must
/// outlive its sink. RunState::recording reflects its recorder, whoever starts or stops it.
class OperatorDesk final : public page::Operator {
 public:
  OperatorDesk(const Session& session, std::shared_ptr<SceneFollower> follower,
               output::RunOrders& orders, Clock& clock, DeskOptions options);

  page::State state() const override;
  Result<void> apply(const page::Command& command) override;
  Result<Image<Rgb8>> take_picture(const std::string& take, int frame) override {
    return takes_.picture(take, frame);
  }

  /// A sink of the run that sees and records every frame.
  std::unique_ptr<output::CompositeSink> make_sink();
  /// Called by that sink only.
  render::OutputMask wanted() const;
  void see(const output::CompositePtr& composite);

 private:
  /// Figures of the last frame and of the last second.
  struct Frames {
    std::uint64_t count = 0;
    int number = 0;
    double frame_ms = 0, delay_ms = 0, fps = 0;
    HostTime finished{}, second_began{};
    std::uint64_t second_count = 0;
    std::string pose = "unknown";
    bool objects_shown = true;
    std::optional<SeenFrom> from;
  };
  Frames frames() const;
  static page::ScanState scan_state(const output::RunState& run);
  Result<void> learn_background();
  Result<void> scan_room(bool on);
  Result<void> record(const page::StartRecording* start);
  void obey_record_orders();
  void tell_recording();
  Result<void> save();
  Result<void> discard();

  const Session& session_;
  output::RunOrders& orders_;
  const Clock& clock_;
  const DeskOptions options_;
  SceneDesk scene_;
  CameraDesk cameras_;
  PresetDesk presets_;
  TakeList takes_;
  CompositeRecorder recorder_;
  std::mutex record_mutex_;   ///< held while a recording begins or ends
  mutable std::mutex mutex_;  ///< guards the members below
  Frames frames_;
  RoomSweep sweep_;  ///< last: its thread uses the session
};

}  // namespace mixrig::session
