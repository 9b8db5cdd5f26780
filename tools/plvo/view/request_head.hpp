// SPDX-License-Identifier: Apache-2.0
// Validates the head of a request as libmicrohttpd delivers it. The library's strings end at the first null
// character. It also accepts a bare line feed as the end of a line and several spaces as one, and passes
// duplicate headers. The request is fully known only if every received byte is accounted for.
#pragma once

#include <microhttpd.h>

#include <optional>
#include <string_view>

namespace plvo {

// Returns true if method, target, version and headers, written as in RFC 9112, have the length of the
// received head, no name or value contains a control character, no name contains a space, and at most one
// header states the length of the body. target: as received, with the query (MHD_OPTION_URI_LOG_CALLBACK).
bool is_well_formed(MHD_Connection* connection, std::string_view method, std::string_view target,
                    std::string_view version);

// Returns the header of this name; no value if there is none or more than one.
std::optional<std::string_view> only_header(MHD_Connection* connection, std::string_view name);

// Returns true if the request announces a body.
bool has_body(MHD_Connection* connection);

}  // namespace plvo
