// SPDX-License-Identifier: Apache-2.0
#include "multibody/contacts/contact_passes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "contact/sweep.h"
#include "core/index.h"
#include "math/rotation.h"
#include "multibody/contacts/contact_rate.h"

namespace slew::multibody {

using contact::ContactModel;
using contact::ContactPair;
using contact::ContactPoint;
using contact::RememberedContact;
using math::Mat3;
using math::Vec3;

namespace {

// a path into a thin shape is divided into parts of a quarter of its half thickness, up to this number; stiff contacts
// may require more
constexpr double kPartsPerThickness = 4;
constexpr double kMostParts = 256;
// a multiple of the part to rounding does not get one part more
constexpr double kContactRounding = 1e-9;

void place_frames(const ContactElements& elements, const Workspace& ws, std::span<contact::Pose> poses) noexcept {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ContactFrame& frame = elements.frames[i];
    const LinkMotion& link = ws.motion[at(frame.link)];
    poses[i] = {link.p + link.R * frame.p_LB, link.R * frame.R_LB};
  }
}

void note_start(const ContactElements& elements, const Workspace& ws, ContactWorkspace& contacts) noexcept {
  for (std::size_t i = 0; i < contacts.poses.size(); ++i) {
    const LinkMotion& link = ws.motion[at(elements.frames[i].link)];
    const Vec3 arm = contacts.poses[i].p_WF - link.p;
    contacts.start_poses[i] = contacts.poses[i];
    contacts.start_speeds[i] = {link.v + cross(link.w, arm), link.w};
  }
  std::fill(contacts.was_touching.begin(), contacts.was_touching.end(), static_cast<unsigned char>(0));
  for (const ContactPoint& point : contacts.set.points()) contacts.was_touching[point.pair] = 1;
}

// A contact point between the material of two frames.
struct Touch {
  const ContactElements& elements;
  const ContactWorkspace& contacts;
  const Workspace& ws;
  const ContactPoint& point;
  std::size_t a, b;  // frames

