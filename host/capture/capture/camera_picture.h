// SPDX-License-Identifier: Apache-2.0
// A plate that is still in its camera's buffer and is decoded on first use.
#pragma once

#include <mutex>
#include <optional>

#include "hal/base/image.h"
#include "hal/base/raw_picture.h"
#include "hal/device/frame.h"
#include "host/capture/capture/decode.h"

namespace mixrig::capture {

/// A camera's picture in its own buffer, for a Pool: nothing is allocated in later uses of an
/// object. Call hold() and recycle() from one thread while nobody else has the object; any thread
/// may call the others.
class CameraPicture {
 public:
  /// Holds a frame of the camera that `decoder` belongs to; all calls have the same decoder.
  /// Returns false, and holds nothing, if the frame's memory is not shared or it has no raw() form.
  bool hold(const device::FramePtr& frame, const ColorDecoder& decoder);
  /// Drops the frame, so that its driver may fill the buffer again.
  void recycle();

  /// Returns the picture in the camera's format. Precondition of raw() and decoded(): a frame is
  /// held.
  const RawPicture& raw() const { return *raw_; }
  /// Returns the picture as ColorDecoder::decode() makes it; the first call decodes it.
  const Image<Rgb8>& decoded() const;

 private:
  device::FramePtr frame_;
  std::optional<RawPicture> raw_;
  mutable std::mutex mutex_;  ///< guards the members below
  mutable std::optional<ColorDecoder> decoder_;
  mutable Image<Rgb8> image_;
  mutable bool is_decoded_ = false;
};

}  // namespace mixrig::capture
