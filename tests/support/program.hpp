#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace saccade::test {

/// What a run of the program gave.
struct ProgramRun {
  int exit_code = -1;  ///< 128 + signal if it was killed
  std::string output;  ///< stdout
  std::string talk;    ///< stderr
};

/// Runs the saccade program that was built with these tests and waits for its end. With `interrupt_after_s` > 0 it is
/// sent SIGINT after that time.
[[nodiscard]] ProgramRun runSaccade(const std::vector<std::string>& arguments, double interrupt_after_s = 0.0);

/// Runs the program, waits until it has made `file`, and kills it (SIGKILL) `after_s` later; an empty name waits for
/// nothing.
[[nodiscard]] ProgramRun killSaccade(const std::vector<std::string>& arguments, const std::filesystem::path& file,
                                     double after_s);

}  // namespace saccade::test
