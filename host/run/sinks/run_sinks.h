// SPDX-License-Identifier: Apache-2.0
// Opens and feeds the sinks of a run: files, contact sheet, streams, sinks of callers and extras.
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

/// Runs each sink in its own thread. For the compositing thread.
class RunSinks {
 public:
  /// All arguments must outlive it.
  RunSinks(const Session& session, const RunOptions& options, const Clock& clock, WorkGate* gate)
      : session_(session), options_(options), clock_(clock), gate_(gate) {}

  /// Opens all sinks but the streams. `folder`: of the run's files; absent: none. Adds `sinks` and
  /// those of `extras`, which must outlive this object. Errors: those of the sinks, before the
  /// first frame.
  Result<void> open(FrameRange range, const std::optional<std::filesystem::path>& folder,
                    std::vector<std::unique_ptr<output::CompositeSink>> sinks,
                    const RunExtras& extras);
  /// Opens the streams; call it after the background is prepared, which a stereo pair shows behind
  /// people.
  Result<void> open_streams();
  bool has_files() const { return files_ != nullptr; }
  /// Whether a frame was written to the files.
  bool has_written() const { return files_ != nullptr && files_->report().written > 0; }
  /// The mover of objects; null if no extra moves objects.
  ObjectMover* mover() { return mover_; }
  /// Waits until the sinks of the extra that moves objects have handled everything delivered.
  void wait_for_mover();

  /// Sets whether files are written from this frame on.
  void set_recording(bool on) { recording_ = on; }
  /// Images that the sinks need of a frame.
  struct Wanted {
    render::OutputMask all = 0;
    render::OutputMask kept = 0;  ///< those of `all` that sinks use after deliver() has returned
  };
  Wanted wanted(int number) const;
  bool on_sheet(int number) const;
  Result<void> deliver(const output::CompositePtr& composite);
  /// The sheet if no frame was delivered to it; null otherwise.
  output::SinkThread* empty_sheet() { return sheet_has_rows_ ? nullptr : sheet_; }
  /// Finishes all sinks, each whatever becomes of the others. Errors: the first one's.
  Result<void> finish();
  /// Reports of all sinks and streams. Precondition: finish() was called.
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
  std::vector<const output::StreamSink*> stream_sinks_;  ///< those in sinks_
  output::SinkThread* files_ = nullptr;  ///< one of sinks_; null without an output folder
  output::SinkThread* sheet_ = nullptr;  ///< one of sinks_; null without an output folder
  /// The elements of sinks_ that belong to the mover's extra.
  std::vector<output::SinkThread*> before_moves_;
  bool sheet_has_rows_ = false;
  bool recording_ = true;
};

}  // namespace mixrig::session