  [[nodiscard]] Vec3 velocity_of(std::size_t frame) const noexcept {
    const LinkMotion& link = ws.motion[at(elements.frames[frame].link)];
    return link.v + cross(link.w, point.p_W - link.p);
  }
  // from the frame's origin to the present material point, in the attitude of the start
  [[nodiscard]] Vec3 arm_at_start(std::size_t frame) const noexcept {
    const contact::Pose& pose = contacts.poses[frame];
    return contacts.start_poses[frame].R_WF * transpose_multiply(pose.R_WF, point.p_W - pose.p_WF);
  }
  [[nodiscard]] Vec3 way_of(std::size_t frame) const noexcept {
    return point.p_W - contacts.start_poses[frame].p_WF - arm_at_start(frame);
  }
  [[nodiscard]] Vec3 start_velocity_of(std::size_t frame) const noexcept {
    return contacts.start_speeds[frame].v_W + cross(contacts.start_speeds[frame].w_W, arm_at_start(frame));
  }
  [[nodiscard]] Vec3 velocity() const noexcept { return velocity_of(a) - velocity_of(b); }
  [[nodiscard]] Vec3 mean_velocity() const noexcept { return (way_of(a) - way_of(b)) * (1 / contacts.time); }
  // speeds at which the shapes go deeper [m/s]
  [[nodiscard]] double rate() const noexcept { return -dot(point.n_W, velocity()); }
  [[nodiscard]] double start_rate() const noexcept {
    return -dot(point.n_W, start_velocity_of(a) - start_velocity_of(b));
  }
};

// (1), (2): the contact's state, from the start of the sub-step to now; its normal force
contact::NormalForce carry(const ContactPair& pair, const Touch& touch, RememberedContact& state) noexcept {
  const ContactPoint& point = touch.point;
  const double rate = touch.rate();
  const bool is_new = state.normal.impact_speed == 0;
  if (is_new && touch.contacts.time > 0) observe(pair.normal, 0, touch.start_rate(), state.normal);
  observe(pair.normal, point.depth, rate, state.normal);
  const contact::NormalForce normal = evaluate(pair.normal, point.share, point.depth, rate, state.normal);
  if (pair.has_friction && !is_new && touch.contacts.time > 0) {
    const contact::SlidingContact sliding{point.n_W, touch.mean_velocity(), normal.force, point.share};
    state.friction.z_W = evaluate(pair.friction, sliding, touch.contacts.time, state.friction).z_W;
  }
  return normal;
}

ContactForce force_at(const ContactPair& pair, const Touch& touch, RememberedContact& state) noexcept {
  const ContactPoint& point = touch.point;
  const contact::NormalForce normal = carry(pair, touch, state);
  ContactForce out{.pair = touch.elements.pair_of_tested[point.pair],
                   .frame_a = static_cast<int>(touch.a),
                   .frame_b = static_cast<int>(touch.b),
                   .p_W = point.p_W,
                   .n_W = point.n_W,
                   .normal_W = point.n_W * normal.force,
                   .friction_W = Vec3(),
                   .depth = point.depth,
                   .depth_rate = touch.rate(),
                   .energy = stored_energy(pair.normal, point.share, point.depth)};
  if (pair.has_friction) {
    const contact::SlidingContact sliding{point.n_W, touch.velocity(), normal.force, point.share};
    out.friction_W = -evaluate(pair.friction, sliding, 0, state.friction).f_W;
    out.energy += stored_energy(pair.friction, point.share, state.friction);
  }
  return out;
}

Touch touch_of(const ContactElements& elements, const Workspace& ws, const ContactPoint& point) noexcept {
  const ContactPair& pair = elements.model.pairs()[point.pair];
  return {
      elements, *ws.contact, ws, point, elements.model.frame_of(pair.shape_a), elements.model.frame_of(pair.shape_b)};
}

void lose(const ContactElements& elements, std::size_t pair, ContactWorkspace& contacts) noexcept {
  contacts.is_lost = true;
  if (contacts.lost_pair < 0) contacts.lost_pair = elements.pair_of_tested[pair];
}

// pairs that were apart at the start and are apart now, or touch from the other side, but met between
void find_passed(const ContactElements& elements, ContactWorkspace& contacts) noexcept {
  const std::span<const ContactPoint> points = contacts.set.points();
  for (std::size_t pair = 0; pair < contacts.was_touching.size(); ++pair) {
    if (contacts.was_touching[pair] != 0) continue;
    const contact::Meeting meeting =
        sweep(elements.model, pair, contacts.start_poses, contacts.poses, contacts.set, contact::Turn::steady);
    if (meeting.kind == contact::Meeting::Kind::none) continue;
    const auto at_end =
        std::find_if(points.begin(), points.end(), [pair](const ContactPoint& point) { return point.pair == pair; });
    const bool is_seen =
        meeting.kind == contact::Meeting::Kind::found && at_end != points.end() && dot(at_end->n_W, meeting.n_W) > 0;
    if (!is_seen) return lose(elements, pair, contacts);
  }
}

// Where the start's speeds led past no shape, but forces or motions did. A pair that overlaps now from the side it came
// from is met in the next sub-step.
void look_back(const ContactElements& elements, const Workspace& ws, ContactWorkspace& contacts) noexcept {
  place_frames(elements, ws, contacts.poses);
  for (std::size_t pair = 0; pair < contacts.was_touching.size(); ++pair) {
    const contact::Meeting meeting =
        sweep(elements.model, pair, contacts.start_poses, contacts.poses, contacts.set, contact::Turn::steady);
    if (meeting.kind == contact::Meeting::Kind::none) continue;
    bool is_seen = false;
    if (meeting.kind == contact::Meeting::Kind::found) {
      const std::span<const contact::ManifoldPoint> points =
          points_at_end(elements.model, pair, meeting, contacts.poses, contacts.set);
      is_seen = !points.empty() && dot(points.front().n_W, meeting.n_W) > 0;
    }
    if (!is_seen) return lose(elements, pair, contacts);
  }
}

// poses reached with the speeds of the start within h
void look_ahead(double h, ContactWorkspace& contacts) noexcept {
  for (std::size_t i = 0; i < contacts.ahead.size(); ++i) {
    const contact::Pose& from = contacts.start_poses[i];
    const ContactWorkspace::FrameSpeed& speed = contacts.start_speeds[i];
    const Vec3 half = speed.w_W * (0.5 * h);
    const Mat3 turn = math::rotation_of(math::normalized({1, half[0], half[1], half[2]}));
    contacts.ahead[i] = {from.p_WF + speed.v_W * h, turn * from.R_WF};
  }
}

}  // namespace

ContactWorkspace::ContactWorkspace(const ContactElements& elements)
    : set(elements.model),
      before(elements.model),
      now(elements.model),
      poses(elements.frames.size()),
      start_poses(elements.frames.size()),
      ahead(elements.frames.size()),
      start_speeds(elements.frames.size()),
      was_touching(elements.model.pairs().size()),
      forces(elements.model.pairs().size() * contact::kMaxPointsPerPair) {
  int last = 0;
  for (const ContactFrame& frame : elements.frames) last = std::max(last, frame.link);
  rates.resize(at(last) + 1);
}

