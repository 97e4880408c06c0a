// SPDX-License-Identifier: Apache-2.0
// Requests that are lost on their way, or whose session ends.
#include "observer/observer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <deque>
#include <memory>

#include "core/failure.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::observer {
namespace observer_test {

using wire::Role;
using wire::Topic;

constexpr std::uint64_t kRequest = 7;

wire::Header header() {
  wire::Header header;
  header.session = {1, 2, 3};
  header.role = Role::io;
  header.phase = wire::Phase::running;
  return header;
}

// Messages of an io node: at first, and as replies.
class PlayedIo final : public transport::Transport {
 public:
  PlayedIo() {
    wire::SessionDescription session;
    session.header = header();
    session.name = "crane";
    publish_to(session, messages_);
    wire::Health health;
    health.header = header();
    publish_to(health, messages_);
  }

  template <typename Message>
  void publish_first(const Message& message) {
    publish_to(message, messages_);
  }
  template <typename Message>
  void publish_as_reply(const Message& message) {
    publish_to(message, replies_);
  }

  // It has not discovered this program's writer yet.
  void lose_requests(int count) { lost_ = count; }

  Status publish(Topic topic, std::span<const std::byte>) noexcept override {
    EXPECT_EQ(topic, Topic::control_request);
    if (lost_-- > 0) return Status::ok();
    messages_.insert(messages_.end(), replies_.begin(), replies_.end());
    replies_.clear();
    return Status::ok();
  }
  bool take(transport::Received& message) override {
    if (messages_.empty()) return false;
    taken_ = std::move(messages_.front());
    messages_.pop_front();
    message = {taken_.topic, taken_.bytes};
    return true;
  }
  void wait_until(std::int64_t) override {}
  std::vector<std::string> discovered_writers(Topic) override { return {}; }
  std::vector<std::string> misfits() override { return {}; }
  std::size_t matched_readers(Topic) const override { return 1; }

 private:
  struct PlayedMessage {
    Topic topic{};
    transport::ByteBuffer bytes;
  };

  template <typename Message>
  static void publish_to(const Message& message, std::deque<PlayedMessage>& where) {
    PlayedMessage played{transport::kTopicOf<Message>, {}};
    EXPECT_TRUE(transport::encode(message, played.bytes));
    where.push_back(std::move(played));
  }

  std::deque<PlayedMessage> messages_;
  std::deque<PlayedMessage> replies_;
  PlayedMessage taken_;
  int lost_ = 0;
};

class ObserverRequest : public ::testing::Test {
 protected:
  static wire::NodeStatus end() {
    wire::NodeStatus status;
    status.header = header();
    status.state = wire::NodeState::ended;
    status.reason = "the session reached its end";
    return status;
  }
  static wire::ControlReply accepted() {
    wire::ControlReply reply;
    reply.header = header();
    reply.request = kRequest;
    reply.is_accepted = true;
    return reply;
  }

  // "" when io has answered, else the message for the user
  std::string failure_of_request(std::uint64_t number = kRequest, SimDuration at_most = milliseconds(10'000)) {
    Observer observer(std::move(io_), {.session = "crane", .stop = &stop_});
    wire::ControlRequest request;
    request.request = number;
    try {
      const wire::ControlReply reply = observer.request_reply(request, at_most, [this] {
        ++sent_first_;
        stop_.store(signal_);
      });
      return reply.is_accepted ? "" : "refused";
    } catch (const Failure& failure) {
      code_ = failure.code();
      return failure.what();
    }
  }

  int sent_first_ = 0;
  std::atomic<int> stop_ = 0;     // as a signal handler sets it
  int signal_ = 0;                // that comes when the request is sent
  ExitCode code_ = ExitCode::ok;  // exit code of the failure
  std::unique_ptr<PlayedIo> io_ = std::make_unique<PlayedIo>();
};

constexpr const char* kEnded =
    "session 'crane' ended before it answered: the session reached its end; there is nothing left to be changed; start "
    "it again";

TEST_F(ObserverRequest, IsAnswered) {
  io_->publish_as_reply(accepted());
  EXPECT_EQ(failure_of_request(), "");
}

TEST_F(ObserverRequest, SendsALostRequestAgainWithWhatBelongsToIt) {
  io_->lose_requests(1);
  io_->publish_as_reply(accepted());
  EXPECT_EQ(failure_of_request(), "");
  EXPECT_EQ(sent_first_, 2);
}

TEST_F(ObserverRequest, TakesNoEventForTheAnswerToARequestThatHasNoNumberYet) {
  wire::ControlReply event = accepted();
  event.request = 0;
  io_->publish_first(event);
  io_->publish_as_reply(end());
  EXPECT_EQ(failure_of_request(0), kEnded);
}

TEST_F(ObserverRequest, ASessionThatEndsInsteadOfReplyingFailsAtOnce) {
  io_->publish_as_reply(end());
  EXPECT_EQ(failure_of_request(), kEnded);
  EXPECT_EQ(code_, ExitCode::failed);
}

TEST_F(ObserverRequest, ASessionWithoutAReplyFails) {
  io_->lose_requests(1000);
  EXPECT_EQ(failure_of_request(kRequest, milliseconds(1000)),
            "session 'crane' has not answered within 1 s; the request may have had an effect; look with 'slewring "
            "sessions' whether it still runs");
  EXPECT_EQ(code_, ExitCode::failed);
}

TEST_F(ObserverRequest, ASignalEndsIt) {
  signal_ = static_cast<int>(ExitCode::interrupted);
  EXPECT_EQ(failure_of_request(), "interrupted; the request may have had an effect");
  EXPECT_EQ(code_, ExitCode::interrupted);
}

TEST_F(ObserverRequest, ASessionThatHasEndedFailsAtOnce) {
  io_->publish_first(end());
  EXPECT_EQ(failure_of_request(), kEnded);
}

TEST_F(ObserverRequest, TakesAnAnswerThatComesBehindTheEnd) {
  io_->publish_as_reply(end());
  io_->publish_as_reply(accepted());
  EXPECT_EQ(failure_of_request(), "");
}

TEST_F(ObserverRequest, AWithdrawnSessionFailsAtOnce) {
  wire::SessionDescription withdrawn;
  withdrawn.header = header();
  withdrawn.header.phase = wire::Phase::ended;
  withdrawn.name = "crane";
  io_->publish_as_reply(withdrawn);
  EXPECT_EQ(failure_of_request(),
            "session 'crane' ended before it answered; there is nothing left to be changed; start it again");
}

}  // namespace observer_test
}  // namespace slew::observer
