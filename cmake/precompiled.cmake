# The headers of others that most files include are parsed once for each kind of target, and not 900 times. No header of
# ours is among them, but for one that cuts another short. The presets debug and fuzz do without: there an include that is
# missing is found.
# All targets below a folder, into a variable.
function(targets_below folder result)
  get_property(found DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder ${subfolders})
    targets_below(${subfolder} below)
    list(APPEND found ${below})
  endforeach()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# precompile(KIND [SHARED] FOLDERS <folder>.. LIBRARIES <what the headers need>.. OPTIONS <option>.. HEADERS
# <header>..): the headers for the programs and archives below the folders, which are compiled with the options too.
function(precompile kind)
  cmake_parse_arguments(PARSE_ARGV 1 arg "SHARED" "" "FOLDERS;LIBRARIES;OPTIONS;HEADERS")
  set(carrier freshet_precompiled_${kind})
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${carrier}.cc CONTENT "")
  add_library(${carrier} STATIC EXCLUDE_FROM_ALL ${CMAKE_CURRENT_BINARY_DIR}/${carrier}.cc)
  target_link_libraries(${carrier} PRIVATE freshet_flags ${arg_LIBRARIES})
  if(arg_SHARED AND (FRESHET_PYTHON OR BUILD_SHARED_LIBS))
    set_target_properties(${carrier} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_precompile_headers(${carrier} PRIVATE ${arg_HEADERS})
  target_compile_options(${carrier} PRIVATE ${arg_OPTIONS})
  foreach(folder ${arg_FOLDERS})
    targets_below(${folder} targets)
    foreach(target ${targets})
      get_target_property(type ${target} TYPE)
      get_target_property(without ${target} DISABLE_PRECOMPILE_HEADERS)
      if(type MATCHES "EXECUTABLE|STATIC_LIBRARY" AND NOT without)
        target_precompile_headers(${target} REUSE_FROM ${carrier})
        target_compile_options(${target} PRIVATE ${arg_OPTIONS})
      endif()
    endforeach()
  endforeach()
endfunction()

# Clang wants every flag of the languages alike; GCC takes what a file adds to them. GCC 12 warns of overruns in strings
# that are put together when their header is precompiled, and only then.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    set(mistaken -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
  set(common <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional>
             <random> <set> <span> <string> <thread> <vector> <opencv2/core.hpp> <opencv2/imgproc.hpp>
             <oneapi/tbb/parallel_for.h> <cmake/json_for_precompiling.h>)
  set(libraries opencv_core opencv_imgproc TBB::tbb nlohmann_json::nlohmann_json)
  if(FRESHET_BENCH)
    set(benches bench)
  endif()
  precompile(engine SHARED FOLDERS report cache store media hints vision stored ingest query synth starter studio library ${benches}
             OPTIONS ${mistaken} LIBRARIES ${libraries} HEADERS ${common})
  # What reads options and what is a test runs once: it is compiled faster, and what it calls is as fast as ever.
  set(once $<$<CONFIG:Release>:-O1>)
  find_package(CLI11 REQUIRED)
  precompile(commands FOLDERS tools OPTIONS ${mistaken} ${once}
             LIBRARIES ${libraries} fmt::fmt CLI11::CLI11 HEADERS ${common} <fmt/format.h> <CLI/CLI.hpp>)
  if(FRESHET_TESTS)
    find_package(GTest REQUIRED)
    precompile(tests FOLDERS tests OPTIONS ${mistaken} ${once}
               LIBRARIES ${libraries} GTest::gtest HEADERS ${common} <gtest/gtest.h>)
  endif()
endif()
