#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace saccade {

/// Predicts with a two-class C-SVC of LIBSVM that has an RBF kernel and probability estimates (Chang & Lin 2011; the
/// paper's ranker).
///
/// The text is LIBSVM's own model format; the prediction is our vectorised kernel and equals svm_predict_probability
/// within 1e-6. Immutable after construction, so any number of threads may predict. Training: svm_training.hpp.
class Svm {
 public:
  Svm() = default;

  /// Reads LIBSVM's model text. Throws std::invalid_argument that names the line if it is not such a model.
  [[nodiscard]] static Svm parse(std::string_view text);

  /// Probability of the class +1 of each of `count` rows of dimension() values, row after row.
  /// 1 000 rows against 200 support vectors of 36 values: about 0.7 ms with AVX2.
  void predict(std::span<const float> rows, std::size_t count, std::span<double> probability) const;

  /// Values of a row: the largest feature index of the model.
  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  [[nodiscard]] std::size_t supportVectors() const { return vector_count_; }
  /// The model as it was read.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::size_t dimension_ = 0;
  double gamma_ = 0.0, rho_ = 0.0, prob_a_ = 0.0, prob_b_ = 0.0;
  bool first_label_is_object_ = true;
  std::size_t vector_count_ = 0;
  std::vector<double> coefficients_;  ///< of the vectors, 0 for those that fill the last block
  std::vector<double> vectors_;       ///< block after block, in each value by value
  std::vector<double> norms_;         ///< squared lengths of the vectors
};

}  // namespace saccade
