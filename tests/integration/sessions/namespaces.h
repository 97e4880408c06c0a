// Two network namespaces joined by a veth pair: two machines as far as the network is concerned.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace slew::testing {

class NamespacePair {
 public:
  // Makes both, or leaves problem() with the reason why that is not possible here. Removes what killed tests left.
  NamespacePair();
  ~NamespacePair();
  NamespacePair(const NamespacePair&) = delete;
  NamespacePair& operator=(const NamespacePair&) = delete;

  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  struct Side {
    std::string name;       // of the namespace
    std::string interface;  // its end of the cable
    std::string address;
    // in front of a program that is to run there
    [[nodiscard]] std::vector<std::string> command() const;
  };
  [[nodiscard]] const Side& left() const noexcept { return left_; }
  [[nodiscard]] const Side& right() const noexcept { return right_; }

  void unplug();
  // From now on each side loses this share of the datagrams that come to it [%]. False where that is not possible.
  [[nodiscard]] bool lose(int percent);
  // From now on the datagrams that leave the left side are counted. False where that is not possible.
  [[nodiscard]] bool count_sent();
  [[nodiscard]] std::uint64_t sent();

 private:
  [[nodiscard]] bool ip(const std::vector<std::string>& arguments);
  [[nodiscard]] bool filter(const Side& side, const std::vector<std::string>& arguments);
  void remove_left_behind();

  std::string problem_;
  Side left_, right_;
};

}  // namespace slew::testing
