# isowave_embed(NAME FILE ...): the files' text, one after the other, as `const std::string_view isowave::view::embedded::NAME`
# in a source that is added to the list `embedded`; no file: an empty text. A raw string literal, which a compiler reads at once.
# Made again when a file changes. REQUIRES: no file holds the delimiter )isowave-embd".
function(isowave_embed name)
  set(text "")
  foreach(file ${ARGN})
    file(READ ${file} content)
    string(APPEND text "${content}")
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT
"// Made by view/embed.cmake.
#include \"view/embedded.h\"

const std::string_view isowave::view::embedded::@name@ = R\"isowave-embd(@text@)isowave-embd\";
" @ONLY)
  set(embedded ${embedded} ${source} PARENT_SCOPE)
endfunction()
