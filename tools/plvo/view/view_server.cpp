// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/view_server.hpp"

#include "plvo/host/number_text.hpp"
#include "plvo/view/view_hub.hpp"

#ifdef PLVO_HAVE_MICROHTTPD
#include <microhttpd.h>
#include <sys/socket.h>

#include <cstring>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "plvo/host/background.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/stream/tcp_listener.hpp"
#include "plvo/report/page.hpp"
#include "plvo/report/palette.hpp"
#include "plvo/view/connection_table.hpp"
#include "plvo/view/host_names.hpp"
#include "plvo/view/page.hpp"
#include "plvo/view/rate_limit.hpp"
#include "plvo/view/reply_queue.hpp"
#include "plvo/view/request_head.hpp"
#endif

namespace plvo {

#ifdef PLVO_HAVE_MICROHTTPD
namespace {

constexpr int kBacklog = 128;
// Memory of one connection: its request line and headers, and the headers of the reply. A longer request gets
// status 414 or 431.
constexpr std::size_t kConnectionBytes = 16 * 1024;
constexpr unsigned kSilence_s = 5;
// A browser needs one or two connections and keeps them. More are refused before anything is read: for one
// address above 10 a second or 32 at once, for all above 40 a second or 64 at once.
constexpr RateLimit::Bucket kConnections{100'000'000, 3'200'000'000};
constexpr RateLimit::Bucket kAllConnections{25'000'000, 1'600'000'000};
// Bytes of replies, plus ReplyQueue::kReplyBytes for each: 8 MB/s for one address, 16 MB/s for all; bursts of
// one second's amount.
constexpr RateLimit::Bucket kBytes{125, 1'000'000'000};
constexpr RateLimit::Bucket kAllBytes{62, 1'000'000'000};
// The table hangs up before these limits are reached. They are a second safeguard, with capacity for
// connections that were hung up but are not closed yet.
constexpr unsigned kLibraryConnections = 2 * ConnectionTable::kMaxConnections;
constexpr unsigned kLibraryPerAddress = 2 * ConnectionTable::kMaxPerAddress;

// State of one request until its reply is sent.
struct Request {
  MHD_Connection* connection = nullptr;
  std::string target;  // as received, with the query
  bool judged = false;
  std::optional<std::string> reply;  // set when it may be answered; for /update the text
};

// The page, with what it shares with the report: the colours, and how a view in space is turned.
const std::string& live_page() {
  static const std::string page = [] {
    std::string text = kViewPage;
    for (const auto& [mark, content] :
         {std::pair<std::string, std::string>("@PALETTE@", report::palette_css()),
          {"@TURNTABLE@", report::k_turntable_js}})
      text.replace(text.find(mark), mark.size(), content);
    return text;
  }();
  return page;
}

std::string machine_at(MHD_Connection* connection) {
  return machine_of(*MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr);
}

int socket_of(MHD_Connection* connection) {
  return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

std::uint64_t number(MHD_Connection* connection, const char* name, std::uint64_t otherwise) {
  const char* found = MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, name);
  std::uint64_t value = otherwise;
  if (found != nullptr) parse_whole_text(found, value);
  return value;
}

MHD_Result send(MHD_Connection* connection, unsigned code, const char* type, MHD_Response* response) {
  if (response == nullptr) return MHD_NO;
  if (*type != '\0') MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, type);
  for (const auto& [name, value] :
       {std::pair("Cache-Control", "no-store"), std::pair("X-Content-Type-Options", "nosniff"),
        std::pair("Cross-Origin-Resource-Policy", "same-origin"),
        std::pair("Content-Security-Policy",
                  "default-src 'none'; script-src 'unsafe-inline'; style-src "
                  "'unsafe-inline'; img-src 'self'; connect-src 'self'; "
                  "frame-ancestors 'none'")}) {
    MHD_add_response_header(response, name, value);
  }
  const MHD_Result result = MHD_queue_response(connection, code, response);
  MHD_destroy_response(response);
  return result;
}

// text must outlive the program's last reply.
MHD_Result send_constant(MHD_Connection* connection, unsigned code, const char* type, const char* text) {
  return send(
      connection, code, type,
      MHD_create_response_from_buffer(std::strlen(text), const_cast<char*>(text), MHD_RESPMEM_PERSISTENT));
}

MHD_Result send_update(MHD_Connection* connection, std::string text) {
  auto* kept = new std::string(std::move(text));  // freed after the last byte is sent
  return send(
      connection, MHD_HTTP_OK, "application/octet-stream",
      MHD_create_response_from_buffer_with_free_callback_cls(
          kept->size(), kept->data(), [](void* done) { delete static_cast<std::string*>(done); }, kept));
}

}  // namespace

struct ViewServer::Impl {
  ViewHub hub;
  ConnectionTable table{[](int descriptor) { ::shutdown(descriptor, SHUT_RDWR); }};
  RateLimit connections{kConnections, kAllConnections};
  RateLimit bytes{kBytes, kAllBytes};
  ReplyQueue queue{hub, bytes, [this] { table.hang_up_overdue(posix_monotonic_ns()); }};
  std::optional<HostNames> names;
  MHD_Daemon* daemon = nullptr;
  int port = 0;

  bool start_daemon(int listener);
  bool lets_in(const sockaddr& peer);
  MHD_Result refuse_or_go_on(Request& request, const char* method, const char* version);
  MHD_Result refuse(MHD_Connection* connection, unsigned code, const char* text);
  MHD_Result answer(Request& request, std::string_view path);
  void wait(Request& request, std::string_view path);
};

bool ViewServer::Impl::lets_in(const sockaddr& peer) {
  const std::string machine = machine_of(peer);
  const std::int64_t now_ns = posix_monotonic_ns();
  if (!connections.allows(machine, now_ns)) return false;
  connections.spend(machine, 1, now_ns);
  return true;
}

// Closes the connection without a reply if its address has used up its limit.
MHD_Result ViewServer::Impl::refuse(MHD_Connection* connection, unsigned code, const char* text) {
  const std::string machine = machine_at(connection);
  const std::int64_t now_ns = posix_monotonic_ns();
  if (!bytes.allows(machine, now_ns)) return MHD_NO;
  bytes.spend(machine, ReplyQueue::kReplyBytes, now_ns);
  return send_constant(connection, code, "text/plain", text);
}

// Checks made when the headers are complete: well-formed, a known host name, GET or HEAD, no body.
MHD_Result ViewServer::Impl::refuse_or_go_on(Request& request, const char* method, const char* version) {
  MHD_Connection* connection = request.connection;
  if (!is_well_formed(connection, method, request.target, version)) {
    return refuse(connection, MHD_HTTP_BAD_REQUEST,
                  "This request can be read in more than one way. HTTP/1.1 wants single spaces, CRLF at the "
                  "end of each line, no control characters, and one length of a body.\n");
  }
  const std::optional<std::string_view> host = only_header(connection, MHD_HTTP_HEADER_HOST);
  if (!host || !names->allows(*host)) {
    return refuse(
        connection, MHD_HTTP_FORBIDDEN,
        "This live view does not answer under this name. Use the address that plvo live printed, or "
        "start it with --view-host and the name (and port) in your browser.\n");
  }
  if (std::strcmp(method, MHD_HTTP_METHOD_GET) != 0 && std::strcmp(method, MHD_HTTP_METHOD_HEAD) != 0) {
    return refuse(connection, MHD_HTTP_METHOD_NOT_ALLOWED, "Only GET.\n");
  }
  if (has_body(connection)) return refuse(connection, MHD_HTTP_BAD_REQUEST, "No body is wanted.\n");
  return MHD_YES;
}

// Suspends the connection in the library until it may be answered; it cannot be closed meanwhile.
void ViewServer::Impl::wait(Request& request, std::string_view path) {
  MHD_Connection* connection = request.connection;
  ReplyQueue::Request waiting;
  waiting.address = machine_at(connection);
  if (path == "/update") {
    ViewHub::Ask& ask = waiting.ask.emplace();
    ask.after = number(connection, "after", 0);
    ask.image = number(connection, "image", 0);
    ask.path_epoch = number(connection, "epoch", ~std::uint64_t{0});
    ask.path_points = static_cast<std::size_t>(number(connection, "path", 0));
    if (const char* viewer = MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, "viewer")) {
      ask.viewer = viewer;
    }
  } else if (path == "/") {
    waiting.bytes = static_cast<std::int64_t>(live_page().size());
  }
  MHD_suspend_connection(connection);
  waiting.is_over = [this, descriptor = socket_of(connection)] { return table.is_over(descriptor); };
  waiting.done = [&request](std::string reply) {
    request.reply = std::move(reply);
    MHD_resume_connection(request.connection);
  };
  if (!queue.add(waiting)) waiting.done("");
}

MHD_Result ViewServer::Impl::answer(Request& request, std::string_view path) {
  MHD_Connection* connection = request.connection;
  if (!request.reply) {
    wait(request, path);
    return MHD_YES;
  }
  if (path == "/")
    return send_constant(connection, MHD_HTTP_OK, "text/html; charset=utf-8", live_page().c_str());
  if (path == "/favicon.ico") return send_constant(connection, MHD_HTTP_NO_CONTENT, "", "");
  if (path == "/update") return send_update(connection, std::move(*request.reply));
  return send_constant(connection, MHD_HTTP_NOT_FOUND, "text/plain", "There is only the page itself: /\n");
}

bool ViewServer::Impl::start_daemon(int listener) {
  const MHD_AcceptPolicyCallback on_newcomer = [](void* self, const sockaddr* peer, socklen_t) {
    return static_cast<Impl*>(self)->lets_in(*peer) ? MHD_YES : MHD_NO;
  };
  using OnTarget = void* (*)(void*, const char*, MHD_Connection*);  // the return value becomes `known` below
  const OnTarget on_target = [](void*, const char* target, MHD_Connection* connection) -> void* {
    return new Request{connection, target, false, {}};
  };
  // Valid paths contain no escapes, so leave them.
  using Unescape = std::size_t (*)(void*, MHD_Connection*, char*);
  const Unescape leave_as_it_is = [](void*, MHD_Connection*, char* text) { return std::strlen(text); };
  const MHD_AccessHandlerCallback on_request = [](void* self, MHD_Connection* connection, const char* path,
                                                  const char* method, const char* version, const char*,
                                                  std::size_t* body_bytes, void** known) {
    auto& impl = *static_cast<Impl*>(self);
    auto& request = *static_cast<Request*>(*known);
    if (!request.judged) {  // the headers are complete
      request.judged = true;
      impl.table.asked(socket_of(connection), posix_monotonic_ns());
      return impl.refuse_or_go_on(request, method, version);
    }
    if (*body_bytes != 0) return MHD_NO;
    return impl.answer(request, path);
  };
  const MHD_RequestCompletedCallback on_answered = [](void* self, MHD_Connection* connection, void** known,
                                                      MHD_RequestTerminationCode) {
    delete static_cast<Request*>(std::exchange(*known, nullptr));
    static_cast<Impl*>(self)->table.answered(socket_of(connection), posix_monotonic_ns());
  };
  const MHD_NotifyConnectionCallback on_connection = [](void* self, MHD_Connection* connection, void**,
                                                        MHD_ConnectionNotificationCode what) {
    auto& impl = *static_cast<Impl*>(self);
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) return impl.table.closed(socket_of(connection));
    impl.table.opened(socket_of(connection), machine_at(connection), posix_monotonic_ns());
  };
  // The library's thread inherits the priority of the thread that starts it.
  std::thread([&] {
    run_in_background();
    daemon = MHD_start_daemon(
        MHD_USE_POLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, on_newcomer, this, on_request, this,
        MHD_OPTION_LISTEN_SOCKET, listener, MHD_OPTION_URI_LOG_CALLBACK, on_target, nullptr,
        MHD_OPTION_UNESCAPE_CALLBACK, leave_as_it_is, nullptr, MHD_OPTION_NOTIFY_COMPLETED, on_answered, this,
        MHD_OPTION_NOTIFY_CONNECTION, on_connection, this, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
        kConnectionBytes, MHD_OPTION_CONNECTION_TIMEOUT, kSilence_s, MHD_OPTION_CONNECTION_LIMIT,
        kLibraryConnections, MHD_OPTION_PER_IP_CONNECTION_LIMIT, kLibraryPerAddress,
        MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END);
  }).join();
  return daemon != nullptr;
}

ViewServer::ViewServer() : impl_(std::make_unique<Impl>()) {}
ViewServer::~ViewServer() { stop(); }

bool ViewServer::available() { return true; }

Status ViewServer::start(const std::string& host, int port, const std::vector<std::string>& names) {
  TcpListener listener;
  if (Status status = listen_tcp(host, port, kBacklog, listener); !status.ok()) {
    return Status(status.code(), "the live view: ").append(status.message());
  }
  impl_->names.emplace(host, listener.address, listener.port, names);
  impl_->port = listener.port;
  impl_->queue.start();
  if (!impl_->start_daemon(listener.descriptor)) {  // takes ownership of the socket in any case
    impl_->queue.stop();
    return {StatusCode::kIo, "the live view cannot start its server; is there memory for another thread?"};
  }
  return {};
}

// Stop the queue first: it resumes the suspended connections, as the library requires before it stops.
void ViewServer::stop() {
  impl_->queue.stop();
  if (impl_->daemon != nullptr) MHD_stop_daemon(std::exchange(impl_->daemon, nullptr));
}

int ViewServer::port() const { return impl_->port; }

int ViewServer::connections() const {
  if (impl_->daemon == nullptr) return 0;
  const MHD_DaemonInfo* info = MHD_get_daemon_info(impl_->daemon, MHD_DAEMON_INFO_CURRENT_CONNECTIONS);
  return info != nullptr ? static_cast<int>(info->num_connections) : 0;
}

#else

struct ViewServer::Impl {
  ViewHub hub;
};

ViewServer::ViewServer() : impl_(std::make_unique<Impl>()) {}
ViewServer::~ViewServer() = default;
bool ViewServer::available() { return false; }
Status ViewServer::start(const std::string&, int, const std::vector<std::string>&) {
  return {StatusCode::kUnsupported,
          "this plvo was built without the live view: sudo apt install libmicrohttpd-dev, then configure and "
          "build again"};
}
void ViewServer::stop() {}
int ViewServer::port() const { return 0; }
int ViewServer::connections() const { return 0; }

#endif

void ViewServer::publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
                         const ViewStatus& status, bool lens_is_straight) {
  impl_->hub.publish(frame, features, result, status, lens_is_straight);
}
void ViewServer::publish_map_way(std::span<const Vector3> positions) {
  impl_->hub.publish_map_way(positions);
}
void ViewServer::publish_status(const ViewStatus& status) { impl_->hub.publish_status(status); }
int ViewServer::viewers() const { return impl_->hub.viewers(); }
std::uint64_t ViewServer::images() const { return impl_->hub.images(); }
std::uint64_t ViewServer::replies() const { return impl_->hub.replies(); }
std::uint64_t ViewServer::encodings() const { return impl_->hub.encodings(); }

}  // namespace plvo
