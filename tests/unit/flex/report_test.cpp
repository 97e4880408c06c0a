// SPDX-License-Identifier: Apache-2.0
// The report's figures and its text, and the picture of mode shapes.
#include <gtest/gtest.h>

#include "flex/attachment_comparison.h"
#include "flex/mode_shape_plot.h"
#include "flex/reduction_report.h"
#include "tests/support/flex_beams.h"

namespace slew::flex {
namespace report_test {

using namespace testing;

TEST(ReductionReport, FiguresAreThoseOfTheBody) {
  const FeModel model = build_beam(jib_boom());
  const ReductionDef def = with_modes(10);
  const std::vector<int> kept = {1, 2};
  const ReductionReport report = report_reduction(model, def, reduce(model, def), kept);
  EXPECT_EQ(report.freedoms, 234);
  EXPECT_EQ(report.held_freedoms, 6);
  EXPECT_EQ(report.source.boundary_freedoms, 6);
  EXPECT_EQ(report.source.interior_freedoms, 222);
  ASSERT_EQ(report.modes.size(), 16u);
  double all = 0;
  for (const ModeFigures& mode : report.modes) {
    EXPECT_EQ(mode.is_kept, mode.ordinal <= 2);
    EXPECT_GE(mode.relative_error, -1e-10) << "a reduced model is never softer";
    all += mode.effective_mass[1];
  }
  EXPECT_LT(report.modes[0].relative_error, 2e-5);
  // first bending mode of a uniform cantilever: 61.3 % of the mass
  EXPECT_NEAR(report.kept_effective_mass[1] / report.full_mass.mass, 0.613, 0.003);
  EXPECT_LT(all, report.full_mass.mass);
  EXPECT_GT(all, 0.9 * report.full_mass.mass);
  EXPECT_NEAR(report.reduced_mass.mass, report.full_mass.mass, 1e-10);
}

TEST(ReductionReport, EffectiveMassesOfAllModesAreTheMassThatMoves) {
  const FeModel model = build_beam(jib_boom(5));
  const ReductionDef def = with_modes(18);
  const ReductionReport report = report_reduction(model, def, reduce(model, def), {});
  // all modes there are: C^T C = rows of the held model, R^T M M_ff^-1 M R: below the mass by the held part only
  for (const double mass : report.kept_effective_mass) {
    EXPECT_GT(mass, 0.85 * report.full_mass.mass);
    EXPECT_LT(mass, report.full_mass.mass);
  }
}

TEST(ReductionReport, TextListsWhatIsKeptAndReached) {
  const FeModel model = build_beam(jib_boom());
  const ReductionDef def = with_modes(4);
  const std::vector<int> kept = {1, 2};
  const std::string text = text_of(report_reduction(model, def, reduce(model, def), kept));
  for (const char* part :
       {"Truck_JibBoom: beam of 20 nodes and 19 elements", "body frame clamped at node 1",
        "6 held, 6 of interfaces, 222 inside", "10 modes from 6 of the interfaces and 4 inside; 2 kept", "   1 kept",
        "   3 dropped", "static compliance of node 20 with node 1 held", "effective mass"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(ReductionReport, OfFilesHasTheSameFiguresOfTheReducedBody) {
  const FeModel model = build_beam(jib_boom());
  for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
    const ReductionDef def = with_modes(10, attachment);
    const Reduction all = reduce(model, def);
    const std::vector<int> kept = {1, 2, 3, 4};
    const ReductionReport whole = report_reduction(model, def, all, kept), files = report_files(all, kept);
    EXPECT_FALSE(files.has_model);
    ASSERT_EQ(files.modes.size(), whole.modes.size());
    ASSERT_EQ(files.compliance.size(), 3u);
    for (std::size_t a = 0; a < 3; ++a) {
      // loads at interfaces are statically exact with all modes
      EXPECT_NEAR(files.compliance[a].full / whole.compliance[a].full, 1, 1e-8);
      EXPECT_NEAR(files.compliance[a].share(), whole.compliance[a].share(), 1e-8);
      EXPECT_EQ(files.kept_effective_mass[a], whole.kept_effective_mass[a]);
    }
    const std::string text = text_of(files);
    EXPECT_EQ(text.find("whole model"), std::string::npos) << text;
    EXPECT_NE(text.find("4 kept"), std::string::npos) << text;
  }
}

TEST(ReductionReport, ASelectionOfFilesWithoutRotationsHasNoCompliance) {
  const FeModel model = build_beam(jib_boom(4));
  Reduction all = reduce(model, with_modes(2, Attachment::free));
  for (ReducedNode& node : all.body.nodes) node.psi.assign(all.body.modes(), {});
  EXPECT_TRUE(report_files(all, {}).compliance.empty());
}

TEST(ReductionReport, SummaryListsWhatTheLowestModesReach) {
  const FeModel model = build_beam(jib_boom());
  const Reduction all = reduce(model, with_modes(10));
  const std::string text = summary_of(all, tip_compliance(model, all));
  for (const char* part : {"mass 127.55", "16 modes: 8.1", "static compliance of node 20", "modes 1 to 2 ",
                           "modes 1 to 16   reach 100.00, 100.00, 100.00 %"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

// issue of the choice: one bending mode a plane reaches half of the compliance free, nearly all of it clamped
TEST(AttachmentComparison, IsTheSameFromBothSides) {
  const FeModel model = build_beam(jib_boom());
  const std::vector<int> kept = {1, 2};
  ReductionDef clamped = with_modes(10), free = with_modes(10, Attachment::free);
  const AttachmentComparison a = compare_attachments(model, clamped, reduce(model, clamped), kept);
  const AttachmentComparison b = compare_attachments(model, free, reduce(model, free), kept);
  ASSERT_EQ(a.rows.size(), 4u);
  ASSERT_EQ(b.rows.size(), 4u);
  EXPECT_EQ(a.reference_nodes, std::vector<int>{1});
  EXPECT_EQ(b.reference_nodes, std::vector<int>{1});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(a.rows[i].modes, b.rows[i].modes);
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_NEAR((*a.rows[i].clamped)[d], (*b.rows[i].clamped)[d], 1e-9);
      EXPECT_NEAR((*a.rows[i].free)[d], (*b.rows[i].free)[d], 1e-9);
    }
  }
  EXPECT_NEAR((*a.rows[0].clamped)[1], 0.969, 0.001);
  EXPECT_NEAR((*a.rows[0].free)[1], 0.504, 0.001);
  EXPECT_NEAR((*a.rows[1].clamped)[2], 0.995, 0.001);
  EXPECT_NEAR((*a.rows[3].free)[0], 1, 1e-9);
}

TEST(AttachmentComparison, ReportsWhyThereIsNone) {
  const FeModel model = build_beam(jib_boom(4));
  ReductionDef def = with_modes(2, Attachment::free);
  def.modes.interface_nodes = {2};
  const AttachmentComparison comparison = compare_attachments(model, def, reduce(model, def), {});
  EXPECT_TRUE(comparison.rows.empty());
  EXPECT_NE(text_of(comparison).find("not available, the body has no second interface node"), std::string::npos);
}

TEST(ModeShapePlot, HasAPanelForEveryModeAndNoLooseEnds) {
  const Reduction r = reduce(build_beam(jib_boom()), with_modes(4));
  const std::vector<int> modes = {1, 2, 3};
  const std::string svg = mode_shape_svg(r, modes);
  const auto count = [&](const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("class='box'"), 3u);
  EXPECT_EQ(count("<polyline class='moved'"), 6u);
  EXPECT_EQ(count("<polyline class='rest'"), 6u);
  EXPECT_EQ(count("<svg"), 1u);
  EXPECT_EQ(count("nan"), 0u);
  EXPECT_NE(svg.find("Mode 1: 8.1"), std::string::npos);
  EXPECT_NE(error_of([&] { (void)mode_shape_svg(r, std::vector<int>{99}); }).find("there is no mode 99"),
            std::string::npos);
}

}  // namespace report_test
}  // namespace slew::flex
