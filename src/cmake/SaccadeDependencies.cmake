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
# Sensors and recordings of other systems: used where they are found, each may be switched off. What a build lacks is said
# when somebody asks for it.
find_package(mrpt-obs QUIET)
option(SACCADE_WITH_MRPT "Read and write MRPT rawlogs (libmrpt-obs-dev)" ${mrpt-obs_FOUND})

# rosbag's own CMake package wants all of ROS; its headers want those of pluginlib and what that needs.
find_path(SACCADE_ROSBAG_INCLUDE_DIR rosbag/bag.h)
find_path(SACCADE_SENSOR_MSGS_INCLUDE_DIR sensor_msgs/Image.h)
find_library(SACCADE_ROSBAG_LIBRARY rosbag_storage)
if(SACCADE_ROSBAG_INCLUDE_DIR AND SACCADE_SENSOR_MSGS_INCLUDE_DIR AND SACCADE_ROSBAG_LIBRARY)
  set(saccade_rosbag_found ON)
else()
  set(saccade_rosbag_found OFF)
endif()
option(SACCADE_WITH_ROSBAG "Read and write ROS 1 bags (librosbag-storage-dev, libsensor-msgs-dev)" ${saccade_rosbag_found})
if(SACCADE_WITH_ROSBAG AND NOT TARGET saccade_dependency::rosbag)
  if(NOT saccade_rosbag_found)
    message(FATAL_ERROR "Saccade needs rosbag/bag.h and sensor_msgs/Image.h: install the Debian packages librosbag-storage-dev and libsensor-msgs-dev.")
  endif()
  add_library(saccade_dependency::rosbag INTERFACE IMPORTED)
  set(saccade_rosbag_includes "${SACCADE_ROSBAG_INCLUDE_DIR}")
  foreach(part pluginlib class_loader rcpputils rcutils ament_index_cpp)
    list(APPEND saccade_rosbag_includes "${SACCADE_ROSBAG_INCLUDE_DIR}/${part}")
  endforeach()
  set_target_properties(saccade_dependency::rosbag PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${saccade_rosbag_includes}"
    INTERFACE_LINK_LIBRARIES "${SACCADE_ROSBAG_LIBRARY};roscpp_serialization;rostime;cpp_common;console_bridge")
endif()

find_path(SACCADE_OPENNI2_INCLUDE_DIR OpenNI.h PATH_SUFFIXES openni2)
find_library(SACCADE_OPENNI2_LIBRARY OpenNI2)
if(SACCADE_OPENNI2_INCLUDE_DIR AND SACCADE_OPENNI2_LIBRARY)
  set(saccade_openni2_found ON)
else()
  set(saccade_openni2_found OFF)
endif()
option(SACCADE_WITH_OPENNI2 "Read OpenNI2 cameras, read and write .oni (libopenni2-dev)" ${saccade_openni2_found})
if(SACCADE_WITH_OPENNI2 AND NOT TARGET saccade_dependency::openni2)
  if(NOT saccade_openni2_found)
    message(FATAL_ERROR "Saccade needs OpenNI.h and libOpenNI2: install the Debian package libopenni2-dev.")
  endif()
  add_library(saccade_dependency::openni2 UNKNOWN IMPORTED)
  set_target_properties(saccade_dependency::openni2 PROPERTIES
    IMPORTED_LOCATION "${SACCADE_OPENNI2_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${SACCADE_OPENNI2_INCLUDE_DIR}")
endif()
