// SPDX-License-Identifier: Apache-2.0
// `slewring draw SCENE`: mechanism and hydraulic circuit of a scene as a picture or a page, before any run.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>

#include "analysis/drawing/mechanism_look.h"
#include "analysis/drawing/mechanism_picture.h"
#include "cli/verbs.h"
#include "core/escaped.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/text_output.h"
#include "diagram/circuit_svg.h"
#include "plotting/svg_text.h"
#include "program/add_scene_options.h"
#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::cli {
namespace {

struct DrawOptions {
  std::string scene, output, view = "side", part = "all";
  std::vector<std::string> overrides;
  bool is_json = false;
};

// One of the pictures: a heading and what is below it.
struct Picture {
  std::string heading, group;
  double width = 0, height = 0;  // px
};

struct Drawing {
  std::vector<Picture> pictures;
  std::vector<std::string> left_out;  // sentences
};

Drawing draw_scene(const scene::Scene& scene, const DrawOptions& options) {
  Drawing drawing;
  if (options.part != "circuit") {
    if (scene.has_mechanics()) {
      const analysis::ViewFrom view = options.view == "top"     ? analysis::ViewFrom::top
                                      : options.view == "front" ? analysis::ViewFrom::front
                                                                : analysis::ViewFrom::side;
      const std::string folder = std::filesystem::path(options.scene).parent_path().string();
      analysis::MechanismPicture picture = analysis::draw_mechanism(scene, folder.empty() ? "." : folder, view);
      for (std::string& sentence : picture.left_out) {
        drawing.left_out.push_back(sentence + "; the body is drawn without this mesh");
      }
      drawing.pictures.push_back(
          {"Mechanism, " + options.view + " view", std::move(picture.group), picture.width, picture.height});
    } else {
      drawing.left_out.emplace_back("the scene has no bodies; the mechanism is left out");
    }
  }
  if (options.part != "mechanism") {
    if (!scene.hydraulics.components.empty()) {
      std::vector<diagram::ControlledBy> inputs;
      for (const scene::InputDef& input : scene.inputs) inputs.push_back({input.primitive, input.name});
      const diagram::CircuitLayout layout = diagram::lay_out(scene.hydraulics, inputs);
      const auto [width, height] = diagram::circuit_size(layout);
      drawing.pictures.push_back({"Hydraulic circuit", diagram::circuit_group(layout), width, height});
    } else {
      drawing.left_out.emplace_back("the scene has no hydraulic components; the circuit is left out");
    }
  }
  return drawing;
}

std::string style_text() {
  return std::string(plotting::kStyle) + std::string(diagram::kDiagramStyle) + analysis::mechanism_style();
}

// Pictures below each other.
std::string drawing_svg(const scene::Scene& scene, const Drawing& drawing) {
  constexpr double kTitle = 62, kHeading = 30, kBetween = 18;
  double width = 300, height = kTitle;
  for (const Picture& picture : drawing.pictures) {
    width = std::max(width, picture.width);
    height += kHeading + picture.height + kBetween;
  }
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"diagram\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 "
      "{0:.0f} {1:.0f}\">\n<title>{2}</title>\n<style>{3}.diagram "
      ".heading{{font-size:13px;font-weight:600}}</style>\n<rect "
      "class=\"ground\" width=\"100%\" height=\"100%\"/>\n<text class=\"title\" x=\"16\" y=\"30\">{2}</text>\n",
      width, height, escaped(scene.name), style_text());
  double y = kTitle;
  for (const Picture& picture : drawing.pictures) {
    fmt::format_to(std::back_inserter(out), "<text class=\"heading\" x=\"16\" y=\"{:.0f}\">{}</text>\n", y + 8,
                   picture.heading);
    y += kHeading;
    fmt::format_to(std::back_inserter(out), "<g transform=\"translate({:.0f} {:.0f})\">\n{}</g>\n",
                   (width - picture.width) / 2, y, picture.group);
    y += picture.height + kBetween;
  }
  return out + "</svg>\n";
}

