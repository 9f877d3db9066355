#include "saccade/discovery/candidate_json.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace saccade {
namespace {

/// Writes the text of one candidate after another: nine hundred a frame, which are too many to build as a document
/// first. Nothing that it writes needs escaping but the masks' backslashes.
class CandidateWriter {
 public:
  CandidateWriter(const CandidateOutliner& outliner, const CandidateBoxes& boxes, std::string& text)
      : outliner_(outliner), boxes_(boxes), text_(text) {}

  void write(const Candidate& candidate, const std::optional<int>& rank, bool attended) {
    const CandidateOutline outline = outliner_.outline(candidate);
    text_ += R"({"rank":)";
    rank ? integer(*rank) : null();
    text_ += R"(,"score":)";
    decimal(candidate.score);
    text_ += attended ? R"(,"attended":true)" : R"(,"attended":false)";
    text_ += candidate.inhibited ? R"(,"inhibited":true)" : R"(,"inhibited":false)";
    text_ += R"(,"box":)";
    integers({outline.box.x, outline.box.y, outline.box.width, outline.box.height});
    text_ += R"(,"source":")";
    text_ += sourceName(candidate.source);
    text_ += R"(","mask":{"size":)";
    integers({outliner_.imageSize().height, outliner_.imageSize().width});
    text_ += R"(,"counts":")";
    escaped(outline.mask);
    text_ += R"("},"box3d":)";
    box(boxes_.box(candidate));
    text_ += R"(,"features":)";
    decimals(candidate.features);
    text_ += '}';
  }

 private:
  void null() { text_ += "null"; }

  void integer(int value) {
    char digits[16];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }

  /// Five digits: enough for ranks and reports, and a line stays short.
  void decimal(double value) {
    if (!std::isfinite(value)) {
      null();
      return;
    }
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, std::round(value * 1e5) / 1e5).ptr);
  }

  void integers(std::initializer_list<int> values) {
    char before = '[';
    for (const int value : values) {
      text_ += before;
      integer(value);
      before = ',';
    }
    text_ += ']';
  }

  template <typename Values>
  void decimals(const Values& values) {
    char before = '[';
    for (const float value : values) {
      text_ += before;
      decimal(static_cast<double>(value));
      before = ',';
    }
    text_ += ']';
  }

  void box(const std::optional<WorldBox>& box) {
    if (!box) {
      null();
      return;
    }
    decimals(
        std::array{box->min().x(), box->min().y(), box->min().z(), box->max().x(), box->max().y(), box->max().z()});
  }

  void escaped(std::string_view mask) {
    for (const char character : mask) {
      if (character == '\\') text_ += '\\';
      text_ += character;
    }
  }

  const CandidateOutliner& outliner_;
  const CandidateBoxes& boxes_;
  std::string& text_;
};

}  // namespace

std::string_view sourceName(CandidateSource source) {
  return source == CandidateSource::kColor ? "colour" : "depth";
}

std::string candidateLine(const CandidateLineHeader& header, const Candidates& open, int attended_count,
                          const Candidates& inhibited, const CandidateOutliner& outliner, const CandidateBoxes& boxes) {
  const nlohmann::ordered_json frame = {
      {"frame", header.frame.value}, {"name", header.name}, {"stamp_s", header.stamp_s}, {"tracking", header.tracking}};
  // Names come from file names, which need not be UTF-8.
  std::string text = frame.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  text.back() = ',';
  text += R"("candidates":[)";
  CandidateWriter writer(outliner, boxes, text);
  for (std::size_t rank = 0; rank < open.size(); ++rank) {
    const int number = static_cast<int>(rank);
    if (rank > 0) text += ',';
    writer.write(open[rank], number, number < attended_count);
  }
  for (const Candidate& candidate : inhibited) {
    if (text.back() == '}') text += ',';
    writer.write(candidate, std::nullopt, false);
  }
  text += "]}";
  return text;
}

}  // namespace saccade
