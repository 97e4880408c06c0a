// SPDX-License-Identifier: Apache-2.0
#include "sensors/sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/state_hash.h"
#include "math/rotation.h"
#include "sensors/fcl_border.h"
#include "sensors/shape_search.h"

namespace slew::sensors {

using fcl_border::QueryResult;
using math::Vec3;

namespace {

constexpr double kReached = 1e-4;  // m, distance at which a continuous search has found a hit

// Motion of a frame over an interval: a straight line, and a turn about a fixed axis by less than half a turn.
struct Path {
  FrameMotion start;
  Vec3 displacement;  // m
  Vec3 turn;          // rad, start's axes
  double angle = 0;

  Path(const FrameMotion& from, const FrameMotion& to) : start(from), displacement(to.p_W - from.p_W) {
    const math::Quaternion q = math::quaternion_of(transpose(from.R_W) * to.R_W);
    const Vec3 v(q.x, q.y, q.z);
    const double sine = norm(v);
    angle = 2 * std::atan2(sine, q.w);
    if (sine > 0) turn = v * (angle / sine);
  }

  // Pose at this share of the interval, with the velocities of its start.
  [[nodiscard]] FrameMotion at(double tau) const {
    return {start.p_W + displacement * tau, start.R_W * rotation_of(math::turn_by(turn * tau)), start.v_W, start.w_W};
  }
  // The same with the mean velocities of the interval, which lasts so long [s].
  [[nodiscard]] FrameMotion mean_at(double tau, double interval) const {
    FrameMotion motion = at(tau);
    motion.v_W = displacement * (1 / interval);
    motion.w_W = start.R_W * turn * (1 / interval);
    return motion;
  }
};

// Visits the fields of a saved state for their hash.
struct Hasher {
  static constexpr bool kIsReading = false;
  StateHash hash;

  template <StateNumber T>
  void number(const T& value) noexcept {
    hash.add(value);
  }
  void flag(bool value) noexcept { hash.add(static_cast<std::uint64_t>(value)); }
  template <std::integral T>
  void count(const T& value, T) noexcept {
    hash.add(value);
  }
};

}  // namespace

Sensors::Sensors(const SensorsDef& def) : interval_(def.interval), search_(std::make_unique<Search>(def)) {
  for (const SensorDef& sensor_def : def.sensors) {
    Sensor sensor{sensor_def, {}, 0};
    const auto add_group = [&](const std::vector<std::string>& names) {
      sensor.groups.push_back(search_->add_group(shapes_of(def, names)));
    };
    switch (sensor_def.type) {
      case SensorType::clearance:
      case SensorType::collision:
        add_group(sensor_def.of);
        add_group(sensor_def.to);
        break;
      case SensorType::zone:
        add_group({sensor_def.zone});
        for (const std::string& name : sensor_def.watch) add_group({name});
        break;
    }
    switch (sensor_def.type) {
      case SensorType::clearance:
        sensor.first = clearances_.size();
        clearances_.emplace_back();
        break;
      case SensorType::collision:
        sensor.first = collisions_.size();
        collisions_.emplace_back();
        break;
      case SensorType::zone:
        sensor.first = watched_.size();
        watched_.resize(watched_.size() + sensor_def.watch.size());
        break;
    }
    list_variables(sensor);
    sensors_.push_back(std::move(sensor));
  }
  last_.resize(def.frames.size());
}

Sensors::~Sensors() = default;

// ---- samples --------------------------------------------------------------------------------------------------

bool Sensors::observe(std::span<const FrameMotion> frames) {
  events_.clear();
  for (std::size_t group = 0; group < search_->group_shapes.size(); ++group) {
    search_->place(group, [&](std::size_t frame) { return frames[frame]; });
  }
  bool is_fine = true;
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    bool has_values = false;
    switch (sensors_[i].def.type) {
      case SensorType::clearance:
        has_values = observe_clearance(i, frames);
        break;
      case SensorType::zone:
        has_values = observe_zone(i);
        break;
      case SensorType::collision:
        has_values = observe_collision(i, frames);
        break;
    }
    if (!has_values && is_fine) failed_ = i;
    is_fine = is_fine && has_values;
  }
  std::copy(frames.begin(), frames.end(), last_.begin());
  has_last_ = true;
  return is_fine;
}

