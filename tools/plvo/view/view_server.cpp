// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/view_server.hpp"

#include "plvo/view/view_hub.hpp"

#ifdef PLVO_HAVE_MICROHTTPD
#include <microhttpd.h>
#include <sys/socket.h>

#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "plvo/host/posix_clock.hpp"
#include "plvo/host/stream/tcp_listener.hpp"
#include "plvo/view/connection_table.hpp"
#include "plvo/view/host_names.hpp"
#include "plvo/view/page.hpp"
#include "plvo/view/reply_queue.hpp"
#endif

namespace plvo {

#ifdef PLVO_HAVE_MICROHTTPD
namespace {

constexpr int kBacklog = 128;
// Of one connection: its request line and headers, and the headers of the reply. Who sends more gets 414 or
// 431.
constexpr std::size_t kConnectionBytes = 16 * 1024;
constexpr unsigned kSilence_s = 5;
// The table hangs up before these are reached; the library's own limits stand behind it, with room for those
// that were hung up on and are not closed yet.
constexpr unsigned kLibraryConnections = 2 * ConnectionTable::kMaxConnections;
constexpr unsigned kLibraryPerAddress = 2 * ConnectionTable::kMaxPerAddress;

// What is known of one request until its reply has gone.
struct Request {
  MHD_Connection* connection = nullptr;
  std::optional<std::string> reply;  // to /update, once it is composed
};

int socket_of(MHD_Connection* connection) {
  return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

std::uint64_t number(MHD_Connection* connection, const char* name, std::uint64_t otherwise) {
  const char* found = MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, name);
  const std::string_view text = found != nullptr ? found : "";
  std::uint64_t value = otherwise;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() ? value : otherwise;
}

// The one header of this name; nothing when there is none, or more than one.
std::optional<std::string_view> only_header(MHD_Connection* connection, const char* name) {
  struct Search {
    const char* name;
    std::size_t count = 0;
    std::string_view value;
  } search{name, 0, {}};
  MHD_get_connection_values(
      connection, MHD_HEADER_KIND,
      [](void* to, MHD_ValueKind, const char* key, const char* value) {
        auto& s = *static_cast<Search*>(to);
        if (::strcasecmp(key, s.name) == 0) {
          ++s.count;
          s.value = value != nullptr ? value : "";
        }
        return MHD_YES;
      },
      &search);
  return search.count == 1 ? std::optional(search.value) : std::nullopt;
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

// text: must last for ever.
MHD_Result send_constant(MHD_Connection* connection, unsigned code, const char* type, const char* text) {
  return send(
      connection, code, type,
      MHD_create_response_from_buffer(std::strlen(text), const_cast<char*>(text), MHD_RESPMEM_PERSISTENT));
}

MHD_Result send_update(MHD_Connection* connection, std::string text) {
  auto* kept = new std::string(std::move(text));  // until the last byte has gone
  return send(
      connection, MHD_HTTP_OK, "application/octet-stream",
      MHD_create_response_from_buffer_with_free_callback_cls(
          kept->size(), kept->data(), [](void* done) { delete static_cast<std::string*>(done); }, kept));
}

}  // namespace

struct ViewServer::Impl {
  ViewHub hub;
  ConnectionTable table{[](int descriptor) { ::shutdown(descriptor, SHUT_RDWR); }};
  ReplyQueue queue{hub, [this] { table.hang_up_overdue(posix_monotonic_ns()); }};
  std::optional<HostNames> names;
  MHD_Daemon* daemon = nullptr;
  int port = 0;

