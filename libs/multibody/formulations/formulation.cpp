// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/formulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/reductions.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/contacts/contact_rate.h"
#include "multibody/formulations/body_coordinates.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/body_penalty.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/step_parts.h"
#include "multibody/formulations/stops.h"
#include "multibody/motions/motion_pieces.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

namespace {

// greatest number of parts (2, 4, ...) of a sub-step whose iteration does not converge
constexpr int kMostPartsOfAStep = 8;
// Growth of the speeds above which an iteration without convergence has diverged.
constexpr double kMostGrowth = 1e3;
// Smallest part of an explicit rule at a touch, in 1/1024: there it resolves what it is stable with. The parts between
// touches bound the number of divisions.
constexpr int kSmallestOfExplicit = 4, kNoMostDivisions = std::numeric_limits<int>::max();

}  // namespace

struct Dynamics::Bodies {
  Bodies(const Model& mechanism, const State& start, const StepRule& rule)
      : model(is_implicit(rule.integrator) ? build_stiff_body_model(mechanism) : build_body_model(mechanism)),
        state(body_state(mechanism, start)),
        ws(mechanism, model) {}

  BodyModel model;
  BodyState state;
  BodyWorkspace ws;
};

struct Dynamics::HeldBodies {
  HeldBodies(Formulation formulation, const Model& mechanism, const State& start)
      : model(build_penalty_model(mechanism, formulation)), state(body_state(mechanism, start)), ws(mechanism, model) {}

  PenaltyModel model;
  BodyState state;
  PenaltyWorkspace ws;
};

// The start of a sub-step or part, for its repetition in shorter ones.
struct Dynamics::Start {
  explicit Start(const Model& mechanism) : joints(start_state(mechanism)), bodies(body_state(mechanism, joints)) {}

  // bodies, stages: null if the formulation, the rule has none
  void keep(const State& present, const BodyState* present_bodies, const StageWorkspace* stages) noexcept {
    copy_state(present, joints);
    if (present_bodies != nullptr) bodies = *present_bodies;
    if (stages == nullptr) return;
    algorithmic = stages->algorithmic;
    algorithmic_turn = stages->algorithmic_turn;
  }
  void go_back(State& present, BodyState* present_bodies, StageWorkspace* stages) const noexcept {
    copy_state(joints, present);
    if (present_bodies != nullptr) *present_bodies = bodies;
    if (stages == nullptr) return;
    stages->algorithmic = algorithmic;
    stages->algorithmic_turn = algorithmic_turn;
  }

  State joints;
  BodyState bodies;
  std::vector<double> algorithmic;
  std::vector<math::Vec3> algorithmic_turn;
};

// Integrators beside rk4. In joint coordinates the iteration has a matrix of its own.
struct Dynamics::Stages {
  Stages(const Model& mechanism, const StepRule& step_rule, StageWorkspace::Coordinates coordinates)
      : rule(step_rule), model(build_stiff_body_model(mechanism)), ws(mechanism, model, coordinates), start(mechanism) {
    if (coordinates == StageWorkspace::Coordinates::joint) matrix.emplace(mechanism, model);
    keep(start.joints, nullptr);
    part_mean.resize(mechanism.rows.size());
  }

  void keep(const State& joints, const BodyState* bodies) noexcept { start.keep(joints, bodies, &ws); }
  void go_back(State& joints, BodyState* bodies) noexcept { start.go_back(joints, bodies, &ws); }

  // The lead of generalised_alpha belongs to parts of one length.
  void forget_lead() noexcept {
    std::fill(ws.algorithmic.begin(), ws.algorithmic.end(), 0.0);
    std::fill(ws.algorithmic_turn.begin(), ws.algorithmic_turn.end(), math::Vec3());
  }

  StepRule rule;
  BodyModel model;
  StageWorkspace ws;
  std::optional<BodyWorkspace> matrix;
  Start start;
  std::vector<double> part_mean;
};

// Sub-steps in parts where one-sided forces begin or end, or a table bends.
struct Dynamics::Touches {
  Touches(const Model& mechanism, Touched which, const StageWorkspace* stages)
      : touched(which),
        is_explicit(which == Touched::swings),
        stops(element_stop_count(mechanism)),
        stops_0(stops),
        part_mean(mechanism.rows.size()),
        start(mechanism) {
    start.keep(start.joints, nullptr, stages);
  }

  Touched touched;
  bool is_explicit;
  std::vector<StopMotion> stops, stops_0;  // at the end and the start of a part
  std::vector<double> part_mean;
  Start start;
};

