// SPDX-License-Identifier: Apache-2.0
// A WebSocket whose messages are text. Private to this module.
#pragma once

#include <deque>
#include <memory>
#include <string>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "host/operator/page/hub.h"

namespace mixrig::page {

/// Sends and receives text messages. A client that asks faster than it reads (64 messages wait) is
/// disconnected. The object lives while it is read from or written to. Used on the server's thread.
class TextSocket : public std::enable_shared_from_this<TextSocket> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  TextSocket(Hub& hub, boost::beast::tcp_stream stream, std::size_t most_message);
  virtual ~TextSocket();
  void open(Request request);
  void send(std::string message);
  void close();

 protected:
  virtual void on_open() = 0;
  virtual void on_message(const std::string& message) = 0;
  /// Called once, when the other side has closed or close() was called.
  virtual void on_end() {}
  boost::asio::ip::address local_address() const;
  bool writes() const { return !queue_.empty(); }

  Hub& hub_;

 private:
  void read();
  void write_next();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Visitors::Place place_;
  boost::beast::flat_buffer buffer_;
  Request request_;
  std::deque<std::string> queue_;  ///< the first one is being written
};

}  // namespace mixrig::page
