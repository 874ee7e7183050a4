# What `cmake --install` puts where, so that find_package(freshet) gives freshet::freshet and the headers of
# include/freshet. The rooms behind it are installed as archives alone: no header of theirs.
include(CMakePackageConfigHelpers)

set(rooms report cache store media hints vision stored ingest query field toml sampling outline playing animate matte simulate transfer transfer_files)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/freshet)
foreach(room ${rooms})
  set_target_properties(freshet_${room} PROPERTIES EXPORT_NAME ${room})
  install(TARGETS freshet_${room} EXPORT freshet-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endforeach()
set_target_properties(freshet_library PROPERTIES EXPORT_NAME freshet)
install(TARGETS freshet_library EXPORT freshet-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} FILE_SET HEADERS)
install(TARGETS freshet_flags EXPORT freshet-targets)
install(EXPORT freshet-targets NAMESPACE freshet:: DESTINATION ${package_dir})

write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/freshetConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES cmake/freshetConfig.cmake cmake/dependencies.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/freshetConfigVersion.cmake DESTINATION ${package_dir})
