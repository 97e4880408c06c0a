// SPDX-License-Identifier: Apache-2.0
#include "analysis/load_chart/load_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "analysis/description/instant.h"
#include "analysis/description/largest_force.h"
#include "analysis/description/port_limits.h"
#include "analysis/description/settled_pose.h"
#include "analysis/load_chart/tipping.h"
#include "analysis/parameter_sweep/variation.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/index.h"
#include "core/suggestion.h"
#include "mechanics_node/payload.h"
#include "multibody/model/model.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::analysis {

using math::Vec3;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

[[noreturn]] void refuse_chart(const std::string& what, const std::string& remedy) {
  throw Failure(ExitCode::bad_input, fmt::format("{}; nothing was computed; {}", what, remedy));
}

// By line.
struct TippingPose {
  std::vector<TippingMoments> moments{};
  std::vector<double> sides{};  // signs
};

class ChartMaker {
 public:
  explicit ChartMaker(const LoadChartOptions& options)
      : options_(options), base_(std::make_unique<scene::Scene>(scene::load_file(options.scene, options.overrides))) {
    read_coordinates();
    check_machine();
    for (const std::string& line : options.lines) {
      lines_.push_back(read_tipping_line(line, Vec3(base_->mechanics.gravity)));
    }
    read_structure();
    chart_.scene = base_->name;
    chart_.from = options.from.empty() ? std::string(multibody::kGroundName) : options.from;
    list_limits();
  }

  LoadChart make(const std::function<bool(std::string_view, double)>& progress) {
    const std::vector<Settings> rows = sweep_rows(variations_, Sampling::grid, 0, 0);
    if (rows.size() > kMostChartPoses) {
      refuse_chart(fmt::format("{} poses are more than {}", rows.size(), kMostChartPoses), "give fewer in --over");
    }
    for (const Settings& row : rows) {
      if (!progress("poses", static_cast<double>(chart_.poses.size()) / static_cast<double>(rows.size()))) break;
      tipping_.emplace_back();
      chart_.poses.push_back(pose_of(row));
    }
    if (!lines_.empty()) find_sides();
    for (std::size_t i = 0; i < chart_.poses.size(); ++i) {
      if (chart_.poses[i].has_load()) choose(tipping_[i], chart_.poses[i]);
    }
    const auto has_load = [](const ChartPose& pose) { return pose.has_load(); };
    if (!chart_.poses.empty() && std::none_of(chart_.poses.begin(), chart_.poses.end(), has_load)) {
      const ChartPose& first = chart_.poses.front();
      throw Failure(ExitCode::bad_input,
                    fmt::format("no position of --over has a load; at the first one, {}: {}; there is no chart; choose "
                                "other positions or joints",
                                fmt::join(first.settings, ", "), first.refusal));
    }
    if (!is_steady_) {
      chart_.warnings.emplace_back(
          "a pressure that limits loads still rose after 30 s of stall; the loads are those of its value then");
    }
    return std::move(chart_);
  }

 private:
  // ---- options
  void read_coordinates() {
    if (options_.over.empty() || options_.over.size() > 2) {
      refuse_chart(fmt::format("--over is given {} times", options_.over.size()), "give it for one or two joints");
    }
    for (const std::string& text : options_.over) {
      Variation variation = parse_variation(text, Sampling::grid, "--over");
      const auto& joints = base_->mechanics.joints;
      const auto is_it = [&](const multibody::JointDef& joint) { return joint.name == variation.path; };
      if (std::none_of(joints.begin(), joints.end(), is_it)) {
        std::vector<std::string_view> names;
        for (const multibody::JointDef& joint : joints) names.push_back(joint.name);
        const std::string meant(closest(variation.path, names));
        refuse_chart(fmt::format("--over {}: the scene has no joint '{}'", text, variation.path),
                     meant.empty() ? "name a joint with one coordinate" : "did you mean '" + meant + "'?");
      }
      if (!chart_.coordinates.empty() && chart_.coordinates.front().joint == variation.path) {
        refuse_chart(fmt::format("--over is given twice for {}", variation.path),
                     "give all its positions in one, or another joint");
      }
      chart_.coordinates.push_back({variation.path, variation.unit});
      variation.path = "start." + variation.path;
      variations_.push_back(std::move(variation));
    }
  }

  void check_machine() const {
    const multibody::MechanicsDef& mechanics = base_->mechanics;
    if (!base_->has_mechanics() || base_->ports.empty()) {
      refuse_chart("no cylinder carries a payload in this scene", "take a scene with mechanics and hydraulics");
    }
    if (base_->has_flexible_bodies()) {
      refuse_chart("the scene has flexible or segmented bodies, which no start by joint coordinates puts elsewhere",
                   "take its rigid scene");
    }
    if (norm(Vec3(mechanics.gravity)) <= 0) refuse_chart("the scene has no gravity", "set mechanics.gravity");
    for (const multibody::JointDef& joint : mechanics.joints) {
      if (joint.type != multibody::JointType::floating) continue;
      refuse_chart(fmt::format("{} lets the machine move on its tyres or springs, where it is at rest with one payload "
                               "only",
                               joint.name),
                   fmt::format("hold it with --set {}.type=fixed", joint.name));
    }
  }

