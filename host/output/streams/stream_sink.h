// SPDX-License-Identifier: Apache-2.0
// Sends composites through GStreamer to another program or into a file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/output/sink/composite_sink.h"
#include "host/output/streams/stream_picture.h"
#include "host/output/streams/timecode.h"

namespace mixrig::output {

/// Counts for one receiver.
struct StreamOutReport {
  std::string uri, picture;
  Size size;
  std::uint64_t frames = 0;   ///< pictures given to GStreamer
  std::uint64_t dropped = 0;  ///< pictures dropped because GStreamer still held two, or had ended
  StereoCounts stereo;
};

/// Sends pictures stamped with their mid-exposure, 0 for the first. A network receiver that is
/// slow, absent or gone loses pictures, which are counted; a file gets all. A failing end is logged
/// once; one that calls by SRT is begun anew every two seconds of exposures.
class StreamSink final : public CompositeSink {
 public:
  /// Checks what can be checked before the first picture. Errors: kUsage (plan_stream(),
  /// a host that is not known), kUnsupported with the Debian package of a missing plug-in.
  static Result<void> check(const scene::StreamOut& out, Size view, double rate_hz);
  /// Opens the stream. A file that is there stays: NAME-2.mkv and so on is written, which a warning
  /// and the report say. Timecode begins at the time of day if `day_at_zero`, the time of day at
  /// host time 0, is given, else at 0. Errors: those of check(); kIo if the end cannot be opened.
  static Result<std::unique_ptr<StreamSink>> create(const scene::StreamOut& wanted, Size view,
                                                    double rate_hz, bool transparent,
                                                    RoomBehind behind, DayAtZero day_at_zero = {});
  ~StreamSink() override;
  std::string_view name() const override { return "stream"; }
  render::OutputMask wanted(int) const override { return picture_.wanted(); }
  Result<void> write(const CompositePtr& composite) override;
  Result<void> finish() override;
  /// Precondition: finish() was called.
  const StreamOutReport& report() const { return report_; }

 private:
  struct Graph;  ///< GStreamer's objects
  StreamSink(const scene::StreamOut& out, Size view, double rate_hz, bool transparent,
             RoomBehind behind);
  /// False if the picture must be dropped.
  bool has_room(HostTime now);
  bool call_again(HostTime now);

  const scene::StreamOut out_;
  const Size view_;
  const double rate_hz_;
  StreamPicture picture_;
  StreamOutReport report_;
  std::unique_ptr<Graph> graph_;
  std::vector<std::uint8_t> drawn_;          ///< the picture before conversion to I420
  std::optional<TimecodeCounter> timecode_;  ///< if the format carries timecode
  std::optional<HostTime> first_;
  Duration last_{-1};  ///< time stamp of the last picture
  bool ended_ = false;
  std::optional<HostTime> called_;  ///< when a receiver that did not answer was called last
};

}  // namespace mixrig::output
