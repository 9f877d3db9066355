#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <memory>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <string>
#include <type_traits>
#include <vector>

namespace saccade {

/// Messages generated for older C++ ask their allocators for `rebind`, which std::allocator lost in C++20. Their texts
/// stay plain std::string.
template <typename T>
struct MessageAllocator : std::allocator<T> {
  MessageAllocator() = default;
  template <typename U>
  MessageAllocator(const MessageAllocator<U>&) noexcept {}

  template <typename U>
  struct rebind {
    using other = std::conditional_t<std::is_same_v<U, char>, std::allocator<char>, MessageAllocator<U>>;
  };
};

using ImageMessage = sensor_msgs::Image_<MessageAllocator<void>>;
using CompressedImageMessage = sensor_msgs::CompressedImage_<MessageAllocator<void>>;
using CameraInfoMessage = sensor_msgs::CameraInfo_<MessageAllocator<void>>;
using TransformStampedMessage = geometry_msgs::TransformStamped_<MessageAllocator<void>>;

/// `tf2_msgs/TFMessage`, whose own package would bring a message generator along.
struct TransformMessage {
  std::vector<TransformStampedMessage, MessageAllocator<TransformStampedMessage>> transforms;
};

inline constexpr const char* kTransformMd5 = "94810edda583a504dfda3829e70d7eec";

}  // namespace saccade

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<saccade::TransformMessage> {
  static const char* value() { return saccade::kTransformMd5; }
  static const char* value(const saccade::TransformMessage&) { return value(); }
};
template <>
struct DataType<saccade::TransformMessage> {
  static const char* value() { return "tf2_msgs/TFMessage"; }
  static const char* value(const saccade::TransformMessage&) { return value(); }
};
template <>
struct Definition<saccade::TransformMessage> {
  static const char* value() {
    static const std::string text =
        "geometry_msgs/TransformStamped[] transforms\n\n"
        "================================================================================\n"
        "MSG: geometry_msgs/TransformStamped\n" +
        std::string(Definition<saccade::TransformStampedMessage>::value());
    return text.c_str();
  }
  static const char* value(const saccade::TransformMessage&) { return value(); }
};

}  // namespace message_traits
namespace serialization {

template <>
struct Serializer<saccade::TransformMessage> {
  template <typename Stream, typename T>
  static void allInOne(Stream& stream, T message) {
    stream.next(message.transforms);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace serialization
}  // namespace ros
