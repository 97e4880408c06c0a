// SPDX-License-Identifier: Apache-2.0
// Sensors of a scene: clearance of groups of shapes, zones, collisions (docs/models/sensors.md).
//
// An observer of poses: no force follows from a sensor. FCL searches and allocates: not for a step in real time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "contact/contact_def.h"
#include "core/element_variable.h"
#include "core/field.h"
#include "core/problem.h"
#include "core/state_bytes.h"
#include "core/status.h"
#include "math/vector3.h"

namespace slew::sensors {

enum class SensorType : int { clearance, zone, collision };

// One struct for every type; each type's field table lists the members that it has. Names are shapes, or frames: then
// all shapes of the frame that are no zone of any sensor.
struct SensorDef {
  std::string name{};
  SensorType type = SensorType::clearance;
  std::vector<std::string> of{}, to{};  // clearance, collision: the two groups
  std::string zone{};                   // a solid shape
  std::vector<std::string> watch{};     // zone: what it watches
  double limit = 0;                     // m, clearance: close below it; 0: none
  double hysteresis = 0;                // m, clearance: no longer close above limit + hysteresis
  double stay = 0;                      // s, zone: the event after so long inside; 0: none
  bool is_continuous = false;           // collision: the motion between two samples is searched too
};

struct SensorsDef {
  std::vector<contact::FrameDef> frames;
  std::vector<contact::ShapeDef> shapes;
  std::vector<SensorDef> sensors;
  double interval = 0.01;  // s between two samples, > 0
};

// The types of the section `sensors`, in the order of SensorType.
struct SensorTypeRow {
  std::string_view name;
  std::string_view doc;
  std::span<const Field> fields;
};
[[nodiscard]] std::span<const SensorTypeRow> sensor_types() noexcept;

// Appends all problems: unknown names, groups that share a frame and nothing else, zones without an inside, two planes,
// meshes without triangles. Paths are "Sensor.key".
void validate(const SensorsDef& def, Problems& problems);

// Motion of a frame, in the world.
struct FrameMotion {
  math::Vec3 p_W{};                         // m, origin
  math::Mat3 R_W = math::Mat3::identity();  // columns are the frame's axes
  math::Vec3 v_W{};                         // m/s, of the origin
  math::Vec3 w_W{};                         // rad/s
};

enum class EventKind : std::uint8_t { close, clear, enter, leave, stay, hit, apart };

struct Event {
  std::size_t sensor = 0;   // index of SensorsDef::sensors
  std::size_t watched = 0;  // zone: index of `watch`
  EventKind kind = EventKind::close;
  double value = 0;    // m (close, clear), s since enter or hit (leave, stay, apart), m/s (hit); enter: 0
  math::Vec3 place_W;  // m, of a hit
  double before = 0;   // s, by which a hit was before the sample
};

// "Boom_Cab: 0.482 m, below the limit of 0.5 m"; of a hit with its time before the sample
[[nodiscard]] std::string event_text(const SensorDef& def, const Event& event);

class Sensors {
 public:
  // Pre-condition: validate() found nothing.
  explicit Sensors(const SensorsDef& def);
  ~Sensors();
  Sensors(const Sensors&) = delete;
  Sensors& operator=(const Sensors&) = delete;

  // Takes the next sample, by frame. False: a search failed, and the values of that sensor stay; or the motion before a
  // sample was not searched, since a body turns by half a turn or more in an interval, and its values are those of the
  // sample alone. failed() names the sensor.
  bool observe(std::span<const FrameMotion> frames);
  [[nodiscard]] std::size_t failed() const noexcept { return failed_; }
  // Events of the last sample, in the order of the sensors.
  [[nodiscard]] std::span<const Event> events() const noexcept { return events_; }

  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept { return variables_; }
  void read_variables(std::span<double> values) const noexcept;

  // Back to the state before the first sample.
  void reset() noexcept;
  [[nodiscard]] std::uint64_t state_hash() const noexcept;
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  struct Search;  // shapes and groups of FCL

  // Values of a sensor, and its memory.
  struct Clearance {
    double distance = 0, closing_speed = 0;
    math::Vec3 p_of_W, p_to_W;
    bool is_close = false;
  };
  struct Watched {
    bool is_inside = false;
    std::int64_t samples = 0;  // since it entered
  };
  struct Collision {
    bool is_touching = false;
    std::int64_t samples = 0;  // since the one of the hit
    double hit_before = 0;     // s, of the hit before that sample
    std::int64_t hits = 0;
    double speed = 0;  // m/s, of the last hit
    math::Vec3 place_W;
  };
  // A sensor refers to its groups and to its values by index.
  struct Sensor {
    SensorDef def;
    std::vector<std::size_t> groups;  // of, to; or the zone, then the watched ones
    std::size_t first = 0;            // among the values of its type
  };

  void list_variables(const Sensor& sensor);
  bool observe_clearance(std::size_t index, std::span<const FrameMotion> frames);
  bool observe_zone(std::size_t index);
  bool observe_collision(std::size_t index, std::span<const FrameMotion> frames);
  bool search_motion(std::size_t index, std::span<const FrameMotion> frames, bool& has_hit);
  void add_hit(std::size_t index, Collision& collision, double speed, math::Vec3 place_W, double before);
  template <typename Bytes, typename Self>
  static void visit(Bytes& bytes, Self& self);

  [[nodiscard]] double time_of(std::int64_t samples) const noexcept { return interval_ * static_cast<double>(samples); }

  double interval_;
  std::unique_ptr<Search> search_;
  std::vector<Sensor> sensors_;
  std::vector<Clearance> clearances_;
  std::vector<Watched> watched_;
  std::vector<Collision> collisions_;
  std::vector<FrameMotion> last_;  // sample before, by frame; used after the first one
  bool has_last_ = false;
  std::vector<ElementVariable> variables_;
  std::vector<Event> events_;
  std::size_t failed_ = 0;
};

}  // namespace slew::sensors
