#include "csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

double parsed(std::string_view cell, const std::string& where) {
  std::string_view digits = cell;
  if (!digits.empty() && digits[0] == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || code != std::errc() || end != digits.data() + digits.size() ||
      !std::isfinite(value)) {
    throw Error(fmt::format("{} = '{}'; permitted is a finite number", where, cell));
  }
  return value;
}

}  // namespace

CsvTable::CsvTable(std::string_view text, const std::string& file) : file_(file) {
  int line_number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_number;
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const bool header = columns_.empty();
    std::size_t column = 0;
    for (bool more = true; more; ++column) {
      const std::size_t comma = line.find(',');
      more = comma != std::string_view::npos;
      const std::string_view cell = trimmed(line.substr(0, comma));
      if (more) line.remove_prefix(comma + 1);
      if (header) {
        if (cell.empty() || std::find(columns_.begin(), columns_.end(), cell) != columns_.end()) {
          throw Error(fmt::format("{} line {}: column {} is called '{}'; permitted is a name of its own",
                                  file, line_number, column + 1, cell));
        }
        columns_.emplace_back(cell);
      } else if (column < columns_.size()) {
        cells_.push_back(
            parsed(cell, fmt::format("{} line {} column '{}'", file, line_number, columns_[column])));
      }
    }
    if (!header && column != columns_.size()) {
      throw Error(fmt::format("{} line {} has {} cells; permitted are {}", file, line_number, column,
                              columns_.size()));
    }
  }
}

std::vector<double> CsvTable::column(std::size_t index) const {
  std::vector<double> result;
  for (std::size_t row = 0; row < rows(); ++row) result.push_back(at(row, index));
  return result;
}

std::vector<double> CsvTable::column(const std::string& name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  if (found == columns_.end()) throw Error(file_ + ": the column '" + name + "' is missing");
  return column(static_cast<std::size_t>(found - columns_.begin()));
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