void begin_contacts(const Model& model, const State& state, Workspace& ws) noexcept {
  if (model.contact == nullptr) return;
  ws.contact->time = 0;
  ws.contact->is_near = true;
  ws.contact->before.assign(state.contacts);
}

void update_contacts(const Model& model, Workspace& ws) noexcept {
  if (model.contact == nullptr) return;
  const ContactElements& elements = *model.contact;
  ContactWorkspace& contacts = *ws.contact;
  contacts.force_count = 0;
  if (!contacts.is_near) return;
  place_frames(elements, ws, contacts.poses);
  find_contacts(elements.model, contacts.poses, contacts.set);
  if (contacts.time == 0) note_start(elements, ws, contacts);
  const std::span<const ContactPoint> points = contacts.set.points();
  contacts.force_count = points.size();
  if (points.empty()) return;
  contacts.now.advance(contacts.before, elements.model, contacts.poses, contacts.set);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContactPair& pair = elements.model.pairs()[points[i].pair];
    contacts.forces[i] = force_at(pair, touch_of(elements, ws, points[i]), contacts.now.states()[i]);
  }
}

void apply_contacts(const Model& model, Workspace& ws) noexcept {
  if (model.contact == nullptr) return;
  const auto push = [&](int frame, Vec3 point, Vec3 force) {
    const int link = model.contact->frames[at(frame)].link;
    ArticulatedInertia& body = ws.inertia[at(link)];
    body.f -= force;
    body.n -= cross(point - ws.motion[at(link)].p, force);
  };
  for (std::size_t i = 0; i < ws.contact->force_count; ++i) {
    const ContactForce& force = ws.contact->forces[i];
    const Vec3 F = force.normal_W + force.friction_W;
    push(force.frame_a, force.p_W, F);
    push(force.frame_b, force.p_W, -F);
  }
}

ContactSlopes slopes_of_contact(const Model& model, const Workspace& ws, std::size_t index,
                                ChangeWeights weights) noexcept {
  const ContactElements& elements = *model.contact;
  const ContactPoint& point = ws.contact->set.points()[index];
  const ContactPair& pair = elements.model.pairs()[point.pair];
  const RememberedContact& state = ws.contact->now.states()[index];
  const Touch touch = touch_of(elements, ws, point);
  const contact::NormalForce normal = evaluate(pair.normal, point.share, point.depth, touch.rate(), state.normal);
  ContactSlopes slopes{.link_a = elements.frames[touch.a].link,
                       .link_b = elements.frames[touch.b].link,
                       .n_W = point.n_W,
                       .along = weights.position * normal.d_depth + weights.rate * normal.d_depth_rate,
                       .of_share = weights.position * normal.force / point.depth,
                       .tangential = Mat3()};
  if (!pair.has_friction) return slopes;
  contact::SlidingContact sliding{point.n_W, touch.velocity(), normal.force, point.share};
  slopes.tangential = evaluate(pair.friction, sliding, 0, state.friction).d_velocity * weights.rate;
  // bristles bend with the mean velocity since the start
  const double time = ws.contact->time;
  if (!(time > 0)) return slopes;
  sliding.v_W = touch.mean_velocity();
  const Mat3 bending = evaluate(pair.friction, sliding, time, state.friction).d_velocity -
                       evaluate(pair.friction, sliding, 0, state.friction).d_velocity;
  slopes.tangential += bending * (weights.position / time);
  return slopes;
}

void accept_contacts(const Model& model, double h, State& state, Workspace& ws) noexcept {
  if (model.contact == nullptr) return;
  const ContactElements& elements = *model.contact;
  ContactWorkspace& contacts = *ws.contact;
  if (!contacts.is_near) return look_back(elements, ws, contacts);
  contacts.time = h;
  place_frames(elements, ws, contacts.poses);
  find_contacts(elements.model, contacts.poses, contacts.set);
  find_passed(elements, contacts);
  state.contacts.advance(contacts.before, elements.model, contacts.poses, contacts.set);
  const std::span<const ContactPoint> points = contacts.set.points();
  contacts.is_hit = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContactPair& pair = elements.model.pairs()[points[i].pair];
    const Touch touch = touch_of(elements, ws, points[i]);
    RememberedContact& remembered = state.contacts.states()[i];
    const double start_rate = remembered.normal.impact_speed == 0 ? touch.start_rate() : 0;
    contacts.is_hit = contacts.is_hit || std::max(touch.rate(), start_rate) > pair.normal.smallest_impact_speed;
    static_cast<void>(carry(pair, touch, remembered));
  }
}

