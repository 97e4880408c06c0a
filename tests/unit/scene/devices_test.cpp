// SPDX-License-Identifier: Apache-2.0
// The sections `devices` and `outputs` of a scene: reading them, the published text, what is refused.
#include "scene/devices.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "scene/recorded_files.h"
#include "scene/scene.h"
#include "scene_text.h"
#include "support/temporary_folder.h"

namespace slew::scene {
namespace devices_test {

// a body that is pushed by two inputs, and one lamp's worth of variables
const std::string kPushed = R"(bodies:
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Free: {type: floating, body2: Ball}
forces:
  Push: {type: point_force, body: Ball, force: 1 N, direction: [1, 0, 0]}
  Lift: {type: point_force, body: Ball, force: 1 N, direction: [0, 1, 0]}
inputs:
  Input_Push: {type: analog, primitive: Push, block: 2, channel: 1}
  Input_Lift: {type: digital, primitive: Lift, block: 2, channel: 7}
)";

const std::string kDevices = R"(outputs:
  Lamp: {type: switched, condition: "Ball.center_of_mass.y > 250 mm", hysteresis: 5 cm, delay: 20 ms}
  Gauge: {type: analog, variable: Ball.center_of_mass.y, low: 0, high: 2 m, low_output: 4, high_output: 20}
devices:
  Stick:
    type: joystick
    match: "*Joystick*"
    block: 2
    axes:
      - {code: ABS_X, channel: 1, lowest: 0, centre: 512, highest: 1023, dead_zone: 0.05}
    buttons: [{code: BTN_TRIGGER, channel: 7, invert: true}]
    dead_man: BTN_THUMB
    conditions: ["Ball.center_of_mass.y < 3 m"]
  Dash:
    type: udp_out
    send: 127.0.0.1:5006
    every: 20 ms
    byte_order: big
    fields:
      - {name: count, as: uint16, is: sequence}
      - {name: height, as: float32, variable: Ball.center_of_mass.y}
      - {name: lamps, as: uint8}
      - {name: lamp, of: lamps, bit: 3, output: Lamp}
      - {name: current, as: int16, scale: 0.01, lowest: 4, highest: 20, output: Gauge}
)";

TEST(DeviceSection, IsPartOfThePublishedScene) {
  const Scene scene = load_text(kPushed + kDevices, "test");
  const Scene again = load_text(scene.expanded_text, "again");
  for (const Scene* one : {&scene, &again}) {
    const DevicesDef& devices = one->devices;
    EXPECT_EQ(devices.names(), (std::vector<std::string>{"Stick", "Dash"}));
    ASSERT_EQ(devices.joysticks.size(), 1u);
    const JoystickDef& stick = devices.joysticks[0];
    EXPECT_EQ(stick.match, "*Joystick*");
    ASSERT_EQ(stick.stick.axes.size(), 1u);
    EXPECT_EQ(stick.stick.axes[0].highest, 1023);
    EXPECT_EQ(stick.stick.axes[0].dead_zone, 0.05);
    ASSERT_EQ(stick.stick.buttons.size(), 1u);
    EXPECT_TRUE(stick.stick.buttons[0].invert);
    EXPECT_EQ(stick.enable.dead_man, "BTN_THUMB");
    EXPECT_EQ(stick.enable.devices, std::vector<std::string>{"Stick"});
    ASSERT_EQ(devices.udp_outs.size(), 1u);
    const UdpOutDef& dash = devices.udp_outs[0];
    EXPECT_EQ(dash.every, 0.02);
    const devices::ByteLayout layout = build(dash.layout);
    EXPECT_EQ(layout.size, 9u);
    EXPECT_EQ(layout.values.size(), 3u);
    EXPECT_EQ(layout.byte_order, devices::ByteOrder::big);
    ASSERT_EQ(one->outputs.switched.size(), 1u);
    const devices::SwitchedOutputDef& lamp = one->outputs.switched[0].output;
    EXPECT_EQ(lamp.variable, "Ball.center_of_mass.y");
    EXPECT_EQ(lamp.comparison, devices::Comparison::above);
    EXPECT_EQ(lamp.threshold, 0.25);
    EXPECT_EQ(lamp.hysteresis, 0.05);
    EXPECT_EQ(lamp.delay, 0.02);
    ASSERT_EQ(one->outputs.analog.size(), 1u);
    EXPECT_EQ(one->outputs.analog[0].output.high, 2);
  }
}