bool Sensors::observe_clearance(std::size_t index, std::span<const FrameMotion> frames) {
  const Sensor& sensor = sensors_[index];
  Clearance& clearance = clearances_[sensor.first];
  Search::Nearest nearest;
  if (!search_->find_nearest(sensor.groups[0], sensor.groups[1], nearest)) return false;
  const auto motion_of = [&](std::size_t frame) { return frames[frame]; };
  clearance.distance = nearest.distance;
  clearance.closing_speed = nearest.distance > 0 ? nearest.closing_speed(motion_of) : 0;
  clearance.p_of_W = nearest.p_a_W;
  clearance.p_to_W = nearest.p_b_W;
  const double border = sensor.def.limit + (clearance.is_close ? sensor.def.hysteresis : 0);
  const bool is_close = clearance.is_close ? nearest.distance <= border : nearest.distance < border;
  if (is_close != clearance.is_close) {
    events_.push_back({index, 0, is_close ? EventKind::close : EventKind::clear, nearest.distance, {}});
  }
  clearance.is_close = is_close;
  return true;
}

bool Sensors::observe_zone(std::size_t index) {
  const Sensor& sensor = sensors_[index];
  bool is_fine = true;
  for (std::size_t k = 0; k < sensor.def.watch.size(); ++k) {
    Watched& watched = watched_[sensor.first + k];
    bool is_inside = false;
    if (fcl_border::find_overlap(*search_->groups, sensor.groups[0], sensor.groups[k + 1], is_inside) !=
        QueryResult::fine) {
      is_fine = false;
      continue;
    }
    const double before = time_of(watched.samples), now = time_of(watched.samples + 1);
    watched.samples = is_inside && watched.is_inside ? watched.samples + 1 : 0;
    if (is_inside != watched.is_inside) {
      events_.push_back({index, k, is_inside ? EventKind::enter : EventKind::leave, is_inside ? 0 : now, {}});
    } else if (is_inside && sensor.def.stay > 0 && before < sensor.def.stay && now >= sensor.def.stay) {
      events_.push_back({index, k, EventKind::stay, now, {}});
    }
    watched.is_inside = is_inside;
  }
  return is_fine;
}

void Sensors::add_hit(std::size_t index, Collision& collision, double speed, Vec3 place_W, double before) {
  ++collision.hits;
  collision.samples = 0;
  collision.hit_before = before;
  collision.speed = speed;
  collision.place_W = place_W;
  events_.push_back({index, 0, EventKind::hit, speed, place_W, before});
}

bool Sensors::observe_collision(std::size_t index, std::span<const FrameMotion> frames) {
  const Sensor& sensor = sensors_[index];
  Collision& collision = collisions_[sensor.first];
  Search::Nearest nearest;
  if (!search_->find_nearest(sensor.groups[0], sensor.groups[1], nearest)) return false;
  const bool is_touching = nearest.distance <= (sensor.def.is_continuous ? kReached : 0);
  // shapes that overlap have many contacts: the first one since the sample before has the speed and the place of a hit
  bool has_hit = false, is_fine = true;
  if ((sensor.def.is_continuous || is_touching) && has_last_ && !collision.is_touching) {
    is_fine = search_motion(index, frames, has_hit);
  }
  // they overlap at the start, where no motion is known, or the motion could not be searched
  if (is_touching && !collision.is_touching && !has_hit) {
    const auto before = [&](std::size_t frame) { return last_[frame]; };
    const double speed = has_last_ ? std::max(nearest.closing_speed(before), 0.0) : 0;
    add_hit(index, collision, speed, 0.5 * (nearest.p_a_W + nearest.p_b_W), 0);
    has_hit = true;
  }
  if (!has_hit) ++collision.samples;
  if (!is_touching && (collision.is_touching || has_hit)) {
    events_.push_back({index, 0, EventKind::apart, collision.hit_before + time_of(collision.samples), {}});
  }
  if (!is_touching) collision.samples = 0;
  collision.is_touching = is_touching;
  return is_fine;
}

