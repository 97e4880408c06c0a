// SPDX-License-Identifier: Apache-2.0
// CSV files of scripts and tables: common notations, and refused files.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "scene/script.h"
#include "scene_text.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace csv_test {

// one force along a rail, and a second one
const std::string kSlide =
    "bodies: {B: {mass: 1, inertia: [1, 1, 1]}}\n"
    "joints: {J: {type: prismatic, body2: B}}\n"
    "forces: {F: {type: point_force, body: B, force: 1}, G: {type: point_force, body: B, force: 1}}\n"
    "inputs: {Stick: {type: analog, primitive: F}, Lever: {type: analog, primitive: G, channel: 1}}\n";

class Csv : public ::testing::Test {
 protected:
  Scene load(const std::string& csv, const std::string& keys = "") const {
    folder_.write("t.csv", csv);
    return load_file(folder_.write("scene.yaml", kSlide + "script: {file: t.csv" + keys + "}\n"));
  }
  Table stick(const std::string& csv, const std::string& keys = "") const {
    const Scene scene = load(csv, keys);
    EXPECT_FALSE(scene.script.tracks.empty());
    return scene.script.tracks.empty() ? Table{} : scene.script.tracks.front().points;
  }

  // the problems of the script's file, without its folder
  std::string refusal(const std::string& csv, const std::string& keys = "") const {
    return problems([&] { (void)load(csv, keys); });
  }
  std::string refusal_of_table(const std::string& csv) const {
    folder_.write("t.csv", csv);
    return problems([&] { (void)load_file(table_scene("t.csv")); });
  }
  [[nodiscard]] std::string table_scene(const std::string& value) const {
    return folder_.write("scene.yaml",
                         "bodies: {B: {mass: 1, inertia: [1, 1, 1]}}\njoints: {J: {type: prismatic, body2: B}}\n"
                         "forces: {F: {type: point_force, body: B, force_table: " +
                             value + "}}\n");
  }

  TemporaryFolder folder_;