TEST(DeviceSection, ReceivedFieldsNameInputsDirectly) {
  const Scene scene = load_text(kPushed + R"(devices:
  Rig:
    type: udp_in
    listen: 127.0.0.1:5005
    from: [127.0.0.1, 10.0.0.7]
    timeout: 50 ms
    most_lost: 5
    packing: 4
    fields: [{name: enable, as: bool}, {name: push, as: float32, input: Input_Push}]
    dead_man: enable
)",
                                "test");
  ASSERT_EQ(scene.devices.udp_ins.size(), 1u);
  const UdpInDef& rig = scene.devices.udp_ins[0];
  EXPECT_EQ(rig.layout.fields[1].input, "Input_Push");
  EXPECT_EQ(rig.enable.device_timeout, 0.05);
  EXPECT_EQ(build(rig.layout).size, 8u);
}

// A problem has the line of the row, or of the value, and a remedy.
void expect_problem(const std::string& sections, const std::string& text) {
  EXPECT_EQ(problems_of(kPushed + sections), text) << sections;
}

TEST(DeviceSection, WhatAJoystickNamesMustExist) {
  const std::string stick = "devices:\n  Stick:\n    type: joystick\n    path: /dev/input/event5\n    block: 2\n";
  const std::string axis = "lowest: 0, centre: 1, highest: 2}";
  expect_problem(
      stick + "    axes:\n    - {code: ABS_X, channel: 1, " + axis + "\n    - {code: ABS_Y, channel: 4, " + axis + "\n",
      "test:18:7: Stick.axes.ABS_Y.channel: no analog input has block 2 and channel 4; expected 1 "
      "(Input_Push)");
  expect_problem(stick + "    axes:\n    - {code: ABS_Z, channel: 7, " + axis + "\n",
                 "test:17:7: Stick.axes.ABS_Z.channel: no analog input has block 2 and channel 7; expected 1 "
                 "(Input_Push)");
  expect_problem(stick + "    buttons:\n    - {code: BTN_TRIGER, channel: 7}\n",
                 "test:17:7: Stick.buttons.BTN_TRIGER.code: there is no button 'BTN_TRIGER'; expected a name of the "
                 "kernel, as BTN_TRIGGER; did you mean 'BTN_TRIGGER'?");
  expect_problem(stick,
                 "test:12:3: Stick: the device has neither axes nor buttons; expected axes or buttons; 'slewring "
                 "device calibrate' writes them");
  expect_problem(stick + "    axes: [{code: ABS_X, channel: 1, lowest: 0, centre: 5, highest: 2}]\n",
                 "test:16:12: Stick.axes.ABS_X.centre: 0, 5, 2 are not in order; expected lowest <= centre <= highest, "
                 "lowest < highest; calibrate the device");
  expect_problem(stick + "    axes: [{code: ABS_X, chanel: 1, " + axis + "]\n",
                 "test:16:26: Stick.axes[0].chanel: unknown key; did you mean 'channel'?");
  expect_problem(stick + "    axes: {ABS_X: 1}\n", "test:16:11: Stick.axes: is a map; expected a list of maps");
  expect_problem(stick + "    axes: [ABS_X]\n", "test:16:12: Stick.axes[0]: is 'ABS_X'; expected a map");
  expect_problem(stick + "    match: a\n    axes: [{code: ABS_X, channel: 1, " + axis + "]\n",
                 "test:12:3: Stick: the device is not identified, or twice; expected one of path and match");
}

