// Numbers and tables for people.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/number_text.h"

namespace isowave::tools {

// Columns aligned to the right, the first one to the left; headers carry the units.
class Table {
  public:
    explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
    void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
    std::string text() const;

  private:
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace isowave::tools
