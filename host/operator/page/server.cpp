// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/server.h"

#include <charconv>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/capture/take/streams/gst_pipeline.h"
#include "host/operator/page/connection.h"
#include "host/operator/page/event_socket.h"
#include "host/operator/page/hub.h"
#include "host/operator/page/osc/osc_port.h"
#include "host/operator/page/pictures/picture_sink.h"
#include "host/operator/page/pictures/picture_stream.h"
#include "host/operator/page/token_file.h"
#include "host/operator/page/webrtc/webrtc_socket.h"

namespace mixrig::page {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr auto kTellEvery = std::chrono::milliseconds(200);
constexpr auto kAcceptPause = std::chrono::milliseconds(100);
constexpr int kMostAcceptedAtOnce = 256;

std::string host_text(const asio::ip::address& address) {
  const std::string text = address.is_unspecified() ? asio::ip::host_name() : address.to_string();
  return text.find(':') != std::string::npos ? "[" + text + "]" : text;
}

}  // namespace

namespace {

Result<Listen> parse_address(std::string_view text, Listen listen, const Error& bad) {
  if (text.empty()) return listen;
  const std::size_t bracket = text.find(']');
  const std::size_t colon = text.find(':', bracket == std::string_view::npos ? 0 : bracket);
  std::string_view address = text.substr(0, colon);
  if (address.size() > 2 && address.front() == '[' && address.back() == ']')
    address = address.substr(1, address.size() - 2);
  if (address == "localhost") address = "127.0.0.1";
  boost::system::error_code error;
  asio::ip::make_address(std::string(address), error);
  if (error) return bad;
  listen.address = address;
  if (colon == std::string_view::npos) return listen;
  const char* const end = text.data() + text.size();
  const auto [at, code] = std::from_chars(text.data() + colon + 1, end, listen.port);
  if (code != std::errc() || at != end) return bad;
  return listen;
}

}  // namespace

Result<Listen> parse_listen(std::string_view text) {
  return parse_address(text, {},
                       {ErrorCode::kUsage, "--page " + std::string(text) +
                                               ": give ADDRESS:PORT, such as 127.0.0.1:8437"});
}

Result<void> check_proxied(std::string_view name) {
  constexpr std::string_view kOfName =
      "abcdefghijklmnopqrstuvwxyz0123456789-.ABCDEFGHIJKLMNOPQRSTUVWXYZ";
  const std::size_t end = std::min(name.find(':'), name.size());
  const std::string_view port = name.substr(std::min(end + 1, name.size()));
  if (end > 0 && name.substr(0, end).find_first_not_of(kOfName) == std::string_view::npos &&
      (end == name.size() || !port.empty()) &&
      port.find_first_not_of("0123456789") == std::string_view::npos)
    return {};
  return Error{ErrorCode::kUsage, "--page-proxy " + std::string(name) +
                                      ": give the proxy's HOST or HOST:PORT, such as rig.example"};
}

Result<Listen> parse_osc_listen(std::string_view text) {
  const bool port_alone =
      !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  return parse_address(port_alone ? "127.0.0.1:" + std::string(text) : std::string(text),
                       {"127.0.0.1", kDefaultOscPort},
                       {ErrorCode::kUsage, "--osc-in " + std::string(text) +
                                               ": give PORT or ADDRESS:PORT, such as 8438"});
}

struct Server::Impl {
  Impl(Operator& run, output::RunOrders& orders, const Clock& clock) : hub(run, orders, clock) {}
  ~Impl();

  Result<void> open(const Listen& listen);
  Result<void> open_osc(const Listen& listen);
  void accept();
  void accept_waiting(std::shared_ptr<Connection> first);
  void accept_later();
  void tell_later();
  Result<void> open_guard(const Listen& listen, bool loopback);
  void renew_token();
  void serve();

  Hub hub;
  tcp::acceptor acceptor{hub.io};
  asio::steady_timer timer{hub.io}, pause{hub.io};
  OscPort osc{hub};
  std::optional<TokenFile> token_file;
  std::string url, osc_text;
  std::uint16_t port = 0;
  std::thread thread;
};