namespace {

// by the motion at the start of a sub-step; false if not finite
bool is_resolved(const Workspace& ws, double h) noexcept {
  constexpr double kSquare = kLargestTurn * kLargestTurn;
  for (const LinkMotion& m : ws.motion) {
    if (!(dot(m.w, m.w) * h * h <= kSquare)) return false;
  }
  return true;
}

// the pair stays for the report of the step
bool take_lost(Workspace& ws) noexcept {
  if (ws.contact == nullptr) return false;
  if (!ws.contact->is_lost) ws.contact->lost_pair = -1;
  return std::exchange(ws.contact->is_lost, false);
}

// conditions on the end of a sub-step
bool is_right(const Model& model, const State& state, Workspace& ws) noexcept {
  const bool is_lost = take_lost(ws);
  return !is_lost && is_finite(state) && are_drives_defined(model, state.time);
}

}  // namespace

Dynamics::Dynamics(Formulation formulation, const Model& model, const State& start, StepRule rule) {
  using enum StageWorkspace::Coordinates;
  const bool has_rule = is_implicit(rule.integrator) || rule.integrator == Integrator::semi_implicit_euler;
  switch (formulation) {
    case Formulation::recursive:
      is_euler_ = rule.integrator == Integrator::semi_implicit_euler;
      if (is_implicit(rule.integrator)) stages_ = std::make_unique<Stages>(model, rule, joint);
      break;
    case Formulation::lagrange:
      bodies_ = std::make_unique<Bodies>(model, start, rule);
      if (has_rule) stages_ = std::make_unique<Stages>(model, rule, body);
      break;
    case Formulation::augmented:
    case Formulation::penalty:
      held_ = std::make_unique<HeldBodies>(formulation, model, start);
      break;
  }
  motion_resolution_ = motion_resolution(formulation, rule.integrator);
  piece_mean_.resize(model.rows.size());
  // semi-implicit Euler sees a force a part late, and keeps no energy over parts of different lengths
  if (formulation != Formulation::augmented && rule.integrator != Integrator::semi_implicit_euler) {
    const Touched touched = is_implicit(rule.integrator) ? Touched::tables : Touched::swings;
    touches_ = std::make_unique<Touches>(model, touched, stages_ == nullptr ? nullptr : &stages_->ws);
  }
  if (model.contact == nullptr || held_ != nullptr || is_implicit(rule.integrator)) return;
  rule.integrator = Integrator::sdirk2;
  settling_ = std::make_unique<Stages>(model, rule, bodies_ == nullptr ? joint : body);
  if (!settling_->matrix) settling_->matrix.emplace(model, settling_->model);
}

Dynamics::~Dynamics() = default;
Dynamics::Dynamics(Dynamics&&) noexcept = default;
Dynamics& Dynamics::operator=(Dynamics&&) noexcept = default;

void Dynamics::evaluate(const Model& model, State& state, Workspace& ws) noexcept {
  if (bodies_ != nullptr) {
    is_regular_ = multibody::evaluate(model, bodies_->model, bodies_->state, state, ws, bodies_->ws);
  } else if (held_ != nullptr) {
    is_regular_ = multibody::evaluate(model, held_->model, held_->state, state, ws, held_->ws);
  } else {
    multibody::evaluate(model, state, ws);
  }
}

StepKind Dynamics::step_kind() const noexcept {
  if (stages_ != nullptr && is_implicit(stages_->rule.integrator)) return StepKind::implicit;
  if (settling_ != nullptr) return StepKind::settling;
  return held_ != nullptr && held_->model.formulation == Formulation::augmented ? StepKind::corrected
                                                                                : StepKind::explicit_rule;
}

// after evaluate(), for the next h
ContactStep Dynamics::contact_step(StepKind kind, const Model& model, double h, Workspace& ws) const noexcept {
  if (kind == StepKind::corrected) return {kind, kReachOfCorrections, kReachOfCorrections};
  if (is_euler_ && model.contact != nullptr && ws.contact->force_count > 0) {
    solve_forward(model, ws, ws.residual_free, ws.udot);
    if (stays_slow(model, h, ws)) return {kind, kReachOfEuler, kReachOfEulerAtRest};
  }
  // the explicit rule beside stages is semi-implicit Euler
  const bool is_euler = is_euler_ || (stages_ != nullptr && kind != StepKind::implicit);
  return is_euler ? ContactStep{kind, kReachOfEuler, kReachOfEuler} : ContactStep{kind, kReach, kReach};
}

// One of the parts into which contacts divide a sub-step of h.
struct Dynamics::PartOfStep {
  double h;
  ContactParts parts;
  int index;
  ContactParts pieces;
  std::span<const double> mean, slope;

