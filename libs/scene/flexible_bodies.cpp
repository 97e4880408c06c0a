// SPDX-License-Identifier: Apache-2.0
#include "scene/flexible_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "coupling/samples.h"
#include "flex/finite_segments.h"
#include "flex/flexible_files.h"
#include "flex/input_error.h"
#include "multibody/flexible/deflection.h"
#include "multibody/flexible/elastic_law.h"
#include "multibody/formulations/integrators.h"
#include "scene/assets.h"
#include "scene/flexible_conversion.h"

namespace slew::scene {
namespace {

using multibody::BodyDef;
using multibody::FlexibleBodyDef;
using multibody::SegmentedBodyDef;

// "0.005;0.005"; nothing if the text is no list of numbers
std::optional<std::vector<double>> number_list(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const std::size_t first = text.find_first_not_of(' ', begin), last = text.find_last_not_of(' ', end - 1);
    if (first >= end) return std::nullopt;
    double& number = numbers.emplace_back();
    const auto [rest, error] = std::from_chars(text.data() + first, text.data() + last + 1, number);
    if (error != std::errc() || rest != text.data() + last + 1 || !std::isfinite(number)) return std::nullopt;
    begin = end + 1;
  }
  return numbers;
}

struct Wanted {
  bool all = false;
  std::vector<int> ordinals{};
};

class FlexibleReader {
 public:
  FlexibleReader(const LoadContext& load_context, Scene& scene, Problems& problems, Problems& warnings)
      : load_context_(load_context), scene_(scene), problems_(problems), warnings_(warnings) {}

  void read(const BodyDef& body) {
    FlexibleBodyDef flexible{.body = body.name};
    flexible.relative_damping = numbers_of(body, "relative_damping", body.relative_damping);
    flexible.start = numbers_of(body, "modal_coordinates", body.modal_coordinates);
    flexible.start_rates = numbers_of(body, "modal_rates", body.modal_rates);
    const std::optional<Wanted> modes = modes_of(body);
    if (load_context_.has_assets) {
      const flex::FlexibleFileSet files = files_of(body);
      const flex::Reduction* reduction = reduction_of(body, files);
      if (reduction != nullptr && modes) take(body, files, *reduction, *modes, flexible);
    }
    const bool is_undeformed = body.start_shape == multibody::StartShape::undeformed;
    if (is_undeformed && flexible.modes != nullptr) flexible.start.assign(flexible.modes->modes(), 0.0);
    scene_.mechanics.flexible_bodies.push_back(std::move(flexible));
  }

  void read_segmented(const BodyDef& body) {
    SegmentedBodyDef segmented{.body = body.name};
    const auto damping = number_list(body.relative_damping);
    if (damping && damping->size() <= 1) {
      segmented.relative_damping = damping->empty() ? 0 : damping->front();
    } else {
      report_problem(body, "relative_damping",
                     "'" + body.relative_damping + "' is not one number: the beams between segments are damped alike",
                     "one number, of the files' first mode");
    }
    if (body.start_shape == multibody::StartShape::undeformed) segmented.start = multibody::SegmentStart::straight;
    if (load_context_.has_assets) {
      const flex::FlexibleFileSet files = files_of(body);
      const flex::Reduction* reduction = reduction_of(body, files);
      if (reduction != nullptr) cut(body, files, *reduction, segmented);
    }
    scene_.mechanics.segmented_bodies.push_back(std::move(segmented));
  }

 private:
  std::vector<double> numbers_of(const BodyDef& body, const char* key, const std::string& text) {
    if (auto numbers = number_list(text)) return *std::move(numbers);
    report_problem(body, key, "'" + text + "' is no list of numbers",
                   "numbers between semicolons, such as '0.005;0.005'");
    return {};
  }

  [[nodiscard]] flex::FlexibleFileSet files_of(const BodyDef& body) const {
    return {load_context_.asset_folder, body.flex_model.empty() ? scene_.name : body.flex_model, body.flex_file_prefix};
  }

  void cut(const BodyDef& body, const flex::FlexibleFileSet& files, const flex::Reduction& reduction,
           SegmentedBodyDef& segmented) {
    try {
      segmented.chain = std::make_shared<const multibody::SegmentChain>(
          segment_chain(reduction, static_cast<int>(body.segments), fmt::format("{}_{}", files.model, files.prefix)));
    } catch (const flex::InputError& error) {
      report_problem(body, "flex_file_prefix", error.what(), "files of a straight beam, or type flexible");
      return;
    }
    const auto& nodes = segmented.chain->nodes;
    double length = 0;
    for (const auto& node : nodes) length = std::max(length, norm(node.position - nodes.front().position));
    BodyDef of_files;
    multibody::take_mass(*segmented.chain, of_files);
    compare_mass(body, of_files, length);
  }

