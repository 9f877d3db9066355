#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "saccade/evaluation/sequence_evaluation.hpp"

namespace saccade {

/// All figures of some sequences and their means, as one JSON document: `{"k", "sequences": [...], "mean": {...}}`.
/// Figures that not every sequence has are missing from the means.
[[nodiscard]] std::string evaluationJson(const std::vector<SequenceEvaluation>& sequences, int k);

/// The figures of single labelled frames as JSON: those of our method at the top (`frames`, `boxes`, `masks`,
/// `candidates_per_frame`, `ms_per_frame`), other methods by name under `others`.
[[nodiscard]] std::string framesJson(const SequenceEvaluation& evaluation, int k);

/// Our figures on single frames by the names they have in JSON, for boxes and masks.
[[nodiscard]] std::vector<std::vector<std::string>> figureRows(const SequenceEvaluation& evaluation, int k);

/// The figures of all sequences as text for a terminal: the means, or the one sequence's figures.
[[nodiscard]] std::vector<std::vector<std::string>> methodRows(const std::vector<SequenceEvaluation>& sequences, int k);
[[nodiscard]] std::vector<std::vector<std::string>> runRows(const std::vector<SequenceEvaluation>& sequences, int k);

/// Writes the curves as CSV files into `folder`: recall_precision.csv (sequence, method, candidates, recall, precision,
/// by boxes and masks), global_recall.csv and revisit_rate.csv (sequence, run, frame, value). Throws IoError.
void writeCurves(const std::vector<SequenceEvaluation>& sequences, int k, const std::filesystem::path& folder);

}  // namespace saccade
