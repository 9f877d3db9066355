#include "saccade/discovery/svm_training.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>

#include <libsvm/svm.h>

#include "saccade/discovery/kernel_expansion.hpp"

namespace saccade {
namespace {

constexpr double kCacheMib = 200.0;
constexpr double kStop = 1e-3;

struct ModelDeleter {
  void operator()(svm_model* model) const { svm_free_and_destroy_model(&model); }
};
using ModelPointer = std::unique_ptr<svm_model, ModelDeleter>;

void silent(const char*) {}

// LIBSVM's sparse rows; the model points into them, so they must outlive it.
class Problem {
 public:
  Problem(const SvmExamples& examples, const std::vector<std::size_t>& chosen) {
    const std::size_t d = examples.dimension;
    nodes_.resize(chosen.size() * (d + 1));
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      svm_node* row = nodes_.data() + i * (d + 1);
      for (std::size_t k = 0; k < d; ++k) {
        row[k] = {static_cast<int>(k) + 1, static_cast<double>(examples.rows[chosen[i] * d + k])};
      }
      row[d] = {-1, 0.0};
      rows_.push_back(row);
      labels_.push_back(examples.labels[chosen[i]]);
    }
    problem_.l = static_cast<int>(chosen.size());
    problem_.y = labels_.data();
    problem_.x = rows_.data();
  }
  [[nodiscard]] const svm_problem& get() const { return problem_; }

 private:
  std::vector<svm_node> nodes_;
  std::vector<svm_node*> rows_;
  std::vector<double> labels_;
  svm_problem problem_{};
};

// Puts an object first: LIBSVM calls the class of the first example the first class.
void objectFirst(const SvmExamples& examples, std::vector<std::size_t>& chosen) {
  const auto object = std::find_if(chosen.begin(), chosen.end(), [&](std::size_t i) { return examples.labels[i] > 0; });
  if (object != chosen.end()) std::rotate(chosen.begin(), object, object + 1);
}

ModelPointer train(const SvmExamples& examples, const std::vector<std::size_t>& chosen, const Problem& problem,
                   const SvmTrainingConfig& config) {
  const auto objects = static_cast<double>(
      std::count_if(chosen.begin(), chosen.end(), [&](std::size_t i) { return examples.labels[i] > 0; }));
  const double others = static_cast<double>(chosen.size()) - objects;
  int labels[2] = {1, -1};
  double weights[2] = {std::sqrt(others / objects), std::sqrt(objects / others)};
  svm_parameter parameter{};
  parameter.svm_type = C_SVC;
  parameter.kernel_type = RBF;
  parameter.gamma = config.gamma;
  parameter.C = config.c;
  parameter.cache_size = kCacheMib;
  parameter.eps = kStop;
  parameter.shrinking = 1;
  parameter.nr_weight = 2;
  parameter.weight_label = labels;
  parameter.weight = weights;
  ModelPointer model(svm_train(&problem.get(), &parameter));
  // The model keeps a copy of the parameters; the weights live on this stack frame.
  model->param.nr_weight = 0;
  model->param.weight_label = nullptr;
  model->param.weight = nullptr;
  return model;
}

std::vector<double> heldOutDecisions(const SvmExamples& examples, const std::vector<std::size_t>& chosen,
                                     const SvmTrainingConfig& config) {
  std::vector<int> groups;
  for (const std::size_t i : chosen) groups.push_back(examples.groups[i]);
  const std::vector<int> folds = foldOfExamples(groups, config.folds);
  std::vector<double> decisions(chosen.size(), 0.0);
  const Problem everything(examples, chosen);
  for (int fold = 0; fold < config.folds; ++fold) {
    std::vector<std::size_t> rest;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (folds[i] != fold) rest.push_back(chosen[i]);
    }
    objectFirst(examples, rest);
    const bool both = !rest.empty() && examples.labels[rest.front()] > 0 &&
                      std::any_of(rest.begin(), rest.end(), [&](std::size_t i) { return examples.labels[i] < 0; });
    if (!both) continue;
    const Problem problem(examples, rest);
    const ModelPointer model = train(examples, rest, problem, config);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (folds[i] == fold) svm_predict_values(model.get(), everything.get().x[i], &decisions[i]);
    }
  }
  return decisions;
}

struct Sigmoid {
  double a = 0.0, b = 0.0;
};

