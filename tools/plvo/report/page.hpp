// SPDX-License-Identifier: Apache-2.0
// The report's page as text; CMake makes the definitions from tools/plvo/report/page.
#pragma once

namespace plvo::report {

extern const char* const k_page_html;  // with @STYLE@, @DATA@ and @SCRIPT@ to be filled in
extern const char* const k_style_css;
extern const char* const k_charts_js;
extern const char* const k_paths_js;
extern const char* const k_frames_js;
extern const char* const k_main_js;

}  // namespace plvo::report
