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

/// One filled buffer; its bytes are valid until give_back().
struct V4l2Picture {
  V4l2Bytes bytes{};  ///< of each plane
  std::size_t begin = 0;  ///< of the first plane's bytes in its buffer
  std::uint32_t index = 0, sequence = 0;
  HostTime stamp{};             ///< CLOCK_MONOTONIC as the driver stamped it
  bool stamp_valid = false;     ///< the stamp is of CLOCK_MONOTONIC
  bool stamp_is_start = false;  ///< of the start of exposure, else of the end of the transfer
  bool error = false;
};

/// The driver fills one while another is read and a third waits.
inline constexpr std::size_t kKeptBuffers = 3;

/// Of single-planar and multi-planar nodes; a node that is both is used as single-planar. For one
/// thread.
class V4l2Node {
 public:
  V4l2Node() = default;
  V4l2Node(V4l2Node&& other) noexcept { *this = std::move(other); }
  V4l2Node& operator=(V4l2Node&& other) noexcept;
  ~V4l2Node() { close(); }

  /// Errors: kNotFound, kDevice (no capture node), kIo.
  static Result<V4l2Node> open(const std::string& path);
  /// Selects and sets a mode; fills model, size, format, rate and controls of `info`.
  Result<V4l2Layout> configure(const StreamRequest& request, CameraInfo& info);
  /// `lends`: with more buffers, exported as DMABUFs; without these where the driver refuses.
  Result<void> start_streaming(bool lends = false);
  /// Waits for a picture; empty after `timeout`. Errors: kDevice when the node is gone.
  Result<std::optional<V4l2Picture>> next(Duration timeout);
  Result<void> give_back(const V4l2Picture& picture) { return queue(picture.index); }
  /// Lends out the buffer of a picture in place of give_back(), until LentPicture::recycle(); false
  /// where it is not exported, or the driver would be left with fewer than kKeptBuffers.
  bool lend(const V4l2Picture& picture, LentPicture& into);
  /// Gives the driver the buffers that are lent no longer. Errors: kDevice when the node is gone.
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
  std::uint32_t type_ = 0;  ///< of its buffers
  std::size_t planes_ = 1;
  std::shared_ptr<V4l2Buffers> buffers_;  ///< null while nothing streams
  std::vector<std::uint32_t> returned_;
};

}  // namespace mixrig::device
