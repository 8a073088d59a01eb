# cmake -DOUTPUT=x.cpp -DFOLDER=dir -P embed.cmake: the report's files as strings of a program.
set(text "// Generated from experiments/report.\n#include \"experiments/report/page.h\"\n\nnamespace misbench {\n")
foreach(kind html css js)
  file(READ ${FOLDER}/report.${kind} content)
  string(APPEND text "const char* const kReport_${kind} = R\"MISBENCH(${content})MISBENCH\";\n")
endforeach()
string(APPEND text "}  // namespace misbench\n")
file(WRITE ${OUTPUT} "${text}")
