#include "saccade/discovery/svm.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr std::size_t kRows = 8;   // rows judged at a time
constexpr std::size_t kBlock = 4;  // support vectors taken together

// Half of the rows judged at a time: one AVX register, or two of SSE or NEON.
using Quad = double __attribute__((vector_size(32)));
using QuadBits = std::int64_t __attribute__((vector_size(32)));

SACCADE_INLINE Quad loadQuad(const double* from) {
  Quad quad;
  std::memcpy(&quad, from, sizeof quad);
  return quad;
}

// e^x for x <= 0 within a relative 1e-11: 2^n by the exponent bits, the rest by its series to the 9th power.
SACCADE_INLINE Quad expOfNegative(const Quad& power) {
  constexpr double kLog2E = 1.4426950408889634, kLn2 = 0.693147180559945309;
  constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52: adding it leaves the rounded number in the low bits
  constexpr double kLeast = -700.0;                // smaller results would not be normal numbers
  const Quad x = power < kLeast ? Quad{} + kLeast : power;
  const Quad shifted = x * kLog2E + kRounder;
  const Quad r = x - (shifted - kRounder) * kLn2;
  Quad p = r * (1.0 / 362880.0) + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  p = p * r + 1.0;
  p = p * r + 1.0;
  return std::bit_cast<Quad>(std::bit_cast<QuadBits>(p) + (std::bit_cast<QuadBits>(shifted) << 52));
}

// Decision values of eight rows, given value by value: columns[d * kRows + lane]. |x - v|² = |x|² + |v|² - 2 x·v
// leaves one multiplication and addition a value; the products of a block of vectors with all lanes stay in registers.
SACCADE_MULTIVERSION void decide(const double* columns, const double* row_norms, const double* vectors,
                                 const double* norms, const double* coefficients, std::size_t vector_count,
                                 std::size_t dimension, double gamma, double* decision) {
  const Quad low_norms = loadQuad(row_norms), high_norms = loadQuad(row_norms + kRows / 2);
  Quad low_sum = {}, high_sum = {};
  for (std::size_t s = 0; s < vector_count; s += kBlock) {
    const double* block = vectors + s * dimension;
    Quad low[kBlock] = {}, high[kBlock] = {};
    for (std::size_t d = 0; d < dimension; ++d) {
      const Quad x_low = loadQuad(columns + d * kRows), x_high = loadQuad(columns + d * kRows + kRows / 2);
      for (std::size_t i = 0; i < kBlock; ++i) {
        low[i] += x_low * block[d * kBlock + i];
        high[i] += x_high * block[d * kBlock + i];
      }
    }
    for (std::size_t i = 0; i < kBlock; ++i) {  // rounding may leave a distance a little below 0: e^x bears it
      low_sum += coefficients[s + i] * expOfNegative((2.0 * low[i] - low_norms - norms[s + i]) * gamma);
      high_sum += coefficients[s + i] * expOfNegative((2.0 * high[i] - high_norms - norms[s + i]) * gamma);
    }
  }
  std::memcpy(decision, &low_sum, sizeof low_sum);
  std::memcpy(decision + kRows / 2, &high_sum, sizeof high_sum);
}

double sigmoid(double decision, double a, double b) {
  const double x = a * decision + b;
  return x >= 0.0 ? std::exp(-x) / (1.0 + std::exp(-x)) : 1.0 / (1.0 + std::exp(x));
}

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  [[noreturn]] void complain(const std::string& expected, std::string_view found) const {
    throw std::invalid_argument("line " + std::to_string(number_) + " of the SVM: expected " + expected + ", found \"" +
                                std::string(found.substr(0, 60)) + "\"");
  }

 private:
  std::string_view rest_;
  int number_ = 0;
};

std::string_view takeWord(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

template <typename Number>
Number toNumber(const Lines& lines, std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  bool finite = true;
  if constexpr (std::is_floating_point_v<Number>) finite = std::isfinite(value);
  if (error != std::errc{} || end != word.data() + word.size() || !finite) lines.complain("a number", word);
  return value;
}

}  // namespace

