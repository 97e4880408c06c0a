// SPDX-License-Identifier: Apache-2.0
#include <utility>  // in front of Beast: its detectors of coroutines need std::exchange
//
#include "view_node/server.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <list>
#include <optional>

#include "core/failure.h"
#include "view_node/http_answers.h"
#include "view_node/scene_editing.h"

namespace slew::view_node {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::beast::error_code;
using net::ip::tcp;
// one executor, known when it is compiled: half the time of the general one
using Executor = net::io_context::executor_type;
using Socket = net::basic_stream_socket<tcp, Executor>;
using Acceptor = net::basic_socket_acceptor<tcp, Executor>;
using gateway::Frame;
using gateway::FrameType;
using gateway::Gateway;
using gateway::Service;

constexpr std::size_t kMostConnections = 64;
constexpr std::uint32_t kMostHeaderBytes = 16 * 1024;
constexpr int kSendBuffer = 64 * 1024;  // bytes in the kernel: what is in it is not replaced by newer values
constexpr std::int64_t kRequestNs = 10'000'000'000;
constexpr std::int64_t kStalledNs = 60'000'000'000;
constexpr std::int64_t kClosingNs = 2'000'000'000;
constexpr std::size_t kMostReason = 120;  // bytes of a WebSocket's reason to close

std::string_view view(boost::beast::string_view text) {
  return {text.data(), text.size()};
}

// One connection: HTTP, then perhaps a WebSocket. Handlers keep it alive; a closed socket ends them.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Socket socket, const ServerDef& def, const HttpAnswers& answers, Gateway& gateway)
      : stream_(std::move(socket)),
        def_(def),
        answers_(answers),
        gateway_(gateway),
        deadline_ns_(monotonic_ns() + kRequestNs) {
    error_code ignored;
    stream_.next_layer().set_option(net::socket_base::send_buffer_size(kSendBuffer), ignored);
    stream_.next_layer().set_option(tcp::no_delay(true), ignored);
    parser_.header_limit(kMostHeaderBytes);
    parser_.body_limit(kMostWorkspaceBytes);
  }

  void start() {
    http::async_read(stream_.next_layer(), buffer_, parser_,
                     [self = shared_from_this()](error_code error, std::size_t) { self->take_request(error); });
  }

  // Sends the next frame, if none is under way; closes what has had its time.
  void look_after(std::int64_t now_ns) {
    if (now_ns > deadline_ns_ || now_ns > last_ns_) return drop();
    if (!client_ || is_closing_) return;
    const std::string& reason = gateway_.close_reason(*client_);
    // its last events have some time
    if (!reason.empty() && last_ns_ == INT64_MAX) last_ns_ = now_ns + kClosingNs;
    if (is_writing_) return;
    if (const auto frame = gateway_.next_frame(*client_)) return write(*frame);
    if (!reason.empty()) close(reason);
  }

  [[nodiscard]] bool is_over() const noexcept { return is_over_; }

  void drop() {
    if (std::exchange(is_over_, true)) return;
    if (client_) gateway_.disconnect(*client_);
    client_.reset();
    error_code ignored;
    stream_.next_layer().close(ignored);
  }

