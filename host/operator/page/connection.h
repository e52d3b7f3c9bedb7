// SPDX-License-Identifier: Apache-2.0
// One HTTP connection of the page. Private to this module.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/file_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "host/operator/page/hub.h"

namespace mixrig::page {

/// Reads requests one after the other, and answers them. Used on the server's thread.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Hub& hub, boost::asio::ip::tcp::socket socket);
  ~Connection();
  void read_header();
  /// False once its place was given to another one.
  bool is_open() const { return stream_.socket().is_open(); }

 private:
  void on_header(boost::beast::error_code error);
  void serve(const Request& request);
  void read_body(Change change);
  void read_upload(const std::string& name);
  void act(Action action);
  void send(const Answer& answer, bool close = false);
  void answer(const Result<void>& done);
  void drain();
  bool has_body() const;

  Hub& hub_;
  boost::beast::tcp_stream stream_;
  Visitors::Place place_;
  bool admitted_ = false;  ///< a request was permitted
  int waits_ = 0;          ///< turns of the loop in which a request waited for a place
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> header_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> body_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::file_body>> upload_;
  boost::beast::http::response<boost::beast::http::string_body> response_;
  std::filesystem::path folder_;  ///< folder of the upload; empty: none
};

}  // namespace mixrig::page
