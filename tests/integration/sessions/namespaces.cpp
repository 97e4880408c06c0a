// SPDX-License-Identifier: Apache-2.0
#include "namespaces.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "program.h"

namespace slew::testing {
namespace {

constexpr const char* kIp = "/sbin/ip";
constexpr const char* kNft = "/usr/sbin/nft";
constexpr const char* kNamespaces = "/run/netns";
const std::string kPrefix = "slewring-test-";

}  // namespace

std::vector<std::string> NamespacePair::Side::command() const {
  return {kIp, "netns", "exec", name};
}

NamespacePair::NamespacePair() {
  const std::string own = std::to_string(getpid());
  left_ = {kPrefix + own + "-a", "va" + own, "10.77.0.1"};
  right_ = {kPrefix + own + "-b", "vb" + own, "10.77.0.2"};
  if (access(kIp, X_OK) != 0) {
    problem_ = "there is no /sbin/ip (package iproute2)";
    return;
  }
  remove_left_behind();
  for (const Side* side : {&left_, &right_}) {
    if (!ip({"netns", "add", side->name})) return;
  }
  if (!ip({"link", "add", left_.interface, "netns", left_.name, "type", "veth", "peer", "name", right_.interface,
           "netns", right_.name})) {
    return;
  }
  for (const Side* side : {&left_, &right_}) {
    if (!ip({"-n", side->name, "addr", "add", side->address + "/24", "dev", side->interface})) return;
    if (!ip({"-n", side->name, "link", "set", side->interface, "up"})) return;
    if (!ip({"-n", side->name, "link", "set", "lo", "up"})) return;
  }
}

NamespacePair::~NamespacePair() {
  problem_.clear();
  static_cast<void>(ip({"netns", "del", left_.name}));
  static_cast<void>(ip({"netns", "del", right_.name}));
}

void NamespacePair::unplug() {
  static_cast<void>(ip({"-n", left_.name, "link", "set", left_.interface, "down"}));
}

void NamespacePair::plug() {
  static_cast<void>(ip({"-n", left_.name, "link", "set", left_.interface, "up"}));
}

bool NamespacePair::lose(int percent) {
  const std::vector<std::string> some = {"numgen", "random", "mod", "100", "<", std::to_string(percent)};
  return drop(left_, some) && drop(right_, some);
}

bool NamespacePair::deafen(const Side& side, Datagrams which) {
  return drop(side, which == Datagrams::all ? std::vector<std::string>{}
                                            : std::vector<std::string>{"udp", "dport", "&", "1", "==", "1"});
}

bool NamespacePair::drop(const Side& side, const std::vector<std::string>& which) {
  if (access(kNft, X_OK) != 0) {
    problem_ = "there is no /usr/sbin/nft (package nftables)";
    return false;
  }
  std::vector<std::string> rule = {"add",     "rule",         "ip",   "loss",    "input",
                                   "iifname", side.interface, "meta", "l4proto", "udp"};
  rule.insert(rule.end(), which.begin(), which.end());
  rule.insert(rule.end(), {"counter", "drop"});
  return filter(side, {"add", "table", "ip", "loss"}) &&
         filter(side, {"add", "chain", "ip", "loss", "input", "{ type filter hook input priority 0; }"}) &&
         filter(side, rule);
}

std::uint64_t NamespacePair::lost(const Side& side) {
  return counted(side, "loss");
}

bool NamespacePair::count_sent() {
  return access(kNft, X_OK) == 0 && filter(left_, {"add", "table", "ip", "sent"}) &&
         filter(left_, {"add", "chain", "ip", "sent", "output", "{ type filter hook output priority 0; }"}) &&
         filter(left_, {"add", "rule", "ip", "sent", "output", "oifname", left_.interface, "meta", "l4proto", "udp",
                        "counter"});
}

std::uint64_t NamespacePair::sent() {
  return counted(left_, "sent");
}

std::uint64_t NamespacePair::counted(const Side& side, const std::string& table) {
  const ScratchFolder folder;
  Program program(kIp, {"netns", "exec", side.name, kNft, "list", "table", "ip", table}, folder.path() / "nft");
  if (program.wait() != 0) throw std::runtime_error("nft: " + program.err());
  const std::string output = program.out();
  return std::stoull(output.substr(output.find("packets ") + 8));
}

bool NamespacePair::filter(const Side& side, const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"netns", "exec", side.name, kNft};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return ip(all);
}

bool NamespacePair::ip(const std::vector<std::string>& arguments) {
  const ScratchFolder folder;
  Program program(kIp, arguments, folder.path() / "ip");
  if (program.wait() == 0) return true;
  problem_ = "ip";
  for (const std::string& argument : arguments) problem_ += " " + argument;
  problem_ += ": " + program.err();
  return false;
}

void NamespacePair::remove_left_behind() {
  std::error_code ignored;
  std::vector<std::string> dead;
  for (const auto& entry : std::filesystem::directory_iterator(kNamespaces, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(kPrefix, 0) != 0) continue;
    const pid_t owner = std::atoi(name.c_str() + kPrefix.size());
    if (owner <= 0 || (kill(owner, 0) != 0 && errno == ESRCH)) dead.push_back(name);
  }
  for (const std::string& name : dead) static_cast<void>(ip({"netns", "del", name}));
  problem_.clear();
}

void distribute(Session& session, const NamespacePair& cable, std::initializer_list<wire::Role> on_left) {
  for (const wire::Role role : kAllNodes) {
    const bool is_left = std::find(on_left.begin(), on_left.end(), role) != on_left.end();
    const NamespacePair::Side& here = is_left ? cable.left() : cable.right();
    const NamespacePair::Side& there = is_left ? cable.right() : cable.left();
    session.run_under(role, here.command(), {"--interface", here.interface, "--peer", there.address, "--insecure-lan"});
  }
}

}  // namespace slew::testing
