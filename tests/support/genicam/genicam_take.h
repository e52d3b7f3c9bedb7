// SPDX-License-Identifier: Apache-2.0
// A take as two GigE Vision cameras of this machine: "Aravis-Fake-COLOR" at 127.0.0.1 sends its
// plates, "Aravis-Fake-TOF" at 127.0.0.2 its depth and amplitude as a Helios2 would. Both expose
// at the same time, stamped by a clock of their own.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/math/geometry/depth_noise.h"
#include "tests/support/genicam/emulated_genicam.h"

namespace mixrig::test {

enum class GenicamDepthLayout {
  kAbcy,   ///< Coord3D_ABCY16, the layout of LUCID's cameras
  kParts,  ///< Coord3D_C16, Mono16 and Confidence16 as parts of one buffer
  kNone,   ///< no depth camera: another device sends the depth
};

/// Plays a take in its own thread, from the time that the host acquires from both cameras: every
/// frame once, then the last one repeatedly.
class GenicamTake {
 public:
  using Shutter = std::function<void(int frame)>;

  /// Reads all frames before it returns. `shutter` is called on the playing thread when a frame,
  /// counted from 1, is exposed. Errors: those of the take.
  static Result<std::unique_ptr<GenicamTake>> open(const std::string& take, double rate_hz,
                                                   GenicamDepthLayout layout, Shutter shutter = {});
  ~GenicamTake();
  /// From now on a frame is sent once `recorded` is at most six frames behind, or has not grown for
  /// ten seconds: the host may be slow.
  void wait_for(std::function<int()> recorded);
  /// Whether all frames were sent, and the last one twice more.
  bool finished() const { return finished_; }
  bool running() const { return color_.running() && depth_.running(); }
  int frames() const { return static_cast<int>(frames_.size()); }
  /// The take's frame, from 1 on, that was sent with this counter.
  int frame_of(std::uint64_t counter) const;
  /// Depth of a frame in steps of 0.25 mm, as it was sent; 65535 is unknown.
  const std::vector<std::uint16_t>& steps(int frame) const {
    return frames_[static_cast<std::size_t>(frame - 1)].steps;
  }
  /// Seconds from the start of the acquisition to the end of the last frame, and four frames more.
  double seconds() const { return (frames() + 4) / rate_hz_; }
  /// [[camera]] and, if there is a depth camera, [depth] of a rig.toml.
  std::string rig_tables() const;

 private:
  struct Frame {
    std::vector<std::uint8_t> color;  ///< RGB8
    std::vector<std::uint16_t> steps, amplitude;
  };
  GenicamTake(std::vector<Frame> frames, Size color_px, const GenicamFeatures& depth,
              const geometry::DepthNoise& noise, double rate_hz, GenicamDepthLayout layout,
              Shutter shutter);
  void play();
  void wait_for_host(std::uint64_t counter);
  void send(const Frame& frame, std::uint64_t counter);
  void send_depth(const Frame& frame, std::uint64_t counter, std::uint64_t stamp_ns);

  std::vector<Frame> frames_;
  Size color_px_, depth_px_;
  geometry::DepthNoise noise_;
  double rate_hz_;
  GenicamDepthLayout layout_;
  Shutter shutter_;
  EmulatedGenicam color_, depth_;
  GvspSender sender_;
  std::vector<std::uint8_t> buffer_;
  std::mutex mutex_;  ///< guards recorded_
  std::function<int()> recorded_;
  std::uint64_t left_out_ = 0;  ///< frames that the host seems to have lost
  std::atomic<bool> stop_ = false, finished_ = false;
  std::thread thread_;
};

}  // namespace mixrig::test
