// SPDX-License-Identifier: Apache-2.0
// One client that looks at pictures: one of them, or a stream (MJPEG). Private to this module.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "host/operator/page/hub.h"

namespace mixrig::page {

/// A client gets the newest picture when it has taken the one before: a slow one misses some, and
/// holds no more than one. Each part has X-Frame (number of the capture), X-Captured-Ms (its
/// mid-exposure on the host's clock) and X-Age-Ms (at the time of sending). On the server's thread.
class PictureStream : public std::enable_shared_from_this<PictureStream> {
 public:
  PictureStream(Hub& hub, boost::beast::tcp_stream stream, GetPicture wanted);
  ~PictureStream();
  void start();
  void on_picture(View view);

 private:
  void wait_for_end();
  void send_head();
  void send_newest();
  void send_one(const Picture& picture);
  void send_none();
  template <typename Buffers>
  void write(const Buffers& buffers, bool last);

  Hub& hub_;
  boost::beast::tcp_stream stream_;
  const GetPicture wanted_;
  boost::asio::steady_timer patience_;  ///< for a single picture
  bool writing_ = false;
  std::uint64_t sent_ = 0;  ///< serial of the last one
  std::string head_;
  PicturePtr sending_;
  char ignored_ = 0;
};

}  // namespace mixrig::page
