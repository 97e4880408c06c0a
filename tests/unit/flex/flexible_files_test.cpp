// SPDX-License-Identifier: Apache-2.0
// Flexible files: the same bits back, and every fault named with file and line.
#include "flex/flexible_files.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/flex_beams.h"
#include "tests/support/temporary_folder.h"

namespace slew::flex {
namespace flexible_files_test {

using namespace testing;
using slew::testing::TemporaryFolder;

Reduction small_reduction() {
  ReductionDef def = with_modes(2);
  def.stiffening = GeometricStiffening::straight_beam;
  return reduce(build_beam(jib_boom(4)), def);
}

void expect_same(math::Vec3 a, math::Vec3 b) {
  const auto left = a.array(), right = b.array();
  EXPECT_EQ(std::memcmp(left.data(), right.data(), sizeof left), 0);
}

void expect_same(const math::Mat3& a, const math::Mat3& b) {
  for (int i = 0; i < 3; ++i) expect_same(a.c[i], b.c[i]);
}

template <typename T>
void expect_same(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), 8 * a.size()), 0);
}

void expect_same(const Reduction& a, const Reduction& b) {
  EXPECT_EQ(a.source.made_of, b.source.made_of);
  EXPECT_EQ(a.source.clamped_nodes, b.source.clamped_nodes);
  EXPECT_EQ(a.source.interface_nodes, b.source.interface_nodes);
  EXPECT_EQ(a.source.interior_freedoms, b.source.interior_freedoms);
  EXPECT_EQ(a.source.stiffening, b.source.stiffening);
  EXPECT_EQ(a.source.attachment, b.source.attachment);
  expect_same({a.body.mass}, std::vector<double>{b.body.mass});
  expect_same(a.body.s0, b.body.s0);
  expect_same(a.body.W0, b.body.W0);
  expect_same(a.body.omega, b.body.omega);
  expect_same(a.body.C, b.body.C);
  expect_same(a.body.Z, b.body.Z);
  expect_same(a.body.Y, b.body.Y);
  expect_same(a.body.G, b.body.G);
  expect_same(a.body.H, b.body.H);
  expect_same(a.body.K, b.body.K);
  ASSERT_EQ(a.body.nodes.size(), b.body.nodes.size());
  for (std::size_t i = 0; i < a.body.nodes.size(); ++i) {
    EXPECT_EQ(a.body.nodes[i].id, b.body.nodes[i].id);
    expect_same(a.body.nodes[i].position, b.body.nodes[i].position);
    expect_same(a.body.nodes[i].phi, b.body.nodes[i].phi);
    expect_same(a.body.nodes[i].psi, b.body.nodes[i].psi);
    expect_same(a.body.nodes[i].g, b.body.nodes[i].g);
  }
  ASSERT_EQ(a.recovery.points.size(), b.recovery.points.size());
  for (std::size_t i = 0; i < a.recovery.points.size(); ++i) {
    EXPECT_EQ(a.recovery.points[i].node, b.recovery.points[i].node);
    EXPECT_EQ(a.recovery.points[i].y, b.recovery.points[i].y);
    EXPECT_EQ(a.recovery.points[i].has_shear, b.recovery.points[i].has_shear);
  }
  expect_same(a.recovery.normal, b.recovery.normal);
  expect_same(a.recovery.shear, b.recovery.shear);
}

TEST(FlexibleFiles, WhatIsReadHasTheBitsOfWhatWasWritten) {
  const TemporaryFolder folder("flex_files");
  const FlexibleFileSet set{folder.path(), "Truck_JibBoom", "beam_hard"};
  ReductionDef free = with_modes(3, Attachment::free);
  const FeModel model = build_beam(jib_boom(6));
  const std::vector<int> two = {1, 4};
  for (const Reduction& reduction : {small_reduction(), reduce(model, free), select(small_reduction(), two)}) {
    write_flexible_files(set, reduction);
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "Truck_JibBoom_beam_hard_Frequencies.dat"));
    expect_same(read_flexible_files(set), reduction);
  }
}

class FaultyFiles : public ::testing::Test {
 protected:
  FaultyFiles() { write_flexible_files(set_, small_reduction()); }

  // error after replacing the first `from` in the file by `to`
  std::string changed(const std::string& matrix, const std::string& from, const std::string& to) {
    write_flexible_files(set_, small_reduction());
    const std::string name = "M_F_" + matrix + ".dat";
    std::string text = folder_.read(name);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    (void)folder_.write(name, text);
    return error();
  }
  std::string error() {
    std::string text = error_of([&] { (void)read_flexible_files(set_); });
    const std::string path = folder_.path().string() + "/";
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path)) text.erase(at, path.size());
    return text;
  }

  TemporaryFolder folder_{"flex_faulty"};
  FlexibleFileSet set_{folder_.path(), "M", "F"};
};

