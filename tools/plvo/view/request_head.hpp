// SPDX-License-Identifier: Apache-2.0
// What libmicrohttpd hands over of a request, looked at before anything in it is believed. The library hands
// over strings that end at the first null character, whatever follows it, takes a bare line feed for the end
// of a line, several spaces for one, and one header twice. What came is only known in full if each of its
// bytes is accounted for.
#pragma once

#include <microhttpd.h>

#include <optional>
#include <string_view>

namespace plvo {

// Whether method, target, version and headers, put together again as RFC 9112 writes them, have the length of
// what was received, no name or value holds a control character, no name a space, and no more than one header
// says how long the body is. target: as it came, with the query (MHD_OPTION_URI_LOG_CALLBACK).
bool is_well_formed(MHD_Connection* connection, std::string_view method, std::string_view target,
                    std::string_view version);

// The one header of this name; nothing when there is none, or more than one.
std::optional<std::string_view> only_header(MHD_Connection* connection, std::string_view name);

// A body is announced.
bool has_body(MHD_Connection* connection);

}  // namespace plvo