// Conservative advancement over the interval before this sample. False: a search failed, or a body turns by half a turn
// or more, which poses do not show.
bool Sensors::search_motion(std::size_t index, std::span<const FrameMotion> frames, bool& has_hit) {
  const Sensor& sensor = sensors_[index];
  const std::size_t a = sensor.groups[0], b = sensor.groups[1];
  std::vector<Path> paths;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) paths.emplace_back(last_[frame], frames[frame]);
  for (const std::size_t group : {a, b}) {
    for (const std::size_t i : search_->group_shapes[group]) {
      const std::size_t frame = search_->shapes[i].frame;
      const double rate = std::max(norm(last_[frame].w_W), norm(frames[frame].w_W));
      if (rate * interval_ >= M_PI) return false;
    }
  }
  // (3)
  double mu = 0;
  for (const std::size_t i : search_->group_shapes[a]) {
    for (const std::size_t j : search_->group_shapes[b]) {
      const Search::Shape &x = search_->shapes[i], &y = search_->shapes[j];
      if (x.frame == y.frame) continue;
      const auto turned = [&](const Search::Shape& s) {
        return paths[s.frame].angle > 0 ? paths[s.frame].angle * s.extent : 0.0;
      };
      mu = std::max(mu, norm(paths[x.frame].displacement - paths[y.frame].displacement) + turned(x) + turned(y));
    }
  }
  bool is_fine = true;
  double tau = 0;
  while (mu > 0 && tau < 1 && !has_hit) {
    const auto at_tau = [&](std::size_t frame) { return paths[frame].at(tau); };
    search_->place(a, at_tau);
    search_->place(b, at_tau);
    Search::Nearest nearest;
    is_fine = search_->find_nearest(a, b, nearest);
    if (!is_fine) break;
    if (nearest.distance <= kReached) {
      // (4)
      const auto mean = [&](std::size_t frame) { return paths[frame].mean_at(tau, interval_); };
      const double speed = std::max({nearest.closing_speed(at_tau), nearest.closing_speed(mean), 0.0});
      add_hit(index, collisions_[sensor.first], speed, 0.5 * (nearest.p_a_W + nearest.p_b_W), (1 - tau) * interval_);
      has_hit = true;
    }
    // not to the contact itself, where the shapes have no direction from one to the other
    tau += (nearest.distance - 0.5 * kReached) / mu;
  }
  // the groups stand at the sample again, for the next query
  for (const std::size_t group : {a, b}) {
    search_->place(group, [&](std::size_t frame) { return frames[frame]; });
  }
  return is_fine;
}

// ---- variables, texts, state ----------------------------------------------------------------------------------

void Sensors::list_variables(const Sensor& sensor) {
  const std::string& name = sensor.def.name;
  const auto add = [&](const std::string& quantity, Dimension dimension) {
    variables_.push_back({name + "." + quantity, dimension, false});
  };
  const auto add_point = [&](const std::string& quantity) {
    for (const char axis : {'x', 'y', 'z'}) add(fmt::format("{}.{}", quantity, axis), Dimension::length);
  };
  switch (sensor.def.type) {
    case SensorType::clearance:
      add("distance", Dimension::length);
      add("closing_speed", Dimension::velocity);
      add_point("point_of");
      add_point("point_to");
      if (sensor.def.limit > 0) add("close", Dimension::none);
      break;
    case SensorType::zone:
      add("inside", Dimension::none);
      for (const std::string& watched : sensor.def.watch) {
        add(watched + ".inside", Dimension::none);
        add(watched + ".time", Dimension::time);
      }
      break;
    case SensorType::collision:
      add("touching", Dimension::none);
      add("hits", Dimension::none);
      add("speed", Dimension::velocity);
      add_point("place");
      break;
  }
}

