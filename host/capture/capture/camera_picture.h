// SPDX-License-Identifier: Apache-2.0
// A plate that still lies in its camera's buffer, and is decoded where somebody looks at it.
#pragma once

#include <mutex>
#include <optional>

#include "hal/base/image.h"
#include "hal/base/raw_picture.h"
#include "hal/device/frame.h"
#include "host/capture/capture/decode.h"

namespace mixrig::capture {

/// Made for a Pool: nothing is allocated in later uses of an object. hold() and recycle() are for
/// one thread while nobody else has the object, the others for any.
class CameraPicture {
 public:
  /// Takes a frame of the camera that `decoder` is of; all calls have the same. False, and nothing
  /// is held, where its memory is not shared or it has no raw() form.
  bool hold(const device::FramePtr& frame, const ColorDecoder& decoder);
  /// Drops the frame, whose buffer its driver may fill again then.
  void recycle();

  /// Precondition of both: it holds a frame.
  const RawPicture& raw() const { return *raw_; }
  /// sRGB, as ColorDecoder::decode() makes it; decoded by the first call.
  const Image<Rgb8>& decoded() const;

 private:
  device::FramePtr frame_;
  std::optional<RawPicture> raw_;
  mutable std::mutex mutex_;  ///< guards what follows
  mutable std::optional<ColorDecoder> decoder_;
  mutable Image<Rgb8> image_;
  mutable bool is_decoded_ = false;
};

}  // namespace mixrig::capture
