// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/hub.h"

#include <utility>

#include <boost/asio/post.hpp>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/math/image_io/jpeg_write.h"
#include "host/operator/page/event_socket.h"
#include "host/operator/page/osc/osc_port.h"
#include "host/operator/page/webrtc/webrtc_peer.h"

namespace mixrig::page {
namespace {

/// JPEG of a picture of a recording.
Result<std::string> take_jpeg(Operator& op, const GetTakePicture& wanted) {
  constexpr int kQuality = 85;
  std::string jpeg;
  MIXRIG_TRY(guarded("a picture of a take", [&]() -> Result<void> {
    MIXRIG_ASSIGN(const Image<Rgb8> picture, op.take_picture(wanted.take, wanted.frame));
    MIXRIG_ASSIGN(jpeg, image_io::encode_jpeg(picture.view(), kQuality));
    return {};
  }));
  return jpeg;
}

}  // namespace

std::string remote_address(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code error;
  const auto other = socket.remote_endpoint(error);
  return error ? std::string() : other.address().to_string();
}

bool is_of_this_machine(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code error;
  const auto other = socket.remote_endpoint(error);
  return !error && other.address().is_loopback();
}

void Outlet::post(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  if (io_ != nullptr) boost::asio::post(*io_, std::move(work));
}

void Outlet::close() {
  const std::lock_guard lock(mutex_);
  io_ = nullptr;
}

void Hub::end_peer(std::shared_ptr<WebrtcPeer> peer) {
  post_peer_work([this, peer = std::move(peer)]() mutable {
    peer.reset();
    outlet->post([this] { --peers; });
  });
}

void Hub::post_peer_work(std::function<void()> task) {
  boost::asio::post(peer_work, [task = std::move(task)] {
    const Result<void> done = guarded("work of WebRTC", task);
    if (!done) log_warning("page", done.error().context);
  });
}

nlohmann::json Hub::state() const {
  const output::RunState run = orders.state();
  return to_json(op.state(), {run.view, run.frozen, static_cast<int>(sockets.size())});
}

void Hub::act(Action action, std::function<void(Result<void>)> done) {
  if (const auto* order = std::get_if<output::RunOrder>(&action)) {
    auto given = orders.give(*order);
    tell();
    return done(std::move(given));
  }
  auto* command = std::get_if<Command>(&action);
  if (at_work >= kMostAtWork)
    return done(Error{ErrorCode::kData, "64 changes are waiting: send them more slowly"});
  ++at_work;
  boost::asio::post(work, [this, command = std::move(*command), done = std::move(done)]() mutable {
    auto result =
        std::make_shared<Result<void>>(guarded("a change", [&] { return op.apply(command); }));
    boost::asio::post(io, [this, result, done = std::move(done)] {
      --at_work;
      tell();
      done(std::move(*result));
    });
  });
}

void Hub::get_take_picture(GetTakePicture wanted, std::function<void(Result<std::string>)> done) {
  if (take_pictures >= kMostTakePictures)
    return done(Error{ErrorCode::kData, "8 pictures of takes are waiting: ask more slowly"});
  ++take_pictures;
  boost::asio::post(take_work,
                    [this, wanted = std::move(wanted), done = std::move(done)]() mutable {
                      auto result = std::make_shared<Result<std::string>>(take_jpeg(op, wanted));
                      boost::asio::post(io, [this, result, done = std::move(done)] {
                        --take_pictures;
                        done(std::move(*result));
                      });
                    });
}

void Hub::tell() {
  if (sockets.empty() && osc == nullptr) return;
  const nlohmann::json now = state();
  for (EventSocket* socket : std::set(sockets)) socket->tell(now);
  if (osc != nullptr) osc->tell(now);
}

}  // namespace mixrig::page