 private:
  void take_request(error_code error) {
    if (error == http::error::header_limit)
      return answer(sentence(431, "the request's header has more than 16 KiB; nothing was changed"));
    if (error == http::error::body_limit)
      return answer(sentence(413, "the request's body has more than 1 MiB; nothing was changed"));
    const bool is_cut = error == http::error::end_of_stream || error == http::error::partial_message;
    if (error && error.category() == http::make_error_code(http::error::bad_method).category() && !is_cut)
      return answer(sentence(400, "the request is no HTTP/1.1 (" + error.message() +
                                      "); nothing was changed; send a method, a path and HTTP/1.1, headers 'Name: "
                                      "value', and a Content-Length that is a number"));
    if (error) return drop();
    http::request<http::string_body>& request = parser_.get();
    const auto origin = request.find(http::field::origin);
    const gateway::Request asked{.method = view(request.method_string()),
                                 .target = view(request.target()),
                                 .host = view(request[http::field::host]),
                                 .origin = view(request[http::field::origin]),
                                 .subprotocols = view(request[http::field::sec_websocket_protocol]),
                                 .has_origin = origin != request.end(),
                                 .is_upgrade = websocket::is_upgrade(request)};
    const gateway::Verdict verdict = gateway::judge(def_.door, asked);
    if (verdict.service == Service::websocket) return accept(verdict.subprotocol);
    if (is_of_scene(verdict.service) && def_.editing != nullptr && !def_.is_looking_only) {
      deadline_ns_ = INT64_MAX;  // a scene's check takes its time
      return def_.editing->take({.service = verdict.service,
                                 .is_change = asked.method != "GET" && asked.method != "HEAD",
                                 .if_match = std::string(view(request[http::field::if_match])),
                                 .body = std::move(request.body())},
                                [connection = weak_from_this()](const HttpAnswer& given) {
                                  if (const auto self = connection.lock()) self->answer(given);
                                });
    }
    answer(answers_.answer(
        verdict, {.method = asked.method,
                  .accept_encoding = view(request[http::field::accept_encoding]),
                  .conditions = {view(request[http::field::if_match]), view(request[http::field::if_none_match])},
                  .body = std::move(request.body())}));
  }

  void answer(const HttpAnswer& given) {
    if (is_over_) return;
    const auto beast = [](std::string_view text) { return boost::beast::string_view(text.data(), text.size()); };
    response_.result(given.status);
    response_.set(http::field::server, "slewring");
    response_.set(http::field::cache_control, beast(given.cache));
    if (!given.entity_tag.empty()) response_.set(http::field::etag, given.entity_tag);
    if (given.is_compressed) response_.set(http::field::content_encoding, "gzip");
    if (given.depends_on_encoding) response_.set(http::field::vary, "Accept-Encoding");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Frame-Options", "DENY");
    response_.set("Content-Security-Policy",
                  "default-src 'self'; connect-src 'self' ws: wss:; img-src 'self' data: blob:; style-src 'self' "
                  "'unsafe-inline'; worker-src 'self' blob:; frame-ancestors 'none'");
    response_.keep_alive(false);
    if (given.content != nullptr) {
      content_ = given.content;
      response_.set(http::field::content_type, beast(given.type));
      response_.content_length(content_->size());
      if (parser_.get().method() != http::verb::head) response_.body() = {content_->data(), content_->size()};
    }
    deadline_ns_ = monotonic_ns() + kStalledNs;
    http::async_write(stream_.next_layer(), response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.next_layer().shutdown(tcp::socket::shutdown_send, ignored);
      self->deadline_ns_ = monotonic_ns() + kClosingNs;
      self->read_rest();
    });
  }

  // A socket that is closed with bytes of its client unread takes the answer back.
  void read_rest() {
    buffer_.clear();
    stream_.next_layer().async_read_some(buffer_.prepare(kMostHeaderBytes),
                                         [self = shared_from_this()](error_code error, std::size_t) {
                                           if (error) return self->drop();
                                           self->read_rest();
                                         });
  }

  void accept(gateway::Subprotocol subprotocol) {
    if (buffer_.size() > 0)
      return answer(
          sentence(400, "bytes came in front of the answer to the WebSocket's request; no connection was made"));
    stream_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      const std::string_view name = gateway::to_text(subprotocol);
      response.set(http::field::sec_websocket_protocol, boost::beast::string_view(name.data(), name.size()));
      response.set(http::field::server, "slewring");
    }));
    stream_.read_message_max(gateway::kMaxMessageBytes);
    stream_.auto_fragment(false);
    stream_.async_accept(parser_.get(), [self = shared_from_this()](error_code error) {
      if (error) return self->drop();
      self->deadline_ns_ = INT64_MAX;
      self->client_ = self->gateway_.connect();
      if (!self->client_) return self->close("the gateway has 32 clients already; close one and connect again");
      self->read();
    });
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error || !self->client_) return self->drop();
      const auto bytes = self->buffer_.data();
      self->gateway_.take_message(*self->client_, self->stream_.got_text() ? FrameType::text : FrameType::binary,
                                  {static_cast<const char*>(bytes.data()), bytes.size()}, monotonic_ns());
      self->buffer_.consume(bytes.size());
      self->read();
    });
  }

  // The connection's next frame follows at once, so that a fast client is not bound to the rounds of poll().
  void write(const Frame& frame) {
    is_writing_ = true;
    deadline_ns_ = monotonic_ns() + kStalledNs;
    frame_ = frame;
    stream_.text(frame.type == FrameType::text);
    const std::array<net::const_buffer, 2> parts = {
        net::buffer(frame_.head), frame_.body != nullptr ? net::buffer(*frame_.body) : net::const_buffer()};
    stream_.async_write(parts, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->drop();
      self->is_writing_ = false;
      self->deadline_ns_ = INT64_MAX;
      self->look_after(monotonic_ns());
    });
  }

  void close(const std::string& reason) {
    is_closing_ = true;
    last_ns_ = std::min(last_ns_, monotonic_ns() + kClosingNs);
    const websocket::close_reason sent(websocket::close_code::going_away, reason.substr(0, kMostReason));
    stream_.async_close(sent, [self = shared_from_this()](error_code) { self->drop(); });
  }

  websocket::stream<Socket, false> stream_;
  boost::beast::flat_buffer buffer_{gateway::kMaxMessageBytes + kMostHeaderBytes};
  http::request_parser<http::string_body> parser_;
  http::response<http::span_body<const char>> response_;
  std::shared_ptr<const std::string> content_;  // of the response
  const ServerDef& def_;
  const HttpAnswers& answers_;
  Gateway& gateway_;
  std::optional<gateway::ClientId> client_;
  Frame frame_;                       // under way
  std::int64_t deadline_ns_;          // of the request or the frame that is under way
  std::int64_t last_ns_ = INT64_MAX;  // end of a client that has a reason to be closed
  bool is_writing_ = false, is_closing_ = false, is_over_ = false;
};

}  // namespace