TEST(DeviceSection, WhatAPacketNamesMustExist) {
  const std::string rig = "devices:\n  Rig:\n    type: udp_in\n    listen: 127.0.0.1:5005\n    fields:\n";
  expect_problem(rig + "    - {name: push, input: Input_Pull}\n",
                 "test:16:27: Rig.fields[0].input: no input 'Input_Pull'; did you mean 'Input_Push'?");
  expect_problem(rig + "    - {name: push, input: Ball}\n",
                 "test:16:27: Rig.fields[0].input: 'Ball' is a body; expected the name of an input");
  expect_problem(rig + "    - {name: push}\n",
                 "test:12:3: Rig: the device moves nothing; expected a field with an input");
  expect_problem(rig + "    - {name: push, input: Input_Push}\n    - {name: again, input: Input_Push}\n",
                 "test:17:7: Rig.again.input: input Input_Push is moved by Rig already; expected one device for an "
                 "input, once");
  expect_problem(rig + "    - {name: push, input: Input_Push}\n    dead_man: pull\n",
                 "test:17:15: Rig.dead_man: there is no field 'pull'; expected a field of the layout that has a "
                 "value");
  expect_problem(rig + "    - {name: push, input: Input_Push}\n    conditions: [\"Ball.x > 1 m\"]\n",
                 "test:17:17: Rig.conditions: conditions enable nothing without a dead-man input; expected dead_man");
  expect_problem(rig + "    - {name: push, input: Input_Push, as: uint16, is: sequence}\n",
                 "test:16:7: Rig.push.input: a sequence, a checksum or a divided integer has no value; expected no "
                 "input");
  expect_problem("devices:\n  Dash:\n    {type: udp_out, send: 127.0.0.1, fields: [{name: a, variable: Bal.x}]}\n",
                 "test:13:27: Dash.send: '127.0.0.1' is no address; expected IPv4 address and port, as 127.0.0.1:5005");
  expect_problem("devices:\n  Dash: {type: udp_out, send: 127.0.0.1:9, fields: [{name: a, variable: Bal.x}]}\n",
                 "test:12:53: Dash.a.variable: no element 'Bal'; did you mean 'Ball'?");
  expect_problem("devices:\n  Dash: {type: udp_out, send: 127.0.0.1:9, fields: [{name: a, output: Lamp}]}\n",
                 "test:12:71: Dash.fields[0].output: no output 'Lamp'");
}

TEST(DeviceSection, AFieldOfAVariableIsInItsSiUnit) {
  const auto dash = [](const std::string& unit) {
    return "devices:\n  Dash: {type: udp_out, send: 127.0.0.1:9, fields: [{name: a, variable: Ball.position.x, unit: " +
           unit + "}]}\n";
  };
  const std::string place = "test:12:53: Dash.a.unit: ";
  expect_problem(dash("mm"), place +
                                 "a variable is sent in SI, not in 'mm'; expected 'unit: m, scale: 0.001' for raw "
                                 "numbers in mm");
  expect_problem(dash("bar"), place +
                                  "a variable is sent in SI, not in 'bar'; expected 'unit: Pa, scale: 100000' for raw "
                                  "numbers in bar");
  expect_problem(dash("degC"), place +
                                   "a variable is sent in SI, not in 'degC'; expected 'unit: K, offset: 273.15' for "
                                   "raw numbers in degC");
  expect_problem(dash("zorkmid"), place +
                                      "there is no unit 'zorkmid'; expected the SI unit of the variable, as m, N "
                                      "or Pa");
  expect_problem(dash("mA"), place + "no variable is in 'mA'; expected the SI unit of the variable, as m, N or Pa");
  // the unit of the raw numbers, as their scale states
  EXPECT_EQ(load_text(kPushed + dash("mm, scale: 0.001"), "test").devices.udp_outs.at(0).layout.fields.at(0).unit, "m");
  // the dimension is compared where the variables are known
  EXPECT_EQ(variables_of(load_text(kPushed + dash("N m"), "test").devices, {}).at(0).unit, "N m");
  // an output's numbers are what its other side takes
  EXPECT_NO_THROW(static_cast<void>(
      load_text(kPushed + "outputs:\n  Lamp: {type: switched, condition: Ball.position.y > 1 m}\ndevices:\n"
                          "  Dash: {type: udp_out, send: 127.0.0.1:9, fields: [{name: a, output: Lamp, "
                          "unit: mA}]}\n",
                "test")));
}