// P(object | f) = 1 / (1 + exp(a f + b)) by Newton's method with halved steps (Lin, Lin & Weng 2007).
Sigmoid fitSigmoid(const std::vector<double>& decisions, const std::vector<std::int8_t>& labels) {
  const auto objects = static_cast<double>(std::count(labels.begin(), labels.end(), std::int8_t{1}));
  const double others = static_cast<double>(labels.size()) - objects;
  const double high = (objects + 1.0) / (objects + 2.0), low = 1.0 / (others + 2.0);
  const auto target = [&](std::size_t i) { return labels[i] > 0 ? high : low; };
  const auto cost = [&](const Sigmoid& s) {
    double sum = 0.0;
    for (std::size_t i = 0; i < decisions.size(); ++i) {
      const double x = decisions[i] * s.a + s.b;
      sum += x >= 0.0 ? target(i) * x + std::log1p(std::exp(-x)) : (target(i) - 1.0) * x + std::log1p(std::exp(x));
    }
    return sum;
  };
  Sigmoid best{0.0, std::log((others + 1.0) / (objects + 1.0))};
  double best_cost = cost(best);
  for (int round = 0; round < 100; ++round) {
    double h11 = 1e-12, h22 = 1e-12, h21 = 0.0, g1 = 0.0, g2 = 0.0;
    for (std::size_t i = 0; i < decisions.size(); ++i) {
      const double p = 1.0 / (1.0 + std::exp(decisions[i] * best.a + best.b)), d2 = p * (1.0 - p), d1 = target(i) - p;
      h11 += decisions[i] * decisions[i] * d2;
      h22 += d2;
      h21 += decisions[i] * d2;
      g1 += decisions[i] * d1;
      g2 += d1;
    }
    if (std::abs(g1) < 1e-5 && std::abs(g2) < 1e-5) break;
    const double determinant = h11 * h22 - h21 * h21;
    const double step_a = -(h22 * g1 - h21 * g2) / determinant, step_b = -(h11 * g2 - h21 * g1) / determinant;
    double length = 1.0;
    for (; length > 1e-10; length /= 2.0) {
      const Sigmoid next{best.a + length * step_a, best.b + length * step_b};
      const double next_cost = cost(next);
      if (next_cost >= best_cost) continue;
      best = next;
      best_cost = next_cost;
      break;
    }
    if (length <= 1e-10) break;
  }
  return best;
}

// LIBSVM's own model, its rows filled up with zeros again.
KernelExpansion expansionOf(const svm_model& model, std::size_t dimension) {
  KernelExpansion expansion{dimension, model.param.gamma, model.rho[0], {}, {}};
  for (int i = 0; i < model.l; ++i) {
    expansion.coefficients.push_back(model.sv_coef[0][i]);
    const std::size_t begin = expansion.vectors.size();
    expansion.vectors.resize(begin + dimension, 0.0);
    for (const svm_node* node = model.SV[i]; node->index != -1; ++node) {
      expansion.vectors[begin + static_cast<std::size_t>(node->index) - 1] = node->value;
    }
  }
  return expansion;
}

// The model in LIBSVM's text format, with the sigmoid. LIBSVM lists the vectors of the first class, whose coefficients
// are positive, before those of the second.
std::string writeModel(const KernelExpansion& expansion, const Sigmoid& sigmoid) {
  std::vector<std::size_t> order(expansion.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto second =
      std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return expansion.coefficients[i] > 0.0; });
  std::ostringstream out;
  out.precision(12);
  out << "svm_type c_svc\nkernel_type rbf\ngamma " << expansion.gamma << "\nnr_class 2\ntotal_sv " << order.size()
      << "\nrho " << expansion.rho << "\nlabel 1 -1\nprobA " << sigmoid.a << "\nprobB " << sigmoid.b << "\nnr_sv "
      << second - order.begin() << ' ' << order.end() - second << "\nSV\n";
  for (const std::size_t i : order) {
    out << expansion.coefficients[i];
    for (std::size_t k = 0; k < expansion.dimension; ++k) {
      const double value = expansion.vectors[i * expansion.dimension + k];
      char text[32];
      std::snprintf(text, sizeof text, "%.4g", value);
      // The last index says how long a row is, so it is there even where its value is 0 throughout.
      if (value != 0.0 || k + 1 == expansion.dimension) out << ' ' << k + 1 << ':' << text;
    }
    out << " \n";
  }
  return out.str();
}

}  // namespace

std::vector<int> foldOfExamples(const std::vector<int>& groups, int folds) {
  std::vector<int> known = groups;
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<int> result;
  for (const int group : groups) {
    const auto rank = std::lower_bound(known.begin(), known.end(), group) - known.begin();
    result.push_back(static_cast<int>(rank % folds));
  }
  return result;
}

Svm trainSvm(const SvmExamples& examples, const SvmTrainingConfig& config) {
  const std::size_t n = examples.size();
  if (examples.groups.size() != n || examples.rows.size() != n * examples.dimension) {
    throw std::invalid_argument(
        "trainSvm: " + std::to_string(n) + " labels, " + std::to_string(examples.groups.size()) + " groups, " +
        std::to_string(examples.rows.size()) + " values of " + std::to_string(examples.dimension) + " a row");
  }
  const auto objects = std::count_if(examples.labels.begin(), examples.labels.end(), [](int y) { return y > 0; });
  if (objects == 0 || objects == static_cast<std::ptrdiff_t>(n)) {
    throw std::invalid_argument("trainSvm: " + std::to_string(objects) + " objects among " + std::to_string(n) +
                                " examples; both classes are needed");
  }
  svm_set_print_string_function(&silent);
  std::vector<std::size_t> chosen(n);
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  objectFirst(examples, chosen);
  const Problem problem(examples, chosen);
  const KernelExpansion whole = expansionOf(*train(examples, chosen, problem, config), examples.dimension);
  const std::vector<double> rows(examples.rows.begin(), examples.rows.end());
  const KernelExpansion kept = reduced(whole, static_cast<std::size_t>(config.max_vectors), rows, config.seed);

  std::vector<std::int8_t> labels;
  for (const std::size_t i : chosen) labels.push_back(examples.labels[i]);
  Sigmoid sigmoid = fitSigmoid(heldOutDecisions(examples, chosen, config), labels);
  // From one or two groups nothing is learnt about others; the order of the decisions must not be turned round for it.
  if (sigmoid.a >= 0.0) sigmoid = fitSigmoid(whole.values(rows), examples.labels);
  return Svm::parse(writeModel(kept, sigmoid));
}

}  // namespace saccade