  // means of the rows' forces, continued along their lines, over a piece of it
  void put_forces(int count, int piece, std::span<double> forces) const noexcept {
    const double later = (index * count + piece + 0.5) * (h / parts.count / count) - 0.5 * h;
    for (std::size_t k = 0; k < mean.size(); ++k) forces[k] = mean[k] + later * slope[k];
  }
};

bool Dynamics::advance(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                       std::span<const double> slope) noexcept {
  const StepKind kind = step_kind();
  const ContactParts parts = multibody::contact_parts(model, h, contact_step(kind, model, h, ws), ws);
  contact_parts_ = 1;
  settling_parts_ = 0;
  if (parts.count == 1 && !parts.is_settling) {
    return advance_part(model, state, ws, h, mean, slope) && is_right(model, state, ws);
  }
  contact_parts_ = 0;
  bool is_sound = true;
  for (int i = 0; i < parts.count; ++i) {
    if (i > 0) evaluate(model, state, ws);
    const ContactParts pieces =
        i > 0 ? contact_parts_again(model, h, parts.count, contact_step(kind, model, h / parts.count, ws), ws)
              : ContactParts{.is_settling = parts.is_settling};
    is_sound = advance_contacts(model, state, ws, {h, parts, i, pieces, mean, slope}) && is_sound;
  }
  return is_right(model, state, ws) && is_sound;
}

// after evaluate() at the start of the part
bool Dynamics::advance_contacts(const Model& model, State& state, Workspace& ws, const PartOfStep& part) noexcept {
  const double length = part.h / part.parts.count;
  ContactParts pieces = part.pieces;
  if (pieces.is_settling && is_motion_fast(model.drives, motion_resolution_, state.time, length)) {
    pieces = contact_parts_again(model, part.h, part.parts.count,
                                 contact_step(StepKind::explicit_rule, model, length, ws), ws);
  } else if (pieces.is_settling) {
    part.put_forces(1, 0, ws.row_part);
    ++contact_parts_;
    ++settling_parts_;
    if (settle_part(model, state, ws, length, ws.row_part, part.slope)) return true;
    pieces = contact_parts_again(model, part.h, part.parts.count,
                                 contact_step(StepKind::explicit_rule, model, length, ws), ws);
  }
  pieces.count = std::max(pieces.count, part.parts.pieces);
  bool is_sound = true;
  for (int j = 0; j < pieces.count; ++j) {
    if (j > 0) evaluate(model, state, ws);
    part.put_forces(pieces.count, j, ws.row_part);
    is_sound = advance_part(model, state, ws, length / pieces.count, ws.row_part, part.slope) && is_sound;
    ++contact_parts_;
  }
  return is_sound;
}

// One part by the implicit rule; false: back at its start, evaluated.
bool Dynamics::settle_part(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                           std::span<const double> slope) noexcept {
  Stages& s = *settling_;
  BodyState* const bodies = bodies_ == nullptr ? nullptr : &bodies_->state;
  const bool was_lost = ws.contact->is_lost, is_fine_enough = is_resolved(ws, h);
  s.keep(state, bodies);
  bool is_sound = is_fine_enough && is_regular_;
  if (bodies != nullptr) {
    is_sound = multibody::evaluate(model, s.model, *bodies, state, ws, *s.matrix) && is_sound;
  } else {
    // no values are carried from part to part
    s.matrix->ldl.set_smallest_pivot(model.has_closing_rows() ? ws.loops.factor.smallest_pivot() : 1.0);
  }
  ws.until = state.time + h;
  is_sound =
      is_sound && multibody::advance(model, s.model, s.rule, {state, bodies}, ws, *s.matrix, s.ws, h, mean, slope);
  ws.until = kNever;
  // a corner that lands beside resting contacts is an impact
  if (is_sound && !ws.contact->is_hit && is_finite(state)) return true;
  ws.contact->is_lost = was_lost;
  s.go_back(state, bodies);
  evaluate(model, state, ws);
  return false;
}

bool Dynamics::advance_part(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                            std::span<const double> slope) noexcept {
  parts_ = iterations_ = 0;
  if (is_motion_fast(model.drives, motion_resolution_, state.time, h)) {
    return take_motions(model, state, ws, h, mean, slope);
  }
  const bool is_fine_enough = is_resolved(ws, h);
  ws.until = state.time + h;
  const bool is_sound = take_substep(model, state, ws, h, mean, slope) && is_fine_enough;
  ws.until = kNever;
  return is_sound;
}

