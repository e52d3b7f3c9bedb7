// SPDX-License-Identifier: Apache-2.0
#include "host/page/event_socket.h"

#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>

namespace mixrig::page {

namespace beast = boost::beast;

EventSocket::EventSocket(Hub& hub, beast::tcp_stream stream)
    : hub_(hub), socket_(std::move(stream)) {
  hub_.sockets.insert(this);
  ++hub_.connections;
}

EventSocket::~EventSocket() {
  hub_.sockets.erase(this);
  --hub_.connections;
}

void EventSocket::open(Request request) {
  request_ = std::move(request);
  beast::get_lowest_layer(socket_).expires_never();  // the socket has time-outs of its own
  socket_.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
  socket_.read_message_max(kMostMessage);
  socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
    if (error) return;
    self->send(opened_message());
    self->read();
  });
}

void EventSocket::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) return;
    const std::string message = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    const double host_ms = milliseconds(self->hub_.clock.now().time_since_epoch());
    self->send(self->subscriptions_.answer(message, self->hub_.state(), host_ms));
    self->read();
  });
}

void EventSocket::tell(const nlohmann::json& state) {
  if (!queue_.empty()) return;  // it has not read what it was told; the next time is soon
  for (const std::string& part : subscriptions_.changed(state))
    send(changed_message(part, state.at(part)));
}

void EventSocket::send(std::string message) {
  constexpr std::size_t kMostWaiting = 64;
  if (queue_.size() >= kMostWaiting) return close();
  queue_.push_back(std::move(message));
  if (queue_.size() == 1) write_next();
}

void EventSocket::write_next() {
  socket_.text(true);
  socket_.async_write(boost::asio::buffer(queue_.front()),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (error) return self->close();
                        self->queue_.pop_front();
                        if (!self->queue_.empty()) self->write_next();
                      });
}

void EventSocket::close() { beast::get_lowest_layer(socket_).close(); }

}  // namespace mixrig::page
