# Everything Freshet stands on: distribution packages only, found here once.
find_package(PkgConfig REQUIRED)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs video calib3d features2d optflow photo xphoto alphamat ximgproc)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LMDB REQUIRED IMPORTED_TARGET lmdb)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_check_modules(FFMPEG REQUIRED IMPORTED_TARGET libavformat libavfilter libavcodec libavutil libswscale)
pkg_check_modules(OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)
pkg_check_modules(LCMS REQUIRED IMPORTED_TARGET lcms2)

# FLANN ships no CMake package. It is header templates and one library, and its headers call LZ4.
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
find_library(FLANN_CPP_LIBRARY flann_cpp REQUIRED)
# Imported, so that a program that links Freshet meets it under the same name.
add_library(flann_cpp INTERFACE IMPORTED GLOBAL)
target_include_directories(flann_cpp SYSTEM INTERFACE ${FLANN_INCLUDE_DIR})
target_link_libraries(flann_cpp INTERFACE ${FLANN_CPP_LIBRARY} PkgConfig::LZ4)