TEST_F(FaultyFiles, MissingFileIsNamed) {
  std::filesystem::remove(folder_.path() / "M_F_Inertia.dat");
  EXPECT_EQ(error(),
            "M_F_Inertia.dat: the file is missing; expected the 9 files M_F_*.dat of a set; copy the whole set, or "
            "write it again");
}

TEST_F(FaultyFiles, FilesOfTwoSetsAreRefused) {
  const std::string frequencies = folder_.read("M_F_Frequencies.dat");
  write_flexible_files(set_, reduce(build_beam(jib_boom(4, 2e10)), with_modes(2)));
  (void)folder_.write("M_F_Frequencies.dat", frequencies);
  EXPECT_NE(error().find("M_F_Frequencies.dat:1: the file is of the set "), std::string::npos);
  EXPECT_NE(error().find("the files do not belong together"), std::string::npos);
}

TEST_F(FaultyFiles, HeadersAreChecked) {
  EXPECT_NE(
      changed("Nodes", "slewring-flexible 2", "something").find("M_F_Nodes.dat:1: the first line is 'something Nodes"),
      std::string::npos);
  EXPECT_NE(changed("Nodes", "slewring-flexible 2", "slewring-flexible 1").find("the format has version 1; expected 2"),
            std::string::npos);
  EXPECT_NE(changed("Nodes", " Nodes ", " Modes ").find("M_F_Nodes.dat:1: the file holds Modes; expected Nodes"),
            std::string::npos);
  EXPECT_NE(changed("Nodes", "rows=4", "rows=5").find("M_F_Nodes.dat:1: the header states 5 rows; expected 4"),
            std::string::npos);
  EXPECT_NE(changed("Modes", "columns=8", "columns=9").find("M_F_Modes.dat:1: the header states 9 columns; expected 8"),
            std::string::npos);
  EXPECT_NE(changed("Modes", "set=", "sat=").find("the header has no set="), std::string::npos);
  EXPECT_NE(changed("Modes", "rows=32", "rows=x").find("'x' is no whole number"), std::string::npos);
}

TEST_F(FaultyFiles, RowsAreChecked) {
  EXPECT_NE(changed("Elements", "\n2 2 3", "\n2 2 33").find("node 33; expected one of this body"), std::string::npos);
  EXPECT_NE(changed("Elements", "\n2 2 3", "\n2 2 2").find("an element without length"), std::string::npos);
  EXPECT_NE(changed("Elements", "\n2 2 3 ", "\n2 2 3 -").find("in column 4; expected a number > 0"), std::string::npos);
  EXPECT_NE(changed("Elements", "rows=3", "rows=2").find("expected 3, as in Source"), std::string::npos);
  EXPECT_NE(changed("Frequencies", "\n2 ", "\n2 nan\n#")
                .find("M_F_Frequencies.dat:4: nan is not finite; expected a finite number"),
            std::string::npos);
  EXPECT_NE(changed("Frequencies", "\n2 ", "\n2 1e\n#").find("'1e' is no number"), std::string::npos);
  EXPECT_NE(changed("Frequencies", "\n2 ", "\n2 1.0\n#").find("after"), std::string::npos);
  EXPECT_NE(changed("Frequencies", "\n2 ", "\n3 ").find("mode 3; expected mode 2"), std::string::npos);
  EXPECT_NE(changed("Nodes", "\n2 ", "\n1 ").find("node 1 is given twice"), std::string::npos);
  EXPECT_NE(changed("Inertia", "\ns0 ", "\nC ").find("a row of 'C'; expected one of 's0'"), std::string::npos);
  EXPECT_NE(changed("Inertia", "\nmass 0 0 ", "\nmass 0 0 -").find("a mass of -"), std::string::npos);
  EXPECT_NE(changed("Stiffness", " 0.0000000000000000e+00 ", " 1.0 ").find("the elements (2, 1) and (1, 2) differ"),
            std::string::npos);
  EXPECT_NE(changed("Recovery", "\n1 1 ", "\n9 1 ").find("element 9, node 1; expected one of this body"),
            std::string::npos);
  EXPECT_NE(changed("Nodes", "\n2 ", "\n2 7 ").find("M_F_Nodes.dat:4: 5 words; expected 4 of Nodes"),
            std::string::npos);
  EXPECT_NE(changed("Source", "\nattachment clamped", "\nattachment glued")
                .find("attachment is 'glued'; expected clamped or free"),
            std::string::npos);
  EXPECT_NE(changed("Source", "\nattachment clamped", "\nremark none").find("there is no 'attachment'"),
            std::string::npos);
  EXPECT_NE(changed("Source", "\nmodes 8", "\nmodes 7").find("expected 7"), std::string::npos);
}

