// SPDX-License-Identifier: Apache-2.0
// Parameters, templates, groups and includes: a scene that uses them is the scene that is written out, and each fault
// has its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene/canonical.h"
#include "scene/scene.h"
#include "scene_text.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace language_test {

std::string expanded(const std::string& text, const Overrides& overrides = {}) {
  return load_text(text, "test", overrides).expanded_text;
}

std::string refusal_of(const std::string& path, const Overrides& overrides = {}) {
  try {
    (void)load_file(path, overrides);
  } catch (const LoadError& error) {
    return error.what();
  }
  return "accepted";
}

const double kThirtyDegrees = static_cast<double>(std::numbers::pi_v<long double> / 6);

// ---- parameters

TEST(SceneParameters, AloneTheyAreTheTextThatStandsThere) {
  const std::string with = R"(parameters: {m: 2 kg, r: 0.5 m, kind: revolute, body: Rod, Lx: "${r}"}
bodies:
  Rod: {mass: ${m}, center_of_mass: [${Lx}, 0, 0], inertia: [0, 1, 1]}
joints:
  Hinge: {type: revolute, body2: ${body}}
)";
  EXPECT_EQ(expanded(with), expanded(kPendulum));
  EXPECT_EQ(expanded(with, {"m=3kg"}), expanded(kPendulum, {"Rod.mass=3kg"}));
}

TEST(SceneParameters, ExpressionsStandInListsWithAndWithoutQuotes) {
  const std::string scene = R"(parameters: {L: 2.6 m, a: 30 deg}
bodies:
  Rod: {mass: 2 kg, center_of_mass: [${L/2 * cos(a)}, "${min(L, 1 m)}", ${-L}], inertia: [0, 1, 1]}
joints:
  Hinge: {type: revolute, body2: Rod, limit_min: ${-a}, limit_max: "${2 * a}", limit_stiffness: 1e6 Nm/rad}
)";
  const Scene loaded = load_text(scene, "test");
  const Triple& center = loaded.mechanics.bodies.at(0).center_of_mass;
  EXPECT_EQ(center, (Triple{2.6 / 2 * std::cos(kThirtyDegrees), 1, -2.6}));
  EXPECT_EQ(loaded.mechanics.joints.at(0).first.limit_max, 2 * kThirtyDegrees);
  EXPECT_EQ(load_text(loaded.expanded_text, "test").expanded_text, loaded.expanded_text);
  EXPECT_EQ(loaded.expanded_text.find("${"), std::string::npos);
}

TEST(SceneParameters, FieldsOfAnyKindTakeThem) {
  const std::string scene = R"(parameters: {n: 2, is_tested: false, level: linear, T: 3 s}
session: {exchange_every: "${n * 2}", coupling: ${level}, duration: ${T * 2}}
inputs:
  Stick: {type: analog, primitive: Push, scale: "${cos(60 deg) * 200}"}
forces:
  Push: {type: point_force, body: Rod, point: [0.1 m, 0, 0], direction: [1, 0, 0]}
script:
  inputs:
    Stick: [[0 s, 0], ["${T}", "${1/n}"]]
)" + kPendulum;
  const Scene loaded = load_text(scene, "test");
  EXPECT_EQ(loaded.session.exchange_every, 4);
  EXPECT_EQ(loaded.session.duration, 6);
  EXPECT_EQ(loaded.inputs.at(0).scale, std::cos(static_cast<double>(std::numbers::pi_v<long double> / 3)) * 200);
  EXPECT_EQ(loaded.script.tracks.at(0).points.at(1), (std::array<double, 2>{3, 0.5}));
}

