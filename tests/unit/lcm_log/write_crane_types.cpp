// SPDX-License-Identifier: Apache-2.0
// Writes the types of the signal list of signal_list_test.cpp for lcm-gen.
#include <cstdio>
#include <fstream>

#include "lcm_log/signal_list.h"

int main(int argc, char** argv) {
  slew::lcm_log::SignalList list;
  const slew::Status status = read_signal_list("crane=Cyl_Lift.stroke,Bag.position.y,2nd.force", list);
  if (argc != 2 || !status.is_ok()) return 1;
  std::ofstream(argv[1]) << types_text(std::vector{list}, std::vector<std::vector<std::string>>{{"m", "m", "N"}});
  return 0;
}