TEST_F(FaultyFiles, EveryCutIsNoticed) {
  for (const std::string& matrix : flexible_matrices()) {
    write_flexible_files(set_, small_reduction());
    const std::string name = "M_F_" + matrix + ".dat", text = folder_.read(name);
    for (const double share : {0.0, 0.02, 0.3, 0.7, 0.95}) {
      (void)folder_.write(name, text.substr(0, static_cast<std::size_t>(share * static_cast<double>(text.size()))));
      EXPECT_NE(error().find(name), std::string::npos) << matrix << ' ' << share;
    }
    (void)folder_.write(name, text + text.substr(text.rfind('\n', text.size() - 2) + 1));
    EXPECT_NE(error().find("there are more rows"), std::string::npos) << matrix;
  }
}

TEST_F(FaultyFiles, ModelsThatShareTheirFilesNamesAreDistinguished) {
  const Reduction r = small_reduction();
  const FlexibleFileSet own{folder_.path(), "a", "b_c"}, other{folder_.path(), "a_b", "c"};
  write_flexible_files(own, r);
  const std::string before = folder_.read("a_b_c_Source.dat");
  const std::string written = error_of([&] { write_flexible_files(other, r); });
  EXPECT_NE(written.find("this is of model 'a', prefix 'b_c'; expected model 'a_b', prefix 'c'; nothing was written"),
            std::string::npos)
      << written;
  EXPECT_EQ(folder_.read("a_b_c_Source.dat"), before);
  const std::string read = error_of([&] { (void)read_flexible_files(other); });
  EXPECT_NE(read.find("the files are of model 'a', prefix 'b_c'; expected model 'a_b', prefix 'c'"), std::string::npos)
      << read;
  EXPECT_EQ(find_flexible_files(folder_.path() / "a_b_c").prefix, "b_c");
  expect_same(read_flexible_files(find_flexible_files(folder_.path() / "a_b_c")), r);
}

TEST_F(FaultyFiles, ASetIsFoundByTheBeginningOfItsFiles) {
  EXPECT_EQ(find_flexible_files(folder_.path() / "M_F").model, "M");
  // a set without owner in Source, and one with renamed files
  EXPECT_EQ(changed("Source", "\nfiles M F\n", "\nremark M F\n"), "");
  EXPECT_EQ(find_flexible_files(folder_.path() / "M_F").prefix, "F");
  for (const std::string& matrix : flexible_matrices())
    std::filesystem::rename(folder_.path() / ("M_F_" + matrix + ".dat"), folder_.path() / ("N_G_" + matrix + ".dat"));
  EXPECT_EQ(find_flexible_files(folder_.path() / "N_G").prefix, "G");
  EXPECT_EQ(error_of([&] { (void)read_flexible_files({folder_.path(), "N", "G"}); }), "");
  EXPECT_NE(
      error_of([&] { (void)find_flexible_files(folder_.path() / "M_F"); }).find("M_F_Source.dat: the file is missing"),
      std::string::npos);
}

TEST_F(FaultyFiles, AWriteThatFailsLeavesTheOldSet) {
  std::vector<std::string> before;
  for (const std::string& matrix : flexible_matrices()) before.push_back(folder_.read("M_F_" + matrix + ".dat"));
  const Reduction other = reduce(build_beam(jib_boom(5)), with_modes(2));
  // in the way of the sixth file
  std::filesystem::create_directory(folder_.path() / "M_F_Stiffness.dat.new");
  EXPECT_NE(error_of([&] { write_flexible_files(set_, other); }).find("cannot be written"), std::string::npos);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) files += entry.is_regular_file();
  EXPECT_EQ(files, flexible_matrices().size());
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(folder_.read("M_F_" + flexible_matrices()[i] + ".dat"), before[i]);
  EXPECT_EQ(error(), "");
}

TEST_F(FaultyFiles, NamesThatNoFileCanHaveAreRefused) {
  const Reduction r = small_reduction();
  const auto text = [&](const std::string& model, const std::string& prefix) {
    return error_of([&] { write_flexible_files({folder_.path(), model, prefix}, r); });
  };
  EXPECT_NE(text("a/b", "F").find("the model's name 'a/b'"), std::string::npos);
  EXPECT_NE(text("M", "F/1").find("the prefix 'F/1'"), std::string::npos);
  EXPECT_NE(text("M", "").find("the prefix ''"), std::string::npos);
  EXPECT_NE(error_of([&] {
              write_flexible_files({folder_.path() / "nowhere", "M", "F"}, r);
            }).find("cannot be written"),
            std::string::npos);
}

}  // namespace flexible_files_test
}  // namespace slew::flex
