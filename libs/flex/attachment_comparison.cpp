// SPDX-License-Identifier: Apache-2.0
#include "flex/attachment_comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <numeric>

#include "flex/input_error.h"
#include "flex/tip_compliance.h"

namespace slew::flex {
namespace {

// numbers of modes: for a square section one, two and three bending modes per plane
constexpr std::size_t kLowest[] = {2, 4, 6};

ReductionDef other_frame(const ReductionDef& def, const Source& source) {
  ReductionDef other = def;
  other.stiffening = GeometricStiffening::none;
  std::vector<int>& clamped = other.modes.clamped_nodes;
  std::vector<int>& interfaces = other.modes.interface_nodes;
  interfaces = source.interface_nodes;
  if (source.attachment == Attachment::clamped) {
    other.modes.attachment = Attachment::free;
    clamped.clear();
    interfaces.insert(interfaces.begin(), source.clamped_nodes.begin(), source.clamped_nodes.end());
  } else {
    other.modes.attachment = Attachment::clamped;
    clamped = {interfaces.front()};
    interfaces.erase(interfaces.begin());
    if (interfaces.empty()) throw InputError("the body has no second interface node");
  }
  return other;
}

std::vector<std::size_t> lowest(std::size_t count) {
  std::vector<std::size_t> places(count);
  std::iota(places.begin(), places.end(), std::size_t{0});
  return places;
}

std::optional<std::array<double, 3>> shares(const TipCompliance& tip, const std::vector<std::size_t>& places) {
  if (!places.empty() && places.back() >= tip.by_mode.size()) return std::nullopt;
  return tip.share(places);
}

std::string text_of(const std::optional<std::array<double, 3>>& share) {
  if (!share) return "-";
  return fmt::format("{:.1f}, {:.1f}, {:.1f}", 100 * (*share)[0], 100 * (*share)[1], 100 * (*share)[2]);
}

}  // namespace

AttachmentComparison compare_attachments(const FeModel& model, const ReductionDef& def, const Reduction& all,
                                         std::span<const int> kept) {
  AttachmentComparison out;
  try {
    const Reduction other = reduce(model, other_frame(def, all.source));
    const bool is_clamped = all.source.attachment == Attachment::clamped;
    out.tip = all.source.interface_nodes.back();
    out.reference_nodes = (is_clamped ? all : other).source.clamped_nodes;
    const TipCompliance own = tip_compliance(model, all, out.reference_nodes, out.tip);
    const TipCompliance its = tip_compliance(model, other, out.reference_nodes, out.tip);
    if (!own.is_known() || !its.is_known()) throw InputError("the reference nodes do not hold the body");
    const TipCompliance &clamped = is_clamped ? own : its, &free = is_clamped ? its : own;
    std::vector<std::size_t> places = places_of(kept, all.body.modes());
    if (!kept.empty())
      out.rows.push_back({fmt::format("{}", fmt::join(kept, ";")), shares(clamped, places), shares(free, places)});
    for (const std::size_t count : kLowest) {
      if (places != lowest(count) && count < all.body.modes())
        out.rows.push_back(
            {fmt::format("lowest {}", count), shares(clamped, lowest(count)), shares(free, lowest(count))});
    }
    out.rows.push_back({"all", clamped.share(lowest(clamped.by_mode.size())), free.share(lowest(free.by_mode.size()))});
  } catch (const InputError& error) {
    out.rows.clear();
    out.obstacle = error.what();
  }
  return out;
}

std::string text_of(const AttachmentComparison& comparison) {
  if (!comparison.obstacle.empty())
    return fmt::format("\n  clamped beside free: not available, {}\n", comparison.obstacle);
  std::string text = fmt::format(
      "\n  share of the compliance of node {} with node {} held, by modes of a clamped and of a free body frame\n"
      "  modes           clamped x, y, z [%]     free x, y, z [%]\n",
      comparison.tip, fmt::join(comparison.reference_nodes, ", "));
  for (const AttachmentShares& row : comparison.rows)
    fmt::format_to(std::back_inserter(text), "  {:<16}{:<24}{}\n", row.modes, text_of(row.clamped), text_of(row.free));
  return text;
}

}  // namespace slew::flex
