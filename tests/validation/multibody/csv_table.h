// SPDX-License-Identifier: Apache-2.0
// Reference tables of tests/validation/data: comma separated numbers, lines starting with # are text.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "build_paths.h"

namespace slew::multibody::testing {

inline std::vector<std::vector<double>> read_table(const std::string& name) {
  std::ifstream file(std::string(SLEWRING_SOURCE_DIR) + "/tests/validation/data/" + name);
  EXPECT_TRUE(file.is_open()) << name;
  std::vector<std::vector<double>> rows;
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace slew::multibody::testing
