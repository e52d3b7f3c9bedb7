// SPDX-License-Identifier: Apache-2.0
// Copies pixels out of the GPU through pixel pack buffers: started after a frame is drawn, fetched
// after its fence has passed.
#pragma once

#include <memory>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/render/gles/gl/gl_handles.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

/// Copies one attachment of a target to the host. Always used with the same format and size, so
/// that its buffer is allocated once.
class ReadBack {
 public:
  /// Queues a copy of attachment `index` and returns at once; reads floats, bytes, or bytes of all
  /// four channels.
  void start_float(const Target& target, int index) { start(target, index, GL_FLOAT, false); }
  void start_byte(const Target& target, int index) {
    start(target, index, GL_UNSIGNED_BYTE, false);
  }
  void start_rgba(const Target& target, int index) { start(target, index, GL_UNSIGNED_BYTE, true); }

  /// Fetches the first channel of the started copy; waits for the GPU if it has not finished.
  /// Errors: kDevice where the driver does not map the buffer.
  Result<void> fetch(ImageView<float> out) const { return fetch_first(out); }
  Result<void> fetch(ImageView<std::uint8_t> out) const { return fetch_first(out); }
  /// After start_rgba(): fetches colour and alpha separately; an empty view is not written.
  Result<void> fetch(ImageView<Rgb8> color, ImageView<std::uint8_t> alpha) const;

 private:
  void start(const Target& target, int index, GLenum type, bool all_channels);
  template <typename T>
  Result<void> fetch_first(ImageView<T> out) const;

  BufferHandle buffer_;
  Size size_;
  GLenum format_ = 0;  ///< read format: GL_RED or GL_RGBA; 0 before the first start
  std::size_t bytes_ = 0;
};

/// A point in the queue of the GPU.
class Fence {
 public:
  /// Inserts the fence after everything queued so far, and flushes the queue.
  void set();
  /// Returns once the GPU has passed the fence. Errors: kTimeout after ten seconds, kDevice where
  /// the context was lost.
  Result<void> wait() const;

 private:
  struct Delete {
    void operator()(GLsync sync) const { glDeleteSync(sync); }
  };
  std::unique_ptr<std::remove_pointer_t<GLsync>, Delete> sync_;
};

}  // namespace mixrig::render::gles
