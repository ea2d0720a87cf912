# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=x.cpp -DNAME=n -DFILES=a,b -P embed.cmake: the text of the files, one after the other, as
# cinch::embedded::n.
# By way of hex digits, for which CMake has no other meaning.
string(REPLACE "," ";" files "${FILES}")
set(code "#include \"experiments/embedded.hpp\"\n\nnamespace cinch::embedded {\n\n")
string(APPEND code "static constexpr char ${NAME}_text[] =\n    \"\"")
foreach(file IN LISTS files)
  file(READ ${file} text HEX)
  string(LENGTH "${text}" digits)
  set(at 0)
  while(at LESS digits)
    string(SUBSTRING "${text}" ${at} 16000 piece)
    string(REGEX REPLACE "(..)" "\\\\x\\1" piece "${piece}")
    string(APPEND code "\n    \"${piece}\"")
    math(EXPR at "${at} + 16000")
  endwhile()
endforeach()
string(APPEND code ";\n\nconst std::string_view ${NAME}(${NAME}_text, sizeof ${NAME}_text - 1);\n\n")
file(WRITE ${OUTPUT} "${code}} // namespace cinch::embedded\n")