// a list, a table, and entries of both kinds of list by number
TEST(SceneParameters, ListsStandWhereListsAreWanted) {
  const std::string with = R"(parameters:
  c: [500 mm, 0, 0]
  I: [0, 1, 1]
  m: 2 kg
  masses: [1 kg, "${m}", "${2 * m}"]
  push: [[0 s, 0 N], [1 s, 3 kN]]
  names: [Hinge.position, Hinge.velocity]
bodies:
  Rod: {mass: "${masses[1]}", center_of_mass: ${c}, inertia: ${I}}
joints:
  Hinge: {type: revolute, body2: Rod}
forces:
  Push: {type: point_force, body: Rod, direction: [1, 0, 0], point: ["${c[0] / 5}", 0, 0], force_table: ${push}}
recording: {variables: ${names}}
)";
  const std::string without = R"(bodies:
  Rod: {mass: 2 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}
joints:
  Hinge: {type: revolute, body2: Rod}
forces:
  Push: {type: point_force, body: Rod, direction: [1, 0, 0], point: [0.1 m, 0, 0], force_table: [[0 s, 0 N], [1 s, 3 kN]]}
recording: {variables: [Hinge.position, Hinge.velocity]}
)";
  EXPECT_EQ(expanded(with), expanded(without));
  EXPECT_EQ(expanded(with, {"c=[1 m, 0, 0]"}),
            expanded(without, {"Rod.center_of_mass=[1 m, 0, 0]", "Push.point=[0.2 m, 0, 0]"}));
  EXPECT_EQ(load_text(with, "test").parameter_texts.size(), 1U);  // m alone is a number to vary
}

TEST(SceneParameters, ListsGoToInstances) {
  const std::string scene = R"(groups:
  Side:
    parameters: {c: , k: 1}
    bodies:
      Rod: {mass: 1 kg, center_of_mass: ${c}, inertia: [0, 1, 1]}
    joints:
      Hinge: {type: revolute, body2: Rod}
parameters: {own: [1 m, 2 m, 3 m]}
instances:
  L_: {group: Side, parameters: {c: [1 m, 0, 0], k: 2}}
  R_: {group: Side, parameters: {c: ${own}, k: 2}}
)";
  const std::string problems = problems_of(scene);
  EXPECT_EQ(problems, "");
  const Scene loaded = load_text(scene, "test");
  EXPECT_EQ(loaded.mechanics.bodies.at(0).center_of_mass, (Triple{1, 0, 0}));
  EXPECT_EQ(loaded.mechanics.bodies.at(1).center_of_mass, (Triple{1, 2, 3}));
}

TEST(SceneParameters, FaultsOfListsHaveTheirPlace) {
  const auto problem = [](const std::string& parameters, const std::string& mass) {
    return problems_of("parameters: " + parameters + "\nbodies:\n  Rod: {mass: \"" + mass +
                       "\", center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}\njoints:\n"
                       "  Hinge: {type: revolute, body2: Rod}\n");
  };
  EXPECT_EQ(problem("{L: [1 kg, 2 kg]}", "${L[1] * 2}"), "");
  EXPECT_EQ(problem("{L: [1 kg, 2 kg]}", "${L}"),
            "test:3:15: Rod.mass: is a list; expected a mass such as '500 kg', or a bare number in kg");
  EXPECT_EQ(problem("{L: [1 kg, 2 kg]}", "${2 * L}"),
            "test:3:22: Rod.mass: parameter 'L' is a list, no quantity; expected a parameter with a number");
  EXPECT_EQ(problem("{L: [1 kg, 2 kg]}", "${L[2]}"),
            "test:3:18: Rod.mass: list 'L' has 2 entries, counted from 0; expected a number below 2");
  EXPECT_EQ(problem("{L: [1 kg, 2 kg]}", "${L[x]}"),
            "test:3:19: Rod.mass: this is no entry of a list; expected its number from 0, as in L[2]");
  EXPECT_EQ(problem("{L: [1 kg, 2 m]}", "${L[0] + L[1]}"),
            "test:3:23: Rod.mass: '+' between a mass and a length; expected a mass, as on the left");
  EXPECT_EQ(problem("{L: 2 kg}", "${L[0]}"),
            "test:3:18: Rod.mass: parameter 'L' is '2 kg', no list; expected a parameter with a list");
  EXPECT_EQ(problem("{L: [1 kg, heavy]}", "${L[1]}"),
            "test:3:18: Rod.mass: parameter 'L[1]' is 'heavy', no quantity; expected a parameter with a number");
  EXPECT_EQ(problem("{L: [1 kg, \"${L[0]}\"]}", "${L[0]}"),
            "test:1:27: parameters.L: parameter 'L' depends on itself; expected parameters that use each other in one "
            "direction");
  EXPECT_EQ(
      problem("{L: [1 kg], K: [\"${L}\"]}", "${K[0]}"),
      "test:1:32: parameters.K: parameter 'L' is a list, within another parameter; expected one value, such as an "
      "entry of it");
  EXPECT_EQ(problem("{L: [[1 kg, 2 kg]]}", "${L[0]}"),
            "test:3:18: Rod.mass: parameter 'L[0]' is a list, no quantity; expected a parameter with a number");
}

