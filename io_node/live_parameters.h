// Present values of the parameters that may change while the session runs, for those who ask.
//
// The same changes over the same steps as in the nodes that apply them (coupling/parameter_ramps.h), so that io_node
// can say what they compute with, to anybody and at any time, also while the session is paused.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/state_bytes.h"
#include "core/time.h"
#include "coupling/parameter_ramps.h"
#include "transport/wire.h"

namespace slew::io_node {

struct LiveParameter {
  std::string path;  // "Bag.mass"
  double value = 0;  // SI, as the scene has it
};

class LiveParameters {
 public:
  LiveParameters(const std::vector<LiveParameter>& parameters, SimDuration step);

  // Index by path; -1 when there is none.
  [[nodiscard]] int find(std::string_view path) const noexcept;
  // SI, of the last step that advance() was called for.
  [[nodiscard]] double value(int parameter) const noexcept { return values_[static_cast<std::size_t>(parameter)]; }
  [[nodiscard]] bool is_changing(int parameter) const noexcept { return ramps_.is_under_way(parameter); }

  // A change that is in the tick of step n.
  void begin(const wire::Command& command, StepIndex n) noexcept;
  // The values that the nodes compute step n with.
  void advance(StepIndex n) noexcept;
  // As the scene has them.
  void reset() noexcept;
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  std::map<std::string, int, std::less<>> index_;
  std::vector<double> scene_values_;
  std::vector<double> values_;
  coupling::ParameterRamps ramps_;
  SimDuration step_;
};

}  // namespace slew::io_node