class Server::State {
 public:
  State(ServerDef def, Gateway& gateway) : def_(std::move(def)), gateway_(gateway), acceptor_(context_) {
    const auto fail = [&](const char* what, const error_code& error) {
      throw Failure(ExitCode::resources,
                    fmt::format("{} {}:{}: {}; nothing was started; choose another --listen or --port", what,
                                def_.address, def_.port, error.message()));
    };
    error_code error;
    const auto address = net::ip::make_address(def_.address, error);
    if (error) fail("cannot listen on", error);
    const tcp::endpoint endpoint(address, def_.port);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error) fail("cannot listen on", error);
  }

  void accept() {
    acceptor_.async_accept([this](error_code error, Socket socket) {
      if (error == net::error::operation_aborted) return;
      if (!error && connections_.size() < kMostConnections) {
        connections_.push_back(std::make_shared<Connection>(std::move(socket), def_, answers_, gateway_));
        connections_.back()->start();
      }
      accept();
    });
  }

  void poll(SimDuration at_most) {
    look_after();
    context_.run_for(std::chrono::nanoseconds(at_most.ns));
    look_after();
  }

  void close() {
    error_code ignored;
    acceptor_.close(ignored);
    for (const auto& connection : connections_) connection->drop();
    connections_.clear();
    context_.run_for(std::chrono::milliseconds(10));  // handlers of the closed sockets
  }

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

 private:
  void look_after() {
    const std::int64_t now_ns = monotonic_ns();
    for (const auto& connection : connections_) connection->look_after(now_ns);
    std::erase_if(connections_, [](const auto& connection) { return connection->is_over(); });
  }

  ServerDef def_;
  Gateway& gateway_;
  HttpAnswers answers_{def_, gateway_};
  net::io_context context_{1};
  Acceptor acceptor_;
  std::list<std::shared_ptr<Connection>> connections_;
};

Server::Server(ServerDef def, Gateway& gateway) : state_(std::make_unique<State>(std::move(def), gateway)) {
  state_->accept();
}

Server::~Server() {
  state_->close();
}

std::uint16_t Server::port() const noexcept {
  return state_->port();
}

void Server::poll(SimDuration at_most) {
  state_->poll(at_most);
}

}  // namespace slew::view_node
