#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A table of numbers: names of columns, then rows, separated by commas. Blank lines and what follows a #
// count for nothing.
class CsvTable {
 public:
  // `file` heads the messages. Throws Error naming file and line for a cell that is no finite number, a row
  // with more or fewer cells than the header, a column without a name or with one that is there twice.
  CsvTable(std::string_view text, const std::string& file);

  const std::vector<std::string>& columns() const { return columns_; }
  std::size_t rows() const { return columns_.empty() ? 0 : cells_.size() / columns_.size(); }
  double at(std::size_t row, std::size_t column) const { return cells_[row * columns_.size() + column]; }
  std::vector<double> column(std::size_t index) const;
  // Throws Error if there is none of that name.
  std::vector<double> column(const std::string& name) const;

 private:
  std::string file_;
  std::vector<std::string> columns_;
  std::vector<double> cells_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
