# What `cmake --install` puts where, and the Debian packages that cpack makes of it. Components: freshet (program,
# pages, completions, desktop entry), library (the shared library), dev (headers, find_package, pkg-config), python.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/freshet)

# Of a static library the rooms behind it are installed as archives alone: no header of theirs.
if(NOT BUILD_SHARED_LIBS)
  foreach(room report cache store media hints vision stored ingest query search_benchmark field toml sampling outline playing
               animate judging takes matte layers scene scene_frames scene_measured flowlines flowlines_files simulate stills tour
               transfer transfer_files)
    set_target_properties(freshet_${room} PROPERTIES EXPORT_NAME ${room})
    install(TARGETS freshet_${room} EXPORT freshet-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
  endforeach()
endif()
set_target_properties(freshet_library PROPERTIES EXPORT_NAME freshet)
install(TARGETS freshet_library EXPORT freshet-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT dev
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  FILE_SET HEADERS COMPONENT dev)
install(TARGETS freshet_flags EXPORT freshet-targets)
install(EXPORT freshet-targets NAMESPACE freshet:: DESTINATION ${package_dir} COMPONENT dev)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/freshetConfigVersion.cmake COMPATIBILITY SameMinorVersion)
if(BUILD_SHARED_LIBS)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/freshetConfig.cmake @ONLY CONTENT
"include(CMakeFindDependencyMacro)
find_dependency(OpenCV 4.5 COMPONENTS core)
include(\${CMAKE_CURRENT_LIST_DIR}/freshet-targets.cmake)
")
  list(TRANSFORM OpenCV_INCLUDE_DIRS PREPEND -I OUTPUT_VARIABLE opencv_includes)
  list(JOIN opencv_includes " " opencv_includes)
  configure_file(cmake/package/freshet.pc.in ${CMAKE_CURRENT_BINARY_DIR}/freshet.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/freshet.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/freshetConfig.cmake DESTINATION ${package_dir} COMPONENT dev)
else()
  install(FILES cmake/freshetConfig.cmake cmake/dependencies.cmake DESTINATION ${package_dir} COMPONENT dev)
endif()
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/freshetConfigVersion.cmake DESTINATION ${package_dir} COMPONENT dev)

# Manual pages and completions are made from the program's own help, when it is installed.
find_program(FRESHET_PYTHON3 python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(FRESHET_PYTHON3)
  set(pages ${CMAKE_CURRENT_BINARY_DIR}/pages)
  install(CODE "execute_process(COMMAND_ERROR_IS_FATAL ANY
    COMMAND ${FRESHET_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/from_help.py $<TARGET_FILE:freshet> ${pages})"
    COMPONENT freshet)
  install(DIRECTORY ${pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT freshet)
  install(FILES ${pages}/bash/freshet DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT freshet)
  install(FILES ${pages}/zsh/_freshet DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT freshet)
  install(FILES ${pages}/fish/freshet.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT freshet)
endif()
install(FILES cmake/package/freshet.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT freshet)
install(FILES cmake/package/freshet.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT freshet)
install(FILES studio/page/src/icon.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps RENAME freshet.svg
        COMPONENT freshet)
install(FILES docs/manual.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/freshet COMPONENT freshet)

include(cpack)