  // "Cyl_Lift=400kN"
  void read_structure() {
    allowed_.assign(base_->ports.size(), kNever);
    for (const std::string& text : options_.structure) {
      const std::size_t equals = text.find('=');
      const std::string name = text.substr(0, equals);
      const auto port = std::find_if(base_->ports.begin(), base_->ports.end(),
                                     [&](const scene::PortDef& one) { return one.name == name; });
      if (equals == std::string::npos || port == base_->ports.end()) {
        refuse_chart(fmt::format("--structure {}: there is no cylinder '{}'", text, name),
                     "expected CYLINDER=FORCE, such as 'Cyl_Lift=400 kN'");
      }
      const Dimension dimension = port->unit == coupling::PortUnit::metre ? Dimension::force : Dimension::torque;
      const double force = read_option("--structure", text.substr(equals + 1), dimension);
      if (!(force > 0)) refuse_chart("--structure " + text + ": the allowed force is not above 0", "give its size");
      allowed_[static_cast<std::size_t>(port - base_->ports.begin())] = force;
    }
  }

  void list_limits() {
    for (const scene::PortDef& port : base_->ports) chart_.limits.push_back({LimitKind::cylinder, port.name});
    for (std::size_t i = 0; i < allowed_.size(); ++i) {
      if (std::isfinite(allowed_[i])) {
        chart_.limits.push_back({LimitKind::structure, base_->ports[i].name + " structure"});
      }
    }
    has_tipping_ = !lines_.empty() || base_->mechanics.tyre_dummies.size() >= 3;
    if (has_tipping_) chart_.limits.push_back({LimitKind::tipping, "tipping"});
  }

