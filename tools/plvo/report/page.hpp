// SPDX-License-Identifier: Apache-2.0
// The text of the report's page; CMake generates the definitions from tools/plvo/report/page.
#pragma once

namespace plvo::report {

extern const char* const k_page_html;  // with the placeholders @STYLE@, @DATA@ and @SCRIPT@
extern const char* const k_style_css;
extern const char* const k_charts_js;
extern const char* const k_turntable_js;  // of the live page, too
extern const char* const k_paths_js;
extern const char* const k_frames_js;
extern const char* const k_main_js;

}  // namespace plvo::report