// lists cannot grow a scene without bound
TEST(SceneParameters, ListsPutAMillionValuesAtMost) {
  std::string scene = "parameters:\n  L: [";
  for (int i = 0; i < 2000; ++i) scene += i == 0 ? "0" : ", 0";
  scene += "]\nbodies:\n";
  for (int i = 0; i < 600; ++i) scene += "  B" + std::to_string(i) + ": {mass: 1, inertia: ${L}}\n";
  EXPECT_NE(problems_of(scene).find("the lists of parameters give the scene too many values; expected at most 1000000"),
            std::string::npos);
}

TEST(SceneParameters, FaultsHaveTheirPlace) {
  const auto problem = [](const std::string& parameters, const std::string& mass) {
    return problems_of("parameters: " + parameters + "\nbodies:\n  Rod: {mass: " + mass +
                       ", center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}\njoints:\n"
                       "  Hinge: {type: revolute, body2: Rod}\n");
  };
  EXPECT_EQ(problem("{m: 2 kg}", "${m}"), "");
  EXPECT_EQ(problem("{m: 2 kg, L: 1 m}", "${m + L}"),
            "test:3:19: Rod.mass: '+' between a mass and a length; expected a mass, as on the left");
  EXPECT_EQ(problem("{m: 2 kg}", "${mm * 2}"), "test:3:17: Rod.mass: there is no parameter 'mm'; did you mean 'm'?");
  EXPECT_EQ(problem("{m: 2 kg}", "${mm}"), "test:3:17: Rod.mass: there is no parameter 'mm'; did you mean 'm'?");
  EXPECT_EQ(problem("{m: 2 m}", "${m}"),
            "test:3:15: Rod.mass: '2 m' is a length; expected a mass such as '500 kg', or a bare number in kg");
  EXPECT_EQ(
      problem("{L: 2 m}", "${L / (1 m)}"),
      "test:3:15: Rod.mass: the expression gives the number 2, in which all units cancelled; expected a mass such "
      "as '500 kg', or a bare number in kg");
  EXPECT_EQ(problem("{n: 2}", "${n * 3}"), "");
  EXPECT_EQ(problem("{m: 0 kg}", "${1 kg2 / m}"),
            "test:3:23: Rod.mass: division by zero; expected a divisor other than 0");
  EXPECT_EQ(problem("{m: heavy}", "${2 * m}"),
            "test:3:21: Rod.mass: parameter 'm' is 'heavy', no quantity; expected a parameter with a number");
  EXPECT_EQ(problem("{m: \"${2 * k}\", k: \"${m / 3}\"}", "${m}"),
            "test:1:35: parameters.k: parameter 'm' depends on itself; expected parameters that use each other in one "
            "direction");
  EXPECT_EQ(
      problem("{m: {a: 1 kg}}", "2 kg"),
      "test:1:17: parameters.m: is a map; expected one value (a quantity, a number or a text), or a list of them");
  EXPECT_EQ(
      problem("{m: [[[1 kg]]]}", "2 kg"),
      "test:1:17: parameters.m: is a list; expected one value (a quantity, a number or a text), or a list of them");
  EXPECT_EQ(problem("{sin: 1}", "2 kg"),
            "test:1:14: parameters.sin: the name is reserved in expressions; expected another name");
  EXPECT_EQ(
      problem("{2m: 1}", "2 kg"),
      "test:1:14: parameters.2m: is not a name; expected at most 32 letters, digits and _, beginning with a letter");
  EXPECT_EQ(problem("[m]", "2 kg"), "test:1:13: parameters: is a list; expected a map, such as {L: 2.6 m}");
  EXPECT_EQ(
      problem("{m: 2 kg}", "${m} kg"),
      "test:3:15: Rod.mass: '${m} kg' begins with an expression and is longer; expected the expression as the whole "
      "value, ${...}, or $${ at the begin of a text");
  EXPECT_EQ(problem("{m: }", "${m}"),
            "test:3:17: Rod.mass: parameter 'm' has no value; expected a value at parameters.m, or from the instance");
}

