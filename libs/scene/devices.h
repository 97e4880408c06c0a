// SPDX-License-Identifier: Apache-2.0
// Devices of a scene, which move its inputs and show its variables, and the outputs that they show: lamps and gauges.
//
// `slewring run` starts each device as a process (device_node); nothing of it takes part in a step.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/analog_output.h"
#include "devices/byte_layout.h"
#include "devices/can_message.h"
#include "devices/canopen_network.h"
#include "devices/enable_chain.h"
#include "devices/j1939_claim.h"
#include "devices/motion_platform.h"
#include "devices/output_condition.h"
#include "devices/platform_quantities.h"
#include "devices/stick.h"

namespace slew::scene {

struct InputDef;

// A joystick, gamepad or pedals: its axes and buttons move the inputs of its block by their channels.
struct JoystickDef {
  std::string name;
  std::string path;        // "/dev/input/event5", or a file of recorded events
  std::string match;       // pattern of the device's own name; empty: path alone
  std::int64_t block = 0;  // of the inputs
  devices::StickDef stick;
  devices::EnableChainDef enable;  // without a dead-man button: none
};

// Packets of one layout that are received.
struct UdpInDef {
  std::string name;
  std::string listen;                          // "127.0.0.1:5005"
  std::vector<std::string> from{"127.0.0.1"};  // senders that are accepted
  double timeout = 0.1;                        // s without a packet after which the inputs go to neutral
  devices::LayoutDef layout;
  devices::EnableChainDef enable;
};

// Packets of one layout that are sent.
struct UdpOutDef {
  std::string name;
  std::string send;     // "127.0.0.1:5006"
  double every = 0.01;  // s
  devices::LayoutDef layout;
};

enum class CanProtocol : int { plain, j1939, canopen };

// A signal of a message on CAN.
struct CanSignalDef {
  std::string signal;      // "Message.Signal" of the database, "Pdo.object" with CANopen
  std::string input{};     // of the session, which a received value moves
  std::string variable{};  // of the session, whose value is sent
  std::string output{};    // of the scene, whose state is sent
  double gain = 1;         // received: input = gain * value; sent: value = gain * variable
};

// An object of a PDO, in the order of the list; without a name bits that are not used.
struct CanObjectDef {
  std::string pdo;
  devices::PdoObjectDef object;
};

struct CanBusDef {
  std::string interface;   // "can0"
  std::string database;    // DBC file in the scene's folder
  std::string definition;  // the messages that the signals are of, as a DBC text: from `database` where that is read
  CanProtocol protocol = CanProtocol::plain;
  std::vector<CanSignalDef> signals;
  devices::J1939UnitDef unit;         // j1939: what it claims an address with
  devices::CanOpenDef canopen;        // canopen: nodes, and the device as a node
  std::vector<devices::PdoDef> pdos;  // canopen: messages of the signals, with their objects in `objects`
  std::vector<CanObjectDef> objects;
};

struct CanInDef {
  std::string name;
  std::string path;      // file of recorded frames, in place of an interface
  double timeout = 0.2;  // s without a value of a signal after which the inputs go to neutral
  CanBusDef bus;
  devices::EnableChainDef enable;
};

struct CanOutDef {
  std::string name;
  double every = 0.02;  // s
  CanBusDef bus;
};

// A hexapod under a driver's seat that follows a body's point.
struct MotionPlatformDef {
  std::string name;
  std::string body;
  devices::SeatDef seat;                // in axes of the body
  std::vector<std::string> conditions;  // that must all be met; otherwise it parks
  std::string send;                     // "127.0.0.1:6000"
  double every = 0.005;                 // s of the wall clock between two packets
  devices::LayoutDef layout;            // fields name variables "NAME.leg_1" of the platform and those of the session
  devices::MotionPlatformDef platform;

  // The quantity of the platform that the field has; null: it has none.
  [[nodiscard]] const devices::PlatformQuantity* own_quantity(const devices::LayoutFieldDef& field) const;
  // Names of the ten variables of the body, in the order of velocity, orientation (w first) and angular velocity.
  [[nodiscard]] std::vector<std::string> body_variables() const;
};

// A quantity of any dimension, such as "250 bar" for a variable of which only its node has the unit.
struct AnyQuantity {
  double value = 0;  // SI
  std::string unit;  // as written; empty: a bare number in SI
};

// "Vol_MainPump.pressure > 250 bar".
struct Condition {
  std::string variable;
  devices::Comparison comparison{};
  AnyQuantity threshold;

