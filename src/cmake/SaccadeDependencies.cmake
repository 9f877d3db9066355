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
saccade_require(OpenCV "libopencv-dev" COMPONENTS core imgproc imgcodecs videoio)
saccade_require(Threads libc6-dev)
saccade_require(TBB libtbb-dev)
saccade_require(yaml-cpp libyaml-cpp-dev)
saccade_require(nlohmann_json nlohmann-json3-dev)
saccade_require(spdlog libspdlog-dev)
saccade_require(CLI11 libcli11-dev)
saccade_require_library(octomap octomap/OcTree.h octomap liboctomap-dev)
saccade_require_library(octomath octomap/math/Pose6D.h octomath liboctomap-dev)
saccade_require_library(svm libsvm/svm.h svm libsvm-dev)
saccade_require_library(sqlite3 sqlite3.h sqlite3 libsqlite3-dev)
saccade_require_library(zstd zstd.h zstd libzstd-dev)