TEST(SceneParameters, AFaultInAnUnusedOneIsReported) {
  EXPECT_EQ(problems_of("parameters: {a: \"${missing}\"}\n" + kPendulum),
            "test:1:20: parameters.a: there is no parameter 'missing'");
}

TEST(SceneParameters, TheCommandLineSetsThemAndIsChecked) {
  const std::string scene = "parameters: {L: 2 m, half: \"${L / 2}\"}\n" +
                            std::string(
                                "bodies:\n  Rod: {mass: 2 kg, center_of_mass: [${half}, 0, 0], inertia: [0, 1, 1]}\n"
                                "joints:\n  Hinge: {type: revolute, body2: Rod}\n");
  EXPECT_EQ(load_text(scene, "test", {"L=3m"}).mechanics.bodies.at(0).center_of_mass[0], 1.5);
  EXPECT_EQ(load_text(scene, "test", {"Rod.mass=${L * 1 kg/m}"}).mechanics.bodies.at(0).mass, 2);
  EXPECT_EQ(problems_of(scene, {"half=3 s"}),
            "test:3:38: Rod.center_of_mass: '3 s' is a time; expected a length such as '1.5 m', or a bare number in m");
  EXPECT_EQ(problems_of(scene, {"hlf=3 m"}),
            "--set hlf=3 m: there is no parameter 'hlf'; expected Element.key=value, such as 'Bag.mass=1500kg', or "
            "Parameter=value, such as 'L=3m'; did you mean 'half'?");
  EXPECT_EQ(
      problems_of(scene, {"L=3 kg"}),
      "test:3:38: Rod.center_of_mass: '1.5 kg' is a mass; expected a length such as '1.5 m', or a bare number in m");
}

TEST(SceneParameters, ThatNothingUsesAreWarnedAboutInTheScenesOwnFile) {
  const TemporaryFolder folder;
  folder.write("library.yaml", "parameters: {g: 1 m, h: 2 m}\n" + kPendulum);
  const std::string path = folder.write(
      "scene.yaml",
      "include: library.yaml\nparameters: {a: 1 m}\ntemplates: {T: {mass: 1 kg}}\ngroups: {G: {bodies: {}}}\n");
  const std::vector<std::string> expected = {path + ":2:14: parameters.a: nothing uses this parameter",
                                             path + ":3:13: templates.T: nothing uses this template",
                                             path + ":4:10: groups.G: the group has no instance"};
  EXPECT_EQ(load_file(path).warnings, expected);
}

TEST(SceneParameters, ATextThatBeginsLikeAnExpressionSurvivesTheRoundTrip) {
  for (const std::string title : {"${L}", "$${L}", "costs ${5}", "$5", "${"}) {
    const std::string scene =
        kPendulum + "plots:\n  Swing: {title: " + yaml_text(title) + ", variables: [Rod.position.x]}\n";
    const Scene once = load_text(scene, "test");
    EXPECT_EQ(once.plots.at(0).title, title);
    EXPECT_EQ(load_text(once.expanded_text, "test").plots.at(0).title, title);
  }
}

