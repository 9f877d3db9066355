#include "saccade/discovery/ranker_model.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "saccade/core/errors.hpp"

namespace saccade {

namespace embedded {
// Generated at build time from src/discovery/models.
extern const char* const kPaperRanker;
extern const char* const kExtendedRanker;
}  // namespace embedded

namespace {

constexpr std::string_view kHeader = "saccade-ranker 1";
constexpr std::array<std::string_view, kFeatureCount> kFeatureNames{
    "Hu 1", "Hu 2", "Hu 3", "Hu 4", "Hu 5", "Hu 6", "Hu 7", "convexity", "area", "saliency", "perimeter", "depth"};
constexpr std::array<std::string_view, kCueCount> kCueNames{"extent",
                                                            "image border",
                                                            "nearer",
                                                            "farther",
                                                            "unknown depth",
                                                            "colour contrast",
                                                            "saliency contrast",
                                                            "metric size",
                                                            "aspect",
                                                            "box size",
                                                            "compactness",
                                                            "colour spread",
                                                            "length",
                                                            "breadth",
                                                            "thickness",
                                                            "height",
                                                            "structure",
                                                            "segments",
                                                            "colour of neighbours",
                                                            "support",
                                                            "inner contrast",
                                                            "inner steps",
                                                            "open outline",
                                                            "weakest neighbour",
                                                            "agreement",
                                                            "straddling"};
constexpr std::array kDepthFeatures{kFeatureConvexity, kFeatureDepth};
// Agreement and straddling compare the pools and segments of colour and depth.
constexpr std::array kDepthCues{kCueNearer,     kCueFarther,   kCueUnknownDepth, kCueMetricSize, kCueLength,
                                kCueBreadth,    kCueThickness, kCueHeight,       kCueStructure,  kCueSupport,
                                kCueInnerSteps, kCueAgreement, kCueStraddling};

template <typename List>
bool contains(const List& list, int value) {
  return std::any_of(list.begin(), list.end(), [value](auto entry) { return static_cast<int>(entry) == value; });
}

const char* name(FeatureSet set) {
  return set == FeatureSet::kPaper ? "paper" : "extended";
}

std::string takeLine(std::istream& in, const std::string& expected) {
  std::string line;
  if (!std::getline(in, line)) throw std::invalid_argument("expected " + expected + ", found the end");
  return line;
}

std::vector<float> takeNumbers(std::istream& in, const std::string& key, std::size_t count) {
  std::istringstream line(takeLine(in, key));
  std::string word;
  line >> word;
  std::vector<float> values;
  for (std::string number; line >> number;) {
    float value = 0.0F;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc{} || end != number.data() + number.size()) {
      throw std::invalid_argument("expected numbers after " + key + ", found \"" + number.substr(0, 40) + "\"");
    }
    values.push_back(value);
  }
  if (word != key || values.size() != count) {
    throw std::invalid_argument("expected \"" + key + "\" and " + std::to_string(count) + " numbers, found \"" +
                                word.substr(0, 40) + "\" and " + std::to_string(values.size()));
  }
  return values;
}

ScaledSvm takeSvm(std::istream& in, std::size_t count) {
  ScaledSvm judge;
  judge.mean = takeNumbers(in, "mean", count);
  judge.scale = takeNumbers(in, "scale", count);
  if (!std::all_of(judge.scale.begin(), judge.scale.end(), [](float scale) { return scale > 0.0F; })) {
    throw std::invalid_argument("expected scales above 0");
  }
  const std::vector<float> lines = takeNumbers(in, "svm-lines", 1);
  std::string text;
  for (int i = 0; i < static_cast<int>(lines[0]); ++i) text += takeLine(in, "a line of the SVM") + "\n";
  judge.svm = Svm::parse(text);
  if (judge.svm.dimension() > count) {
    throw std::invalid_argument("expected an SVM of " + std::to_string(count) + " values, found one of " +
                                std::to_string(judge.svm.dimension()));
  }
  return judge;
}

BoostedTrees takeTrees(std::istream& in, std::size_t count) {
  const std::vector<float> lines = takeNumbers(in, "trees-lines", 1);
  std::string text;
  for (int i = 0; i < static_cast<int>(lines[0]); ++i) text += takeLine(in, "a line of the trees") + "\n";
  BoostedTrees trees = BoostedTrees::parse(text);
  if (trees.dimension() != count) {
    throw std::invalid_argument("expected trees of " + std::to_string(count) + " values, found some of " +
                                std::to_string(trees.dimension()));
  }
  return trees;
}

void requireLine(std::istream& in, std::string_view expected) {
  const std::string line = takeLine(in, std::string(expected));
  if (line != expected) {
    throw std::invalid_argument("expected \"" + std::string(expected) + "\", found \"" + line.substr(0, 40) + "\"");
  }
}

Judge takeJudge(std::istream& in, const char* title, FeatureSet set, bool with_depth) {
  requireLine(in, title);
  const std::size_t count = featureCount(set, with_depth);
  const std::istream::pos_type begin = in.tellg();
  const bool has_trees = takeLine(in, "an SVM or trees").starts_with("trees-lines");
  in.seekg(begin);
  return has_trees ? Judge(takeTrees(in, count)) : Judge(takeSvm(in, count));
}

void write(std::ostream& out, const ScaledSvm& judge) {
  const std::string& svm = judge.svm.text();
  out << "mean";
  for (const float value : judge.mean) out << ' ' << value;
  out << "\nscale";
  for (const float value : judge.scale) out << ' ' << value;
  out << "\nsvm-lines " << std::count(svm.begin(), svm.end(), '\n') << '\n' << svm;
}

void write(std::ostream& out, const BoostedTrees& judge) {
  const std::string text = judge.text();
  out << "trees-lines " << std::count(text.begin(), text.end(), '\n') << '\n' << text;
}

void predict(const ScaledSvm& judge, std::span<float> rows, std::span<double> probability) {
  judge.scaleRows(rows);
  judge.svm.predict(rows, probability.size(), probability);
}

void predict(const BoostedTrees& judge, std::span<const float> rows, std::span<double> probability) {
  judge.predict(rows, probability.size(), probability);
}

}  // namespace

