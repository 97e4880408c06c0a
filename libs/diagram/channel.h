// SPDX-License-Identifier: Apache-2.0
// A channel between two rows of a diagram: tracks of its nets. Internal to the library.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace slew::diagram {

struct ChannelLine {
  double x = 0;
  std::size_t block = 0;
};

struct ChannelNet {
  struct Span {
    double left = 0, right = 0;
  };
  std::size_t net = 0;
  std::vector<ChannelLine> up{}, down{};  // lines to the row above, and to that below
  std::optional<Span> chip{};             // name of the volume
  int track = -1;                         // from the bottom; -1: a straight line without one
  std::optional<double> track_y{};

  [[nodiscard]] double low() const noexcept;
  [[nodiscard]] double high() const noexcept;
  [[nodiscard]] bool needs_track() const noexcept { return chip.has_value() || high() - low() > 0; }
  [[nodiscard]] static double chip_height() noexcept { return 28; }
};

class Channel {
 public:
  // The net's part; a new one if it has none.
  [[nodiscard]] ChannelNet& net(std::size_t index);
  [[nodiscard]] const ChannelNet* find(std::size_t index) const noexcept;

  // Finds the place for a volume's name: near its line, where no line of another net passes.
  void place_chip(std::size_t index, double width);

  // A block that has to move since its line cannot avoid that of another net; none: all have their tracks.
  [[nodiscard]] std::optional<std::size_t> choose_tracks();

  // Sets y of all tracks in a channel that begins at top; its bottom.
  double set_heights(double top);
  // y at which straight lines meet.
  [[nodiscard]] double middle() const noexcept { return middle_; }

 private:
  std::vector<ChannelNet> nets_;
  double middle_ = 0;
};

}  // namespace slew::diagram