Result<void> Server::Impl::open(const Listen& listen) {
  const tcp::endpoint wanted(asio::ip::make_address(listen.address), listen.port);
  boost::system::error_code error;
  acceptor.open(wanted.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(wanted, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) acceptor.non_blocking(true, error);
  if (error)
    return system_error(ErrorCode::kIo,
                        "cannot serve the page at " + listen.address + ":" +
                            std::to_string(listen.port) + ": choose another one by --page",
                        error.value());
  port = acceptor.local_endpoint().port();
  url = "http://" + host_text(wanted.address()) + ":" + std::to_string(port) + "/";
  return open_guard(listen, wanted.address().is_loopback());
}

/// Who may use the page. A token that has a file is not told by the address, which logs keep.
Result<void> Server::Impl::open_guard(const Listen& listen, bool loopback) {
  if (hub.guard.proxied = listen.proxied; !listen.proxied.empty())
    url = "https://" + listen.proxied + "/";
  if (!listen.token_file.empty()) {
    token_file.emplace(listen.token_file);
    MIXRIG_ASSIGN(hub.guard.token, token_file->read());
  } else if (!loopback || !listen.proxied.empty()) {
    hub.guard.token = random_token();
    url += "?token=" + hub.guard.token;
  }
  return {};
}

/// Takes a new token from its file. What was connected by the old one ends.
void Server::Impl::renew_token() {
  const auto token = token_file ? token_file->changed() : std::nullopt;
  if (!token) return;
  if (!*token) return log_warning("page", (*token).error().context + "; the old token stays");
  if (**token == hub.guard.token) return;
  hub.guard.token = **token;
  if (hub.osc != nullptr) osc.renew_prefix();
  hub.visitors.end_all();
  log_warning("page", "the token was renewed");
}

Result<void> Server::Impl::open_osc(const Listen& listen) {
  MIXRIG_TRY(osc.open(listen));
  hub.osc = &osc;
  osc_text = host_text(asio::ip::make_address(listen.address)) + ":" + std::to_string(osc.port()) +
             ", addresses begin with " + (listen.token_file.empty() ? osc.prefix() : "/TOKEN") +
             "/mixrig/";
  return {};
}

void Server::Impl::accept() {
  acceptor.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) return accept_later();
    accept_waiting(std::make_shared<Connection>(hub, std::move(socket)));
    accept();
  });
}

/// Accepts what waits behind `first`, and serves those that still have a place then: a host that
/// opens connections faster than they are served would fill the kernel's queue, behind which the
/// others wait.
void Server::Impl::accept_waiting(std::shared_ptr<Connection> first) {
  std::vector<std::shared_ptr<Connection>> came{std::move(first)};
  for (int i = 0; i < kMostAcceptedAtOnce; ++i) {
    boost::system::error_code none;
    tcp::socket socket = acceptor.accept(none);
    if (none) break;
    came.push_back(std::make_shared<Connection>(hub, std::move(socket)));
  }
  for (const auto& connection : came)
    if (connection->is_open()) connection->read_header();
}

/// Accepts again after a pause. Where no file descriptor is free, a waiting connection would fail
/// again at once, and the loop would use all of a core.
void Server::Impl::accept_later() {
  pause.expires_after(kAcceptPause);
  pause.async_wait([this](boost::system::error_code error) {
    if (!error) accept();
  });
}

void Server::Impl::tell_later() {
  timer.expires_after(kTellEvery);
  timer.async_wait([this](boost::system::error_code error) {
    if (error) return;
    hub.visitors.end_late(hub.clock.now());
    renew_token();
    hub.tell();
    tell_later();
  });
}

/// Serves until the end. An exception of a handler (no memory) only ends its connection.
void Server::Impl::serve() {
  for (;;) {
    const Result<void> done = guarded("a connection", [this] { hub.io.run(); });
    if (done) return;
    log_warning("page", done.error().context);
  }
}

Server::Impl::~Impl() {
  hub.pictures->set_on_new({});
  hub.io.stop();
  if (thread.joinable()) thread.join();
  hub.outlet->close();
  for (WebrtcSocket* socket : hub.peer_sockets) socket->end();
  for (asio::thread_pool* work : {&hub.work, &hub.take_work}) {
    work->stop();
    work->join();
  }
  hub.peer_work.join();
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::start(Operator& run, output::RunOrders& orders,
                                              const Clock& clock, const Listen& listen,
                                              const std::optional<Listen>& osc_in) {
  // No WebRTC peer or recording then waits for plug-ins while frames come.
  MIXRIG_TRY(take::start_gstreamer());
  auto impl = std::make_unique<Impl>(run, orders, clock);
  MIXRIG_TRY(impl->open(listen));
  if (osc_in) MIXRIG_TRY(impl->open_osc(*osc_in));
  Impl* const all = impl.get();
  all->hub.pictures->set_on_new([all](View view) {
    asio::post(all->hub.io, [all, view] {
      for (PictureStream* stream : std::set(all->hub.streams)) stream->on_picture(view);
    });
  });
  all->accept();
  all->tell_later();
  all->thread = std::thread([all] { all->serve(); });
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

const std::string& Server::url() const { return impl_->url; }
std::uint16_t Server::port() const { return impl_->port; }
const std::string& Server::osc_text() const { return impl_->osc_text; }
std::uint16_t Server::osc_port() const { return impl_->osc.port(); }

std::unique_ptr<output::CompositeSink> Server::make_sink() const {
  return std::make_unique<PictureSink>(impl_->hub.pictures);
}

}  // namespace mixrig::page
