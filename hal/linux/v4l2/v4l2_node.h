// SPDX-License-Identifier: Apache-2.0
// An open V4L2 capture node: the ioctls, nothing else. Closing releases all buffers but lent ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/linux/v4l2/v4l2_buffers.h"
#include "hal/wire/camera/v4l2_format.h"

namespace mixrig::device {

/// A buffer that the driver filled; its bytes are valid until give_back().
struct V4l2Picture {
  V4l2Bytes bytes{};      ///< bytes of each plane
  std::size_t begin = 0;  ///< offset of the first plane's bytes in its buffer
  std::uint32_t index = 0, sequence = 0;
  HostTime stamp{};             ///< the driver's stamp
  bool stamp_valid = false;     ///< the stamp is on CLOCK_MONOTONIC
  bool stamp_is_start = false;  ///< stamps the start of exposure, else the end of the transfer
  bool error = false;
};

/// Buffers that must stay with the driver: one is filled, one read, a third waits.
inline constexpr std::size_t kKeptBuffers = 3;

/// A single-planar or multi-planar node; a node that is both is used as single-planar. For one
/// thread.
class V4l2Node {
 public:
  V4l2Node() = default;
  V4l2Node(V4l2Node&& other) noexcept { *this = std::move(other); }
  V4l2Node& operator=(V4l2Node&& other) noexcept;
  ~V4l2Node() { close(); }

  /// Opens the node at `path`. Errors: kNotFound, kDevice (no capture node), kIo.
  static Result<V4l2Node> open(const std::string& path);
  /// Selects and sets a mode; fills model, size, format, rate and controls of `info`.
  Result<V4l2Layout> configure(const StreamRequest& request, CameraInfo& info);
  /// Starts the stream. With `lends` it uses more buffers, exported as DMABUFs, unless the driver
  /// refuses.
  Result<void> start_streaming(bool lends = false);
  /// Waits for a picture; empty after `timeout`. Errors: kDevice when the node is gone.
  Result<std::optional<V4l2Picture>> next(Duration timeout);
  Result<void> give_back(const V4l2Picture& picture) { return queue(picture.index); }
  /// Lends the buffer of a picture, in place of give_back(), until LentPicture::recycle(). Returns
  /// false if it is not exported or the driver would be left with fewer than kKeptBuffers.
  bool lend(const V4l2Picture& picture, LentPicture& into);
  /// Queues the buffers that users have returned. Errors: kDevice when the node is gone.
  Result<void> give_back_lent();

  Result<void> set(CameraControl control, double value);
  Result<double> get(CameraControl control) const;
  bool is_open() const { return fd_ >= 0; }
  void close();

 private:
  struct Query;
  Error failed(const char* what) const;
  bool multi_planar() const;
  Result<void> map_buffer(std::uint32_t index, bool exports);
  void export_buffer(std::uint32_t index);
  Result<void> queue(std::uint32_t index);
  std::vector<V4l2Mode> modes() const;
  void add_sizes(std::uint32_t code, std::vector<V4l2Mode>& modes) const;
  double max_rate(std::uint32_t code, Size size) const;
  double set_rate(double rate_hz) const;
  bool set_hardware_trigger(bool on) const;
  std::vector<ControlRange> controls() const;
  bool write_control(std::uint32_t id, std::int32_t value) const;

  int fd_ = -1;
  std::string path_;
  std::uint32_t type_ = 0;  ///< type of its buffers
  std::size_t planes_ = 1;
  std::shared_ptr<V4l2Buffers> buffers_;  ///< null while nothing streams
  std::vector<std::uint32_t> returned_;
};

}  // namespace mixrig::device
