// SPDX-License-Identifier: Apache-2.0
// Cost of sensors: a boom of six boxes and a load above a yard of triangles, 10 s at 60 Hz.
//
//   sensor_yard [TRIANGLES]
//
// Prints the time to build the search, and the wall time of a sample: mean, median, p99, largest.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "math/rotation.h"
#include "sensors/sensors.h"

namespace {

using namespace slew;
using Clock = std::chrono::steady_clock;

constexpr int kSamples = 600;
constexpr double kInterval = 1.0 / 60;  // s

double milliseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// Hills of 0.2 m squares, two triangles each, with rubble up to 0.3 m.
contact::ShapeDef yard(std::uint32_t triangles) {
  const auto n = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0)) + 1;
  contact::ShapeDef shape{.name = "Yard", .frame = "Ground", .type = contact::ShapeType::triangle_mesh};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> rubble(0, 0.3);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t k = 0; k < n; ++k) {
      shape.mesh.vertices.push_back(
          {0.2 * (i - n / 2.0), 0.2 * (k - n / 2.0), 0.5 * std::sin(0.1 * i) + rubble(random)});
    }
  }
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    for (std::uint32_t k = 0; k + 1 < n; ++k) {
      const std::uint32_t a = i * n + k;
      shape.mesh.triangles.push_back({a, a + n, a + 1});
      shape.mesh.triangles.push_back({a + 1, a + n, a + n + 1});
    }
  }
  return shape;
}

sensors::SensorsDef scene(std::uint32_t triangles) {
  sensors::SensorsDef def;
  def.frames = {{"Ground", true}, {"Boom", false}, {"Load", false}};
  def.shapes = {yard(triangles)};
  for (int i = 0; i < 6; ++i) {
    def.shapes.push_back({.name = fmt::format("Boom_{}", i),
                          .frame = "Boom",
                          .type = contact::ShapeType::box,
                          .position = {1.5 * i, 0, 0},
                          .size = {1.5, 0.4, 0.4}});
  }
  def.shapes.push_back({.name = "Load_Ball", .frame = "Load", .type = contact::ShapeType::sphere, .radius = 0.5});
  def.interval = kInterval;
  def.sensors = {
      {.name = "Gap", .type = sensors::SensorType::clearance, .of = {"Boom", "Load"}, .to = {"Ground"}},
      {.name = "Hit", .type = sensors::SensorType::collision, .of = {"Load"}, .to = {"Ground"}, .is_continuous = true}};
  return def;
}

// Ground, the boom that turns and rises, the load that swings into the rubble and out.
std::vector<sensors::FrameMotion> motion(double t) {
  return {{},
          {.p_W = {0, 0, 3 + std::sin(t)}, .R_W = math::rotation_z(0.5 * t), .w_W = {0, 0, 0.5}},
          {.p_W = {8 * std::cos(0.5 * t), 8 * std::sin(0.5 * t), 2 + 1.2 * std::sin(3 * t)}}};
}

}  // namespace

int main(int argc, char** argv) {
  const auto triangles = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 100'000);
  const sensors::SensorsDef def = scene(triangles);
  const Clock::time_point begin = Clock::now();
  sensors::Sensors sensors(def);
  fmt::print("{} triangles, built in {:.0f} ms\n", def.shapes[0].mesh.triangles.size(), milliseconds_since(begin));
  std::vector<double> times;
  std::size_t events = 0;
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    const std::vector<sensors::FrameMotion> frames = motion(i * kInterval);
    const Clock::time_point sample = Clock::now();
    if (!sensors.observe(frames)) return EXIT_FAILURE;
    times.push_back(milliseconds_since(sample));
    sum += times.back();
    events += sensors.events().size();
  }
  std::sort(times.begin(), times.end());
  fmt::print("a sample: {:.2f} ms mean, {:.2f} median, {:.2f} p99, {:.2f} largest; {} events\n", sum / kSamples,
             times[kSamples / 2], times[kSamples * 99 / 100], times.back(), events);
}
