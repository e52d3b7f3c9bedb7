// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/connection.h"

#include <cstdlib>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "host/operator/page/event_socket.h"
#include "host/operator/page/files.h"
#include "host/operator/page/json_body.h"
#include "host/operator/page/pictures/picture_stream.h"
#include "host/operator/page/webrtc/webrtc_socket.h"

namespace mixrig::page {

namespace beast = boost::beast;
namespace http = boost::beast::http;

namespace {

constexpr std::uint32_t kMostHeader = 8 << 10;
constexpr std::size_t kMostBuffer = 64 << 10;
constexpr auto kMostIdle = std::chrono::seconds(30);
constexpr auto kMostDrain = std::chrono::seconds(2);
constexpr int kMostWaits = 4;  ///< an answer takes one turn of the loop, a stream keeps its place
constexpr auto kMostUploadTime = std::chrono::seconds(120);

Method method_of(http::verb verb) {
  switch (verb) {
    case http::verb::get:
      return Method::kGet;
    case http::verb::put:
      return Method::kPut;
    case http::verb::post:
      return Method::kPost;
    case http::verb::delete_:
      return Method::kDelete;
    default:
      return Method::kOther;
  }
}

/// Whether a header field that decides on a request comes more than once.
template <typename Fields>
bool has_doubles(const Fields& fields) {
  for (const http::field field :
       {http::field::host, http::field::origin, http::field::content_type,
        http::field::authorization, http::field::cookie, http::field::content_length})
    if (fields.count(field) > 1) return true;
  return false;
}

template <typename Header>
Request request_of(const Header& header, bool from_here) {
  const auto text = [](beast::string_view view) { return std::string(view.data(), view.size()); };
  return {method_of(header.method()),
          text(header.target()),
          text(header[http::field::host]),
          text(header[http::field::origin]),
          text(header[http::field::content_type]),
          text(header[http::field::authorization]),
          text(header[http::field::cookie]),
          text(header["Sec-Fetch-Site"]),
          from_here};
}

Answer answer_of_read(beast::error_code error) {
  if (error == http::error::header_limit) return refusal(431, "the header is larger than 8 KiB");
  if (error == http::error::body_limit) return refusal(413, "the body is too large");
  return refusal(400, "this is no HTTP request");
}

/// Whether the message is at fault and the client is still there to get an answer.
bool is_http_fault(beast::error_code error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

}  // namespace

Connection::Connection(Hub& hub, boost::asio::ip::tcp::socket socket)
    : hub_(hub),
      stream_(std::move(socket)),
      place_(hub.visitors, remote_address(stream_.socket()), hub.clock.now(),
             [this] { stream_.close(); }),
      buffer_(kMostBuffer) {}

Connection::~Connection() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void Connection::read_header() {
  body_.reset();
  header_.emplace();
  header_->header_limit(kMostHeader);
  header_->body_limit(kMostUpload);
  stream_.expires_after(kMostIdle);
  place_.wait();
  http::async_read_header(stream_, buffer_, *header_,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            self->on_header(error);
                          });
}

bool Connection::has_body() const {
  return header_->chunked() || header_->content_length_remaining().value_or(0) > 0;
}

void Connection::on_header(beast::error_code error) {
  if (error && is_http_fault(error)) return send(answer_of_read(error), true);
  if (error) return stream_.close();
  if (has_doubles(header_->get())) return send(refusal(400, "a header field is given twice"), true);
  const Request request = request_of(header_->get(), is_of_this_machine(stream_.socket()));
  if (const auto visit = first_visit(hub_.guard, request)) return send(*visit, has_body());
  if (const auto refused = refuse(hub_.guard, request)) return send(*refused, has_body());
  admitted_ = place_.admit();
  if (!admitted_ && waits_++ < kMostWaits)
    return boost::asio::post(hub_.io, [self = shared_from_this()] { self->on_header({}); });
  if (!admitted_)
    return send(refusal(503, "16 connections of this address are in use: close another page"),
                true);
  waits_ = 0;
  if (request.method == Method::kGet && has_body())
    return send(refusal(400, "a GET has no body"), true);
  serve(request);
}

void Connection::serve(const Request& request) {
  Route route = route_of(request.method, request.target);
  if (const auto* answer = std::get_if<Answer>(&route)) return send(*answer, has_body());
  if (const auto* file = std::get_if<GetFile>(&route)) return send(file_answer(file->name));
  if (const auto* wanted = std::get_if<GetState>(&route)) {
    const nlohmann::json state = hub_.state();
    return send({200,
                 "application/json",
                 to_text(wanted->part.empty() ? state : state.at(wanted->part)),
                 {}});
  }
  if (const auto* picture = std::get_if<GetPicture>(&route))
    return std::make_shared<PictureStream>(hub_, std::move(stream_), *picture)->start();
  if (auto* wanted = std::get_if<GetTakePicture>(&route))
    return hub_.get_take_picture(std::move(*wanted), [self = shared_from_this()](
                                                         Result<std::string> jpeg) {
      self->send(jpeg ? Answer{200, "image/jpeg", *std::move(jpeg), {}} : refusal(jpeg.error()));
    });
  const auto* watched = std::get_if<WatchPicture>(&route);
  if (watched != nullptr || std::holds_alternative<OpenEvents>(route)) {
    if (!beast::websocket::is_upgrade(header_->get()))
      return send(refusal(426, "this address is a WebSocket"));
    std::shared_ptr<TextSocket> socket;
    if (watched != nullptr)
      socket = std::make_shared<WebrtcSocket>(hub_, std::move(stream_), watched->view);
    else
      socket = std::make_shared<EventSocket>(hub_, std::move(stream_));
    return socket->open(header_->release());
  }
  if (const auto* upload = std::get_if<Upload>(&route)) return read_upload(upload->name);
  read_body(std::get<Change>(std::move(route)));
}

void Connection::read_body(Change change) {
  if (header_->content_length_remaining().value_or(0) > kMostBody)
    return send(refusal(413, "the body is larger than 64 KiB"), true);
  body_.emplace(std::move(*header_));
  body_->body_limit(kMostBody);
  http::async_read(stream_, buffer_, *body_,
                   [self = shared_from_this(), change = std::move(change)](beast::error_code error,
                                                                           std::size_t) {
                     if (error && is_http_fault(error))
                       return self->send(answer_of_read(error), true);
                     if (error) return self->stream_.close();
                     auto action = action_of(change, self->body_->get().body());
                     if (!action) return self->send(refusal(action.error()));
                     self->act(*std::move(action));
                   });
}

/// Reads a model into a temporary file, not into memory.
void Connection::read_upload(const std::string& name) {
  std::string pattern = (std::filesystem::temp_directory_path() / "mixrig-page-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    return send(refusal(507, "there is no room for a temporary file"), true);
  folder_ = pattern;
  upload_.emplace(std::move(*header_));
  upload_->body_limit(kMostUpload);
  beast::error_code opened;
  const std::filesystem::path file = folder_ / "upload.glb";
  upload_->get().body().open(file.c_str(), beast::file_mode::write, opened);
  if (opened) return send(refusal(507, "there is no room for a temporary file"), true);
  stream_.expires_after(kMostUploadTime);
  http::async_read(stream_, buffer_, *upload_,
                   [self = shared_from_this(), name, file](beast::error_code error, std::size_t) {
                     self->upload_->get().body().close();
                     if (error && is_http_fault(error))
                       return self->send(answer_of_read(error), true);
                     if (error) return self->stream_.close();
                     self->act(Action(Command(AddObject{name, file})));
                   });
}

void Connection::act(Action action) {
  hub_.act(std::move(action), [self = shared_from_this()](const Result<void>& done) {
    std::error_code ignored;
    if (!self->folder_.empty()) std::filesystem::remove_all(self->folder_, ignored);
    self->folder_.clear();
    self->upload_.reset();
    self->answer(done);
  });
}

/// Reads for a while what the client still sends, so that the answer is not lost with a reset.
void Connection::drain() {
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(kMostBuffer),
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            if (!error) self->drain();
                          });
}

void Connection::answer(const Result<void>& done) {
  if (!done) return send(refusal(done.error()));
  send({200, "application/json", R"({"success":true})", {}});
}

void Connection::send(const Answer& answer, bool close) {
  response_ = {};
  response_.result(static_cast<unsigned>(answer.status));
  response_.set(http::field::content_type, answer.content_type);
  for (const auto& [name, value] : common_headers()) response_.set(name, value);
  for (const auto& [name, value] : answer.headers) response_.set(name, value);
  response_.body() = answer.body;
  response_.keep_alive(!close);
  response_.prepare_payload();
  stream_.expires_after(kMostIdle);
  http::async_write(
      stream_, response_, [self = shared_from_this(), close](beast::error_code error, std::size_t) {
        if (error) return self->stream_.close();
        if (!close) return self->read_header();
        boost::system::error_code ignored;
        self->stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
        self->stream_.expires_after(kMostDrain);
        self->drain();
      });
}

}  // namespace mixrig::page
