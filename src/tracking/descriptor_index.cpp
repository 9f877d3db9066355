#include "tracking/descriptor_index.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "saccade/core/multiversion.hpp"
#include "saccade/tracking/frame_features.hpp"

namespace saccade {
namespace {

constexpr int kWords = FrameFeatures::kDescriptorBytes / 8;
/// Descriptors of the same point from another view differ in some 20 to 60 of their 256 bits, of others in 128 +- 20.
constexpr int kSimilarBits = 60;

SACCADE_MULTIVERSION
void hammingDistances(const std::uint8_t* query, const std::uint8_t* const* others, std::size_t count, int* distances) {
  std::uint64_t q[kWords];
  std::memcpy(q, query, sizeof q);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t o[kWords];
    std::memcpy(o, others[i], sizeof o);
    int distance = 0;
    for (int k = 0; k < kWords; ++k) distance += std::popcount(q[k] ^ o[k]);
    distances[i] = distance;
  }
}

}  // namespace

DescriptorIndex::DescriptorIndex() {
  std::mt19937_64 random(0x5ACCADE);  // its sequence is the same everywhere, unlike that of a distribution
  for (auto& table : bits_) {
    for (std::uint8_t& bit : table) bit = static_cast<std::uint8_t>(random() >> 56);
  }
  for (auto& table : buckets_) table.resize(std::size_t{1} << kBits);
}

std::size_t DescriptorIndex::bucketOf(std::size_t table, const std::uint8_t* descriptor) const {
  std::size_t bucket = 0;
  for (const std::uint8_t bit : bits_[table]) bucket = 2 * bucket + ((descriptor[bit >> 3] >> (bit & 7)) & 1U);
  return bucket;
}

void DescriptorIndex::add(const cv::Mat1b& descriptors) {
  const auto image = static_cast<std::uint32_t>(images_.size());
  images_.push_back(descriptors);
  for (int row = 0; row < descriptors.rows; ++row) {
    const auto position = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({image, static_cast<std::uint32_t>(row)});
    for (std::size_t table = 0; table < kTables; ++table) {
      buckets_[table][bucketOf(table, descriptors[row])].push_back(position);
    }
  }
}

std::vector<double> DescriptorIndex::similarities(const cv::Mat1b& query) const {
  std::vector<double> similarity(images_.size(), 0.0);
  std::vector<int> nearest(images_.size(), kSimilarBits);  // per image, for one row
  std::vector<std::uint32_t> met;
  std::vector<const std::uint8_t*> others;
  std::vector<int> distances;
  for (int row = 0; row < query.rows; ++row) {
    for (std::size_t table = 0; table < kTables; ++table) {
      const auto& bucket = buckets_[table][bucketOf(table, query[row])];
      others.clear();
      for (const std::uint32_t position : bucket) {
        const Entry& entry = entries_[position];
        others.push_back(images_[entry.image][static_cast<int>(entry.row)]);
      }
      distances.resize(others.size());
      hammingDistances(query[row], others.data(), others.size(), distances.data());
      for (std::size_t i = 0; i < bucket.size(); ++i) {
        const std::uint32_t image = entries_[bucket[i]].image;
        if (distances[i] >= nearest[image]) continue;
        if (nearest[image] == kSimilarBits) met.push_back(image);
        nearest[image] = distances[i];
      }
    }
    const double rarity = std::log1p(static_cast<double>(images_.size()) / static_cast<double>(met.size() + 1));
    for (const std::uint32_t image : met) {
      similarity[image] += rarity * (1.0 - static_cast<double>(nearest[image]) / kSimilarBits);
      nearest[image] = kSimilarBits;
    }
    met.clear();
  }
  return similarity;
}

}  // namespace saccade