TEST(DeviceSection, CanSignalsComeFromTheDatabaseAndStayInTheText) {
  const testing::TemporaryFolder folder("can_section");
  folder.write("machine.dbc",
               "BO_ 256 Panel: 8 X\n SG_ Lift : 0|16@1- (0.5,0) [-100|100] \"%\" X\n SG_ Enable : 16|1@1+ (1,0) [0|0] "
               "\"\" X\nBO_ 257 Other: 8 X\n SG_ More : 0|8@1+ (1,0) [0|0] \"\" X\n");
  const std::string panel =
      "devices:\n  Panel:\n    type: can_in\n    interface: can0\n    database: machine.dbc\n    protocol: j1939\n    "
      "signals:\n";
  const std::string path = folder
                               .write("scene.yaml", kPushed + panel +
                                                        "    - {signal: Panel.Lift, input: Input_Push, gain: 0.01}\n"
                                                        "    - {signal: Panel.Enable}\n    dead_man: Panel.Enable\n")
                               .string();
  const Scene scene = load_file(path);
  const Scene again = load_text(scene.expanded_text, "again");
  for (const Scene* one : {&scene, &again}) {
    ASSERT_EQ(one->devices.can_ins.size(), 1u);
    const CanInDef& device = one->devices.can_ins[0];
    EXPECT_EQ(device.bus.protocol, CanProtocol::j1939);
    EXPECT_EQ(device.bus.signals[0].gain, 0.01);
    EXPECT_NE(device.bus.definition.find("BO_ 256 Panel"), std::string::npos);
    EXPECT_EQ(device.bus.definition.find("Other"), std::string::npos);
  }
  const auto problem_of = [&](const std::string& rows) {
    folder.write("scene.yaml", kPushed + panel + rows);
    try {
      static_cast<void>(load_file(path));
    } catch (const LoadError& error) {
      return std::string(error.what()).substr(path.size());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(problem_of("    - {signal: Panel.Lifd, input: Input_Push}\n"),
            ":18:7: Panel.signals.Panel.Lifd: the database has no signal 'Panel.Lifd'; expected message and signal, as "
            "Panel.Lift; did you mean 'Panel.Lift'?");
  EXPECT_EQ(problem_of("    - {signal: Panel.Enable}\n"),
            ":12:3: Panel: the device moves nothing; expected a signal with an input");
  EXPECT_EQ(problem_of("    - {signal: Panel.Lift, input: Input_Push, variable: Ball.x}\n"),
            ":18:7: Panel.signals.Panel.Lift: a received signal takes nothing from the session; expected input");
  folder.write("machine.dbc", "BO_ 256 Panel: 8 X\n SG_ Lift : 0|16@1- (0.5,0\n");
  EXPECT_EQ(
      problem_of("    - {signal: Panel.Lift, input: Input_Push}\n").find(":15:15: Panel.database: machine.dbc:3: "), 0u)
      << problem_of("    - {signal: Panel.Lift, input: Input_Push}\n");
}

TEST(DeviceSection, RecordedFilesAreInTheFolderOfTheScene) {
  const testing::TemporaryFolder folder("recorded_files");
  const auto stick = [](const std::string& path) {
    return kPushed + "devices:\n  Stick: {type: joystick, path: " + path +
           ", block: 2, axes: [{code: ABS_X, channel: 1, lowest: 0, centre: 1, highest: 2}]}\n";
  };
  const auto path_of = [&](const std::string& path) {
    return load_file(folder.write("scene.yaml", stick(path)).string()).devices.joysticks.at(0).path;
  };
  folder.write("stick.events", "");
  EXPECT_EQ(path_of("stick.events"), "stick.events");
  EXPECT_EQ(path_of("/dev/input/is_plugged_in_later"), "/dev/input/is_plugged_in_later");
  try {
    static_cast<void>(path_of("stik.events"));
    ADD_FAILURE() << "accepted";
  } catch (const LoadError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("Stick.path: there is no file '" + (folder.path() / "stik.events").string() +
                        "'; expected a file in the scene's folder"),
              std::string::npos)
        << text;
  }
  // a session's scene has names alone, and each machine its own folder
  DevicesDef devices = load_text(stick("stik.events"), "session").devices;
  place_recorded_files(devices, "there");
  EXPECT_EQ(devices.joysticks.at(0).path, "there/stik.events");
  place_recorded_files(devices, ".");
  EXPECT_EQ(devices.joysticks.at(0).path, "there/stik.events");
}

TEST(OutputSection, QuantitiesMustFitEachOther) {
  expect_problem("outputs:\n  Lamp: {type: switched, condition: \"Ball.y > 250 mbat\"}\n",
                 "test:12:37: Lamp.condition: there is no unit 'mbat'; expected a quantity with its unit such as '250 "
                 "bar', or a bare number in SI");
  expect_problem("outputs:\n  Lamp: {type: switched, condition: Ball.y over 2 m}\n",
                 "test:12:37: Lamp.condition: 'Ball.y over 2 m' is no condition; expected a variable, > >= < or <=, "
                 "and a quantity, as 'Vol_MainPump.pressure > 250 bar'");
  expect_problem("outputs:\n  Lamp: {type: switched, condition: Ball.y > 2 m, hysteresis: 5 bar}\n",
                 "test:12:63: Lamp.hysteresis: '5 bar' is no distance from a threshold in m; expected a quantity of "
                 "the same dimension");
  expect_problem("outputs:\n  Gauge: {type: analog, variable: Ball.y, low: 0 m, high: 5 bar}\n",
                 "test:12:59: Gauge.high: '0 m' and '5 bar' differ in dimension; expected two quantities of the "
                 "variable");
}

TEST(OutputSection, UnitsOfOneDimensionAreAlike) {
  EXPECT_TRUE(is_same_dimension("bar", "Pa"));
  EXPECT_TRUE(is_same_dimension("", "Pa"));
  EXPECT_TRUE(is_same_dimension("rad/s", "deg/s"));
  EXPECT_FALSE(is_same_dimension("bar", "m"));
  EXPECT_FALSE(is_same_dimension("m", "1"));
  EXPECT_TRUE(is_same_dimension("1", "1"));
}

TEST(DeviceFile, ReplacesTheSectionsOfAScene) {
  const testing::TemporaryFolder folder("devices_section");
  const std::string path = (folder.path() / "devices.yaml").string();
  std::ofstream(path) << "devices:\n  Rig:\n    type: udp_in\n    listen: 127.0.0.1:5005\n    fields: [{name: a, as: "
                         "float32, input: Input_Push}]\n";
  const Scene scene = load_text(kPushed + kDevices, "test");
  const Scene with = with_devices(scene, path);
  EXPECT_EQ(with.devices.names(), std::vector<std::string>{"Rig"});
  EXPECT_TRUE(with.outputs.switched.empty());
  EXPECT_EQ(with.inputs.size(), 2u);

  std::ofstream(path) << "bodies:\n  Rig: {mass: 2 kg}\n";
  try {
    static_cast<void>(with_devices(scene, path));
    FAIL();
  } catch (const LoadError& error) {
    EXPECT_EQ(std::string(error.what()),
              path + ":1:1: bodies: is no section of a file of devices; expected devices or outputs");
  }
}

}  // namespace devices_test
}  // namespace slew::scene
