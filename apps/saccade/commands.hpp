#pragma once

#include <CLI/App.hpp>

/// The commands of the program; each adds itself, with its options and what it does, to `program`.
namespace saccade::app {

void addExplore(CLI::App& program);
void addResume(CLI::App& program);
void addInspect(CLI::App& program);
void addRender(CLI::App& program);
void addReport(CLI::App& program);
void addSaliency(CLI::App& program);
void addSimulate(CLI::App& program);
void addEvaluate(CLI::App& program);
void addRepair(CLI::App& program);
void addTrain(CLI::App& program);
void addVerify(CLI::App& program);
void addView(CLI::App& program);
void addExport(CLI::App& program);
void addImport(CLI::App& program);
void addForget(CLI::App& program);
void addDiff(CLI::App& program);
void addMerge(CLI::App& program);
void addRecord(CLI::App& program);
void addPreflight(CLI::App& program);

}  // namespace saccade::app