  bool start_daemon(int listener);
  MHD_Result refuse_or_go_on(MHD_Connection* connection, const char* method);
  MHD_Result answer(Request& request, std::string_view path);
  void wait_for_update(Request& request);
};

// What can be said once the headers are here: no names but ours, nothing but questions, and no luggage.
MHD_Result ViewServer::Impl::refuse_or_go_on(MHD_Connection* connection, const char* method) {
  const std::optional<std::string_view> host = only_header(connection, MHD_HTTP_HEADER_HOST);
  if (!host || !names->allows(*host)) {
    return send_constant(connection, MHD_HTTP_FORBIDDEN, "text/plain",
                         "This live view does not answer under this name. Use the address that plvo live "
                         "printed, or start it with --view-host and the name (and port) in your browser.\n");
  }
  if (std::strcmp(method, MHD_HTTP_METHOD_GET) != 0 && std::strcmp(method, MHD_HTTP_METHOD_HEAD) != 0) {
    return send_constant(connection, MHD_HTTP_METHOD_NOT_ALLOWED, "text/plain", "Only GET.\n");
  }
  const char* length = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Content-Length");
  const char* coding = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Transfer-Encoding");
  if (coding != nullptr || (length != nullptr && std::strcmp(length, "0") != 0)) {
    return send_constant(connection, MHD_HTTP_BAD_REQUEST, "text/plain", "No body is wanted.\n");
  }
  return MHD_YES;
}

// The connection sleeps in the library until the reply is composed; it cannot go away meanwhile.
void ViewServer::Impl::wait_for_update(Request& request) {
  ViewHub::Ask ask;
  ask.after = number(request.connection, "after", 0);
  ask.image = number(request.connection, "image", 0);
  ask.path_epoch = number(request.connection, "epoch", ~std::uint64_t{0});
  ask.path_points = static_cast<std::size_t>(number(request.connection, "path", 0));
  if (const char* viewer = MHD_lookup_connection_value(request.connection, MHD_GET_ARGUMENT_KIND, "viewer")) {
    ask.viewer = viewer;
  }
  MHD_suspend_connection(request.connection);
  const auto go_on = [&request](std::string reply) {
    request.reply = std::move(reply);
    MHD_resume_connection(request.connection);
  };
  if (!queue.add(ask, go_on)) go_on("");
}

MHD_Result ViewServer::Impl::answer(Request& request, std::string_view path) {
  MHD_Connection* connection = request.connection;
  if (path == "/") return send_constant(connection, MHD_HTTP_OK, "text/html; charset=utf-8", kViewPage);
  if (path == "/favicon.ico") return send_constant(connection, MHD_HTTP_NO_CONTENT, "", "");
  if (path != "/update") {
    return send_constant(connection, MHD_HTTP_NOT_FOUND, "text/plain", "There is only the page itself: /\n");
  }
  if (request.reply) return send_update(connection, std::move(*request.reply));
  wait_for_update(request);
  return MHD_YES;
}

bool ViewServer::Impl::start_daemon(int listener) {
  const MHD_AccessHandlerCallback on_request = [](void* self, MHD_Connection* connection, const char* path,
                                                  const char* method, const char*, const char*,
                                                  std::size_t* body_bytes, void** known) {
    auto& impl = *static_cast<Impl*>(self);
    if (*known == nullptr) {  // the headers are here
      *known = new Request{connection, {}};
      impl.table.asked(socket_of(connection), posix_monotonic_ns());
      return impl.refuse_or_go_on(connection, method);
    }
    if (*body_bytes != 0) return MHD_NO;
    return impl.answer(*static_cast<Request*>(*known), path);
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
    const sockaddr* peer =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr;
    impl.table.opened(socket_of(connection), machine_of(*peer), posix_monotonic_ns());
  };
  daemon = MHD_start_daemon(MHD_USE_POLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr,
                            on_request, this, MHD_OPTION_LISTEN_SOCKET, listener, MHD_OPTION_NOTIFY_COMPLETED,
                            on_answered, this, MHD_OPTION_NOTIFY_CONNECTION, on_connection, this,
                            MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes,
                            MHD_OPTION_CONNECTION_TIMEOUT, kSilence_s, MHD_OPTION_CONNECTION_LIMIT,
                            kLibraryConnections, MHD_OPTION_PER_IP_CONNECTION_LIMIT, kLibraryPerAddress,
                            MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END);
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
  if (!impl_->start_daemon(listener.descriptor)) {  // which owns the socket from here on, whatever happens
    impl_->queue.stop();
    return {StatusCode::kIo, "the live view cannot start its server; is there memory for another thread?"};
  }
  return {};
}

// The queue first: it lets go whoever waits, which the library wants before it stops.
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
void ViewServer::publish_status(const ViewStatus& status) { impl_->hub.publish_status(status); }
int ViewServer::viewers() const { return impl_->hub.viewers(); }
std::uint64_t ViewServer::images() const { return impl_->hub.images(); }
std::uint64_t ViewServer::replies() const { return impl_->hub.replies(); }
std::uint64_t ViewServer::encodings() const { return impl_->hub.encodings(); }

}  // namespace plvo