void Sensors::read_variables(std::span<double> values) const noexcept {
  std::size_t at = 0;
  const auto put = [&](double value) { values[at++] = value; };
  const auto put_point = [&](Vec3 point) {
    for (const double x : point.array()) put(x);
  };
  for (const Sensor& sensor : sensors_) {
    switch (sensor.def.type) {
      case SensorType::clearance: {
        const Clearance& clearance = clearances_[sensor.first];
        put(clearance.distance);
        put(clearance.closing_speed);
        put_point(clearance.p_of_W);
        put_point(clearance.p_to_W);
        if (sensor.def.limit > 0) put(clearance.is_close ? 1 : 0);
        break;
      }
      case SensorType::zone: {
        const std::span<const Watched> watched = std::span(watched_).subspan(sensor.first, sensor.def.watch.size());
        put(static_cast<double>(
            std::count_if(watched.begin(), watched.end(), [](const Watched& w) { return w.is_inside; })));
        for (const Watched& one : watched) {
          put(one.is_inside ? 1 : 0);
          put(time_of(one.samples));
        }
        break;
      }
      case SensorType::collision: {
        const Collision& collision = collisions_[sensor.first];
        put(collision.is_touching ? 1 : 0);
        put(static_cast<double>(collision.hits));
        put(collision.speed);
        put_point(collision.place_W);
        break;
      }
    }
  }
}

std::string event_text(const SensorDef& def, const Event& event) {
  const auto watched = [&] { return event.watched < def.watch.size() ? def.watch[event.watched] : std::string("?"); };
  switch (event.kind) {
    case EventKind::close:
      return fmt::format("{}: {:.3g} m, below the limit of {:.3g} m", def.name, event.value, def.limit);
    case EventKind::clear:
      return fmt::format("{}: {:.3g} m, clear again", def.name, event.value);
    case EventKind::enter:
      return fmt::format("{}: {} entered", def.name, watched());
    case EventKind::leave:
      return fmt::format("{}: {} left after {:.3g} s", def.name, watched(), event.value);
    case EventKind::stay:
      return fmt::format("{}: {} has stayed for {:.3g} s", def.name, watched(), event.value);
    case EventKind::hit:
      return fmt::format("{}: hit at {:.3g} m/s, {:.3g} ms before the step, at {:.3f} {:.3f} {:.3f} m", def.name,
                         event.value, 1000 * event.before, event.place_W[0], event.place_W[1], event.place_W[2]);
    case EventKind::apart:
      return fmt::format("{}: apart after {:.3g} s", def.name, event.value);
  }
  return def.name;
}

void Sensors::reset() noexcept {
  std::fill(clearances_.begin(), clearances_.end(), Clearance{});
  std::fill(watched_.begin(), watched_.end(), Watched{});
  std::fill(collisions_.begin(), collisions_.end(), Collision{});
  std::fill(last_.begin(), last_.end(), FrameMotion{});
  has_last_ = false;
  events_.clear();
}

template <typename Bytes, typename Self>
void Sensors::visit(Bytes& bytes, Self& self) {
  for (auto& clearance : self.clearances_) {
    bytes.number(clearance.distance);
    bytes.number(clearance.closing_speed);
    visit_vector(bytes, clearance.p_of_W);
    visit_vector(bytes, clearance.p_to_W);
    bytes.flag(clearance.is_close);
  }
  for (auto& watched : self.watched_) {
    bytes.flag(watched.is_inside);
    bytes.count(watched.samples, kLastStep);
  }
  for (auto& collision : self.collisions_) {
    bytes.flag(collision.is_touching);
    bytes.count(collision.samples, kLastStep);
    bytes.number(collision.hit_before);
    bytes.count(collision.hits, kLastStep);
    bytes.number(collision.speed);
    visit_vector(bytes, collision.place_W);
  }
  for (auto& motion : self.last_) {
    visit_vector(bytes, motion.p_W);
    for (int column = 0; column < 3; ++column) visit_vector(bytes, motion.R_W.c[column]);
    visit_vector(bytes, motion.v_W);
    visit_vector(bytes, motion.w_W);
  }
  bytes.flag(self.has_last_);
}

void Sensors::save(StateWriter& bytes) const {
  visit(bytes, *this);
}

void Sensors::load(StateReader& bytes) noexcept {
  events_.clear();
  visit(bytes, *this);
}

std::uint64_t Sensors::state_hash() const noexcept {
  Hasher hasher;
  visit(hasher, *this);
  return hasher.hash.digest();
}

}  // namespace slew::sensors
