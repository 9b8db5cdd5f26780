// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/request_head.hpp"

#include <strings.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace plvo {
namespace {

template <typename Each>
void for_each_header(MHD_Connection* connection, Each each) {
  MHD_get_connection_values_n(
      connection, MHD_HEADER_KIND,
      [](void* to, MHD_ValueKind, const char* name, std::size_t name_size, const char* value,
         std::size_t value_size) {
        (*static_cast<Each*>(to))(std::string_view(name, name_size), std::string_view(value, value_size));
        return MHD_YES;
      },
      &each);
}

bool is_name(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::strncasecmp(a.data(), b.data(), a.size()) == 0;
}

std::size_t count(MHD_Connection* connection, std::string_view wanted) {
  std::size_t found = 0;
  for_each_header(connection,
                  [&](std::string_view name, std::string_view) { found += is_name(name, wanted); });
  return found;
}

bool is_control(char c) {
  const auto code = static_cast<unsigned char>(c);
  return (code < ' ' && c != '\t') || code == 0x7f;
}

}  // namespace

bool is_well_formed(MHD_Connection* connection, std::string_view method, std::string_view target,
                    std::string_view version) {
  constexpr std::size_t kSpace = 1, kLineEnd = 2;
  std::size_t bytes = method.size() + kSpace + target.size() + kSpace + version.size() + kLineEnd + kLineEnd;
  bool clean = true;
  for_each_header(connection, [&](std::string_view name, std::string_view value) {
    // Both point into the receive buffer: between them are the colon and the spaces after it.
    const auto begin = reinterpret_cast<std::uintptr_t>(name.data());
    const auto end = reinterpret_cast<std::uintptr_t>(value.data()) + value.size();
    bytes += end - begin + kLineEnd;
    clean = clean &&
            std::none_of(name.begin(), name.end(),
                         [](char c) { return is_control(c) || c == ' ' || c == '\t'; }) &&
            std::none_of(value.begin(), value.end(), is_control);
  });
  const MHD_ConnectionInfo* received =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE);
  return clean && received != nullptr && received->header_size == bytes &&
         count(connection, MHD_HTTP_HEADER_CONTENT_LENGTH) +
                 count(connection, MHD_HTTP_HEADER_TRANSFER_ENCODING) <=
             1;
}

std::optional<std::string_view> only_header(MHD_Connection* connection, std::string_view wanted) {
  std::optional<std::string_view> only;
  for_each_header(connection, [&](std::string_view name, std::string_view value) {
    if (is_name(name, wanted)) only = value;
  });
  return count(connection, wanted) == 1 ? only : std::nullopt;
}

bool has_body(MHD_Connection* connection) {
  return count(connection, MHD_HTTP_HEADER_TRANSFER_ENCODING) != 0 ||
         (count(connection, MHD_HTTP_HEADER_CONTENT_LENGTH) != 0 &&
          only_header(connection, MHD_HTTP_HEADER_CONTENT_LENGTH) != "0");
}

}  // namespace plvo
