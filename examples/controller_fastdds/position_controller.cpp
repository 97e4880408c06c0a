// SPDX-License-Identifier: Apache-2.0
// Closes a position loop on a cylinder of a running session, from outside, over Fast DDS: it reads the variables that
// the nodes publish and writes one input channel. Its types are made of the installed slewring.idl by fastddsgen, its
// settings are in slewring_fastdds.xml. examples/controller is the same with Slewring's client library.
//
//   position_controller --session crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86
//
// Steps: find the variable's owner and index in the directory, acquire the channel, then answer every value of the
// variable, in order, with a stick value; release the channel at the end. A lockstep channel needs no more than that.
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "options.h"
#include "slewringPubSubTypes.h"

namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr char kUsage[] =
    "usage: position_controller --session NAME [--variable Cyl_Lift.stroke] [--channel Input_Lift]\n"
    "         [--target 0.86] [--tolerance 0.001] [--gain 20] [--overlap 0.32] [--seconds 15]\n"
    "         [--name position_controller] [--domain 0]\n"
    "Example, with `slewring run scenes/truck_crane.yaml --input none --duration 0` in another terminal:\n"
    "  position_controller --session truck_crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86\n";

constexpr int kSteady = 100;               // values in a row within the tolerance
constexpr std::size_t kMostWaiting = 128;  // values that a writer keeps

struct Settings {
  std::string variable = "Cyl_Lift.stroke";
  std::string channel = "Input_Lift";
  double target = 0.86;     // unit of the variable
  double tolerance = 1e-3;  // unit of the variable
  double gain = 20;         // stick per unit of error
  double overlap = 0.32;    // the valve does nothing below this stick value
};

template <typename Entity>
Entity* checked(Entity* entity, const std::string& what) {
  if (entity == nullptr) throw std::runtime_error("Fast DDS cannot create " + what);
  return entity;
}

// The participant and its endpoints, all in the partition slewring/<session>.
class Connection {
 public:
  Connection(unsigned domain, const std::string& session) {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    const auto profiles = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "slewring_fastdds.xml";
    if (factory->load_XML_profiles_file(profiles.string()) != ReturnCode_t::RETCODE_OK) {
      throw std::runtime_error("cannot read " + profiles.string());
    }
    participant_ = checked(factory->create_participant_with_profile(domain, "slewring"), "a participant");
    dds::SubscriberQos subscriber_qos = dds::SUBSCRIBER_QOS_DEFAULT;
    dds::PublisherQos publisher_qos = dds::PUBLISHER_QOS_DEFAULT;
    subscriber_qos.partition().push_back(("slewring/" + session).c_str());
    publisher_qos.partition().push_back(("slewring/" + session).c_str());
    subscriber_ = checked(participant_->create_subscriber(subscriber_qos), "a subscriber");
    publisher_ = checked(participant_->create_publisher(publisher_qos), "a publisher");
    directory = reader<slewring::VariableDirectoryPubSubType>("slewring/variable_directory", "slewring_kept");
    // also the last blocks from before this reader was discovered: those of step 0, which a lockstep channel's first
    // tick needs
    variables = reader<slewring::VariableBlockPubSubType>("slewring/variables", "slewring_kept");
    lease = reader<slewring::ControllerLeasePubSubType>("slewring/controller_lease", "slewring_stream");
    input = checked(publisher_->create_datawriter_with_profile(
                        topic<slewring::ControllerInputPubSubType>("slewring/controller_input"), "slewring_stream"),
                    "the input's writer");
  }
  ~Connection() {
    if (participant_ == nullptr) return;
    if (input != nullptr) input->wait_for_acknowledgments({0, 250'000'000});
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // Returns when a message may be there, or after 20 ms.
  void wait() {
    dds::ConditionSeq active;
    static_cast<void>(waiting_.wait(active, {0, 20'000'000}));
  }

  dds::DataReader* directory = nullptr;
  dds::DataReader* variables = nullptr;
  dds::DataReader* lease = nullptr;
  dds::DataWriter* input = nullptr;

 private:
  template <typename Type>
  dds::Topic* topic(const std::string& name) {
    dds::TypeSupport type(new Type());
    type.register_type(participant_);
    return checked(participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT), name);
  }
  template <typename Type>
  dds::DataReader* reader(const std::string& name, const std::string& profile) {
    dds::DataReader* made =
        checked(subscriber_->create_datareader_with_profile(topic<Type>(name), profile), "the reader of " + name);
    made->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
    waiting_.attach_condition(made->get_statuscondition());
    return made;
  }

