# Finds every dependency; a missing one is one sentence that names the Debian package to install.
include_guard(GLOBAL)

macro(saccade_require package debian_package)
  find_package(${package} QUIET ${ARGN})
  if(NOT ${package}_FOUND)
    message(FATAL_ERROR "Saccade needs ${package}: install the Debian package ${debian_package}.")
  endif()
endmacro()

# Libraries that ship neither a CMake package nor a reliable pkg-config file.
function(saccade_require_library target header library debian_package)
  find_path(${target}_INCLUDE_DIR ${header})
  find_library(${target}_LIBRARY ${library})
  if(NOT ${target}_INCLUDE_DIR OR NOT ${target}_LIBRARY)
    message(FATAL_ERROR "Saccade needs ${header} and lib${library}: install the Debian package ${debian_package}.")
  endif()
  add_library(saccade_dependency::${target} UNKNOWN IMPORTED)
  set_target_properties(saccade_dependency::${target} PROPERTIES
    IMPORTED_LOCATION "${${target}_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${${target}_INCLUDE_DIR}")
endfunction()

saccade_require(Eigen3 libeigen3-dev)
saccade_require(OpenCV "libopencv-contrib-dev" COMPONENTS core imgproc imgcodecs videoio ximgproc features2d calib3d)
saccade_require(Threads libc6-dev)
saccade_require(TBB libtbb-dev)
saccade_require(yaml-cpp libyaml-cpp-dev)
saccade_require(nlohmann_json nlohmann-json3-dev)
saccade_require(fmt libfmt-dev)
saccade_require(CLI11 libcli11-dev)
saccade_require_library(octomap octomap/OcTree.h octomap liboctomap-dev)
saccade_require_library(octomath octomap/math/Pose6D.h octomath liboctomap-dev)
saccade_require_library(svm libsvm/svm.h svm libsvm-dev)
saccade_require_library(embree embree3/rtcore.h embree3 libembree-dev)
saccade_require_library(sqlite3 sqlite3.h sqlite3 libsqlite3-dev)
saccade_require_library(zstd zstd.h zstd libzstd-dev)
saccade_require_library(avformat libavformat/avformat.h avformat libavformat-dev)
saccade_require_library(avcodec libavcodec/avcodec.h avcodec libavcodec-dev)
saccade_require_library(avutil libavutil/avutil.h avutil libavutil-dev)
saccade_require_library(swscale libswscale/swscale.h swscale libswscale-dev)
saccade_require(SQLiteCpp libsqlitecpp-dev)
saccade_require(Boost libboost-dev)

# .3Dscene files for MRPT's viewer: on where MRPT is found.
find_package(mrpt-opengl QUIET)
set(SACCADE_HAVE_MRPT_SCENES ${mrpt-opengl_FOUND})