namespace {

// Number of parts that an explicit rule requires, with impacts met at this rate.
double explicit_parts(const Model& model, double h, double met_rate, ContactStep step, Workspace& ws) noexcept {
  return h *
         std::max(contact_rate(model, ws) / (met_rate > 0 ? step.reach : step.reach_at_rest), met_rate / step.reach);
}

// number of parts that fast contacts require, from the number sufficient otherwise
ContactParts stiff_parts(const Model& model, double parts, double needed, StepKind kind, Workspace& ws) noexcept {
  if (kind == StepKind::settling && needed > kWorthSettling * parts && !has_impact(model, ws)) {
    const int count = static_cast<int>(std::ceil(parts));
    return {count, true, static_cast<int>(std::ceil(std::min(needed, kMostStiffParts) / count))};
  }
  ws.contact->is_lost = ws.contact->is_lost || !(needed <= kMostStiffParts);
  return {.count = static_cast<int>(std::ceil(std::max(parts, std::min(needed, kMostStiffParts))))};
}

// Number of parts that an implicit rule, or the trapezoid of `augmented`, requires for the rebound of impacts, present
// and met with this rate of their springs; 0: none.
double parts_of_blow(const Model& model, double h, double met_rate, StepKind kind, Workspace& ws) noexcept {
  const bool is_hit = has_impact(model, ws, RateOf::springs);
  const double rate = std::max(met_rate, is_hit ? contact_rate(model, ws, RateOf::springs) : 0.0);
  const double needed = h * rate / kReachOfBlow;
  const double lost = kind == StepKind::corrected ? kLostBlowOfCorrections : kLostBlow;
  ws.contact->is_lost = ws.contact->is_lost || !(needed * kReachOfBlow <= kMostStiffParts * lost);
  return std::min(needed, kMostStiffParts);
}

RateOf chosen_rate(StepKind kind) noexcept {
  return kind == StepKind::implicit ? RateOf::springs : RateOf::all;
}

// Whether a point at the end of the path is not one of the present points, which stay with a shape or roll along with
// it.
bool is_new_point(const ContactPair& pair, const ContactModel& model, const ContactWorkspace& contacts, std::size_t of,
                  Vec3 p_W) noexcept {
  const double nearest2 = pair.match_distance * pair.match_distance;
  for (const ContactPoint& point : contacts.set.points()) {
    if (point.pair != of) continue;
    for (const std::size_t shape : {pair.shape_a, pair.shape_b}) {
      const std::size_t frame = model.frame_of(shape);
      const contact::Pose &from = contacts.start_poses[frame], &to = contacts.ahead[frame];
      const Vec3 arm = point.p_W - from.p_WF, arm_to = p_W - to.p_WF;
      const Vec3 in_shape = transpose_multiply(to.R_WF, arm_to) - transpose_multiply(from.R_WF, arm);
      if (std::min(dot(in_shape, in_shape), dot(arm_to - arm, arm_to - arm)) < nearest2) return false;
    }
  }
  return true;
}

// Rate of the impacts of further corners of a touching pair at the end of the path.
double rate_of_new_points(const Model& model, double h, std::size_t pair, const contact::Meeting& meeting,
                          RateOf chosen, Workspace& ws) noexcept {
  const ContactModel& contact_model = model.contact->model;
  const ContactPair& shapes = contact_model.pairs()[pair];
  ContactWorkspace& contacts = *ws.contact;
  double rate = 0;
  for (const auto& point : points_at_end(contact_model, pair, meeting, contacts.ahead, contacts.set)) {
    if (!is_new_point(shapes, contact_model, contacts, pair, point.p_W)) continue;
    const contact::Meeting corner{
        .kind = contact::Meeting::Kind::found, .n_W = point.n_W, .p_W = point.p_W, .share = 1, .travel = 0};
    if (approach_speed(model, ws, pair, corner) <= shapes.normal.smallest_impact_speed) continue;
    rate = std::max(rate, impact_rate(model, ws, pair, corner, h, chosen));
  }
  return rate;
}

// Whether any common point of two shapes that touch at this one may move faster against the other than the smallest
// impact speed.
bool may_land(const ContactPair& pair, const Touch& touch) noexcept {
  const Vec3 spin = touch.ws.motion[at(touch.elements.frames[touch.a].link)].w -
                    touch.ws.motion[at(touch.elements.frames[touch.b].link)].w;
  const double across = 2 * pair.match_distance / contact::kMatchShare;
  return norm(touch.velocity()) + norm(spin) * across > pair.normal.smallest_impact_speed;
}

// A path twice as long as at the present speed has no corner missed that gains less than its own speed on the way.
constexpr double kAheadOfLanding = 2;

// The same for all touching pairs within the next h.
double rate_of_landings(const Model& model, double h, StepKind kind, Workspace& ws) noexcept {
  const ContactElements& elements = *model.contact;
  ContactWorkspace& contacts = *ws.contact;
  look_ahead(kAheadOfLanding * h, contacts);
  double rate = 0;
  std::size_t seen = contacts.was_touching.size();
  for (const ContactPoint& point : contacts.set.points()) {
    if (point.pair == seen || !may_land(elements.model.pairs()[point.pair], touch_of(elements, ws, point))) continue;
    seen = point.pair;
    rate = std::max(rate, rate_of_new_points(model, h, seen, {}, chosen_rate(kind), ws));
  }
  return rate;
}

}  // namespace

