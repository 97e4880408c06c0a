// SPDX-License-Identifier: Apache-2.0
#include "sensors/sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/find_named.h"
#include "contact/mesh_check.h"
#include "contact/solid.h"
#include "core/state_hash.h"
#include "math/rotation.h"
#include "sensors/fcl_border.h"

namespace slew::sensors {

using contact::ShapeDef;
using contact::ShapeType;
using fcl_border::QueryResult;
using math::Mat3;
using math::Vec3;

namespace {

constexpr double kReached = 1e-4;  // m, distance at which a continuous search has found a hit

bool is_zone(const SensorsDef& def, const std::string& shape) {
  return std::any_of(def.sensors.begin(), def.sensors.end(), [&](const SensorDef& s) { return s.zone == shape; });
}

// Indices of the shapes that a list names; in the list's order, each once. A zone is no part of its body: it counts
// under its own name only.
std::vector<std::size_t> shapes_of(const SensorsDef& def, const std::vector<std::string>& names) {
  std::vector<std::size_t> found;
  for (const std::string& name : names) {
    for (std::size_t i = 0; i < def.shapes.size(); ++i) {
      const ShapeDef& shape = def.shapes[i];
      if (shape.name != name && (shape.frame != name || is_zone(def, shape.name))) continue;
      if (std::find(found.begin(), found.end(), i) == found.end()) found.push_back(i);
    }
  }
  return found;
}

std::size_t frame_index(const SensorsDef& def, const std::string& name) {
  return static_cast<std::size_t>(contact::find_named(def.frames, name) - def.frames.data());
}

class Validator {
 public:
  Validator(const SensorsDef& def, Problems& problems) : def_(def), problems_(problems) {}

  void check(const SensorDef& sensor) {
    if (sensor.type == SensorType::zone) {
      check_zone(sensor);
    } else {
      check_groups(sensor, "to", group(sensor, "of", sensor.of), group(sensor, "to", sensor.to));
    }
  }

 private:
  void add(const SensorDef& sensor, const char* key, std::string what, std::string expected) {
    problems_.push_back({sensor.name + "." + key, std::move(what), std::move(expected), {}});
  }

  std::vector<std::size_t> group(const SensorDef& sensor, const char* key, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      if (shapes_of(def_, {name}).empty()) {
        add(sensor, key, fmt::format("'{}' has no shape", name), "a shape, or a body with a shape that is no zone");
      }
    }
    if (names.empty()) add(sensor, key, "the list is empty", "names of shapes or bodies");
    std::vector<std::size_t> shapes = shapes_of(def_, names);
    for (const std::size_t i : shapes) {
      const ShapeDef& shape = def_.shapes[i];
      const contact::FrameDef* frame = contact::find_named(def_.frames, shape.frame);
      if (shape.type == ShapeType::plane && frame != nullptr && !frame->is_static) {
        add(sensor, key, fmt::format("the plane '{}' is fixed to '{}', which moves", shape.name, shape.frame),
            "a plane on Ground, or a box");
      }
    }
    return shapes;
  }

  // At least one pair of shapes of two frames, and no two planes.
  void check_groups(const SensorDef& sensor, const char* key, const std::vector<std::size_t>& a,
                    const std::vector<std::size_t>& b) {
    if (a.empty() || b.empty()) return;
    bool has_pair = false;
    for (const std::size_t i : a) {
      for (const std::size_t j : b) {
        const ShapeDef &x = def_.shapes[i], &y = def_.shapes[j];
        if (x.frame == y.frame) continue;
        has_pair = true;
        if (x.type == ShapeType::plane && y.type == ShapeType::plane) {
          return add(sensor, key, fmt::format("'{}' and '{}' are both planes", x.name, y.name),
                     "a plane in one group only");
        }
      }
    }
    if (!has_pair) add(sensor, key, "no shape can move relative to one of the other group", "shapes of two bodies");
  }

  void check_zone(const SensorDef& sensor) {
    const ShapeDef* zone = contact::find_named(def_.shapes, sensor.zone);
    if (zone == nullptr) {
      add(sensor, "zone", fmt::format("there is no shape '{}'", sensor.zone), "the name of a shape");
    } else if (zone->type == ShapeType::triangle_mesh || zone->type == ShapeType::height_field) {
      add(sensor, "zone", fmt::format("'{}' is a surface of triangles and has no inside", sensor.zone),
          "a sphere, box, cylinder, capsule, plane or convex mesh");
    }
    std::vector<std::string> seen;
    for (const std::string& name : sensor.watch) {
      if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
        add(sensor, "watch", fmt::format("'{}' is named twice", name), "each name once");
      }
      seen.push_back(name);
    }
    group(sensor, "watch", sensor.watch);
    if (zone == nullptr) return;
    for (const std::string& name : sensor.watch) {
      check_groups(sensor, "watch", shapes_of(def_, {sensor.zone}), shapes_of(def_, {name}));
    }
  }

  const SensorsDef& def_;
  Problems& problems_;
};

std::size_t add_shape(fcl_border::Geometries& geometries, const ShapeDef& def, const contact::Geometry& geometry) {
  std::vector<double> vertices;
  for (const Vec3& v : geometry.vertices) vertices.insert(vertices.end(), {v[0], v[1], v[2]});
  const std::uint32_t* triangles = geometry.triangles.empty() ? nullptr : geometry.triangles.front().data();
  switch (def.type) {
    case ShapeType::sphere:
      return add_sphere(geometries, def.radius);
    case ShapeType::box:
      return add_box(geometries, def.size[0], def.size[1], def.size[2]);
    case ShapeType::cylinder:
      return add_cylinder(geometries, def.radius, def.length);
    case ShapeType::capsule:
      return add_capsule(geometries, def.radius, def.length);
    case ShapeType::plane:
      return add_plane(geometries);
    case ShapeType::convex_mesh:
      return add_convex(geometries, vertices.data(), geometry.vertices.size(), triangles, geometry.triangles.size());
    case ShapeType::triangle_mesh:
    case ShapeType::height_field:
      break;
  }
  return add_surface(geometries, vertices.data(), geometry.vertices.size(), triangles, geometry.triangles.size());
}

