#include "saccade/map/morton_code.hpp"

#include <array>
#include <utility>

namespace saccade {

void sortByMortonCode(std::vector<MortonCoded>& coded, std::vector<MortonCoded>& scratch, int bits) {
  // Radix sort, least digit first, which is stable.
  constexpr int kDigitBits = 11;
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  scratch.resize(coded.size());
  for (int shift = 0; shift < bits; shift += kDigitBits) {
    std::array<std::uint32_t, kDigits> start{};
    for (const MortonCoded& one : coded) ++start[one.code >> shift & (kDigits - 1)];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) sum += std::exchange(s, sum);
    for (const MortonCoded& one : coded) scratch[start[one.code >> shift & (kDigits - 1)]++] = one;
    std::swap(coded, scratch);
  }
}

}  // namespace saccade
