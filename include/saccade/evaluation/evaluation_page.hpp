#pragma once

#include <filesystem>
#include <vector>

#include "saccade/evaluation/sequence_evaluation.hpp"

namespace saccade {

/// Draws the paper's figures of some evaluated sequences into `folder`, each as SVG and PNG, and one page index.html
/// that holds them all with the tables and needs nothing else: precision and recall of each sequence (figure 7),
/// global recall over time without memory (8), precision and recall over the number of candidates (9, 10), F-scores
/// (table 1), global recall over time for the settings of inhibition and with and without it (14), and the share of
/// looks that return to where attention has been.
///
/// Runs `gnuplot` (Debian: gnuplot-nox). Throws IoError if it is not there or fails, or a file cannot be written.
void writeEvaluationPage(const std::vector<SequenceEvaluation>& sequences, int k, const std::filesystem::path& folder);

}  // namespace saccade