// Motion of a frame over an interval: a straight line, and a turn about a fixed axis by less than half a turn.
struct Path {
  FrameMotion start;
  Vec3 way;   // m
  Vec3 turn;  // rad, start's axes
  double angle = 0;

  Path(const FrameMotion& from, const FrameMotion& to) : start(from), way(to.p_W - from.p_W) {
    const math::Quaternion q = math::quaternion_of(transpose(from.R_W) * to.R_W);
    const Vec3 v(q.x, q.y, q.z);
    const double sine = norm(v);
    angle = 2 * std::atan2(sine, q.w);
    if (sine > 0) turn = v * (angle / sine);
  }

  // Pose at this share of the interval, with the velocities of its start.
  [[nodiscard]] FrameMotion at(double tau) const {
    return {start.p_W + way * tau, start.R_W * rotation_of(math::turn_by(turn * tau)), start.v_W, start.w_W};
  }
  // The same with the mean velocities of the interval, which lasts so long [s].
  [[nodiscard]] FrameMotion mean_at(double tau, double interval) const {
    FrameMotion motion = at(tau);
    motion.v_W = way * (1 / interval);
    motion.w_W = start.R_W * turn * (1 / interval);
    return motion;
  }
};

Vec3 velocity_of(const FrameMotion& frame, Vec3 point_W) {
  return frame.v_W + cross(frame.w_W, point_W - frame.p_W);
}

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

Vec3 vector(const double* x) {
  return {x[0], x[1], x[2]};
}

}  // namespace

void validate(const SensorsDef& def, Problems& problems) {
  Validator validator(def, problems);
  for (const SensorDef& sensor : def.sensors) validator.check(sensor);
}

struct Sensors::Search {
  struct Shape {
    std::size_t geometry = 0, frame = 0;
    Vec3 p_FS;
    Mat3 R_FS;
    double extent = 0;  // m, of the farthest point from the frame's origin
  };
  struct Nearest {
    double distance = 0;
    Vec3 p_a_W, p_b_W, n_W;
    std::size_t frame_a = 0, frame_b = 0;

    // m/s, (2); motion_of: motion of a frame
    template <typename MotionOf>
    [[nodiscard]] double closing_speed(const MotionOf& motion_of) const {
      return -dot(velocity_of(motion_of(frame_a), p_a_W) - velocity_of(motion_of(frame_b), p_b_W), n_W);
    }
  };

  explicit Search(const SensorsDef& def)
      : geometries(fcl_border::create_geometries(), &free_geometries), groups(nullptr, &free_groups) {
    for (const ShapeDef& shape : def.shapes) {
      const contact::Geometry geometry = contact::make_geometry(shape);
      const Vec3 p_FS(shape.position);
      const Mat3 R_FS = math::rotation_zxz(shape.orientation);
      shapes.push_back({add_shape(*geometries, shape, geometry), frame_index(def, shape.frame), p_FS, R_FS,
                        norm(p_FS + R_FS * geometry.centre) + geometry.bounding_radius});
    }
    groups.reset(fcl_border::create_groups(*geometries));
  }

  std::size_t add_group(const std::vector<std::size_t>& members) {
    std::vector<std::size_t> indices, frames;
    for (const std::size_t i : members) indices.push_back(shapes[i].geometry), frames.push_back(shapes[i].frame);
    group_shapes.push_back(members);
    return fcl_border::add_group(*groups, indices.data(), frames.data(), indices.size());
  }

  template <typename MotionOf>
  void place(std::size_t group, const MotionOf& motion_of) {
    for (std::size_t k = 0; k < group_shapes[group].size(); ++k) {
      const Shape& shape = shapes[group_shapes[group][k]];
      const FrameMotion motion = motion_of(shape.frame);
      const std::array<double, 3> p = (motion.p_W + motion.R_W * shape.p_FS).array();
      const Mat3 R = motion.R_W * shape.R_FS;
      double columns[9];
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) columns[3 * column + row] = R(row, column);
      }
      fcl_border::place(*groups, group, k, {p.data(), columns});
    }
  }

  // Nearest points of two placed groups.
  bool find_nearest(std::size_t a, std::size_t b, Nearest& found) {
    fcl_border::Nearest raw{};
    if (fcl_border::find_nearest(*groups, a, b, raw) != QueryResult::fine) return false;
    found = {raw.distance,
             vector(raw.p_a_W),
             vector(raw.p_b_W),
             vector(raw.n_W),
             shapes[group_shapes[a][raw.member_a]].frame,
             shapes[group_shapes[b][raw.member_b]].frame};
    return true;
  }

  static void free_geometries(fcl_border::Geometries* p) noexcept { fcl_border::destroy(p); }
  static void free_groups(fcl_border::Groups* p) noexcept { fcl_border::destroy(p); }

  std::unique_ptr<fcl_border::Geometries, void (*)(fcl_border::Geometries*) noexcept> geometries;
  std::unique_ptr<fcl_border::Groups, void (*)(fcl_border::Groups*) noexcept> groups;
  std::vector<Shape> shapes;
  std::vector<std::vector<std::size_t>> group_shapes;
};

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
      mu = std::max(mu, norm(paths[x.frame].way - paths[y.frame].way) + turned(x) + turned(y));
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
