// SPDX-License-Identifier: Apache-2.0
#include "analysis/simplify/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "build_paths.h"
#include "core/failure.h"
#include "multibody/model/model.h"
#include "multibody/results/observe.h"

namespace slew::analysis {
namespace simplify_test {

const std::string kScenes = SLEWRING_SOURCE_DIR "/scenes/";

const Candidate* find(const std::vector<Candidate>& all, const std::string& setting) {
  for (const Candidate& one : all) {
    if (std::find(one.settings.begin(), one.settings.end(), setting) != one.settings.end()) return &one;
  }
  return nullptr;
}

SimplifyOptions options_for(const std::string& scene, std::vector<std::string> errors, const std::string& until) {
  SimplifyOptions options;
  options.scene.file = kScenes + scene;
  options.scene.duration = until;
  options.errors = std::move(errors);
  options.repeats = 1;
  return options;
}

const SimplifyProgress kGoOn = [](std::string_view, double) { return true; };

TEST(Candidates, AreOfWhatTheSceneContains) {
  const scene::Scene crane = scene::load_file(kScenes + "truck_crane_flexible.yaml");
  const std::vector<Candidate> all = candidates(crane, {{"Bag_JibBoom"}, {"Body_Pillar"}});
  EXPECT_NE(find(all, "Bag_JibBoom.tested=false"), nullptr);
  EXPECT_EQ(find(all, "Ground_Bag.tested=false"), nullptr) << "it was not found untouched";
  EXPECT_NE(find(all, "Truck_JibBoom.flex_modes=\"1\""), nullptr);
  EXPECT_NE(find(all, "Truck_JibBoom.flex_modes=\"none\""), nullptr);
  EXPECT_NE(find(all, "hydraulics.relative_tolerance=0.001"), nullptr);
  EXPECT_NE(find(all, "session.step=0.01 s"), nullptr);
  EXPECT_NE(find(all, "Body_Pillar.type=fixed"), nullptr);
  const scene::Scene bars = scene::load_file(kScenes + "four_bar.yaml");
  const std::vector<Candidate> few = candidates(bars, {});
  EXPECT_EQ(find(few, "hydraulics.relative_tolerance=0.001"), nullptr);
  for (const Candidate& one : few) {
    EXPECT_TRUE(one.group == "session.step" || one.group == "mechanics.max_substep") << one.title;
  }
}

// pairs and the shorter list of modes: every setting is one that the scene's rules read
TEST(Candidates, OfPairsAndModesLoad) {
  const scene::Scene crane = scene::load_file(kScenes + "truck_crane_flexible.yaml");
  const std::vector<Candidate> all = candidates(crane, {{"Bag_JibBoom"}, {}});
  for (const Candidate& one : all) {
    EXPECT_NO_THROW(static_cast<void>(scene::load_file(kScenes + "truck_crane_flexible.yaml", one.settings)))
        << one.title;
  }
  const scene::Scene without =
      scene::load_file(kScenes + "truck_crane.yaml", find(all, "Bag_JibBoom.tested=false")->settings);
  const multibody::Description description = multibody::describe(multibody::build_model(without.mechanics));
  EXPECT_EQ(std::count(description.pairs.begin(), description.pairs.end(), "Bag_JibBoom"), 0);
  EXPECT_EQ(std::count(description.pairs_at_rest.begin(), description.pairs_at_rest.end(), "Bag_JibBoom"), 1);
}

// that a pair is not searched cannot be seen in anything, down to the last bit
TEST(Simplify, AnUntouchedPairChangesNothing) {
  const Simplification result = simplify(options_for("truck_crane.yaml", {"Bag.position 1mm"}, "1 s"), kGoOn);
  ASSERT_EQ(result.watched.size(), 3u);
  EXPECT_EQ(result.watched[0].name, "Bag.position.x");
  int pairs = 0;
  for (const Trial& trial : result.trials) {
    if (trial.candidate.title.find("contact pair") != 0) continue;
    ++pairs;
    ASSERT_EQ(trial.changes.size(), 3u);
    for (const double change : trial.changes) EXPECT_EQ(change, 0);
  }
  EXPECT_GE(pairs, 4);
}

TEST(Simplify, WhatItTakesHolds) {
  // by steps, since times are another machine's, or another minute's
  const SimplifyCost steps_per_ms = [](const scene::Scene&, StepIndex steps) {
    return static_cast<double>(steps) / 3000;
  };
  const Simplification result = simplify(
      options_for("single_cylinder.yaml", {"Load.position 1mm", "Cyl_Lift.force 2%"}, "3 s"), kGoOn, steps_per_ms);
  ASSERT_TRUE(result.helps()) << "longer steps of one cylinder cost less and change nothing that matters";
  EXPECT_TRUE(holds(result.watched, result.combined));
  EXPECT_LT(result.combined.cost, result.base_cost);
  // the settings come from the trials that are taken, none of a group twice
  std::size_t settings = 0;
  std::vector<std::string> groups;
  for (const Trial& trial : result.trials) {
    if (!trial.is_taken) continue;
    EXPECT_TRUE(holds(result.watched, trial));
    settings += trial.candidate.settings.size();
    EXPECT_EQ(std::count(groups.begin(), groups.end(), trial.candidate.group), 0);
    groups.push_back(trial.candidate.group);
  }
  EXPECT_EQ(settings, result.settings.size());
  // a part of the range
  EXPECT_NEAR(result.watched.back().tolerance, 0.02 * result.watched.back().range, 1e-12 * result.watched.back().range);
}

TEST(Simplify, NothingIsTakenWhenNothingMayChange) {
  const Simplification result = simplify(options_for("single_cylinder.yaml", {"Cyl_Lift.force 1e-9"}, "1 s"), kGoOn);
  EXPECT_FALSE(result.helps());
  EXPECT_TRUE(result.settings.empty());
  EXPECT_FALSE(result.trials.empty());
  EXPECT_NE(report_text(result).find("nothing helps"), std::string::npos);
}

TEST(Simplify, JudgesByThePayloadOfTheSceneWithoutAnError) {
  SimplifyOptions options = options_for("single_cylinder.yaml", {}, "0.2 s");
  try {
    static_cast<void>(simplify(options, kGoOn));
    ADD_FAILURE() << "no payload, no error";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("the scene names no payload"), std::string::npos) << failure.what();
  }
  options.scene.overrides = {"mechanics.payload=Load"};
  const Simplification result = simplify(options, kGoOn);
  const auto names_load = [](const auto& watched) { return watched.name.starts_with("Load.position"); };
  EXPECT_FALSE(result.watched.empty());
  EXPECT_TRUE(std::all_of(result.watched.begin(), result.watched.end(), names_load));
}

TEST(Simplify, RefusesWhatItCannotJudge) {
  const auto expect_refusal = [](const std::string& error, const std::string& part) {
    try {
      static_cast<void>(simplify(options_for("single_cylinder.yaml", {error}, "1 s"), kGoOn));
      ADD_FAILURE() << error;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code(), ExitCode::bad_input);
      EXPECT_NE(std::string(failure.what()).find(part), std::string::npos) << failure.what();
    }
  };
  expect_refusal("Load.position", "has no tolerance");
  expect_refusal("Load.position 1 bar",
                 "--error: '1 bar' is a pressure; expected a length such as '1.5 m', or a bare number in m");
  expect_refusal("Load.position 0 mm", "more than zero");
  expect_refusal("Lode.position 1 mm", "Lode.position");
}

