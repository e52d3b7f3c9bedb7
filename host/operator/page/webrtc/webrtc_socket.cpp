// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/webrtc/webrtc_socket.h"

#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "host/operator/page/json_body.h"

namespace mixrig::page {
namespace {

std::string event(nlohmann::json data) {
  return to_text({{"type", "event"}, {"data", std::move(data)}});
}

/// Text of an address; an IPv4 address that is mapped to IPv6 is written as IPv4.
std::string address_text(const boost::asio::ip::address& address) {
  namespace ip = boost::asio::ip;
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return ip::make_address_v4(ip::v4_mapped, address.to_v6()).to_string();
  return address.to_string();
}

}  // namespace

WebrtcSocket::WebrtcSocket(Hub& hub, boost::beast::tcp_stream stream, View view)
    : TextSocket(hub, std::move(stream), kMostPeerMessage), view_(view) {
  hub_.peer_sockets.insert(this);
}

WebrtcSocket::~WebrtcSocket() {
  end();
  hub_.peer_sockets.erase(this);
}

void WebrtcSocket::on_open() {
  if (hub_.peers >= kMostPeers)
    return refuse("two browsers are sent pictures by WebRTC: that is the most");
  ++hub_.peers;
  hub_.post_peer_work(
      [self = weak(), &hub = hub_, outlet = hub_.outlet, address = address_text(local_address())] {
        Result<std::shared_ptr<WebrtcPeer>> made = std::shared_ptr<WebrtcPeer>();
        const auto on_offer = [self, outlet](Result<std::string> offer) {
          outlet->post([self, offer = std::move(offer)]() mutable {
            if (const auto socket = self.lock()) socket->told(std::move(offer));
          });
        };
        const Result<void> done =
            guarded("WebRTC", [&] { made = WebrtcPeer::create(address, on_offer); });
        if (!done) made = done.error();
        outlet->post([self, &hub, made = std::move(made)]() mutable {
          if (const auto socket = self.lock(); socket && !socket->ended_)
            return socket->begin(std::move(made));
          hub.end_peer(made ? *std::move(made) : nullptr);
        });
      });
}

void WebrtcSocket::begin(Result<std::shared_ptr<WebrtcPeer>> made) {
  if (!made) {
    hub_.end_peer(nullptr);
    return refuse(to_line(made.error()));
  }
  peer_ = *std::move(made);
  taker_ = hub_.pictures->add_taker(
      view_, [self = weak(), peer = peer_, outlet = hub_.outlet, &clock = hub_.clock](
                 ImageView<const Rgb8> picture, int frame, HostTime mid_exposure) {
        outlet->post([self, frame, mid_exposure, rtp = peer->put(picture, clock.now())] {
          if (const auto socket = self.lock()) socket->tell_picture(frame, mid_exposure, rtp);
        });
      });
  if (offer_) told(*std::exchange(offer_, std::nullopt));
}

void WebrtcSocket::told(Result<std::string> offer) {
  if (ended_) return;
  if (!peer_) {
    offer_ = std::move(offer);
    return;
  }
  if (offer) return send(event({{"action", "offer"}, {"sdp", *offer}}));
  refuse(to_line(offer.error()));
  end();
}

void WebrtcSocket::on_message(const std::string& text) {
  const auto message = parse_peer_message(text);
  if (!message) return refuse(to_line(message.error()));
  if (const auto* view = std::get_if<View>(&*message)) {
    view_ = *view;
    if (taker_) hub_.pictures->set_view(*taker_, view_);
    return;
  }
  if (!peer_ || answered_) return refuse("there is no offer to answer");
  answered_ = true;
  hub_.post_peer_work(
      [peer = peer_, answer = std::get<WebrtcAnswer>(*message)] { peer->take(answer); });
}

void WebrtcSocket::refuse(const std::string& why) {
  send(event({{"action", "refused"}, {"error", why}}));
}

void WebrtcSocket::tell_picture(int frame, HostTime mid_exposure,
                                std::optional<std::uint32_t> rtp) {
  if (ended_) return;
  if (!rtp) return told(Error{ErrorCode::kIo, "WebRTC: the browser takes no more pictures"});
  send(fmt::format(R"({{"type":"event","data":{{"action":"picture","frame":{},)"
                   R"("captured_ms":{:.3f},"rtp":{}}}}})",
                   frame, milliseconds(mid_exposure.time_since_epoch()), *rtp));
}

void WebrtcSocket::end() {
  ended_ = true;
  if (taker_) hub_.pictures->remove_taker(*std::exchange(taker_, std::nullopt));
  if (peer_) hub_.end_peer(std::exchange(peer_, nullptr));
}

}  // namespace mixrig::page