  dds::WaitSet waiting_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
};

// takes every sample that is there and hands it to `use`
template <typename Sample, typename Use>
void take_all(dds::DataReader& reader, Use use) {
  Sample sample;
  dds::SampleInfo about;
  while (reader.take_next_sample(&sample, &about) == ReturnCode_t::RETCODE_OK) {
    if (about.valid_data) use(sample);
  }
}

class Loop {
 public:
  Loop(const Settings& settings, const SessionOptions& options, Connection& connection)
      : settings_(settings), options_(options), connection_(connection) {}

  void find_variable() {
    take_all<slewring::VariableDirectory>(*connection_.directory, [&](const slewring::VariableDirectory& d) {
      for (unsigned i = 0; i < d.entries().size(); ++i) {
        if (d.entries()[i].name() == settings_.variable) place_ = {true, d.header().role(), d.first() + i};
      }
    });
  }

  // Keeps the new values of the variable with their steps, until they are answered. They may arrive before the
  // directory that names them and before the lease that was granted first: a lockstep channel needs them from step 0
  // on.
  void read_variable() {
    if (!place_.is_known) return;
    take_all<slewring::VariableBlock>(*connection_.variables, [&](const slewring::VariableBlock& block) {
      if (block.header().role() != place_.role) return;
      if (place_.index < block.first() || place_.index >= block.first() + block.values().size()) return;
      waiting_.emplace_back(block.header().step(), block.values()[place_.index - block.first()]);
    });
    // in mid-run only the newest is used
    const std::size_t most = has_lease_ ? (is_begun_late_ ? 1 : waiting_.size()) : kMostWaiting;
    while (waiting_.size() > most) waiting_.pop_front();
    if (has_lease_) is_begun_late_ = false;
  }

  // answers the oldest waiting value; false when there is none
  bool answer() {
    if (waiting_.empty()) return false;
    std::tie(step_, value_) = waiting_.front();
    waiting_.pop_front();
    send(slewring::CONTROLLER_WRITE, stick());
    return true;
  }

  void read_lease() {
    take_all<slewring::ControllerLease>(*connection_.lease, [&](const slewring::ControllerLease& lease) {
      if (lease.controller() != options_.name || lease.channel() != settings_.channel) return;
      // the lease may answer or inform another process of this name
      const bool is_notice = lease.answers() == 0;
      if (is_notice ? !has_lease_ : lease.answers() < requested_from_ || lease.answers() > sequence_) return;
      const bool is_taken_away = has_lease_ && !lease.is_granted() && lease.holder().size() == 0;
      const bool had_lease = has_lease_;
      has_lease_ = lease.is_granted() && lease.holder() == options_.name;
      if (has_lease_ && !had_lease) is_begun_late_ = lease.header().step() > 0;
      if (is_taken_away) {
        std::fprintf(stderr, "position_controller: %s\n", lease.reason().c_str());
        requested_from_ = sequence_ + 1;
      } else if (!lease.is_granted()) {
        refusal_ = lease.reason().to_string();
      }
    });
  }

  void send(slewring::ControllerAction action, double stick) {
    slewring::ControllerInput input;
    input.session(options_.session);
    input.controller(options_.name);
    input.channel(settings_.channel);
    input.action(action);
    input.value(stick);
    input.sequence_number(++sequence_);
    input.based_on_step(step_);
    connection_.input->write(&input);
  }

  // proportional, with a jump over the valve's overlap and a rest within half the tolerance
  [[nodiscard]] double stick() const {
    const double error = settings_.target - value_;
    if (std::fabs(error) < 0.5 * settings_.tolerance) return 0;
    const double share = std::min(1.0, std::fabs(settings_.gain * error));
    return std::copysign(settings_.overlap + (1 - settings_.overlap) * share, error);
  }

