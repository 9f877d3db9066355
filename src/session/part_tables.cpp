#include "session/part_tables.hpp"

#include <memory>
#include <sqlite3.h>
#include <vector>

namespace saccade {
namespace {

/// Names are those of CREATE TABLE statements that SQLite itself keeps; quoted, they can hold anything.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

void visitRows(SQLite::Database& from, const std::string& table, SQLite::Database* to) {
  SQLite::Statement query(from, "SELECT * FROM " + quoted(table));
  std::unique_ptr<SQLite::Statement> row;
  if (to != nullptr) {
    std::string places = "?";
    for (int i = 1; i < query.getColumnCount(); ++i) places += ",?";
    row = std::make_unique<SQLite::Statement>(*to, "INSERT INTO " + quoted(table) + " VALUES (" + places + ")");
  }
  while (query.executeStep()) {
    if (!row) continue;
    for (int i = 0; i < query.getColumnCount(); ++i) {
      const SQLite::Column value = query.getColumn(i);
      const int type = value.getType();
      if (type == SQLITE_INTEGER) row->bind(i + 1, value.getInt64());
      if (type == SQLITE_FLOAT) row->bind(i + 1, value.getDouble());
      if (type == SQLITE_TEXT) row->bind(i + 1, value.getString());
      if (type == SQLITE_BLOB) row->bind(i + 1, value.getBlob(), value.getBytes());
      if (type == SQLITE_NULL) row->bind(i + 1);
    }
    row->exec();
    row->reset();
  }
}

}  // namespace

void visitPartTables(const SessionDatabase& from, SessionDatabase* to) {
  from.use("whole parts of the session", [&] {
    SQLite::Statement parts(from.sqlite(), "SELECT name, version FROM parts");
    while (parts.executeStep()) {
      const std::string name = parts.getColumn(0).getString();
      std::string tables;
      std::vector<std::string> names;
      SQLite::Statement query(from.sqlite(),
                              "SELECT name, sql FROM main.sqlite_schema WHERE sql IS NOT NULL AND "
                              "substr(tbl_name, 1, length(?)) = ? ORDER BY type DESC, name");
      query.bind(1, name);
      query.bind(2, name);
      while (query.executeStep()) {
        tables += query.getColumn(1).getString() + ";\n";
        if (query.getColumn(1).getString().starts_with("CREATE TABLE")) names.push_back(query.getColumn(0).getString());
      }
      if (to != nullptr) to->requirePart({name.c_str(), parts.getColumn(1).getInt(), tables.c_str()});
      for (const std::string& table : names) visitRows(from.sqlite(), table, to != nullptr ? &to->sqlite() : nullptr);
    }
  });
}

}  // namespace saccade
