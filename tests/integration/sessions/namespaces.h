// SPDX-License-Identifier: Apache-2.0
// Two network namespaces joined by a veth pair: two machines as far as the network is concerned.
//
// Datagrams are lost by filters of nft at the side they come to.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "session.h"

namespace slew::testing {

class NamespacePair {
 public:
  // Makes both, or leaves problem() with the reason why that is not possible here. Removes the leftovers of killed
  // tests.
  NamespacePair();
  ~NamespacePair();
  NamespacePair(const NamespacePair&) = delete;
  NamespacePair& operator=(const NamespacePair&) = delete;

  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  struct Side {
    std::string name;       // name of the namespace
    std::string interface;  // its end of the cable
    std::string address;
    // in front of a program that is to run there
    [[nodiscard]] std::vector<std::string> command() const;
  };
  [[nodiscard]] const Side& left() const noexcept { return left_; }
  [[nodiscard]] const Side& right() const noexcept { return right_; }

  void unplug();
  void plug();
  // From now on each side loses this share of the datagrams that come to it [%]. False where that is not possible.
  [[nodiscard]] bool lose(int percent);
  enum class Datagrams : std::uint8_t {
    all,
    data,  // datagrams to the odd ports: over the others the sides still discover each other (RTPS 2.5, 9.6.2)
  };
  // From now on this side receives nothing from the other. False where that is not possible.
  [[nodiscard]] bool deafen(const Side& side, Datagrams which = Datagrams::all);
  // Datagrams that a side has lost since lose() or deafen().
  [[nodiscard]] std::uint64_t lost(const Side& side);
  // From now on the datagrams that leave the left side are counted. False where that is not possible.
  [[nodiscard]] bool count_sent();
  [[nodiscard]] std::uint64_t sent();

 private:
  [[nodiscard]] bool ip(const std::vector<std::string>& arguments);
  [[nodiscard]] bool filter(const Side& side, const std::vector<std::string>& arguments);
  [[nodiscard]] bool drop(const Side& side, const std::vector<std::string>& which);
  [[nodiscard]] std::uint64_t counted(const Side& side, const std::string& table);
  void remove_left_behind();

  std::string problem_;
  Side left_, right_;
};

// These nodes on the left side, the others on the right, with the options of two_machines.md.
void distribute(Session& session, const NamespacePair& cable,
                std::initializer_list<wire::Role> on_left = {wire::Role::mechanics, wire::Role::recorder});

}  // namespace slew::testing
