# cpack: Debian packages, one a component, and the source archive (target package_source), which builds with no git.
set(CPACK_PACKAGE_NAME freshet)
set(CPACK_PACKAGE_CONTACT "Freshet <freshet@localhost.localdomain>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "patch database engine for fluid video")
set(CPACK_GENERATOR DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY >=)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# What the build links is found there, before it is installed.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_CURRENT_BINARY_DIR}/library)

set(library_package libfreshet${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(all_of_it "Freshet turns videos of fluids into one packed store, finds in it the patches
that look like the pieces of a still picture, and animates the picture with
them.")
function(debian_package component name section what)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION "${all_of_it}\n.\nThis package holds ${what}." PARENT_SCOPE)
  # Policy wants a copyright and a changelog in every package.
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/copyright DESTINATION ${folder} COMPONENT ${component})
  install(CODE "execute_process(COMMAND gzip -9nc ${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/changelog
    OUTPUT_FILE ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION ${folder} COMPONENT ${component})
endfunction()

set(CPACK_COMPONENTS_ALL freshet)
debian_package(freshet freshet graphics "the program")
set(CPACK_DEBIAN_FRESHET_PACKAGE_RECOMMENDS ffmpeg)
if(BUILD_SHARED_LIBS)
  list(APPEND CPACK_COMPONENTS_ALL library dev)
  debian_package(library ${library_package} libs "the shared library")
  debian_package(dev libfreshet-dev libdevel "the headers for C++")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/triggers)
  set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
  set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${library_package} (= ${PROJECT_VERSION}), libopencv-core-dev")
endif()
if(FRESHET_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  debian_package(python python3-freshet python "the Python module")
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next}), python3-numpy")
  if(BUILD_SHARED_LIBS)
    string(APPEND CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS ", ${library_package} (= ${PROJECT_VERSION})")
  endif()
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-h5py)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_GENERATE_SHLIBS OFF)
endif()

set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_IGNORE_FILES /\\\\.git/ /\\\\.git$ ${CMAKE_CURRENT_SOURCE_DIR}/build/ ${CMAKE_CURRENT_SOURCE_DIR}/demo/ /node_modules/ /__pycache__/)
include(CPack)
