// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/view_server.hpp"

#include "plvo/view/view_hub.hpp"

#ifdef PLVO_HAVE_HTTPLIB
#include <httplib.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <thread>

#include "plvo/view/page.hpp"
#endif

namespace plvo {

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host == "[::1]" || host.rfind("127.", 0) == 0;
}

#ifdef PLVO_HAVE_HTTPLIB
namespace {

constexpr std::size_t kThreads = 24;  // a viewer that waits for news holds one
constexpr int kPatience_ms = 1000;

// The host in a Host header: without the port.
std::string host_of(const std::string& header) {
  if (!header.empty() && header.front() == '[') return header.substr(0, header.find(']') + 1);
  return header.substr(0, header.find(':'));
}

std::uint64_t number(const httplib::Request& request, const char* name, std::uint64_t otherwise) {
  const std::string text = request.get_param_value(name);
  std::uint64_t value = otherwise;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() ? value : otherwise;
}

}  // namespace

struct ViewServer::Impl {
  httplib::Server server;
  ViewHub hub;
  std::thread thread;
  std::atomic<int> port{0};
  bool only_loopback = true;
  bool running = false;

  void set_up() {
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_payload_max_length(1024);
    server.set_read_timeout(2, 0);
    server.set_write_timeout(2, 0);  // a viewer that does not read is let go after this
    server.set_keep_alive_timeout(2);
    server.set_keep_alive_max_count(100'000);
    // The library's own choice would let two servers share one port.
    server.set_socket_options([](int socket) {
      const int on = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    });
    server.set_tcp_nodelay(true);
    server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      if (!only_loopback || is_loopback(host_of(request.get_header_value("Host")))) {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      response.status = 403;
      response.set_content("This live view answers only under the name of the loopback.\n", "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    server.Get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_header(
          "Content-Security-Policy",
          "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src 'self'; "
          "connect-src 'self'");
      response.set_content(kViewPage, std::strlen(kViewPage), "text/html; charset=utf-8");
    });
    server.Get("/favicon.ico",
               [](const httplib::Request&, httplib::Response& response) { response.status = 204; });
    server.Get("/update", [this](const httplib::Request& request, httplib::Response& response) {
      ViewHub::Ask ask;
      ask.after = number(request, "after", 0);
      ask.image = number(request, "image", 0);
      ask.path_epoch = number(request, "epoch", ~std::uint64_t{0});
      ask.path_points = static_cast<std::size_t>(number(request, "path", 0));
      ask.viewer = request.get_param_value("viewer");
      response.set_header("Cache-Control", "no-store");
      response.set_content(hub.reply(ask, kPatience_ms), "application/octet-stream");
    });
  }
};

ViewServer::ViewServer() : impl_(std::make_unique<Impl>()) { impl_->set_up(); }
ViewServer::~ViewServer() { stop(); }

bool ViewServer::available() { return true; }

Status ViewServer::start(const std::string& host, int port) {
  impl_->only_loopback = is_loopback(host);
  errno = 0;
  const int bound =
      port == 0 ? impl_->server.bind_to_any_port(host) : (impl_->server.bind_to_port(host, port) ? port : -1);
  if (bound <= 0) {
    const int error = errno;
    const StatusCode code = error == EADDRINUSE ? StatusCode::kBusy
                            : error == EACCES   ? StatusCode::kPermission
                                                : StatusCode::kInvalidArgument;
    return Status(code, "the live view cannot listen on ")
        .append(host)
        .append(":")
        .append(port)
        .append(": ")
        .append(error != 0 ? std::strerror(error) : "no such address")
        .append("; choose another port with --view");
  }
  impl_->port = bound;
  impl_->running = true;
  impl_->thread = std::thread([this] { impl_->server.listen_after_bind(); });
  while (!impl_->server.is_running()) std::this_thread::yield();  // stop() is deaf before that
  return {};
}

void ViewServer::stop() {
  if (!impl_->running) return;
  impl_->running = false;
  impl_->hub.close();
  impl_->server.stop();
  impl_->thread.join();
}

int ViewServer::port() const { return impl_->port; }

#else

struct ViewServer::Impl {
  ViewHub hub;
};

ViewServer::ViewServer() : impl_(std::make_unique<Impl>()) {}
ViewServer::~ViewServer() = default;
bool ViewServer::available() { return false; }
Status ViewServer::start(const std::string&, int) {
  return {StatusCode::kUnsupported,
          "this plvo was built without the live view: sudo apt install libcpp-httplib-dev libssl-dev, then "
          "configure "
          "and build again"};
}
void ViewServer::stop() {}
int ViewServer::port() const { return 0; }

#endif

void ViewServer::publish(const RgbdFrame& frame, const FeatureView& features, const TrackResult& result,
                         const ViewStatus& status, bool lens_is_straight) {
  impl_->hub.publish(frame, features, result, status, lens_is_straight);
}
void ViewServer::publish_status(const ViewStatus& status) { impl_->hub.publish_status(status); }
int ViewServer::viewers() const { return impl_->hub.viewers(); }
std::uint64_t ViewServer::replies() const { return impl_->hub.replies(); }
std::uint64_t ViewServer::encodings() const { return impl_->hub.encodings(); }

}  // namespace plvo
