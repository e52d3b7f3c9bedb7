// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/text_socket.h"

#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>

namespace mixrig::page {

namespace beast = boost::beast;

TextSocket::TextSocket(Hub& hub, beast::tcp_stream stream, std::size_t most_message)
    : hub_(hub),
      socket_(std::move(stream)),
      place_(hub.visitors, remote_address(beast::get_lowest_layer(socket_).socket()),
             hub.clock.now(), [this] { close(); }) {
  socket_.read_message_max(most_message);
  place_.stay();
}

TextSocket::~TextSocket() = default;

void TextSocket::open(Request request) {
  request_ = std::move(request);
  beast::get_lowest_layer(socket_).expires_never();  // the socket has time-outs of its own
  socket_.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
  socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
    if (error) return self->on_end();
    self->on_open();
    self->read();
  });
}

void TextSocket::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) return self->on_end();
    const std::string message = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    self->on_message(message);
    self->read();
  });
}

void TextSocket::send(std::string message) {
  constexpr std::size_t kMostWaiting = 64;
  if (queue_.size() >= kMostWaiting) return close();
  queue_.push_back(std::move(message));
  if (queue_.size() == 1) write_next();
}

void TextSocket::write_next() {
  socket_.text(true);
  socket_.async_write(boost::asio::buffer(queue_.front()),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (error) return self->close();
                        self->queue_.pop_front();
                        if (!self->queue_.empty()) self->write_next();
                      });
}

void TextSocket::close() { beast::get_lowest_layer(socket_).close(); }

boost::asio::ip::address TextSocket::local_address() const {
  boost::system::error_code ignored;
  return beast::get_lowest_layer(socket_).socket().local_endpoint(ignored).address();
}

}  // namespace mixrig::page
