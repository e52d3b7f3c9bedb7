// SPDX-License-Identifier: Apache-2.0
// Sends one picture, or a stream of them (MJPEG), to one client. Private to this module.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "host/operator/page/hub.h"

namespace mixrig::page {

/// Sends the newest picture when the client has taken the one before; a slow client misses some,
/// and holds no more than one. Each part has X-Frame (number of the capture), X-Captured-Ms (its
/// mid-exposure on the host's clock) and X-Age-Ms (at the time of sending). Used on the server's
/// thread.
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
  Visitors::Place place_;
  const GetPicture wanted_;
  boost::asio::steady_timer patience_;  ///< time limit for a single picture
  bool writing_ = false;
  std::uint64_t sent_ = 0;  ///< serial of the last picture sent
  std::string head_;
  PicturePtr sending_;
  char ignored_ = 0;
};

}  // namespace mixrig::page