// each parameter doubles the one before it: 64 are a number, more are refused, and a longer text cannot grow at all
TEST(SceneParameters, ChainsAreBounded) {
  const auto chain = [](int length) {
    std::string text = "parameters:\n  p0: 1 kg\n";
    for (int i = 1; i < length; ++i) text += "  p" + std::to_string(i) + ": ${p" + std::to_string(i - 1) + " * 1}\n";
    return problems_of(text + "bodies:\n  Rod: {mass: \"${p" + std::to_string(length - 1) +
                       "}\", center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}\njoints:\n"
                       "  Hinge: {type: revolute, body2: Rod}\n");
  };
  EXPECT_EQ(chain(60), "");
  EXPECT_NE(chain(70).find("more than 64 parameters use each other"), std::string::npos);
}

// ---- templates

TEST(Templates, GiveTheKeysThatAnElementLacks) {
  const std::string scene =
      "templates:\n  Body: {mass: 2 kg, inertia: [0, 1, 1]}\n"
      "  Long: {use: Body, center_of_mass: [${c}, 0, 0], mass: 9 kg}\n"
      "  Turning: {type: revolute, body2: Nothing}\n  To_Rod: {body2: Rod}\n"
      "parameters: {c: 0.5 m}\n"
      "bodies:\n  Rod: {use: Long, mass: 2 kg}\njoints:\n  Hinge: {use: [Turning, To_Rod]}\n";
  EXPECT_EQ(expanded(scene), expanded(kPendulum));
}

TEST(Templates, FaultsHaveTheirPlace) {
  const std::string rod = "bodies:\n  Rod: {use: Bdy, mass: 2 kg}\n";
  EXPECT_EQ(problems_of("templates: {Body: {mass: 2 kg}}\n" + rod),
            "test:3:14: Rod.use: there is no template 'Bdy'; did you mean 'Body'?");
  EXPECT_EQ(problems_of("templates: {Bdy: {use: Bdy}}\n" + rod),
            "test:1:24: Rod.use.use.use.use.use.use.use.use.use: templates use each other too deeply, or in a circle; "
            "expected at most 8 levels");
  EXPECT_EQ(problems_of("templates: {Bdy: 3}\n" + rod), "test:1:18: templates.Bdy: is '3'; expected a map");
  EXPECT_EQ(problems_of("templates: {Bdy: {mas: 2 kg}}\n" + rod + "joints:\n  Hinge: {type: revolute, body2: Rod}\n"),
            "test:1:19: Rod.mas: unknown key; did you mean 'mass'?\n"
            "test:3:3: Rod: the key 'inertia' is missing; expected a list of three, [x, y, z]");
}

// ---- groups

const std::string kTwoRods = R"(groups:
  Swing:
    parameters: {m: 1 kg, x: , base: Ground}
    bodies:
      Rod: {position: [${x}, 0, 0], mass: ${m}, center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}
    joints:
      Hinge: {type: revolute, body1: ${base}, point1: [${x}, 0, 0], body2: Rod}
    plots:
      Height: {variables: [Rod.position.y, Hinge.position, mechanics.kinetic_energy]}
instances:
  Left: {group: Swing, parameters: {x: "${-w/2}"}}
  Right: {group: Swing, prefix: R_, parameters: {x: "${w/2}", m: 3 kg}}
parameters: {w: 4 m}
)";

TEST(Groups, AnInstanceIsTheGroupWithAPrefixOnItsNames) {
  const std::string by_hand = R"(bodies:
  Left_Rod: {position: [-2 m, 0, 0], mass: 1 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}
  R_Rod: {position: [2 m, 0, 0], mass: 3 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}
joints:
  Left_Hinge: {type: revolute, body1: Ground, point1: [-2 m, 0, 0], body2: Left_Rod}
  R_Hinge: {type: revolute, body1: Ground, point1: [2 m, 0, 0], body2: R_Rod}
plots:
  Left_Height: {variables: [Left_Rod.position.y, Left_Hinge.position, mechanics.kinetic_energy]}
  R_Height: {variables: [R_Rod.position.y, R_Hinge.position, mechanics.kinetic_energy]}
)";
  EXPECT_EQ(expanded(kTwoRods), expanded(by_hand));
}

