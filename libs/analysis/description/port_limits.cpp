// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/port_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/range_projector.h"

namespace slew::analysis {
namespace {

constexpr double kSameCoordinate = 1e-9;  // of the projector: two cylinders move the same coordinate

class Limits {
 public:
  Limits(LargestForces& largest, const StaticLoad& load)
      : largest_(largest), load_(load), m_(load.F.size()), P_(math::range_projector(load.W, m_)) {
    found_.ports.resize(m_);
  }

  PortLimits find() {
    std::vector<char> is_done(m_, 0);
    for (std::size_t i = 0; i < m_ && found_.refusal.empty(); ++i) {
      if (is_done[i]) continue;
      const std::vector<std::size_t> block = block_of(i);
      for (const std::size_t j : block) is_done[j] = 1;
      add(block);
    }
    return found_;
  }

 private:
  // all ports that move the coordinates of port i
  [[nodiscard]] std::vector<std::size_t> block_of(std::size_t i) const {
    return reached_from(i,
                        [this](std::size_t j, std::size_t k) { return std::fabs(P_[j * m_ + k]) > kSameCoordinate; });
  }

  template <typename Touch>
  [[nodiscard]] std::vector<std::size_t> reached_from(std::size_t i, const Touch& touch) const {
    std::vector<std::size_t> reached = {i};
    for (std::size_t next = 0; next < reached.size(); ++next) {
      for (std::size_t k = 0; k < m_; ++k) {
        if (touch(reached[next], k) && std::find(reached.begin(), reached.end(), k) == reached.end()) {
          reached.push_back(k);
        }
      }
    }
    std::sort(reached.begin(), reached.end());
    return reached;
  }

  [[nodiscard]] std::string names(const std::vector<std::size_t>& block) const {
    std::vector<std::string> list;
    for (const std::size_t j : block) list.push_back(largest_.name(j));
    return fmt::format("{}", fmt::join(list, ", "));
  }

  void add(const std::vector<std::size_t>& block) {
    const bool carries = std::any_of(block.begin(), block.end(), [this](std::size_t j) { return carries_payload(j); });
    if (!carries) return;
    const auto share = [&](std::size_t j, std::size_t k) {
      return j != k && std::find(block.begin(), block.end(), k) != block.end() && largest_.shared_volume(j, k) >= 0;
    };
    const std::vector<std::size_t> together = reached_from(block.front(), share);
    const bool has_shared = std::any_of(block.begin(), block.end(), [&](std::size_t j) {
      return std::any_of(block.begin(), block.end(), [&](std::size_t k) { return share(j, k); });
    });
    if (!has_shared) {
      for (const std::size_t j : block) add_alone(j);
    } else if (together.size() == block.size() && rank_of(block) == 1) {
      add_together(block);
    } else {
      found_.refusal = fmt::format(
          "{} move the same joints, and some of them share volumes: their liftable load is not computed", names(block));
    }
    for (const std::size_t j : block) refuse_unheld(j);
  }

  [[nodiscard]] bool carries_payload(std::size_t i) const noexcept { return std::fabs(load_.slope[i]) >= kNoShare; }

  [[nodiscard]] int rank_of(const std::vector<std::size_t>& block) const noexcept {
    double trace = 0;
    for (const std::size_t j : block) trace += P_[j * m_ + j];
    return static_cast<int>(std::lround(trace));
  }

  // (1)
  void add_alone(std::size_t i) {
    if (!carries_payload(i)) return;
    PortLimit& port = found_.ports[i];
    port.carries = true;
    port.largest = largest_.of(i, load_.slope[i] > 0 ? 1 : -1);
    port.load = load_.mass + (port.largest.force - load_.F[i]) / load_.slope[i];
  }

  // (2)
  void add_together(const std::vector<std::size_t>& block) {
    // P of the block is l l^T / l.l: any of its rows that is not 0 has the lever arms
    std::size_t row = block.front();
    for (const std::size_t j : block) {
      if (P_[j * m_ + j] > P_[row * m_ + row]) row = j;
    }
    std::vector<double> lever(m_, 0.0);
    double slope = 0;
    for (const std::size_t j : block) {
      lever[j] = P_[row * m_ + j];
      slope += lever[j] * load_.slope[j];
    }
    if (slope < 0) {
      for (double& l : lever) l = -l;
    }
    slope = std::fabs(slope);
    const std::size_t command = largest_.best_command(lever);
    double sum = 0;
    for (const std::size_t j : block) {
      PortLimit& port = found_.ports[j];
      port.largest = largest_.of_command(j, lever[j] > 0 ? 1 : -1, command);
      sum += lever[j] * (port.largest.force - load_.F[j]);
    }
    for (const std::size_t j : block) {
      PortLimit& port = found_.ports[j];
      port.carries = carries_payload(j);
      port.load = load_.mass + sum / slope;
      for (const std::size_t k : block) {
        if (k != j) port.with.push_back(k);
      }
    }
  }

  void refuse_unheld(std::size_t i) {
    if (!found_.refusal.empty() || !found_.ports[i].carries) return;
    for (std::size_t k = 0; k < m_; ++k) {
      const double direction = load_.slope[i] > 0 ? 1 : -1;
      const int volume = largest_.unheld_between(i, k, direction, found_.ports[i].largest.command);
      if (volume < 0) continue;
      found_.refusal = fmt::format(
          "{} and {} share {}, whose pressure no valve holds when they stand: the load of the one decides on the force "
          "of the other, and their liftable load is not computed",
          largest_.name(std::min(i, k)), largest_.name(std::max(i, k)), largest_.volume_name(volume));
      return;
    }
  }

  LargestForces& largest_;
  const StaticLoad& load_;
  std::size_t m_;
  std::vector<double> P_;
  PortLimits found_;
};

}  // namespace

PortLimits find_port_limits(LargestForces& largest, const StaticLoad& load) {
  return Limits(largest, load).find();
}

}  // namespace slew::analysis
