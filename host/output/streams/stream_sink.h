// SPDX-License-Identifier: Apache-2.0
// Sends composites to another program, or into a file, through GStreamer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/output/sink/composite_sink.h"
#include "host/output/streams/stream_picture.h"
#include "host/output/streams/timecode.h"

namespace mixrig::output {

/// What was sent to one receiver.
struct StreamOutReport {
  std::string uri, picture;
  Size size;
  std::uint64_t frames = 0;   ///< given to GStreamer
  std::uint64_t dropped = 0;  ///< because it had not taken the two before yet, or ended
  StereoCounts stereo;
};

/// The time stamp of each picture is its mid-exposure, 0 for the first. A network receiver that is
/// slow, absent or gone loses pictures, counted; a file gets all. An end that fails is logged once.
class StreamSink final : public CompositeSink {
 public:
  /// What can be known before a picture is there. Errors: kUsage (plan_stream()), kUnsupported with
  /// the Debian package of a plug-in that is missing.
  static Result<void> check(const scene::StreamOut& out, Size view, double rate_hz);
  /// Timecode begins at the time of day, of which `day_at_zero` is that at host time 0, else at 0.
  /// Errors: of check(); kIo where the end cannot be opened.
  static Result<std::unique_ptr<StreamSink>> create(const scene::StreamOut& out, Size view,
                                                    double rate_hz, bool transparent,
                                                    RoomBehind behind,
                                                    std::optional<Duration> day_at_zero = {});
  ~StreamSink() override;
  std::string_view name() const override { return "stream"; }
  render::OutputMask wanted(int) const override { return picture_.wanted(); }
  Result<void> write(const CompositePtr& composite) override;
  Result<void> finish() override;
  /// After finish().
  const StreamOutReport& report() const { return report_; }

 private:
  struct Graph;  ///< of GStreamer
  StreamSink(const scene::StreamOut& out, Size view, double rate_hz, bool transparent,
             RoomBehind behind);
  /// False where the picture has to be left out.
  bool has_room();

  const scene::StreamOut out_;
  const Size view_;
  const double rate_hz_;
  StreamPicture picture_;
  StreamOutReport report_;
  std::unique_ptr<Graph> graph_;
  std::vector<std::uint8_t> drawn_;          ///< before it becomes I420
  std::optional<TimecodeCounter> timecode_;  ///< where the format has a place for it
  std::optional<HostTime> first_;
  Duration last_{-1};  ///< time stamp of the last picture
  bool ended_ = false;
};

}  // namespace mixrig::output
