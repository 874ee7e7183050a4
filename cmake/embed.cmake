# embed(SOURCE FILE...)
# Makes text files part of a source file: #include "embedded/NAME" in it is a string literal that holds the file. What
# was built from it needs no file beside it, installed or not.
function(embed source)
  foreach(file IN LISTS ARGN)
    cmake_path(GET file FILENAME name)
    file(READ ${file} text)
    file(CONFIGURE OUTPUT embedded/${name} CONTENT "R\"embedded(${text})embedded\"\n" @ONLY NEWLINE_STYLE UNIX)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  set_property(SOURCE ${source} APPEND PROPERTY INCLUDE_DIRECTORIES ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
