// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/pictures/picture_stream.h"

#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

namespace mixrig::page {

namespace asio = boost::asio;
namespace beast = boost::beast;

namespace {

constexpr auto kMostWrite = std::chrono::seconds(10);  ///< a client that takes nothing is closed
constexpr auto kMostWait = std::chrono::seconds(2);    ///< for a single picture

std::string fields_of(const Picture& picture, const Clock& clock) {
  return fmt::format(
      "Content-Type: image/jpeg\r\nContent-Length: {}\r\nX-Frame: {}\r\nX-Captured-Ms: {:.3f}\r\n"
      "X-Age-Ms: {:.3f}\r\n\r\n",
      picture.jpeg.size(), picture.frame, milliseconds(picture.mid_exposure.time_since_epoch()),
      milliseconds(clock.now() - picture.mid_exposure));
}

std::string status_line(std::string_view status) {
  std::string head = fmt::format("HTTP/1.1 {}\r\nConnection: close\r\n", status);
  for (const auto& [name, value] : common_headers()) head += name + ": " + value + "\r\n";
  return head;
}

}  // namespace

PictureStream::PictureStream(Hub& hub, beast::tcp_stream stream, GetPicture wanted)
    : hub_(hub),
      stream_(std::move(stream)),
      place_(hub.visitors, remote_address(stream_.socket()), hub.clock.now(),
             [this] { stream_.close(); }),
      wanted_(wanted),
      patience_(hub.io) {
  place_.stay();
  // A single picture is one that is made from now on: the last one may be old.
  const PicturePtr last = hub_.pictures->newest(wanted_.view);
  if (last && !wanted_.stream && !hub_.pictures->frozen()) sent_ = last->serial;
  hub_.streams.insert(this);
  hub_.pictures->look(wanted_.view);
}

PictureStream::~PictureStream() {
  hub_.streams.erase(this);
  hub_.pictures->look_away(wanted_.view);
}

void PictureStream::start() {
  // Keeps the kernel's buffer small, since buffered pictures arrive late.
  boost::system::error_code ignored;
  stream_.socket().set_option(asio::socket_base::send_buffer_size(64 << 10), ignored);
  stream_.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  stream_.expires_never();
  wait_for_end();
  if (wanted_.stream) return send_head();
  patience_.expires_after(kMostWait);
  patience_.async_wait([self = shared_from_this()](boost::system::error_code error) {
    if (!error && !self->writing_) self->send_none();
  });
  send_newest();
}

/// Waits for the client to close. It sends nothing more, so a read ends only then.
void PictureStream::wait_for_end() {
  stream_.async_read_some(asio::buffer(&ignored_, 1),
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            if (!error) return self->wait_for_end();
                            self->patience_.cancel();
                            self->stream_.close();
                            self->hub_.streams.erase(self.get());
                          });
}

void PictureStream::send_head() {
  head_ = status_line("200 OK") + "Content-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n";
  write(asio::buffer(head_), false);
}

void PictureStream::on_picture(View view) {
  if (view == wanted_.view && !writing_) send_newest();
}

void PictureStream::send_newest() {
  const PicturePtr newest = hub_.pictures->newest(wanted_.view);
  if (!newest || newest->serial <= sent_) return;
  sending_ = newest, sent_ = newest->serial;
  head_ = (wanted_.stream ? "--frame\r\n" : status_line("200 OK")) + fields_of(*newest, hub_.clock);
  patience_.cancel();
  const std::array<asio::const_buffer, 3> parts{asio::buffer(head_), asio::buffer(newest->jpeg),
                                                asio::buffer("\r\n", wanted_.stream ? 2U : 0U)};
  write(parts, !wanted_.stream);
}

void PictureStream::send_none() {
  const std::string body = R"({"error":"no picture came within 2 s"})";
  head_ = status_line("503 Service Unavailable") +
          fmt::format("Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{}", body.size(),
                      body);
  write(asio::buffer(head_), true);
}

template <typename Buffers>
void PictureStream::write(const Buffers& buffers, bool last) {
  writing_ = true;
  stream_.expires_after(kMostWrite);
  asio::async_write(
      stream_, buffers, [self = shared_from_this(), last](beast::error_code error, std::size_t) {
        self->writing_ = false;
        self->sending_.reset();
        if (error || last) {
          self->patience_.cancel();
          boost::system::error_code ignored;
          self->stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
          self->stream_.close();
          return;
        }
        self->send_newest();
      });
}

}  // namespace mixrig::page
