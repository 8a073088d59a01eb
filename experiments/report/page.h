// The report's page, style and scripts, embedded when the program is built.
#pragma once

namespace misbench {

extern const char* const kPage;          // page.html, with {{placeholders}}
extern const char* const kPageStyle;     // page.css
extern const char* const kPageScript;    // the scripts of this folder, in the order of their use
extern const char* const kChartLibrary;  // Chart.js, with its licence

}  // namespace misbench
