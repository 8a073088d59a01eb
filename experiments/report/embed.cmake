# cmake -DOUTPUT=x.cpp -DFOLDER=dir -DCHARTS=chart.min.js -P embed.cmake: the report's files as
# strings of a program.
set(text "// Generated from experiments/report.\n#include \"experiments/report/page.h\"\n\nnamespace misbench {\n")

# embed(NAME FILE...): one string of all of their bytes.
function(embed name)
  set(content "")
  foreach(path ${ARGN})
    file(READ ${path} piece)
    string(APPEND content "${piece}")
  endforeach()
  set(text "${text}const char* const ${name} = R\"MISBENCH(${content})MISBENCH\";\n" PARENT_SCOPE)
endfunction()

embed(kPage ${FOLDER}/page.html)
embed(kPageStyle ${FOLDER}/page.css)
embed(kPageScript ${FOLDER}/decode.js ${FOLDER}/color.js ${FOLDER}/pane.js ${FOLDER}/viewer.js
  ${FOLDER}/viewer_input.js ${FOLDER}/tables.js ${FOLDER}/charts.js ${FOLDER}/start.js)
embed(kChartLibrary ${CHARTS})
string(APPEND text "}  // namespace misbench\n")
file(WRITE ${OUTPUT} "${text}")
