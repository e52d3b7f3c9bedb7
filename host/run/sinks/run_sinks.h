// SPDX-License-Identifier: Apache-2.0
// Where the composites of a run go: files, contact sheet, streams, sinks of callers and extras.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/work_gate.h"
#include "host/output/sink/sink_thread.h"
#include "host/output/streams/stream_sink.h"
#include "host/run/controls/run_options.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Sinks of one run, each in a thread of its own. For the compositing thread.
class RunSinks {
 public:
  /// All of them outlive it.
  RunSinks(const Session& session, const RunOptions& options, const Clock& clock, WorkGate* gate)
      : session_(session), options_(options), clock_(clock), gate_(gate) {}

  /// All but the streams; `folder` of the run's files, none where it is absent. `sinks` are added,
  /// and those of the extras, which outlive this. Errors: those of the sinks, each before the first
  /// frame.
  Result<void> open(FrameRange range, const std::optional<std::filesystem::path>& folder,
                    std::vector<std::unique_ptr<output::CompositeSink>> sinks,
                    const RunExtras& extras);
  /// After the background: what a stereo pair shows behind people is of it.
  Result<void> open_streams();
  bool has_files() const { return files_ != nullptr; }
  /// Null: no extra moves objects.
  ObjectMover* mover() { return mover_; }
  /// Waits until the sinks of the extra that moves objects have seen what was delivered.
  void wait_for_mover();

  /// From this frame on: false, files are not written.
  void set_recording(bool on) { recording_ = on; }
  /// Images that the sinks require of a frame.
  struct Wanted {
    render::OutputMask all = 0;
    render::OutputMask kept = 0;  ///< of these what they use after deliver() has returned
  };
  Wanted wanted(int number) const;
  bool on_sheet(int number) const;
  Result<void> deliver(const output::CompositePtr& composite);
  /// A sheet to which no frame was delivered; null: there is none.
  output::SinkThread* empty_sheet() { return sheet_has_rows_ ? nullptr : sheet_; }
  /// Completes all of them. Errors: those of the sinks.
  Result<void> finish();
  /// After finish(): of each sink, and of each stream.
  std::vector<output::SinkReport> reports() const;
  std::vector<output::StreamOutReport> stream_reports() const;

 private:
  bool live() const { return session_.is_live(); }
  double rate_hz() const;
  bool is_transparent() const;
  render::OutputMask wanted_by(const output::SinkThread& sink, int number) const;
  output::SinkThread* add(std::unique_ptr<output::CompositeSink> sink);
  Result<void> open_files(FrameRange range, const std::filesystem::path& folder);
  Result<void> check_streams();
  Result<void> open_extras(const std::optional<std::filesystem::path>& folder,
                           const RunExtras& extras);

  const Session& session_;
  const RunOptions& options_;
  const Clock& clock_;
  WorkGate* const gate_;
  ObjectMover* mover_ = nullptr;           ///< of one of the extras
  std::vector<scene::StreamOut> streams_;  ///< of the scene and of the options
  std::vector<std::unique_ptr<output::SinkThread>> sinks_;
  std::vector<const output::StreamSink*> stream_sinks_;  ///< of sinks_
  output::SinkThread* files_ = nullptr;            ///< one of sinks_; none without an output folder
  output::SinkThread* sheet_ = nullptr;            ///< one of sinks_; none without an output folder
  std::vector<output::SinkThread*> before_moves_;  ///< of sinks_, those of the mover's extra
  bool sheet_has_rows_ = false;
  bool recording_ = true;
};

}  // namespace mixrig::session
