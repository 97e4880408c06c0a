// SPDX-License-Identifier: Apache-2.0
// The scenes of hopsan/ against HOPSAN 2.24 (commit 0c3995ee): pressures, flows and motions of the same circuits at a
// handful of instants, in SI units. The numbers beside the scenes are HOPSAN's at its smallest step; their row `range`
// is the range of each curve, to which the limits are relative. Laws, steps and the largest differences over time are
// in docs/validation/hopsan.md.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "analysis/comparison/played_scene.h"
#include "build_paths.h"

namespace slew::hydraulics::test {
namespace hopsan_test {

struct Compared {
  const char* circuit;
  double limit;  // share of the range
};

void PrintTo(const Compared& compared, std::ostream* out) {
  *out << compared.circuit;
}

struct Curves {
  std::vector<std::string> variables;
  std::vector<double> ranges;
  std::vector<std::vector<double>> rows;  // time [s], then one value a variable
};

Curves read_curves(const std::string& path) {
  std::ifstream file(path);
  Curves curves;
  std::string line, cell;
  for (int number = 0; std::getline(file, line); ++number) {
    std::istringstream cells(line);
    std::getline(cells, cell, ',');
    std::vector<double> row;
    if (number > 1) row.push_back(std::stod(cell));
    while (std::getline(cells, cell, ',')) {
      if (number == 0) {
        curves.variables.push_back(cell);
      } else {
        row.push_back(std::stod(cell));
      }
    }
    if (number == 1) curves.ranges = row;
    if (number > 1) curves.rows.push_back(row);
  }
  return curves;
}

std::map<std::string, double> values(const analysis::PlayedScene& played) {
  std::map<std::string, double> result;
  const coupling::Subsystem& hydraulics = *played.session().subsystem(wire::Role::hydraulics);
  std::vector<double> read(hydraulics.variables().size());
  hydraulics.read_variables(read);
  for (std::size_t i = 0; i < read.size(); ++i) result[std::string(hydraulics.variables()[i].name)] = read[i];
  return result;
}

class Hopsan : public testing::TestWithParam<Compared> {};

TEST_P(Hopsan, AgreesAtThePorts) {
  const std::string stem =
      std::string(SLEWRING_SOURCE_DIR) + "/tests/validation/hydraulics/hopsan/" + GetParam().circuit;
  const Curves curves = read_curves(stem + ".csv");
  ASSERT_GE(curves.rows.size(), 5U);
  ASSERT_EQ(curves.ranges.size(), curves.variables.size());
  const scene::Scene scene = scene::load_file(stem + ".yaml", {});
  analysis::PlayedScene played(scene);
  for (const std::vector<double>& row : curves.rows) {
    ASSERT_EQ(row.size(), curves.variables.size() + 1);
    while (played.time().seconds() < row[0] - 1e-9) played.advance();
    std::map<std::string, double> found = values(played);
    for (std::size_t i = 0; i < curves.variables.size(); ++i) {
      ASSERT_TRUE(found.contains(curves.variables[i])) << curves.variables[i];
      EXPECT_NEAR(found[curves.variables[i]], row[i + 1], GetParam().limit * curves.ranges[i])
          << curves.variables[i] << " at " << row[0] << " s";
    }
  }
}

// limits: twice the difference of today, and at least 1e-4
INSTANTIATE_TEST_SUITE_P(
    Circuits, Hopsan,
    testing::Values(Compared{"accumulator", 7e-4}, Compared{"check_valve", 1e-4}, Compared{"compensated_valve", 1.3e-2},
                    Compared{"counterbalance_oscillation", 4e-3}, Compared{"counterbalance_valve", 2e-4},
                    Compared{"cylinder", 9e-4}, Compared{"direct_relief_valve", 6e-4}, Compared{"engine", 4e-3},
                    Compared{"fixed_pump", 3e-3}, Compared{"flow_sharing", 2e-4}, Compared{"four_way_valve", 3e-3},
                    Compared{"gear_flow_divider", 2.2e-3}, Compared{"hydrostatic_transmission", 1e-4},
                    Compared{"line", 4e-3}, Compared{"load_sensing_system", 6e-3}, Compared{"motor", 2e-4},
                    Compared{"open_centre_valve", 8e-4}, Compared{"pilot_check_valve", 1e-4},
                    Compared{"pressure_controlled_pump", 3e-3}, Compared{"priority_valve", 8e-3},
                    Compared{"reducing_valve", 5e-3}, Compared{"relief_valve", 6e-4}, Compared{"restrictions", 3e-4},
                    Compared{"shuttle_valve", 1e-3}, Compared{"throttle_check_valve", 1e-4},
                    Compared{"variable_motor", 1e-4}),
    [](const testing::TestParamInfo<Compared>& info) { return std::string(info.param.circuit); });

}  // namespace hopsan_test
}  // namespace slew::hydraulics::test
