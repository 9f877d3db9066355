#include "session_talk.hpp"

#include "terminal.hpp"

namespace saccade::app {

void printFindings(const SessionFindings& findings, std::ostream& out) {
  std::vector<std::vector<std::string>> rows = {{"table", "whole", "damaged"}};
  for (const TableFindings& table : findings.tables) {
    rows.push_back({table.table, grouped(table.whole), grouped(table.damaged)});
  }
  out << alignedTable(rows);
  for (const std::string& complaint : findings.complaints) out << complaint << "\n";
  if (findings.more_complaints > 0) out << "and " << grouped(findings.more_complaints) << " more\n";
}

bool isWhole(const SessionFindings& findings) {
  return findings.complaints.empty();
}

}  // namespace saccade::app
