#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Rows into and out of prepared statements, value by value.
namespace saccade {

/// A value that is bytes rather than text; it must live until the row is written.
struct Bytes {
  std::string_view bytes;
};

class RowBinder {
 public:
  explicit RowBinder(SQLite::Statement& statement) : statement_(statement) {}

  void add(std::integral auto value) { statement_.bind(++column_, static_cast<std::int64_t>(value)); }
  void add(double value) { statement_.bind(++column_, value); }
  void add(const std::string& value) { statement_.bind(++column_, value); }
  void add(const Bytes& value) {
    statement_.bindNoCopy(++column_, value.bytes.data(), static_cast<int>(value.bytes.size()));
  }
  template <typename T>
  void add(const std::optional<T>& value) {
    if (value) {
      add(*value);
    } else {
      statement_.bind(++column_);  // NULL
    }
  }
  template <typename T, std::size_t N>
  void add(const std::array<T, N>& values) {
    for (const T& value : values) add(value);
  }

 private:
  SQLite::Statement& statement_;
  int column_ = 0;
};

/// Runs `statement` with `values` for its parameters, in order, and makes it ready for the next row.
template <typename... Values>
void insert(SQLite::Statement& statement, const Values&... values) {
  statement.tryReset();  // of a row that failed
  RowBinder binder(statement);
  (binder.add(values), ...);
  statement.exec();
  statement.reset();
}

/// The columns of a query's current row, in order.
class RowReader {
 public:
  explicit RowReader(SQLite::Statement& query) : query_(query) {}

  [[nodiscard]] bool nextIsNull() const { return query_.getColumn(column_).isNull(); }
  std::int64_t integer() { return query_.getColumn(column_++).getInt64(); }
  double number() { return query_.getColumn(column_++).getDouble(); }
  std::string text() { return query_.getColumn(column_++).getString(); }
  /// Valid until the query's next step.
  std::string_view bytes() {
    const SQLite::Column column = query_.getColumn(column_++);
    const auto* data = static_cast<const char*>(column.getBlob());
    return data == nullptr ? std::string_view() : std::string_view(data, static_cast<std::size_t>(column.getBytes()));
  }

 private:
  SQLite::Statement& query_;
  int column_ = 0;
};

}  // namespace saccade
