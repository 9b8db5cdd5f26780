// SPDX-License-Identifier: Apache-2.0
// Text that comes from outside (the names of files and topics, what a calibration or a device says) made safe
// to show. A terminal obeys control characters, so they are written as escapes: `\x1b` for a byte, `\u009b`
// for a character, `\xff` for a byte that is not UTF-8. The characters that change the direction of text or
// separate lines without being a newline are escaped as well.
#pragma once

#include <string>
#include <string_view>

namespace plvo {

// One line: newlines and tabs are escaped too, as `\n` and `\t`.
std::string printable(std::string_view text);

// Text that was put together of lines: its newlines stay.
std::string printable_lines(std::string_view text);

}  // namespace plvo
