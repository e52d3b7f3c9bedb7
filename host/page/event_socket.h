// SPDX-License-Identifier: Apache-2.0
// One client of the event socket. Private to this room.
#pragma once

#include <deque>
#include <memory>
#include <string>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "host/page/events.h"
#include "host/page/hub.h"

namespace mixrig::page {

/// A client that is slow to read misses values in between, and is told the newest; one that asks
/// faster than it reads is closed. On the server's thread.
class EventSocket : public std::enable_shared_from_this<EventSocket> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  EventSocket(Hub& hub, boost::beast::tcp_stream stream);
  ~EventSocket();
  void open(Request request);
  void tell(const nlohmann::json& state);

 private:
  void read();
  void send(std::string message);
  void write_next();
  void close();

  Hub& hub_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer buffer_;
  Request request_;
  Subscriptions subscriptions_;
  std::deque<std::string> queue_;  ///< the first is being written
};

}  // namespace mixrig::page
