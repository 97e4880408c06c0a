// What becomes of a request to a session that ends.
#include "cli/observer.h"

#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "cli_support/failure.h"
#include "transport/codec.h"
#include "transport/topics.h"

namespace slew::cli {
namespace {

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

// What an io node says: at first, and when it is asked.
class PlayedIo final : public transport::Transport {
 public:
  PlayedIo() {
    wire::SessionDescription session;
    session.header = header();
    session.name = "crane";
    say(session, said_);
    wire::Health health;
    health.header = header();
    say(health, said_);
  }

  template <typename Message>
  void say_at_first(const Message& message) {
    say(message, said_);
  }
  template <typename Message>
  void say_when_asked(const Message& message) {
    say(message, when_asked_);
  }

  Status publish(Topic topic, std::span<const std::byte>) noexcept override {
    EXPECT_EQ(topic, Topic::control_request);
    said_.insert(said_.end(), when_asked_.begin(), when_asked_.end());
    when_asked_.clear();
    return Status::ok();
  }
  bool take(transport::Received& message) override {
    if (said_.empty()) return false;
    taken_ = std::move(said_.front());
    said_.pop_front();
    message = {taken_.topic, taken_.bytes};
    return true;
  }
  void wait_until(std::int64_t) override {}
  std::vector<std::string> discovered_writers(Topic) override { return {}; }
  std::vector<std::string> misfits() override { return {}; }

 private:
  struct Said {
    Topic topic{};
    transport::ByteBuffer bytes;
  };

  template <typename Message>
  static void say(const Message& message, std::deque<Said>& where) {
    Said said{transport::kTopicOf<Message>, {}};
    EXPECT_TRUE(transport::encode(message, said.bytes));
    where.push_back(std::move(said));
  }

  std::deque<Said> said_;
  std::deque<Said> when_asked_;
  Said taken_;
};

class Asking : public ::testing::Test {
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

  // "" when io has answered, else what the user is told
  std::string ask(std::uint64_t number = kRequest) {
    Observer observer(std::move(io_), "crane");
    wire::ControlRequest request;
    request.request = number;
    try {
      return observer.ask(request).is_accepted ? "" : "refused";
    } catch (const cli_support::Failure& failure) {
      EXPECT_EQ(failure.code(), ExitCode::failed);
      return failure.what();
    }
  }

  std::unique_ptr<PlayedIo> io_ = std::make_unique<PlayedIo>();
};

constexpr const char* kEnded =
    "session 'crane' ended before it answered: the session reached its end; there is nothing left to be changed; start "
    "it again";

TEST_F(Asking, IsAnswered) {
  io_->say_when_asked(accepted());
  EXPECT_EQ(ask(), "");
}

TEST_F(Asking, TakesNoEventForTheAnswerToARequestThatHasNoNumberYet) {
  wire::ControlReply event = accepted();
  event.request = 0;
  io_->say_at_first(event);
  io_->say_when_asked(end());
  EXPECT_EQ(ask(0), kEnded);
}

TEST_F(Asking, ASessionThatEndsInsteadOfAnsweringIsToldAtOnce) {
  io_->say_when_asked(end());
  EXPECT_EQ(ask(), kEnded);
}

TEST_F(Asking, ASessionThatHasEndedIsToldAtOnce) {
  io_->say_at_first(end());
  EXPECT_EQ(ask(), kEnded);
}

TEST_F(Asking, TakesAnAnswerThatComesBehindTheEnd) {
  io_->say_when_asked(end());
  io_->say_when_asked(accepted());
  EXPECT_EQ(ask(), "");
}

TEST_F(Asking, ASessionThatIsWithdrawnIsToldAtOnce) {
  wire::SessionDescription withdrawn;
  withdrawn.header = header();
  withdrawn.header.phase = wire::Phase::ended;
  withdrawn.name = "crane";
  io_->say_when_asked(withdrawn);
  EXPECT_EQ(ask(), "session 'crane' ended before it answered; there is nothing left to be changed; start it again");
}

}  // namespace
}  // namespace slew::cli