  // False for a value that is NaN.
  [[nodiscard]] bool is_met(double value) const noexcept { return devices::is_met(comparison, value, threshold.value); }
};

// A lamp, buzzer or contact.
struct SwitchedDef {
  std::string name;
  std::string condition;
  std::string hysteresis;  // quantity; empty: 0
  devices::SwitchedOutputDef output;
};

// A gauge, current or voltage.
struct AnalogDef {
  std::string name;
  std::string low, high;  // quantities of the variable
  devices::AnalogOutputDef output;
};

struct DevicesDef {
  std::vector<JoystickDef> joysticks;
  std::vector<UdpInDef> udp_ins;
  std::vector<UdpOutDef> udp_outs;
  std::vector<CanInDef> can_ins;
  std::vector<CanOutDef> can_outs;
  std::vector<MotionPlatformDef> platforms;

  // Names of all devices, in the order above.
  [[nodiscard]] std::vector<std::string> names() const;
};

struct OutputsDef {
  std::vector<SwitchedDef> switched;
  std::vector<AnalogDef> analog;
};

inline constexpr std::size_t kMaxDevices = 16;  // each is a process

[[nodiscard]] std::span<const Field> joystick_fields();  // without the lists
[[nodiscard]] std::span<const Field> udp_in_fields();    // without the list
[[nodiscard]] std::span<const Field> udp_out_fields();   // without the list
[[nodiscard]] std::span<const Field> can_in_fields();    // without the list
[[nodiscard]] std::span<const Field> can_out_fields();   // without the list
[[nodiscard]] std::span<const Field> can_signal_fields() noexcept;
[[nodiscard]] std::span<const Field> can_pdo_fields();
[[nodiscard]] std::span<const Field> can_object_fields();
[[nodiscard]] std::span<const Field> motion_platform_fields();  // without the list
[[nodiscard]] std::span<const Field> switched_fields();
[[nodiscard]] std::span<const Field> analog_fields();

// Value of a text such as "250 bar" or "0.5"; otherwise a problem with the path.
[[nodiscard]] std::optional<AnyQuantity> read_any_quantity(std::string_view path, std::string_view text,
                                                           Problems& problems);
[[nodiscard]] std::optional<Condition> read_condition(std::string_view path, std::string_view text, Problems& problems);
// True if a quantity in the first unit can be compared with a variable in the second. Empty: SI, fits all.
[[nodiscard]] bool is_same_dimension(const std::string& a, const std::string& b);

enum class CanFlow : std::uint8_t { received, sent };  // by the device

// Fills the definition with the messages that the signals name: from the database at the path, where one is named, and
// with J1939 from the messages that are built in (devices/j1939.h).
void read_database(const std::string& device, CanBusDef& bus, const std::string& path, Problems& problems);
// The messages of a bus: of the definition, with CANopen the PDOs in their order.
[[nodiscard]] std::vector<devices::CanMessage> can_messages(const CanBusDef& bus, CanFlow flow, Problems& problems);

// Fills what follows from the texts of outputs, and checks the rules between the fields.
void read_outputs(OutputsDef& outputs, Problems& problems);
// The same for devices, and their use of inputs.
void read_devices(DevicesDef& devices, std::span<const InputDef> inputs, Problems& problems);

// Rules between a platform and the rest of the scene. gravity: m/s2, Ground; publish_interval: of variables, s.
void check_platform(const MotionPlatformDef& def, const Triple& gravity, double publish_interval, Problems& problems);

// Variables that outputs, conditions and fields name, with the path of each text, and the unit of the quantity that
// they are compared with; empty: none.
struct NamedVariable {
  std::string path, variable, unit{};
};
[[nodiscard]] std::vector<NamedVariable> variables_of(const DevicesDef& devices, const OutputsDef& outputs);

}  // namespace slew::scene
