// SPDX-License-Identifier: Apache-2.0
// A controller's view of one session: the functions of slewring_client.h in C++, without handles that may be wrong.
//
// Blocks of variables are put together by step: a step is complete when every requested variable of it has arrived.
// Blocks of an older epoch are ignored. One thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"
#include "observer/observer.h"
#include "transport/network.h"
#include "transport/wire.h"

namespace slew::client {

// As the codes of slewring_client.h.
enum class Code : int { ok = 0, timeout = -1, refused = -2, lost = -3, ended = -4, bad_argument = -5, failed = -6 };

struct Answer {
  Code code = Code::ok;
  std::string text;
};

struct JoinOptions {
  std::string session;
  std::string controller;
  transport::Network network;
};

enum class Which : std::uint8_t { next, newest };

class ClientSession final : private observer::Receiver {
 public:
  // Fills `session`, or reports the cause of the failure.
  static Answer join(const JoinOptions& options, SimDuration timeout, std::unique_ptr<ClientSession>& session);
  ~ClientSession() override;
  ClientSession(const ClientSession&) = delete;
  ClientSession& operator=(const ClientSession&) = delete;

  [[nodiscard]] const observer::SessionView& view() const noexcept { return observer_->view(); }
  void drain() { observer_->drain(); }

  Answer find(const std::string& variable, SimDuration timeout, int& handle);
  [[nodiscard]] double value(int handle) const noexcept;
  Answer acquire(const std::string& channel, double how, SimDuration timeout, int& handle);
  Answer release(int channel);
  Answer step(Which which, SimDuration timeout);
  Answer write(int channel, double value);
  // Next unrequested sentence from the session; false: none.
  bool take_notice(std::string& text);

  [[nodiscard]] StepIndex present_step() const noexcept { return step_; }
  [[nodiscard]] SimDuration step_size() const noexcept { return {view().session().step_ns}; }
  [[nodiscard]] StepIndex steps_per_block() const noexcept { return steps_per_block_; }
  [[nodiscard]] std::uint64_t blocks_missed() const noexcept;

  // The text of the last failure, and the last notice, for the C functions that hand out pointers.
  std::string error;
  std::string notice;

 private:
  enum class Lease : std::uint8_t { none, requested, held, refused, lost };
  struct Channel {
    std::string name;
    Lease lease = Lease::none;
    std::string reason{};
    std::uint64_t requested_from = 0;  // number of the first message that requested it
    StepIndex answered = kJoinStep;    // step of the last value that was written since it is held; -1: none
  };
  // Values of one step as they arrive.
  struct Block {
    std::vector<double> values;
    std::vector<bool> has;
    std::size_t count = 0;
    bool has_own = false;      // the session's own block of the step
    bool is_left_out = false;  // a node leaves its values out
  };

  explicit ClientSession(JoinOptions options);

  void take_lease(const wire::ControllerLease& message) override;
  void take_block(const wire::VariableBlock& block, std::span<const std::byte> bytes, double time) override;
  void begin_epoch(std::uint32_t epoch);
  void note_distance(const wire::Header& header) noexcept;
  void place(const wire::VariableBlock& block);
  bool choose(Which which);
  [[nodiscard]] bool is_complete(const Block& block) const noexcept;
  [[nodiscard]] bool can_never_be_complete(std::map<StepIndex, Block>::const_iterator block) const noexcept;
  Answer send(const std::string& channel, wire::ControllerAction action, double value, StepIndex based_on);
  [[nodiscard]] bool is_over() const noexcept { return view().end().has_value(); }
  [[nodiscard]] Answer ended() const;

  JoinOptions options_;
  std::unique_ptr<observer::Observer> observer_;
  std::uint32_t epoch_ = 0;
  std::vector<observer::VariablePlace> wanted_;  // by handle
  std::deque<wire::VariableBlock> new_blocks_;   // received before step() was called
  std::map<StepIndex, Block> blocks_;            // not handed out yet
  bool only_newest_ = false;                     // the next step is the newest: a channel was acquired in mid-run
  std::vector<double> values_;                   // values of step_, by handle
  StepIndex step_ = kJoinStep;
  std::array<std::optional<StepIndex>, wire::kRoles> newest_of_;  // step of each node's newest block
  StepIndex steps_per_block_ = 0;                                 // the smallest distance of two; 0: not known yet
  StepIndex steps_passed_ = 0;                                    // counted from the first block of each epoch on
  StepIndex blocks_come_ = 0;                                     // blocks that arrived in them
  std::vector<Channel> channels_;
  std::deque<std::string> notices_;
  std::uint64_t
      sequence_;  // number of the last message that was sent; drawn at random, as another process may have this name
};

}  // namespace slew::client
