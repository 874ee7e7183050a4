# What `cmake --install` puts where, so that find_package(freshet) gives freshet::store, freshet::query, ...
include(CMakePackageConfigHelpers)

set(rooms store media vision ingest query field animate matte simulate transfer transfer_files)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/freshet)
foreach(room ${rooms})
  set_target_properties(freshet_${room} PROPERTIES EXPORT_NAME ${room})
  install(TARGETS freshet_${room} EXPORT freshet-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endforeach()
install(TARGETS freshet_flags EXPORT freshet-targets)
install(EXPORT freshet-targets NAMESPACE freshet:: DESTINATION ${package_dir})

install(DIRECTORY include/freshet platform store media vision ingest query synth DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/freshet
        FILES_MATCHING PATTERN "*.h" PATTERN query/benchmark EXCLUDE)

write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/freshetConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES cmake/freshetConfig.cmake cmake/dependencies.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/freshetConfigVersion.cmake DESTINATION ${package_dir})