TEST(Groups, ElementsAroundAnInstanceAreLaidOverItsOwnAndGiveTheOrder) {
  const Scene scene = load_text(kTwoRods + "bodies:\n  R_Rod: {mass: 7 kg}\n  Left_Rod: {}\n", "test");
  EXPECT_EQ(scene.mechanics.bodies.at(0).name, "R_Rod");
  EXPECT_EQ(scene.mechanics.bodies.at(0).mass, 7);
  EXPECT_EQ(scene.mechanics.bodies.at(0).position[0], 2);
  EXPECT_EQ(scene.mechanics.bodies.at(1).name, "Left_Rod");
}

TEST(Groups, TheCommandLineSetsElementsOfInstances) {
  EXPECT_EQ(load_text(kTwoRods, "test", {"R_Rod.mass=8 kg"}).mechanics.bodies.at(1).mass, 8);
  EXPECT_EQ(load_text(kTwoRods, "test", {"w=6 m"}).mechanics.bodies.at(1).position[0], 3);
}

// Outer passes the name of one of its own bodies to Inner, which has a body of that name as well
TEST(Groups, ATextOfAParameterNamesWhatItNamesWhereItIsWritten) {
  const std::string nested = R"(groups:
  Inner:
    parameters: {base: , at: 0 m}
    bodies:
      Rod: {relative_to: ${base}, position: [1 m, 0, 0], mass: 1 kg, inertia: [0, 1, 1]}
    joints:
      Hinge: {type: revolute, body1: ${base}, point1: [1 m, 0, 0], body2: Rod}
  Outer:
    parameters: {base: Ground}
    bodies:
      Rod: {relative_to: ${base}, mass: 2 kg, inertia: [0, 1, 1]}
    joints:
      Hinge: {type: revolute, body1: ${base}, body2: Rod}
    instances:
      Tip: {group: Inner, parameters: {base: Rod}}
instances:
  A: {group: Outer}
  B: {group: Outer, parameters: {base: A_Tip_Rod}}
)";
  const Scene scene = load_text(nested, "test");
  std::vector<std::string> names;
  for (const multibody::BodyDef& body : scene.mechanics.bodies) names.push_back(body.relative_to + " " + body.name);
  EXPECT_EQ(names, (std::vector<std::string>{"Ground A_Rod", "A_Rod A_Tip_Rod", "A_Tip_Rod B_Rod", "B_Rod B_Tip_Rod"}));
  EXPECT_EQ(scene.mechanics.joints.at(3).body1, "B_Rod");
}

TEST(Groups, FaultsHaveTheirPlace) {
  const std::string group = "groups: {G: {parameters: {x: 1 m}, bodies: {Rod: {mass: 1 kg, inertia: [0, 1, 1]}}}}\n";
  EXPECT_EQ(problems_of(group + "instances: {A: {group: H}}\n"),
            "test:2:24: instances.A.group: there is no group 'H'; did you mean 'G'?");
  EXPECT_EQ(problems_of(group + "instances: {A: {prefix: H}}\n"),
            "test:2:13: instances.A: the key 'group' is missing; expected the name of a group");
  EXPECT_EQ(problems_of(group + "instances: {A: {group: G, parameters: {y: 2 m}}}\n"),
            "test:2:40: instances.A.parameters.y: 'G' has no parameter 'y'; did you mean 'x'?");
  EXPECT_EQ(problems_of(group + "instances: {A: {group: G, parametres: {x: 2 m}}}\n"),
            "test:2:27: instances.A.parametres: unknown key; expected group, prefix or parameters; did you mean "
            "'parameters'?");
  EXPECT_EQ(problems_of(group + "instances: {A: {group: G}, B: {group: G, prefix: A_}}\n"),
            "test:2:28: instances.B: another instance has an element 'A_Rod'; expected another prefix");
  EXPECT_EQ(problems_of("groups: {G: {session: {step: 1 ms}}}\ninstances: {A: {group: G}}\n"),
            "test:1:14: instances.A: a group has no section 'session'; expected sections of elements, parameters, "
            "templates, groups, instances, start or payload");
  EXPECT_EQ(problems_of("groups: {G: {instances: {I: {group: G}}}}\ninstances: {A: {group: G}}\n"),
            "test:1:26: instances.I: 'G' holds an instance of itself; expected another group");
  const std::string long_name = problems_of(group + "instances: {A23456789012345678901234567890: {group: G}}\n");
  EXPECT_NE(long_name.find("A23456789012345678901234567890_Rod: the name has 34 characters"), std::string::npos)
      << long_name;
}

