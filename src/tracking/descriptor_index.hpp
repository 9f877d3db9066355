#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// Which images share descriptors with a new one: locality-sensitive hashing by random bits (Indyk and Motwani 1998),
/// so that nothing has to be learnt and images can be added at any time.
///
/// Owns the hash tables; the descriptors stay with their owner and must outlive the index. 36 bytes a descriptor.
class DescriptorIndex {
 public:
  DescriptorIndex();

  /// Takes the rows of `descriptors` as the image after the last one.
  void add(const cv::Mat1b& descriptors);

  /// How much each image has in common with `query`: per row of `query` and image the nearness of the most similar
  /// descriptor found, weighted down if many images have one. Cost ~ rows of `query` times what its buckets hold.
  [[nodiscard]] std::vector<double> similarities(const cv::Mat1b& query) const;

 private:
  static constexpr std::size_t kTables = 8;
  static constexpr std::size_t kBits = 12;

  struct Entry {
    std::uint32_t image = 0;
    std::uint32_t row = 0;
  };

  [[nodiscard]] std::size_t bucketOf(std::size_t table, const std::uint8_t* descriptor) const;

  std::array<std::array<std::uint8_t, kBits>, kTables> bits_;             ///< of the descriptor, per table
  std::array<std::vector<std::vector<std::uint32_t>>, kTables> buckets_;  ///< positions in entries_
  std::vector<Entry> entries_;
  std::vector<cv::Mat1b> images_;
};

}  // namespace saccade
