// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/camera_picture.h"

namespace mixrig::capture {

bool CameraPicture::hold(const device::FramePtr& frame, const ColorDecoder& decoder) {
  recycle();
  if (!frame->memory) return false;
  if (!decoder_) decoder_ = decoder;
  raw_ = decoder_->raw(*frame);
  if (raw_) frame_ = frame;
  return raw_.has_value();
}

void CameraPicture::recycle() {
  raw_.reset();
  frame_.reset();
  is_decoded_ = false;
}

const Image<Rgb8>& CameraPicture::decoded() const {
  const std::lock_guard lock(mutex_);
  // raw() has checked that the bytes are complete, the only condition of decode() for such a
  // format.
  if (!is_decoded_) (void)decoder_->decode(*frame_, image_);
  is_decoded_ = true;
  return image_;
}

}  // namespace mixrig::capture