// at any interruption: a candidate that was not judged has no verdict, and none is taken
TEST(Simplify, GivesNoVerdictOnWhatItWasInterruptedIn) {
  int all = 0;
  const Simplification whole =
      simplify(options_for("single_cylinder.yaml", {"Load.position 1mm"}, "1 s"), [&](std::string_view, double) {
        ++all;
        return true;
      });
  int interrupted = 0;
  for (int last = 1; last < all; last += 1 + all / 12) {
    int calls = 0;
    const Simplification result = simplify(options_for("single_cylinder.yaml", {"Load.position 1mm"}, "1 s"),
                                           [&](std::string_view, double) { return ++calls < last; });
    if (!result.is_interrupted) continue;  // a candidate that saves time by chance is not combined with others
    ++interrupted;
    EXPECT_FALSE(result.helps());
    EXPECT_TRUE(result.settings.empty());
    for (std::size_t i = 0; i < result.trials.size(); ++i) {
      const Trial &trial = result.trials[i], &judged = whole.trials[i];
      EXPECT_FALSE(trial.is_taken) << last;
      if (trial.was_interrupted) {
        EXPECT_EQ(i + 1, result.trials.size()) << "only the last can be";
        EXPECT_FALSE(trial.has_run());
      } else {
        EXPECT_EQ(holds(result.watched, trial), holds(whole.watched, judged)) << last << ": " << trial.candidate.title;
      }
    }
    const std::string text = report_text(result);
    EXPECT_EQ(text.find("did not repeat"), std::string::npos) << text;
    EXPECT_EQ(text.find("as it is 0 us"), std::string::npos) << text;
  }
  EXPECT_GT(interrupted, 5);
}

}  // namespace simplify_test
}  // namespace slew::analysis