ContactParts contact_parts(const Model& model, double h, ContactStep step, Workspace& ws) noexcept {
  if (model.contact == nullptr) return {};
  const ContactElements& elements = *model.contact;
  ContactWorkspace& contacts = *ws.contact;
  look_ahead(h, contacts);
  contacts.is_near = !contacts.before.states().empty() || !contacts.set.points().empty();
  // parts that are short against the thickness on their path
  double parts = std::ceil(h / elements.substep * (1 - kContactRounding)), met_rate = 0, met_springs = 0;
  for (std::size_t pair = 0; pair < contacts.was_touching.size(); ++pair) {
    const contact::Meeting meeting = sweep(elements.model, pair, contacts.start_poses, contacts.ahead, contacts.set);
    if (meeting.kind == contact::Meeting::Kind::none) continue;
    contacts.is_near = true;
    parts = std::max(parts, kPartsPerThickness * meeting.travel / elements.model.pairs()[pair].half_thickness);
    if (meeting.kind != contact::Meeting::Kind::found) continue;
    const auto rate_of_meeting = [&](RateOf chosen) {
      return contacts.was_touching[pair] == 0 ? impact_rate(model, ws, pair, meeting, h, chosen)
                                              : rate_of_new_points(model, h, pair, meeting, chosen, ws);
    };
    met_rate = std::max(met_rate, rate_of_meeting(chosen_rate(step.kind)));
    if (step.kind == StepKind::corrected) met_springs = std::max(met_springs, rate_of_meeting(RateOf::springs));
  }
  if (!contacts.is_near) return {};
  parts = std::clamp(parts, 1.0, kMostParts);
  if (step.kind == StepKind::implicit) {
    return {.count = static_cast<int>(std::ceil(std::max(parts, parts_of_blow(model, h, met_rate, step.kind, ws))))};
  }
  if (step.kind == StepKind::corrected) parts = std::max(parts, parts_of_blow(model, h, met_springs, step.kind, ws));
  // resolve an imminent impact
  if (met_rate > 0 && step.kind == StepKind::settling) step.kind = StepKind::explicit_rule;
  return stiff_parts(model, parts, explicit_parts(model, h, met_rate, step, ws), step.kind, ws);
}

ContactParts contact_parts_again(const Model& model, double h, int parts, ContactStep step, Workspace& ws) noexcept {
  const double met_rate = rate_of_landings(model, h / parts, step.kind, ws);
  if (step.kind == StepKind::implicit) {
    const double finer = parts_of_blow(model, h, met_rate, step.kind, ws) / parts * (1 - kContactRounding);
    return {.count = static_cast<int>(std::ceil(std::max(1.0, finer)))};
  }
  const double needed = explicit_parts(model, h, met_rate, step, ws);
  const bool may_settle = step.kind == StepKind::settling && met_rate == 0;
  if (may_settle && needed > kWorthSettling * parts && !has_impact(model, ws)) {
    return {.is_settling = true};
  }
  ws.contact->is_lost = ws.contact->is_lost || !(needed <= kMostStiffParts);
  double most = std::min(needed, kMostStiffParts);
  if (step.kind == StepKind::corrected) {
    const double met_springs = rate_of_landings(model, h / parts, StepKind::implicit, ws);
    most = std::max(most, parts_of_blow(model, h, met_springs, step.kind, ws));
  }
  const double finer = std::max(1.0, most / parts * (1 - kContactRounding));
  return {.count = static_cast<int>(std::ceil(finer))};
}

}  // namespace slew::multibody