  void report_problem(const BodyDef& body, const char* key, std::string what, std::string expected) {
    problems_.push_back({fmt::format("{}.{}", body.name, key), std::move(what), std::move(expected), ""});
  }

  std::optional<Wanted> modes_of(const BodyDef& body) {
    if (body.flex_modes.empty()) return Wanted{.all = true};
    if (body.flex_modes == "none") return Wanted{};
    try {
      return Wanted{.ordinals = flex::mode_list(body.flex_modes)};
    } catch (const flex::InputError& error) {
      report_problem(body, "flex_modes", error.what(), "");
      return std::nullopt;
    }
  }

  // null after a reported problem
  const flex::Reduction* reduction_of(const BodyDef& body, const flex::FlexibleFileSet& files) {
    const auto known = sets_.find({files.model, files.prefix});
    if (known != sets_.end()) return known->second.get();
    auto& set = sets_[{files.model, files.prefix}];
    if ((files.model + files.prefix).find('/') != std::string::npos) {
      report_problem(body, "flex_file_prefix",
                     "'" + files.model + "_" + files.prefix + "' lies outside of the scene's folder",
                     "names of files in that folder");
      return nullptr;
    }
    for (const std::string& matrix : flex::flexible_matrices()) {
      if (auto refusal = load_context_.refusal_of(flex::flexible_file(files, matrix).filename().string())) {
        report_problem(body, "flex_file_prefix", std::move(refusal->what), std::move(refusal->expected));
        return nullptr;
      }
    }
    try {
      set = std::make_unique<flex::Reduction>(flex::read_flexible_files(files));
    } catch (const std::exception& error) {
      report_problem(body, "flex_file_prefix", error.what(),
                     "a set of flexible files beside the scene: slewring flex build");
      return nullptr;
    }
    for (const std::string& matrix : flex::flexible_matrices()) add_asset(body, files, matrix);
    return set.get();
  }

  void add_asset(const BodyDef& body, const flex::FlexibleFileSet& files, const std::string& matrix) {
    const std::string name = flex::flexible_file(files, matrix).filename().string();
    const auto known = std::find_if(scene_.assets.begin(), scene_.assets.end(),
                                    [&](const Asset& asset) { return asset.name == name; });
    if (known != scene_.assets.end()) return;
    std::string fault;
    if (std::optional<Asset> asset = measure_asset(name, LoadContext{true, load_context_.asset_folder}, fault)) {
      scene_.assets.push_back(std::move(*asset));
    } else {
      report_problem(body, "flex_file_prefix", "'" + name + "' " + fault, "");
    }
    if (scene_.assets.size() > kMaxAssets) {
      report_problem(body, "flex_file_prefix", fmt::format("the scene has {} files", scene_.assets.size()),
                     fmt::format("at most {}", kMaxAssets));
    }
  }

  void take(const BodyDef& body, const flex::FlexibleFileSet& files, const flex::Reduction& all, const Wanted& wanted,
            FlexibleBodyDef& flexible) {
    const double highest = 2 * std::numbers::pi * body.flex_frequency_limit;
    std::vector<int> kept;
    for (const int ordinal : flex::modes_up_to(all.body, highest)) {
      const bool is_wanted =
          wanted.all || std::find(wanted.ordinals.begin(), wanted.ordinals.end(), ordinal) != wanted.ordinals.end();
      if (is_wanted) kept.push_back(ordinal);
    }
    try {
      static_cast<void>(flex::places_of(wanted.ordinals, all.body.modes()));  // throws for unknown ordinals
      if (kept.empty() && (wanted.all || !wanted.ordinals.empty())) {
        report_problem(body, "flex_frequency_limit",
                       fmt::format("no mode is left below {:.4g} Hz", body.flex_frequency_limit),
                       fmt::format("at least {:.4g} Hz", all.body.omega.front() / (2 * std::numbers::pi)));
        return;
      }
      const flex::Reduction chosen = flex::select(all, kept);
      flexible.modes = std::make_shared<const multibody::ModalBody>(
          modal_body(chosen, fmt::format("{}_{}", files.model, files.prefix)));
      BodyDef of_files;
      multibody::take_mass(*flexible.modes, of_files);
      compare_mass(body, of_files, multibody::length_of(*flexible.modes));
      if (chosen.body.modes() > 0) add_model(flexible, chosen);
    } catch (const flex::InputError& error) {
      report_problem(body, "flex_modes", error.what(), "");
    }
  }

  void add_model(const FlexibleBodyDef& flexible, const flex::Reduction& chosen) {
    scene_.flexible_bodies.push_back({flexible.body, std::make_shared<const flex::Reduction>(chosen), chosen.body.K,
                                      multibody::modal_damping(*flexible.modes, flexible.relative_damping)});
  }

