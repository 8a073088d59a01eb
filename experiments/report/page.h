// The report's page, style and script, embedded when the program is built.
#pragma once

namespace misbench {

extern const char* const kReport_html;  // with {{placeholders}}
extern const char* const kReport_css;
extern const char* const kReport_js;

}  // namespace misbench