// In pieces that resolve the prescribed motions. Their lengths differ: instead of generalised_alpha, whose lead would
// be an impulse in another length, they are taken by sdirk2.
bool Dynamics::take_motions(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                            std::span<const double> slope) noexcept {
  const double start = state.time;
  const bool leads = stages_ != nullptr && stages_->rule.integrator == Integrator::generalised_alpha;
  if (leads) stages_->rule.integrator = Integrator::sdirk2;
  bool is_sound = true;
  double done = 0;
  for (int count = 1; done < h; ++count) {
    const double rest = h - done;
    double piece = motion_piece(model.drives, motion_resolution_, start + done, rest, h);
    if (count == kMostMotionPieces && piece < rest) {
      piece = rest;
      is_sound = false;
    }
    ws.until = start + done + piece;
    if (count > 1) evaluate(model, state, ws);
    // the rows' forces continue along their lines
    const double later = done + 0.5 * piece - 0.5 * h;
    for (std::size_t k = 0; k < mean.size(); ++k) piece_mean_[k] = mean[k] + later * slope[k];
    const bool is_fine_enough = is_resolved(ws, piece);
    is_sound = take_substep(model, state, ws, piece, piece_mean_, slope) && is_fine_enough && is_sound;
    done = piece < rest ? done + piece : h;
  }
  ws.until = kNever;
  if (leads) {
    stages_->rule.integrator = Integrator::generalised_alpha;
    stages_->forget_lead();
  }
  return is_sound;
}

bool Dynamics::take_substep(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                            std::span<const double> slope) noexcept {
  const bool may_touch = touches_ != nullptr && has_element_stops(model, touches_->touched);
  return may_touch ? take_touches(model, state, ws, h, mean, slope) : take_rule(model, state, ws, h, mean, slope);
}

// motion of links and elements at the end of a part
void Dynamics::show_end(const Model& model, const State& state, Workspace& ws) const noexcept {
  if (const BodyState* bodies = own_state(); bodies != nullptr) {
    update_body_motion(model, *bodies, ws);
  } else {
    update_motion(model, state.q, state.u, ws);
  }
  update_elements(model, state.q, Elements::used, ws);
}

bool Dynamics::take_touches(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                            std::span<const double> slope) noexcept {
  Touches& t = *touches_;
  BodyState* const bodies = own_state();
  StageWorkspace* const stages = stages_ == nullptr ? nullptr : &stages_->ws;
  StepParts part(h, t.is_explicit ? kSmallestOfExplicit : kSmallestPart,
                 t.is_explicit ? kNoMostDivisions : kMostDivisions);
  bool is_sound = true, is_plastic = false;
  see_element_stops(model, ws, t.stops_0);
  for (;;) {
    const bool was_lost = ws.contact != nullptr && ws.contact->is_lost;
    const int parts = parts_, iterations = iterations_;
    t.start.keep(state, bodies, stages);
    part.put_mean(mean, slope, t.part_mean);
    const std::span<const double> part_mean = part.is_whole() ? mean : t.part_mean;
    if (stages != nullptr) stages->takes_touch = is_plastic;
    const bool is_taken = take_rule(model, state, ws, part.length(), part_mean, slope);
    show_end(model, state, ws);
    see_element_stops(model, ws, t.stops);
    const bool is_harsh = touch_between(model, t.stops_0, t.stops, {t.touched, part.length()}) == Touch::harsh;
    // an explicit rule takes the smallest part as it is, an implicit one as a touch
    if (is_harsh && (part.may_divide() || (!t.is_explicit && !is_plastic))) {
      is_plastic = !part.may_divide();
      if (part.may_divide()) part.divide();
      if (ws.contact != nullptr) ws.contact->is_lost = was_lost;
      parts_ = parts;
      iterations_ = iterations;
      t.start.go_back(state, bodies, stages);
      evaluate(model, state, ws);
      continue;
    }
    is_plastic = false;
    is_sound = is_taken && is_sound;
    if (!part.take()) break;
    evaluate(model, state, ws);
    see_element_stops(model, ws, t.stops_0);
  }
  if (stages != nullptr) stages->takes_touch = false;
  return is_sound;
}

bool Dynamics::take_rule(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                         std::span<const double> slope) noexcept {
  if (stages_ != nullptr) return advance_by_rule(model, state, ws, h, mean, slope);
  ++parts_;
  if (is_euler_) {
    // its sum over p'' would leave h/2 of the change of p'' as a speed of what hangs on a driven joint
    if (!model.drives.empty()) {
      ws.mean_over = h;
      evaluate(model, state, ws);
      ws.mean_over = 0;
    }
    return advance_by_euler(model, state, ws, h, mean);
  }
  if (bodies_ != nullptr) {
    Bodies& b = *bodies_;
    return multibody::advance(model, b.model, b.state, state, ws, b.ws, h, mean, slope) && is_regular_;
  }
  if (held_ != nullptr) {
    const bool is_sound = multibody::advance(model, held_->model, held_->state, state, ws, held_->ws, h, mean, slope);
    parts_ += held_->ws.parts - 1;
    return is_sound && is_regular_;
  }
  return multibody::advance(model, state, ws, h, mean, slope);
}