// "billion laughs": ten of ten of ten ... instances
TEST(Groups, GrowthWithoutEndIsRefused) {
  std::string text = "groups:\n  G0: {bodies: {Rod: {mass: 1 kg, inertia: [0, 1, 1]}}}\n";
  for (int level = 1; level <= 7; ++level) {
    text += "  G" + std::to_string(level) + ":\n    instances:\n";
    for (int i = 0; i < 10; ++i) {
      text += "      I" + std::to_string(i) + ": {group: G" + std::to_string(level - 1) + "}\n";
    }
  }
  EXPECT_NE(problems_of(text + "instances: {A: {group: G7}}\n").find("there are more than 1000 instances"),
            std::string::npos);
  std::string deep = "groups:\n  G0: {bodies: {Rod: {mass: 1 kg, inertia: [0, 1, 1]}}}\n";
  for (int level = 1; level <= 9; ++level) {
    deep += "  G" + std::to_string(level) + ": {instances: {I: {group: G" + std::to_string(level - 1) + "}}}\n";
  }
  EXPECT_NE(problems_of(deep + "instances: {A: {group: G9, prefix: \"\"}}\n").find("instances are nested too deeply"),
            std::string::npos);
  // a template of templates of 50 keys each
  std::string wide = "templates:\n";
  for (int level = 0; level < 8; ++level) {
    wide += "  T" + std::to_string(level) + ": {use: [";
    for (int i = 0; level > 0 && i < 50; ++i) wide += (i > 0 ? ", T" : "T") + std::to_string(level - 1);
    wide += "], mass: 1 kg}\n";
  }
  EXPECT_NE(problems_of(wide + "bodies:\n  Rod: {use: T7}\n").find("bring in more than 200000 values"),
            std::string::npos);
}

// ---- includes

TEST(Includes, AFileWithAPrefixIsAGroupAndMayIncludeOthers) {
  const TemporaryFolder folder;
  folder.write("rod.yaml", R"(parameters: {base: Ground, L: 1 m}
bodies:
  Rod: {relative_to: ${base}, position: [${L}, 0, 0], mass: 1 kg, inertia: [0, 1, 1]}
joints:
  Hinge: {type: revolute, body1: ${base}, point1: [${L}, 0, 0], body2: Rod}
)");
  folder.write("pair.yaml",
               R"(include: [{file: rod.yaml, prefix: In_}, {file: rod.yaml, prefix: Out_, parameters: {base: In_Rod}}]
description: two rods in a row
)");
  const std::string path = folder.write("scene.yaml", R"(include:
  - {file: pair.yaml, prefix: Left_}
  - {file: rod.yaml, prefix: Right_, parameters: {L: "${2 * W}", base: Left_Out_Rod}}
  - settings.yaml
parameters: {W: 3 m}
bodies:
  Left_In_Rod: {mass: 5 kg}
)");
  folder.write("settings.yaml", "include: more.yaml\nsession: {duration: 3 s}\n");
  folder.write("more.yaml", "session: {duration: 2 s, step: 2 ms}\n");
  const Scene scene = load_file(path);
  EXPECT_EQ(scene.session.duration, 3);
  EXPECT_EQ(scene.session.step, 2e-3);
  std::vector<std::string> names;
  for (const multibody::BodyDef& body : scene.mechanics.bodies) names.push_back(body.relative_to + " " + body.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"Ground Left_In_Rod", "Left_In_Rod Left_Out_Rod", "Left_Out_Rod Right_Rod"}));
  EXPECT_EQ(scene.mechanics.bodies.at(0).mass, 5);
  EXPECT_EQ(scene.mechanics.bodies.at(2).position[0], 6);
  EXPECT_EQ(load_text(scene.expanded_text, "again").expanded_text.substr(12), scene.expanded_text.substr(12));
}

TEST(Includes, CirclesAndUnknownKeysAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.write("scene.yaml", "include: other.yaml\n" + kPendulum);
  folder.write("other.yaml", "include: ./scene.yaml\n");
  const std::string circle = refusal_of(path);
  EXPECT_NE(circle.find("other.yaml:1:10: include: './scene.yaml' includes itself; expected includes without a circle"),
            std::string::npos)
      << circle;
  const std::string keyed = folder.write("keyed.yaml", "include: {file: other.yaml, prefx: A_}\n");
  EXPECT_EQ(refusal_of(keyed),
            keyed +
                ":1:10: include: the key 'prefix' is missing or no text; expected such as {file: side.yaml, prefix: "
                "Left_}\n" +
                keyed + ":1:29: include.prefx: unknown key; expected file, prefix or parameters");
  folder.write("whole.yaml", "session: {step: 1 ms}\n");
  const std::string whole = folder.write("holder.yaml", "include: {file: whole.yaml, prefix: A_}\n" + kPendulum);
  const std::string refusal = refusal_of(whole);
  EXPECT_NE(refusal.find("include.whole.yaml: a group has no section 'session'"), std::string::npos) << refusal;
}

TEST(Includes, ElementsCanBeLeftOut) {
  const TemporaryFolder folder;
  folder.write("base.yaml", kPendulum +
                                "forces:\n  Push: {type: translational, body1: Ground, body2: Rod, point2: [1 m, 0, "
                                "0], point1: [0, 3 m, 0]}\n");
  const std::string path = folder.write("scene.yaml", "include: base.yaml\nwithout: Push\n");
  const Scene scene = load_file(path);
  EXPECT_TRUE(scene.mechanics.translational_forces.empty());
  EXPECT_EQ(scene.mechanics.bodies.size(), 1U);
  EXPECT_EQ(scene.expanded_text.find("without"), std::string::npos);
  // what is left out below can stand there again, otherwise
  const std::string again = folder.write("again.yaml", "include: base.yaml\nwithout: [Push, Rod, Hinge]\n" + kPendulum);
  EXPECT_EQ(load_file(again).mechanics.bodies.size(), 1U);
  const std::string typo = folder.write("typo.yaml", "include: base.yaml\nwithout: [Pusch]\n");
  EXPECT_EQ(refusal_of(typo),
            typo +
                ":2:11: without: the included files have no element 'Pusch'; expected an element of a "
                "file that is included without a prefix; did you mean 'Push'?");
  const std::string used = folder.write("used.yaml", "include: base.yaml\nwithout: Rod\n");
  EXPECT_NE(refusal_of(used).find("Rod"), std::string::npos);
  const std::string alone = folder.write("alone.yaml", "without: Push\n" + kPendulum);
  EXPECT_EQ(refusal_of(alone),
            alone + ":1:1: without: nothing is included; expected a file under `include` with the elements");
}

// the choice of an overlay left the key of a file two levels below unread: a warning, as over one level
TEST(Includes, LayersFollowTheOrderOfLayingOver) {
  const TemporaryFolder folder;
  folder.write("base.yaml", "session: {pace: real, overrun: hold, overrun_after: 3}\n" + kPendulum);
  folder.write("middle.yaml", "include: base.yaml\nsession: {pace: free}\n");
  const std::string path = folder.write("scene.yaml", "include: middle.yaml\n");
  EXPECT_EQ(refusal_of(path), "accepted");
  EXPECT_FALSE(load_file(path).warnings.empty());
}

}  // namespace language_test
}  // namespace slew::scene