  [[nodiscard]] bool has_place() const { return place_.is_known; }
  [[nodiscard]] bool has_lease() const { return has_lease_; }
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] bool is_there() const { return std::fabs(settings_.target - value_) < settings_.tolerance; }

 private:
  // writer's role and position in that node's blocks
  struct Place {
    bool is_known = false;
    slewring::Role role = slewring::ROLE_MECHANICS;
    std::uint64_t index = 0;
  };

  const Settings& settings_;
  const SessionOptions& options_;
  Connection& connection_;
  Place place_;
  bool has_lease_ = false;
  bool is_begun_late_ = false;  // the lease was granted in mid-run, and nothing has been answered since
  std::string refusal_;
  std::deque<std::pair<std::int64_t, double>> waiting_;  // step and value
  double value_ = 0;
  std::int64_t step_ = -1;
  std::uint64_t sequence_ = std::random_device()() * (std::uint64_t{1} << 31);  // no other process's numbers
  std::uint64_t requested_from_ = sequence_ + 1;  // first message that may request the channel
};

// Exit code; prints the result.
int run(const SessionOptions& options, const Settings& settings) {
  Connection connection(static_cast<unsigned>(options.domain), options.session);
  Loop loop(settings, options, connection);
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  auto requested = begin - std::chrono::seconds(1);
  int steady = 0;
  bool had_lease = false;
  while (std::chrono::duration<double>(Clock::now() - begin).count() < options.seconds && steady < kSteady) {
    connection.wait();
    loop.find_variable();
    loop.read_lease();
    if (!loop.refusal().empty()) {
      std::fprintf(stderr, "position_controller: refused: %s\n", loop.refusal().c_str());
      return 1;
    }
    loop.read_variable();
    had_lease |= loop.has_lease();
    if (!loop.has_lease()) {
      // repeats the request until the session answers
      if (loop.has_place() && Clock::now() - requested > std::chrono::milliseconds(100)) {
        requested = Clock::now();
        loop.send(slewring::CONTROLLER_ACQUIRE, 0);
      }
      continue;
    }
    while (steady < kSteady && loop.answer()) steady = loop.is_there() ? steady + 1 : 0;
  }
  if (loop.has_lease()) loop.send(slewring::CONTROLLER_RELEASE, 0);
  if (!loop.has_place()) {
    std::fprintf(stderr, "position_controller: no session '%s' in domain %g publishes %s\n", options.session.c_str(),
                 options.domain, settings.variable.c_str());
    return 1;
  }
  if (!had_lease) {
    std::fprintf(stderr,
                 "position_controller: session '%s' did not answer for channel %s within %g s; nothing was moved\n",
                 options.session.c_str(), settings.channel.c_str(), options.seconds);
    return 1;
  }
  std::printf("%s = %.5f, target %.5f: %s\n", settings.variable.c_str(), loop.value(), settings.target,
              steady >= kSteady ? "reached" : "not reached");
  return steady >= kSteady ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  SessionOptions options;
  options.name = "position_controller";
  Settings settings;
  const std::vector<Option> known = {
      {"--variable", nullptr, &settings.variable}, {"--channel", nullptr, &settings.channel},
      {"--target", &settings.target, nullptr},     {"--tolerance", &settings.tolerance, nullptr},
      {"--gain", &settings.gain, nullptr},         {"--overlap", &settings.overlap, nullptr},
      {"--session", nullptr, &options.session},    {"--name", nullptr, &options.name},
      {"--domain", &options.domain, nullptr},      {"--seconds", &options.seconds, nullptr}};
  if (const int problem = parse("position_controller", argc, argv, known, kUsage); problem != 0)
    return problem == 1 ? 0 : problem;
  if (const int problem = options.check("position_controller", kUsage); problem != 0) return problem;
  try {
    return run(options, settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "position_controller: %s\n", error.what());
    return 1;
  }
}