bool Dynamics::advance_by_rule(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                               std::span<const double> slope) noexcept {
  Stages& s = *stages_;
  BodyState* const bodies = bodies_ == nullptr ? nullptr : &bodies_->state;
  BodyWorkspace& bws = bodies_ == nullptr ? *s.matrix : bodies_->ws;
  const BodyModel& body = bodies_ == nullptr ? s.model : bodies_->model;
  const int most = is_implicit(s.rule.integrator) ? kMostPartsOfAStep : 1;
  if (most > 1) s.keep(state, bodies);
  bool is_sound = true;
  int parts = 1;
  for (;; parts *= 2) {
    // without convergence, repeat in twice as many parts; the rows' forces continue along their lines
    const double part = h / parts;
    is_sound = true;
    for (int i = 0; i < parts && (is_sound || parts == most); ++i) {
      if (parts > 1) evaluate(model, state, ws);
      const double later = (i + 0.5) * part - 0.5 * h;
      for (std::size_t k = 0; k < mean.size(); ++k) s.part_mean[k] = mean[k] + later * slope[k];
      is_sound = multibody::advance(model, body, s.rule, {state, bodies}, ws, bws, s.ws, part, s.part_mean, slope) &&
                 is_regular_ && is_sound;
      iterations_ += s.ws.iterations;
    }
    if (is_sound || parts == most) break;
    s.go_back(state, bodies);
  }
  parts_ += parts;
  if (is_sound) return true;
  // hold a diverged sub-step at its start
  if (most > 1 && !(fixed_max_abs(state.u) <= kMostGrowth * std::max(1.0, fixed_max_abs(s.start.joints.u)))) {
    s.go_back(state, bodies);
    evaluate(model, state, ws);
  }
  return false;
}

const BodyState* Dynamics::own_state() const noexcept {
  return bodies_ != nullptr ? &bodies_->state : held_ != nullptr ? &held_->state : nullptr;
}

void Dynamics::observe(const Model& model, const State& state, Workspace& ws) const noexcept {
  const BodyState* bodies = own_state();
  if (bodies == nullptr) return multibody::observe(model, state, ws);
  set_time(model, state.time, ws);
  update_body_motion(model, *bodies, ws);
  update_elements(model, state.q, Elements::all, ws);
  begin_contacts(model, state, ws);
  update_contacts(model, ws);
}

void Dynamics::add_to_hash(StateHash& hash) const noexcept {
  if (const BodyState* bodies = own_state(); bodies != nullptr) {
    hash.add(std::span<const double>(bodies->q));
    hash.add(std::span<const double>(bodies->u));
  }
  if (stages_ == nullptr || stages_->rule.integrator != Integrator::generalised_alpha) return;
  hash.add(std::span<const double>(stages_->ws.algorithmic));
  for (const math::Vec3& turn : stages_->ws.algorithmic_turn) {
    for (const double x : turn.array()) hash.add(x);
  }
}

template <typename Self, typename Bytes>
void Dynamics::visit(Self& self, Bytes& bytes) {
  const auto visit_bodies = [&](auto& bodies) {
    bytes.numbers(bodies.q);
    bytes.numbers(bodies.u);
  };
  if (self.bodies_ != nullptr) visit_bodies(self.bodies_->state);
  if (self.held_ != nullptr) visit_bodies(self.held_->state);
  if (self.stages_ == nullptr) return;
  auto& ws = self.stages_->ws;
  bytes.numbers(ws.algorithmic);
  for (auto& turn : ws.algorithmic_turn) visit_vector(bytes, turn);
  // an implicit stage in joint coordinates begins with the distance of the last one from singularity
  if (!self.stages_->matrix) return;
  double pivot = self.stages_->matrix->ldl.smallest_pivot();
  bytes.number(pivot);
  if constexpr (Bytes::kIsReading) self.stages_->matrix->ldl.set_smallest_pivot(pivot);
}

void Dynamics::save(StateWriter& bytes) const {
  visit(*this, bytes);
}

void Dynamics::load(StateReader& bytes) noexcept {
  visit(*this, bytes);
}

}  // namespace slew::multibody