  // properties of the body as a rigid one
  void compare_mass(const BodyDef& body, const BodyDef& of_files, double length) {
    constexpr double kAlike = 0.01;
    if (body.mass == 0) return;
    if (std::fabs(body.mass - of_files.mass) > kAlike * of_files.mass) {
      warnings_.push_back(
          {body.name + ".mass",
           fmt::format("{:.6g} kg has no effect: the flexible files give {:.6g} kg", body.mass, of_files.mass),
           "no mass, or that of the files", ""});
    }
    const double off = norm(math::Vec3(body.center_of_mass) - math::Vec3(of_files.center_of_mass));
    if (off > kAlike * length) {
      const auto [x, y, z] = of_files.center_of_mass;
      warnings_.push_back({body.name + ".center_of_mass",
                           fmt::format("it has no effect: the flexible files give [{:.6g}, {:.6g}, {:.6g}] m", x, y, z),
                           "no center_of_mass, or that of the files", ""});
    }
  }

  const LoadContext& load_context_;
  Scene& scene_;
  Problems& problems_;
  Problems& warnings_;
  std::map<std::pair<std::string, std::string>, std::unique_ptr<flex::Reduction>> sets_;
};

// capacity of a sample of the modes
void check_caps(const Scene& scene, Problems& problems) {
  std::size_t modes = 0, pairs = 0;
  for (const FlexibleBody& model : scene.flexible_bodies) {
    modes += model.reduction->body.modes();
    pairs += model.stiffness.size();
  }
  const auto check = [&](std::size_t count, std::size_t most, const char* what) {
    if (count <= most) return;
    problems.push_back({scene.flexible_bodies.back().body + ".flex_modes",
                        fmt::format("the scene's flexible bodies have {} {}", count, what),
                        fmt::format("at most {}", most), ""});
  };
  check(scene.flexible_bodies.size(), coupling::kMaxFlexibleBodies, "bodies with modes");
  check(modes, coupling::kMaxModes, "modes");
  check(pairs, coupling::kMaxModePairs, "pairs of modes, the squares of their numbers of modes together");
}

// The condensed step uses the trapezoidal rule: with another rule in the mechanics the exchange is unstable.
void check_condensed(const Scene& scene, Problems& problems) {
  if (scene.session.flexible != coupling::ElasticExchange::condensed || !scene.has_modes()) return;
  if (multibody::step_rule(scene.mechanics).integrator != multibody::Integrator::trapezoidal) {
    problems.push_back({"session.flexible", "'condensed' requires the trapezoidal integrator",
                        "mechanics.integrator trapezoidal, or flexible once", ""});
  }
  if (scene.session.step > scene.mechanics.max_substep * (1 + 1e-9)) {
    problems.push_back({"session.flexible",
                        fmt::format("'condensed' requires one sub-step, the mechanics has {}",
                                    std::ceil(scene.session.step / scene.mechanics.max_substep * (1 - 1e-9))),
                        fmt::format("mechanics.max_substep of at least {:.3g} s, or flexible once", scene.session.step),
                        ""});
  }
}

}  // namespace

void read_flexible_bodies(const LoadContext& load_context, Scene& scene, Problems& problems, Problems& warnings) {
  FlexibleReader reader(load_context, scene, problems, warnings);
  for (const BodyDef& body : scene.mechanics.bodies) {
    if (body.type == multibody::BodyType::flexible) reader.read(body);
    if (body.type == multibody::BodyType::segmented) reader.read_segmented(body);
  }
  check_caps(scene, problems);
  check_condensed(scene, problems);
  if (scene.session.flexible != coupling::ElasticExchange::once && !scene.has_modes()) {
    warnings.push_back({"session.flexible", "it has no effect: no body of the scene keeps modes", "", ""});
  }
  if (scene.session.shed == ShedLoad::view && !scene.has_flexible_bodies()) {
    warnings.push_back({"session.shed", "view has no effect: no body of the scene bends", "", "variables"});
  }
}

Scene::Scene() = default;
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

bool Scene::has_modes() const noexcept {
  return std::any_of(mechanics.bodies.begin(), mechanics.bodies.end(), [](const BodyDef& body) {
    return body.type == multibody::BodyType::flexible && body.flex_modes != "none";
  });
}

std::uint32_t Scene::flexible_every() const noexcept {
  const bool is_stated_once = session.flexible == coupling::ElasticExchange::once;
  return is_stated_once ? static_cast<std::uint32_t>(recording.every) : 1;
}

StepIndex Scene::exchange_unit() const noexcept {
  const StepIndex of_sensors = has_sensors() ? recording.every : 1;
  return std::lcm(std::lcm<StepIndex>(session.exchange_every, has_modes() ? flexible_every() : 1), of_sensors);
}

}  // namespace slew::scene
