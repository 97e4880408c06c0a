// SPDX-License-Identifier: Apache-2.0
#include "analysis/simplify/candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/display.h"
#include "hydraulics/component_def.h"

namespace slew::analysis {
namespace {

constexpr double kCoarser[] = {10, 100};      // tolerances
constexpr int kLonger[] = {2, 5, 10};         // communication steps; each divides kStepsPerSample
constexpr double kLongerSubsteps[] = {2, 4};  // factors of the mechanics' sub-step
constexpr std::string_view kQuasiStatic = "quasi_static";

class Collector {
 public:
  explicit Collector(const scene::Scene& scene) : scene_(scene) {}

  std::vector<Candidate> collect(const RunFindings& found) {
    for (const std::string& pair : found.untouched_pairs) {
      add("contact pair " + pair + ", which never touched", pair, {pair + ".tested=false"});
    }
    for (const multibody::FlexibleBodyDef& body : scene_.mechanics.flexible_bodies) add_modes(body);
    for (const std::string& joint : found.still_joints) {
      add("joint " + joint + ", which never moved, as a fixed one", joint, {joint + ".type=fixed"});
    }
    add_volumes();
    add_tolerance();
    add_substeps();
    add_steps();
    return std::move(list_);
  }

 private:
  void add(std::string title, std::string group, scene::Overrides settings) {
    list_.push_back({std::move(title), std::move(group), std::move(settings)});
  }

  // numbers of lowest modes that are kept: all but one, half of them, none
  void add_modes(const multibody::FlexibleBodyDef& body) {
    const std::size_t count = body.modes == nullptr ? 0 : body.modes->modes();
    if (count == 0) return;
    const multibody::BodyDef& def = *std::find_if(scene_.mechanics.bodies.begin(), scene_.mechanics.bodies.end(),
                                                  [&](const auto& one) { return one.name == body.body; });
    const std::vector<std::string> ordinals = parts_of(def.flex_modes), damping = parts_of(def.relative_damping);
    for (const std::size_t kept : std::set<std::size_t>{count - 1, count / 2, 0}) {
      std::string modes;
      for (std::size_t k = 0; k < kept; ++k) {
        modes += (k == 0 ? "" : ";") + (k < ordinals.size() ? ordinals[k] : std::to_string(k + 1));
      }
      scene::Overrides settings = {fmt::format("{}.flex_modes=\"{}\"", body.body, kept == 0 ? "none" : modes)};
      if (damping.size() > 1) {
        std::string values;
        for (std::size_t k = 0; k < kept; ++k) values += (k == 0 ? "" : ";") + damping[k];
        settings.push_back(fmt::format("{}.relative_damping=\"{}\"", body.body, values));
      }
      add(fmt::format("modes of {} frozen, {} of {} left", body.body, kept, count), body.body, std::move(settings));
    }
  }

  static std::vector<std::string> parts_of(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find(';', begin), text.size());
      parts.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    return parts;
  }

  void add_volumes() {
    const bool is_known = std::any_of(std::begin(hydraulics::kVolumeFields), std::end(hydraulics::kVolumeFields),
                                      [](const Field& field) { return field.key == kQuasiStatic; });
    if (!is_known) return;
    for (const hydraulics::VolumeDef& volume : scene_.hydraulics.volumes) {
      if (volume.fixed || hydraulics::find_chamber(scene_.hydraulics, volume) != nullptr) continue;
      add("pressure of " + volume.name + " quasi-static", volume.name,
          {fmt::format("{}.{}=true", volume.name, kQuasiStatic)});
    }
  }

  void add_tolerance() {
    if (!scene_.has_hydraulics()) return;
    for (const double factor : kCoarser) {
      const double rtol = factor * scene_.hydraulics.relative_tolerance;
      if (!hydraulics::kToleranceRange.contains(rtol)) continue;
      add(fmt::format("hydraulics' tolerance {:g}", rtol), "hydraulics.relative_tolerance",
          {fmt::format("hydraulics.relative_tolerance={:g}", rtol)});
    }
  }

  // the actual sub-step of the scene, and longer ones up to the communication step
  void add_substeps() {
    const double H = scene_.session.step;
    const double substep = H / std::ceil(H / scene_.mechanics.max_substep - 1e-9);
    for (const double factor : kLongerSubsteps) {
      if (factor * substep > H * (1 + 1e-9)) continue;
      add("mechanics' sub-step " + duration_text(factor * substep), "mechanics.max_substep",
          {fmt::format("mechanics.max_substep={:.9g} s", factor * substep)});
    }
  }

  void add_steps() {
    const double H = scene_.session.step;
    const double substep = H / std::ceil(H / scene_.mechanics.max_substep - 1e-9);
    for (const int factor : kLonger) {
      const double step = factor * H;
      if (step > scene::kMaxStep * (1 + 1e-9)) continue;
      const std::string setting = fmt::format("session.step={:.9g} s", step);
      add(fmt::format("communication step {}, sub-steps as they are", duration_text(step)), "session.step",
          {setting, fmt::format("mechanics.max_substep={:.9g} s", substep)});
      add(fmt::format("communication step {}, sub-steps longer alike", duration_text(step)), "session.step",
          {setting, fmt::format("mechanics.max_substep={:.9g} s", factor * substep)});
    }
  }

  const scene::Scene& scene_;
  std::vector<Candidate> list_;
};

}  // namespace

std::vector<Candidate> candidates(const scene::Scene& scene, const RunFindings& found) {
  return Collector(scene).collect(found);
}

}  // namespace slew::analysis