 private:
  template <typename Load>
  std::string problems(const Load& load_it) const {
    try {
      load_it();
    } catch (const LoadError& error) {
      std::string text = error.what();
      const std::string prefix = folder_.path() + "/";
      for (std::size_t at = 0; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
      // the first line names the value that names the file
      const std::size_t second = text.find('\n');
      return second == std::string::npos ? text : text.substr(second + 1);
    }
    return "accepted";
  }
};

const Table kRamp = {{0, 0}, {0.5, 1}, {2, -0.25}};

TEST_F(Csv, EverySeparatorAndDecimalMarkGivesTheSamePoints) {
  for (const char* csv :
       {"time,Stick\n0,0\n0.5,1\n2,-0.25\n", "time;Stick\n0;0\n0.5;1\n2;-0.25\n", "time;Stick\n0;0\n0,5;1\n2;-0,25\n",
        "time\tStick\n0\t0\n0.5\t1\n2\t-0.25\n", "time\tStick\n0\t0\n0,5\t1\n2\t-0,25\n",
        "\xEF\xBB\xBFsep=;\r\n\"time\";\"Stick\"\r\n0;0\r\n\"0,5\";1\r\n2;\"-0,25\"\r\n",
        "# of a stick\n\ntime [ms], Stick [%]\n0, 0\n500, 100\n2e3, -25\n",
        "Time [s];Stick [1];\n0;0;\n0,5;1;\n2;-,25;\n",
        "Stick,time [min]\n0,0\n1,0.00833333333333333333333\n-0.25,0.033333333333333333333\n"}) {
    EXPECT_EQ(stick(csv), kRamp) << csv;
  }
}

TEST_F(Csv, AQuotedCellMayHoldSeparatorsAndQuotes) {
  EXPECT_EQ(stick("time,\"a \"\"b\"\", c.d\",Stick\n0,,0\n0.5,\"7\",1\n2,,-0.25\n"), kRamp);
}

TEST_F(Csv, ASecondRowAtOneTimeIsAJump) {
  const Scene scene = load("time,Stick\n0,0\n1,0\n1,1\n2,1\n");
  const ScriptPlayer player(scene);
  EXPECT_EQ(player.value(0, {999'999'999}), 0.0);
  EXPECT_EQ(player.value(0, {1'000'000'000}), 1.0);
  // in the scene's own text as well, whose reading gives the same
  EXPECT_EQ(load_text(scene.expanded_text, "scene").script.tracks[0].points, scene.script.tracks[0].points);
}

TEST_F(Csv, RecordedValuesOneStepApartAreHeldAsTicksHeldThem) {
  EXPECT_EQ(stick("time,Stick.raw\n0,0\n0.001,0.5\n0.002,0.5\n0.003,1\n0.5,-1\n"),
            (Table{{0, 0}, {0.001, 0}, {0.001, 0.5}, {0.002, 0.5}, {0.003, 0.5}, {0.003, 1}, {0.5, -1}}));
  // neither for a written point, nor for an existing jump
  EXPECT_EQ(stick("time,Stick\n0,0\n0.001,0.5\n"), (Table{{0, 0}, {0.001, 0.5}}));
  EXPECT_EQ(stick("time,Stick.raw\n0,0\n0.001,0.5\n0.001,1\n"), (Table{{0, 0}, {0.001, 0.5}, {0.001, 1}}));
}

TEST_F(Csv, AnEmptyCellIsNoPointOfItsColumn) {
  const Scene scene = load("time,Stick,Lever\n0,0,\n0.5,1,1\n1,,0\n2,-0.25,\n");
  ASSERT_EQ(scene.script.tracks.size(), 2u);
  EXPECT_EQ(scene.script.tracks[0].points, kRamp);
  EXPECT_EQ(scene.script.tracks[1].points, (Table{{0, 0}, {0.5, 0}, {0.5, 1}, {1, 0}}));
}

TEST_F(Csv, ARecordThatBeginsLateLeavesItsInputsNeutralUntilThen) {
  const Scene scene = load("time,Stick,Lever\n2,0.5,0\n3,1,1\n");
  const ScriptPlayer player(scene);
  EXPECT_EQ(player.value(0, {0}), 0.0);
  EXPECT_EQ(player.value(0, {1'999'999'999}), 0.0);
  EXPECT_EQ(player.value(0, {2'000'000'000}), 0.5);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "script.file: 't.csv' begins at 2 s; Stick is neutral before");
}

TEST_F(Csv, OfAnExportTheInputsAreTakenAndTheRestIsNamed) {
  const Scene scene =
      load("time [s],Stick.raw [1],B.position.x [m],B.position.y [m]\n0,0,1,NaN\n0.5,1,,\n2,-0.25,3,4\n");
  ASSERT_EQ(scene.script.tracks.size(), 1u);
  EXPECT_EQ(scene.script.tracks[0].input, "Stick");
  EXPECT_EQ(scene.script.tracks[0].points, kRamp);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "script.file: 2 columns of 't.csv' are no input and were not taken (B.position.x, ...)");
}

TEST_F(Csv, ListedColumnsAreTakenAlone) {
  const char* csv = "time,Lever,Stick,Oil [degC],Oil [degC]\n0,0,0,x,\n0.5,9,1,,\n2,,-0.25,40,41\n";
  EXPECT_EQ(load(csv, ", columns: [Stick]").script.tracks.size(), 1u);
  EXPECT_EQ(stick(csv, ", columns: [Stick]"), kRamp);
  EXPECT_EQ(refusal(csv, ", columns: [Stock]"), "t.csv:1:1: no column 'Stock'; did you mean 'Stick'?");
  EXPECT_EQ(refusal(csv, ", columns: [Oil]"),
            "t.csv:1:18: no input 'Oil'; expected an input of the scene: Stick, Lever\nt.csv:1:29: no input 'Oil'; "
            "expected an input of the scene: Stick, Lever");
}

TEST_F(Csv, AScriptFileWithoutAValueIsRefusedWithWhatItLacks) {
  EXPECT_EQ(refusal(""), "t.csv:1:1: the file is empty; expected a header such as 'time [s],Stick'");
  EXPECT_EQ(refusal("\n \n\n# nothing\n"), "t.csv:1:1: the file is empty; expected a header such as 'time [s],Stick'");
  EXPECT_EQ(refusal("time,Stick\n"), "t.csv:1:1: the file has a header and no rows; expected a line for each time");
  EXPECT_EQ(refusal("time,Stick\n\n  \n"),
            "t.csv:1:1: the file has a header and no rows; expected a line for each time");
  EXPECT_EQ(refusal("time,Stick,Lever\n0,,0\n1,,1\n"),
            "t.csv:1:6: the column 'Stick' has no values; expected a value in some row");
  EXPECT_EQ(refusal("0,0\n1,1\n"),
            "t.csv:1:1: the file begins with the number '0'; expected a header such as 'time [s],Stick'");
  EXPECT_EQ(refusal("Stick,Lever\n0,0\n"),
            "t.csv:1:1: no column of the header is 'time'; expected a header such as 'time [s],Stick'");
  EXPECT_EQ(refusal("time\n0\n"),
            "t.csv:1:1: no column is named after an input of the scene; expected a column for an input");
  EXPECT_EQ(refusal("time,\"Stick\n0,0\n"), "t.csv:1:6: this quote is not closed in its line; expected a second \"");
  EXPECT_EQ(refusal("time,,Stick\n0,0,0\n"),
            "t.csv:1:6: a column has no name; expected a name in every cell of the header");
  EXPECT_EQ(refusal("time,Stick,Stick.raw\n0,0,0\n"), "t.csv:1:12: two columns are for 'Stick'; expected one of them");
  EXPECT_EQ(refusal("time,Stick,Stick\n0,0,0\n"), "t.csv:1:12: 'Stick' is there twice; expected one column for a name");
  EXPECT_EQ(refusal("time,Stik.raw,B.position.x\n0,0,0\n"), "t.csv:1:6: no input 'Stik'; did you mean 'Stick'?");
  EXPECT_EQ(refusal("time [bar],Stick\n0,0\n"),
            "t.csv:1:1: 'bar' is a pressure; expected a time such as '10 ms', or "
            "a bare number in s");
}

TEST_F(Csv, EveryBadRowIsNamedWithItsPlace) {
  EXPECT_EQ(refusal("time,Stick\n0,0\nx,0\n1,NaN\n2,inf\n3,1.5\n4,\"a\"\n5,0,0\n4.5,0\n,0\n"),
            "t.csv:3:1: 'x' is not a number\n"
            "t.csv:4:3: 'NaN' is not finite; expected a finite number\n"
            "t.csv:5:3: 'inf' is not finite; expected a finite number\n"
            "t.csv:6:3: value '1.5' is out of range; expected -1 to 1\n"
            "t.csv:7:3: 'a' is not a number\n"
            "t.csv:8:1: the line has 3 cells; expected 2 as in the header\n"
            "t.csv:10:1: the cell is empty; expected a number");
  EXPECT_EQ(refusal("time,Stick\n1,0\n0.5,0\n"),
            "t.csv:3:1: time '0.5' lies before that of the row above; expected "
            "times that do not fall; two rows at one time are a jump");
  EXPECT_EQ(refusal("time,Stick\n1,0\n1,1\n1,0\n"),
            "t.csv:4:1: time '1' stands in a third row; expected times that do "
            "not fall; two rows at one time are a jump");
  EXPECT_EQ(refusal("time,Stick\n-1,0\n"), "t.csv:2:1: time '-1' is out of range; expected 0 to 1000000 s");
  EXPECT_EQ(refusal("time;Stick\n0,5;0\n1.5;1\n"),
            "t.csv:3:1: '1.5' has a decimal point, the number in line 2 a decimal "
            "comma; expected one kind of decimal mark in a file");
  EXPECT_EQ(refusal("time;Stick\n1.000,5;0\n"),
            "t.csv:2:1: '1.000,5' is not a plain number; expected one decimal mark, no thousands");
  EXPECT_EQ(refusal("time,Stick\n0,5,0,1\n"),
            "t.csv:2:1: the line has 4 cells; expected 2 as in the header; decimal "
            "commas need ';' or tabs between cells");
}

TEST_F(Csv, ATableFileWithoutAValueIsRefusedWithWhatItLacks) {
  const std::string example = "expected a header such as 'deflection [mm], force [kN]'";
  EXPECT_EQ(refusal_of_table(""), "t.csv:1:1: the file is empty; " + example);
  EXPECT_EQ(refusal_of_table("time [s],F [N]\n\n"),
            "t.csv:1:1: the file has a header and no points; expected a line for each point");
  EXPECT_EQ(refusal_of_table("time [s],F [N]\n0,\n1,\n"), "t.csv:2:3: the cell is empty; expected a number");
  EXPECT_EQ(refusal_of_table("time [s],F [N]\n0,1\n1,2\n1,3\n"),
            "t.csv:4:1: '1' does not lie behind the line before it; expected increasing arguments");
  EXPECT_EQ(refusal_of_table("time [s],F [N]\n0,nan\n"), "t.csv:2:3: 'nan' is not finite; expected a finite number");
}

TEST_F(Csv, AForceTableTakesTwoNamedColumnsInTheirUnits) {
  folder_.write("log.csv", "n;t [ms];F1 [kN];note\n1;0;0,5;a\n2;100;1,5;\n");
  const Scene scene = load_file(table_scene("{file: log.csv, columns: [t, F1]}"));
  EXPECT_EQ(scene.mechanics.point_forces.front().force_table, (Table{{0, 500}, {0.1, 1500}}));
  EXPECT_TRUE(scene.table_files.empty());
  EXPECT_EQ(load_text(scene.expanded_text, "scene").expanded_text, scene.expanded_text);
}

// 10 N at 0.5 s, however the header states its unit
TEST_F(Csv, AUnitInBracketsCountsWhereverItStands) {
  const Table in_newton = {{0, 0}, {0.5, 10}};
  for (const char* header : {"t [s],f [kN]", "t (s),f (kN)", "t [s],f [kN] filtered", "t [s] of the rig,f (kN) left",
                             "t (s),f( kN )", "t [ s ],f/(kN)", "t,f (left) [kN]", "t,[kN] f", "t,(kN)"}) {
    folder_.write("t.csv", std::string(header) + "\n0,0\n0.5,0.01\n");
    const Scene scene = load_file(table_scene("t.csv"));
    EXPECT_EQ(scene.mechanics.point_forces.front().force_table, in_newton) << header;
  }
  EXPECT_EQ(stick("time (ms), Stick (%) of the cab\n0, 0\n500, 100\n2e3, -25\n"), kRamp);
}

TEST_F(Csv, TheNameOfAColumnIsWhatStandsBeforeItsUnit) {
  const Table in_newton = {{0, 0}, {0.5, 10}};
  const std::pair<const char*, const char*> cases[] = {{"f [kN] filtered", "f"},
                                                       {"f left (kN) filtered", "f left"},
                                                       {"f (left) [kN]", "f (left)"},
                                                       {"f (P) [kN]", "f (P)"},
                                                       {"f/(kN)", "f"},
                                                       {"\"f, left [kN]\"", "'f, left'"}};
  for (const auto& [header, name] : cases) {
    folder_.write("t.csv", std::string("n [],t [s],") + header + "\n1,0,0\n2,0.5,0.01\n");
    const Scene scene = load_file(table_scene(std::string("{file: t.csv, columns: [t, ") + name + "]}"));
    EXPECT_EQ(scene.mechanics.point_forces.front().force_table, in_newton) << header;
  }
  // names without a unit are of SI
  for (const char* header : {"t,f", "s,N", "t,force_N", "t,f filtered", "time_of_s,n_A"}) {
    folder_.write("t.csv", std::string(header) + "\n0,0\n0.5,10\n");
    EXPECT_EQ(load_file(table_scene("t.csv")).mechanics.point_forces.front().force_table, in_newton) << header;
  }
}

TEST_F(Csv, AUnitThatDoesNotCountIsRefused) {
  const auto refusal_of = [&](const char* header) {
    return refusal_of_table(std::string("t [s],") + header + "\n0,0\n0.5,0.01\n");
  };
  const std::string expected =
      "; expected a name and one unit in brackets behind it, such as 'f [UNIT]', or the name alone for SI";
  EXPECT_EQ(refusal_of("f []"), "t.csv:1:7: the header 'f []' has no unit in its brackets" + expected);
  EXPECT_EQ(refusal_of("f ()"), "t.csv:1:7: the header 'f ()' has no unit in its brackets" + expected);
  for (const char* header : {"f [N] [kN]", "f (N) [kN]", "f (N) (kN)"}) {
    EXPECT_EQ(refusal_of(header),
              std::string("t.csv:1:7: the header '") + header + "' has two parts in brackets" + expected);
  }
  for (const char* header : {"f [N]/1000", "f [N] * 9.81", "f (N) x 1000", "f [N] - 5", "f [N]^2", "f [kN]2"}) {
    EXPECT_EQ(refusal_of(header), std::string("t.csv:1:7: the header '") + header +
                                      "' goes on with a calculation behind the unit" + expected);
  }
  for (const char* header : {"f kN", "f/kN", "f {kN}", "f <kN>", "f in kN:", "f_kN"}) {
    const std::string refused = refusal_of(header);
    EXPECT_NE(refused.find(std::string("t.csv:1:7: the unit 'kN' in the header '") + header +
                           "' stands in no brackets; expected 'f"),
              std::string::npos)
        << refused;
  }
  EXPECT_NE(refusal_of("kN").find("the unit 'kN' in the header 'kN'"), std::string::npos);
  EXPECT_NE(refusal_of("f N").find("the unit 'N' in the header 'f N'"), std::string::npos);
  EXPECT_EQ(
      refusal_of("f (kn)"),
      "t.csv:1:7: what stands in the brackets of the header 'f (kn)' is no unit; expected a force such as '1 kN', "
      "or a bare number in N; a remark stands in no brackets");
  EXPECT_NE(refusal_of("f (mm)").find("'mm' is a length"), std::string::npos);
  EXPECT_NE(refusal("time (s),Stick %\n0,0\n1,1\n").find("no input 'Stick %'"), std::string::npos);
}

TEST_F(Csv, TwoColumnsOfOneNameAreNoChoice) {
  folder_.write("t.csv", "t [s],f [kN] raw,f [kN] filtered\n0,0,0\n1,1,1\n");
  try {
    (void)load_file(table_scene("{file: t.csv, columns: [t, f]}"));
    ADD_FAILURE() << "accepted";
  } catch (const LoadError& error) {
    EXPECT_NE(std::string(error.what()).find("'f [kN] raw' and 'f [kN] filtered' are both named 'f'"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(Csv, AFileElsewhereIsNotRead) {
  const std::string elsewhere =
      "t.csv' lies outside of the scene's folder and was not read; expected a file in that "
      "folder or below";
  for (const std::string value : {"../t.csv", "/t.csv", "a/../../t.csv"}) {
    const std::string path = folder_.write("scene.yaml", kSlide + "script: {file: " + value + "}\n");
    try {
      (void)load_file(path);
      ADD_FAILURE() << value;
    } catch (const LoadError& error) {
      EXPECT_NE(std::string(error.what()).find(elsewhere), std::string::npos) << error.what();
      EXPECT_EQ(error.diagnostics().size(), 1u);
    }
  }
}

}  // namespace csv_test
}  // namespace slew::scene