std::string drawing_html(const scene::Scene& scene, const Drawing& drawing) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{0}</title>\n<style>{1}:root{{color-scheme:light "
      "dark}}body{{margin:1.5em;"
      "background:var(--ground);color:var(--ink);font-family:Inter,'Helvetica Neue',Arial,'DejaVu Sans',sans-serif}}"
      "h1{{font-size:20px;margin:0}}h2{{font-size:15px;margin:1.6em 0 .5em}}p{{color:var(--quiet);margin:.3em 0}}"
      "svg{{display:block;max-width:100%;height:auto}}</style>\n</head>\n<body "
      "class=\"diagram\">\n<h1>{0}</h1>\n<p>{2}</p>\n",
      escaped(scene.name), style_text(), escaped(scene.description));
  for (const Picture& picture : drawing.pictures) {
    fmt::format_to(std::back_inserter(out),
                   "<h2>{0}</h2>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{1:.0f}\" height=\"{2:.0f}\" "
                   "viewBox=\"0 0 {1:.0f} {2:.0f}\">\n{3}</svg>\n",
                   picture.heading, picture.width, picture.height, picture.group);
  }
  return out + "</body>\n</html>\n";
}

ExitCode draw(const DrawOptions& options) {
  const std::string ending = std::filesystem::path(options.output).extension().string();
  if (ending != ".svg" && ending != ".html") {
    throw Failure(ExitCode::bad_input,
                  "'" + options.output +
                      "' ends neither in .svg nor in .html; nothing was written; name such a file; "
                      "another program makes others of an .svg, such as rsvg-convert a .png");
  }
  const scene::Scene scene = scene::load_file(options.scene, options.overrides);
  const Drawing drawing = draw_scene(scene, options);
  if (drawing.pictures.empty()) {
    throw Failure(ExitCode::bad_input, fmt::format("{}; nothing was written", fmt::join(drawing.left_out, "; ")));
  }
  write_text(options.output, ending == ".svg" ? drawing_svg(scene, drawing) : drawing_html(scene, drawing));
  for (const std::string& sentence : drawing.left_out) std::fprintf(stderr, "slewring: %s\n", sentence.c_str());
  if (options.is_json) {
    Json json = {{"file", options.output}, {"left_out", Json::array()}};
    for (const std::string& sentence : drawing.left_out) json["left_out"].push_back(sentence);
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print("{}\n", options.output);
  }
  return ExitCode::ok;
}

}  // namespace

void add_draw(options::Command& program) {
  options::Command verb = program.command("draw", "draw the mechanism and the hydraulic circuit of a scene");
  const auto options = std::make_shared<DrawOptions>();  // lives as long as the command line's callbacks
  program::add_scene_file(verb, "scene", options->scene).required();
  verb.option("-o,--output", options->output, "file to write: .svg, a picture, or .html, a page")
      .required()
      .value_name("FILE");
  verb.option("--view", options->view, "direction of the mechanism's picture")
      .one_of({"side", "top", "front"})
      .show_default();
  verb.option("--part", options->part, "what is drawn").one_of({"all", "mechanism", "circuit"}).show_default();
  verb.option("--set", options->overrides, "change a value of the scene; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  verb.flag("--json", options->is_json, "print the file and what was left out as JSON");
  verb.footer(
      "The mechanism stands where the scene begins: bodies with their meshes for the eye, else their contact shapes,\n"
      "else bars between their points; joints by type, cylinders, springs, ropes, tyres, centres of mass and frames.\n"
      "Contact planes are not drawn.\n\n"
      "The circuit has symbols after ISO 1219-1: supply below, valves, actuators on top. Lines of different volumes\n"
      "cross without a dot. A name on a line is that of the volume; each line to the tank ends in a tank of its "
      "own.\n\n"
      "Examples:\n"
      "  slewring draw scenes/truck_crane.yaml -o crane.svg\n"
      "  slewring draw scenes/truck_crane.yaml --view top --part mechanism -o above.html");
  verb.action([options] { return draw(*options); });
}

}  // namespace slew::cli