std::size_t featureCount(FeatureSet set, bool with_depth) {
  std::size_t count = kFeatureCount - (with_depth ? 0 : kDepthFeatures.size());
  if (set == FeatureSet::kExtended) count += kCueCount - (with_depth ? 0 : kDepthCues.size());
  return count;
}

std::vector<std::string_view> featureNames(FeatureSet set) {
  std::vector<std::string_view> names(kFeatureNames.begin(), kFeatureNames.end());
  if (set == FeatureSet::kExtended) names.insert(names.end(), kCueNames.begin(), kCueNames.end());
  return names;
}

void appendFeatures(const Candidate& candidate, FeatureSet set, bool with_depth, std::vector<float>& row) {
  for (int i = 0; i < kFeatureCount; ++i) {
    if (with_depth || !contains(kDepthFeatures, i)) row.push_back(candidate.features[static_cast<std::size_t>(i)]);
  }
  if (set == FeatureSet::kPaper) return;
  for (int i = 0; i < kCueCount; ++i) {
    if (with_depth || !contains(kDepthCues, i)) row.push_back(candidate.cues[static_cast<std::size_t>(i)]);
  }
}

void ScaledSvm::scaleRows(std::span<float> rows) const {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t column = i % mean.size();
    rows[i] = std::clamp((rows[i] - mean[column]) / scale[column], -kScaledLimit, kScaledLimit);
  }
}

RankerModel::RankerModel(FeatureSet set, Judge with_depth, Judge without_depth)
    : set_(set), with_depth_(std::move(with_depth)), without_depth_(std::move(without_depth)) {}

const RankerModel& RankerModel::builtIn(FeatureSet set) {
  static const RankerModel paper = parse(embedded::kPaperRanker), extended = parse(embedded::kExtendedRanker);
  return set == FeatureSet::kPaper ? paper : extended;
}

RankerModel RankerModel::load(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(path, "a ranker model", "a file that cannot be opened");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    return parse(text);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "a ranker model", std::string("one that does not parse (") + error.what() + ")");
  }
}

RankerModel RankerModel::parse(std::string_view text) {
  std::istringstream in{std::string(text)};
  requireLine(in, kHeader);
  const std::string set_line = takeLine(in, "the feature set");
  RankerModel model;
  if (set_line == "features extended") {
    model.set_ = FeatureSet::kExtended;
  } else if (set_line != "features paper") {
    throw std::invalid_argument("expected \"features paper\" or \"features extended\", found \"" +
                                set_line.substr(0, 40) + "\"");
  }
  model.with_depth_ = takeJudge(in, "with-depth", model.set_, true);
  model.without_depth_ = takeJudge(in, "without-depth", model.set_, false);
  return model;
}

std::string RankerModel::text() const {
  std::ostringstream out;
  out.precision(9);
  out << kHeader << "\nfeatures " << name(set_) << '\n';
  for (const bool with_depth : {true, false}) {
    out << (with_depth ? "with-depth\n" : "without-depth\n");
    std::visit([&out](const auto& own) { write(out, own); }, judge(with_depth));
  }
  return out.str();
}

void RankerModel::save(const std::filesystem::path& path) const {
  std::ofstream out(path, std::ios::binary);
  out << text();
  out.close();
  if (!out) throw IoError(path, "room for a ranker model", "a file that cannot be written");
}

void RankerModel::score(Candidates& candidates) const {
  for (const bool with_depth : {true, false}) {
    std::vector<float> rows;
    std::vector<std::size_t> owners;
    rows.reserve(candidates.size() * featureCount(set_, with_depth));
    owners.reserve(candidates.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (candidates[i].has_depth != with_depth) continue;
      appendFeatures(candidates[i], set_, with_depth, rows);
      owners.push_back(i);
    }
    if (owners.empty()) continue;
    std::vector<double> probability(owners.size());
    std::visit([&](const auto& own) { predict(own, rows, probability); }, judge(with_depth));
    for (std::size_t i = 0; i < owners.size(); ++i) candidates[owners[i]].score = probability[i];
  }
}

}  // namespace saccade