Svm Svm::parse(std::string_view text) {
  Svm svm;
  svm.text_ = text;
  Lines lines(text);
  std::string_view line;
  std::size_t total = 0;
  bool has_probability = false, has_label = false, in_vectors = false;
  const auto requireWord = [&](std::string_view found, std::string_view expected) {
    if (found != expected) lines.complain(std::string(expected), found);
  };
  while (!in_vectors && lines.next(line)) {
    const std::string_view key = takeWord(line);
    std::string_view value_words = line;
    const std::string_view value = takeWord(value_words);
    if (key == "svm_type") requireWord(value, "c_svc");
    if (key == "kernel_type") requireWord(value, "rbf");
    if (key == "nr_class") requireWord(value, "2");
    if (key == "gamma") svm.gamma_ = toNumber<double>(lines, value);
    if (key == "rho") svm.rho_ = toNumber<double>(lines, value);
    if (key == "total_sv") total = toNumber<std::size_t>(lines, value);
    if (key == "probA") svm.prob_a_ = toNumber<double>(lines, value), has_probability = true;
    if (key == "probB") svm.prob_b_ = toNumber<double>(lines, value);
    if (key == "label") svm.first_label_is_object_ = toNumber<int>(lines, value) == 1, has_label = true;
    in_vectors = key == "SV";
  }
  if (!in_vectors || !has_label || !has_probability || !(svm.gamma_ > 0.0)) {
    lines.complain("the header of an RBF classifier with probabilities", line);
  }
  std::vector<std::pair<std::size_t, double>> entries;  // row * 2^32 + column, value
  while (lines.next(line)) {
    const std::string_view coefficient = takeWord(line);
    if (coefficient.empty()) continue;
    const std::size_t row = svm.coefficients_.size();
    svm.coefficients_.push_back(toNumber<double>(lines, coefficient));
    for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
      const std::size_t colon = word.find(':');
      if (colon == std::string_view::npos) lines.complain("INDEX:VALUE", word);
      const auto index = toNumber<std::size_t>(lines, word.substr(0, colon));
      if (index < 1 || index > 4096) lines.complain("an index from 1 to 4096", word);
      entries.emplace_back(row << 32 | (index - 1), toNumber<double>(lines, word.substr(colon + 1)));
      svm.dimension_ = std::max(svm.dimension_, index);
    }
  }
  if (svm.coefficients_.empty() || svm.coefficients_.size() != total) {
    lines.complain(std::to_string(total) + " support vectors", std::to_string(svm.coefficients_.size()));
  }
  svm.vector_count_ = svm.coefficients_.size();
  const std::size_t padded = (svm.vector_count_ + kBlock - 1) / kBlock * kBlock;
  svm.coefficients_.resize(padded, 0.0);
  svm.norms_.assign(padded, 0.0);
  svm.vectors_.assign(padded * svm.dimension_, 0.0);
  for (const auto& [place, value] : entries) {
    const std::size_t row = place >> 32, column = place & 0xFFFFFFFFU;
    svm.vectors_[(row / kBlock * svm.dimension_ + column) * kBlock + row % kBlock] = value;
    svm.norms_[row] += value * value;
  }
  return svm;
}

void Svm::predict(std::span<const float> rows, std::size_t count, std::span<double> probability) const {
  if (rows.size() < count * dimension_ || probability.size() < count) {
    throw std::invalid_argument("Svm::predict: " + std::to_string(count) + " rows of " + std::to_string(dimension_) +
                                " values announced, " + std::to_string(rows.size()) + " values given");
  }
  constexpr double kSmallest = 1e-7;  // LIBSVM keeps pairwise probabilities this far from 0 and 1
  std::vector<double> columns(dimension_ * kRows, 0.0);
  std::array<double, kRows> decision{}, row_norms{};
  for (std::size_t first = 0; first < count; first += kRows) {
    const std::size_t lanes = std::min(kRows, count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      row_norms[lane] = 0.0;
      for (std::size_t d = 0; d < dimension_; ++d) {
        const auto value = static_cast<double>(rows[(first + lane) * dimension_ + d]);
        columns[d * kRows + lane] = value;
        row_norms[lane] += value * value;
      }
    }
    decide(columns.data(), row_norms.data(), vectors_.data(), norms_.data(), coefficients_.data(), coefficients_.size(),
           dimension_, gamma_, decision.data());
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double pairwise = sigmoid(decision[lane] - rho_, prob_a_, prob_b_);
      const double first_class = std::clamp(pairwise, kSmallest, 1.0 - kSmallest);
      probability[first + lane] = first_label_is_object_ ? first_class : 1.0 - first_class;
    }
  }
}

}  // namespace saccade