  // ---- poses
  ChartPose pose_of(const Settings& row) {
    ChartPose pose;
    scene::Overrides overrides = options_.overrides;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const auto& [path, text] = row[i];
      const Variation& variation = variations_[i];
      const std::optional<double> value = number_of(variation, text);
      if (!value) refuse_chart("--over: '" + text + "' is no position", "expected an angle or a length");
      pose.values.push_back(*value);
      pose.settings.push_back(variation.range ? digits_text(*value, 4) + " " + variation.unit : text);
      overrides.push_back(path + "=" + text);
    }
    try {
      const scene::Scene scene = scene::load_file(options_.scene, overrides);
      find_loads(scene, pose);
    } catch (const scene::LoadError& error) {
      const scene::Diagnostic& first = error.diagnostics().front();
      pose.refusal = first.path.empty() ? first.what : first.path + ": " + first.what;
    }
    return pose;
  }

  void find_loads(const scene::Scene& scene, ChartPose& pose) {
    multibody::Model model = multibody::build_model(scene.mechanics, scene::row_names(scene));
    multibody::State state = multibody::start_state(model);
    std::fill(state.u.begin(), state.u.end(), 0.0);
    multibody::Workspace ws(model);
    const int payload = mechanics_node::payload_of(scene.mechanics, model);
    if (payload == 0) refuse_chart("the scene has no payload that moves", "name one by `payload:`");
    pose.refusal = settle_free_joints(model, scene.ports.size(), scene.started_joints, state);
    if (!pose.refusal.empty()) return;
    multibody::observe(model, state, ws);
    chart_.payload = model.bodies[at(payload)].name;
    chart_.mass = mechanics_node::mass_of(model, payload);
    find_place(model, ws, payload, pose);

    const std::size_t m = scene.ports.size();
    std::vector<double> ratio, F(m), slope(m), stroke(m);
    for (const scene::PortDef& port : scene.ports) ratio.push_back(port.ratio);
    if (!mechanics_node::static_line_forces(model, state, ws, ratio, payload, chart_.mass, F)) {
      pose.refusal = "no forces of the cylinders hold the machine";
      return;
    }
    for (std::size_t i = 0; i < m; ++i) stroke[i] = scene.ports[i].offset + ratio[i] * ws.row_x[i];
    const std::vector<double> W = mechanics_node::port_mobility(model, ws, ratio);
    mechanics_node::payload_slopes(model, state, ws, ratio, payload, chart_.mass, slope);
    pose.loads.assign(chart_.limits.size(), kNever);
    add_cylinders({W, F, slope, chart_.mass}, stroke, pose);
    if (!pose.refusal.empty()) return;
    if (has_tipping_) {
      multibody::observe(model, state, ws);
      add_tipping(model, ws, payload);
    }
  }

  void find_place(const multibody::Model& model, const multibody::Workspace& ws, int payload, ChartPose& pose) const {
    const int from = multibody::find_body(model, chart_.from);
    if (from < 0) refuse_chart("--from: the scene has no body '" + chart_.from + "'", "name a body, or Ground");
    const Vec3 up = model.gravity * (-1 / norm(model.gravity));
    const Vec3 arm = Vec3(multibody::body_pose(model, ws, payload).center_of_mass) -
                     Vec3(multibody::body_pose(model, ws, from).position);
    pose.height = dot(arm, up);
    pose.reach = norm(arm - up * pose.height);
  }

  // (1), (2)
  void add_cylinders(const StaticLoad& load, const std::vector<double>& stroke, ChartPose& pose) {
    if (!largest_) largest_.emplace(*base_, stroke);
    const PortLimits limits = find_port_limits(*largest_, load);
    if (!limits.refusal.empty()) {
      pose.refusal = limits.refusal;
      pose.loads.clear();
      return;
    }
    std::size_t next = stroke.size();
    for (std::size_t i = 0; i < stroke.size(); ++i) {
      const bool carries = std::fabs(load.slope[i]) >= kNoShare;
      const double direction = load.slope[i] > 0 ? 1 : -1;
      if (limits.ports[i].carries) {
        if (!limits.ports[i].largest.is_steady) unsteady_.insert(i);
        pose.loads[i] = limits.ports[i].load;
      }
      if (!std::isfinite(allowed_[i])) continue;
      if (carries) pose.loads[next] = chart_.mass + (direction * allowed_[i] - load.F[i]) / load.slope[i];
      ++next;
    }
  }

  // (3)
  void add_tipping(const multibody::Model& model, const multibody::Workspace& ws, int payload) {
    TippingPose& tipping = tipping_.back();
    weights_ = weights_without(model, ws, payload);
    const Vec3 center(multibody::body_pose(model, ws, payload).center_of_mass);
    const std::vector<TippingLine> lines = lines_.empty() ? lines_of_tyres(model, ws) : lines_;
    for (const TippingLine& line : lines) {
      tipping.moments.push_back(tipping_moments(line, weights_, center, model.gravity));
      tipping.sides.push_back(line.side);
    }
  }

  // of the lines that were given without it
  void find_sides() {
    for (std::size_t line = 0; line < lines_.size(); ++line) {
      if (lines_[line].side != 0) continue;
      std::vector<TippingMoments> moments;
      for (const TippingPose& pose : tipping_) {
        if (!pose.moments.empty()) moments.push_back(pose.moments[line]);
      }
      if (moments.empty()) return;
      const SideChoice choice = choose_side(lines_, line, weights_, moments, Vec3(base_->mechanics.gravity));
      if (lines_.size() == 1 || !choice.is_sure) {
        chart_.notes.push_back(fmt::format("tipping line '{}': {}", options_.lines[line], choice.text));
      }
      for (TippingPose& pose : tipping_) {
        if (!pose.moments.empty()) pose.sides[line] = lines_[line].side;
      }
    }
  }

  void choose(const TippingPose& tipping, ChartPose& pose) {
    for (std::size_t line = 0; line < tipping.moments.size(); ++line) {
      pose.tips_alone = pose.tips_alone || tipping.moments[line].rest * tipping.sides[line] <= 0;
      pose.loads.back() = std::min(pose.loads.back(), tipping_load(tipping.moments[line], tipping.sides[line]));
    }
    pose.limiting =
        static_cast<std::size_t>(std::min_element(pose.loads.begin(), pose.loads.end()) - pose.loads.begin());
    pose.load = std::max(0.0, pose.loads[pose.limiting]);
    if (!std::isfinite(pose.load)) pose.refusal = "no limit depends on the payload";
    if (unsteady_.count(pose.limiting) > 0) is_steady_ = false;
  }

  const LoadChartOptions& options_;
  std::unique_ptr<scene::Scene> base_;
  std::vector<Variation> variations_;
  std::vector<TippingLine> lines_;    // of --tipping-line
  std::vector<TippingPose> tipping_;  // by pose; empty where there is no load
  std::vector<Weight> weights_;       // at the last pose; those fixed to Ground are the same at all
  std::vector<double> allowed_;       // N, by port; infinite: none is given
  bool has_tipping_ = false, is_steady_ = true;
  std::optional<LargestForces> largest_;
  std::set<std::size_t> unsteady_;  // ports whose pressure still rose
  LoadChart chart_;
};

}  // namespace

LoadChart find_load_chart(const LoadChartOptions& options,
                          const std::function<bool(std::string_view, double)>& progress) {
  return ChartMaker(options).make(progress);
}

}  // namespace slew::analysis
