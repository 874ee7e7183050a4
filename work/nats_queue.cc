#include <nats/nats.h>

#include <algorithm>
#include <cinttypes>
#include <regex>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "work/queue.h"

namespace freshet::work {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr const char* kConsumer = "workers";
constexpr milliseconds kStuckAfter{2000};  // without a task
constexpr std::int64_t kAnswerIn = 3000;   // ms, of one request
constexpr std::size_t kMaxFault = 2000;    // bytes of a message

template <auto destroy>
struct Destroy {
  template <class T>
  void operator()(T* object) const {
    destroy(object);
  }
};
template <class T, auto destroy>
using Owned = std::unique_ptr<T, Destroy<destroy>>;
using OwnedMessage = Owned<natsMsg, natsMsg_Destroy>;
using OwnedStream = Owned<jsStreamInfo, jsStreamInfo_Destroy>;
using OwnedConsumer = Owned<jsConsumerInfo, jsConsumerInfo_Destroy>;
using OwnedAck = Owned<jsPubAck, jsPubAck_Destroy>;

/// Takes what a call of the library leaves in a pointer; the holder has it when the whole expression ends.
template <class Holder>
class Into {
 public:
  explicit Into(Holder& holder) : holder_(holder) {}
  ~Into() { holder_.reset(raw_); }
  Into(const Into&) = delete;
  Into& operator=(const Into&) = delete;
  operator typename Holder::pointer *() { return &raw_; }

 private:
  Holder& holder_;
  typename Holder::pointer raw_ = nullptr;
};
template <class Holder>
Into<Holder> into(Holder& holder) {
  return Into<Holder>(holder);
}

struct Address {
  std::string server, name = "freshet";
};

/// For messages: without its password.
std::string shown(const std::string& url) {
  static const std::regex kUser("//[^@/]*@");
  return std::regex_replace(url, kUser, "//...@");
}

Address parse_address(const std::string& url) {
  static const std::regex kForm(R"(((?:nats|tls)://[^/\s]+)(?:/([A-Za-z0-9_-]{1,60})?)?)");
  std::smatch match;
  if (!std::regex_match(url, match, kForm))
    throw Error(ErrorKind::kUsage, "--queue " + shown(url), "is no address of a NATS server",
                "For example --queue nats://localhost:4222 or nats://host:4222/NAME");
  Address address{.server = match[1]};
  if (match[2].length() > 0) address.name = match[2];
  return address;
}

std::string text_of(natsMsg* message) {
  return {natsMsg_GetData(message), static_cast<std::size_t>(std::max(0, natsMsg_GetDataLength(message)))};
}

/// Whatever else is found there is nothing.
std::string text_in(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}
std::uint64_t number_in(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}
/// Of a server that may come back.
bool is_away(natsStatus status) {
  return status == NATS_NO_SERVER || status == NATS_TIMEOUT || status == NATS_CONNECTION_CLOSED ||
         status == NATS_CONNECTION_DISCONNECTED || status == NATS_IO_ERROR;
}

Fault fault_of(const Json& json) { return {number_in(json, "times"), text_in(json, "fault")}; }

}  // namespace

struct Delivery::Message {
  OwnedMessage message;
  std::string text;
  std::uint64_t times = 0, sequence = 0;
};

Delivery::Delivery(std::unique_ptr<Message> message) : message_(std::move(message)) {}
Delivery::Delivery(Delivery&&) noexcept = default;
Delivery::~Delivery() = default;
const std::string& Delivery::text() const { return message_->text; }
std::uint64_t Delivery::times() const { return message_->times; }
void Delivery::still_working() const { natsMsg_InProgress(message_->message.get(), nullptr); }

bool Delivery::done() {
  jsOptions options;
  jsOptions_Init(&options);
  options.Wait = kAnswerIn;
  return natsMsg_AckSync(message_->message.get(), &options, nullptr) == NATS_OK;
}

void Delivery::hand_back(milliseconds delay) {
  if (delay.count() > 0)
    natsMsg_NakWithDelay(message_->message.get(), delay.count(), nullptr);
  else
    natsMsg_Nak(message_->message.get(), nullptr);
}

struct Queue::Connection {
  Address address;
  std::string faults;  // the stream's name
  milliseconds ack_wait{};
  Owned<natsConnection, natsConnection_Destroy> nats;
  Owned<jsCtx, jsCtx_Destroy> jetstream;
  Owned<natsSubscription, natsSubscription_Destroy> workers;

  std::string subject(const char* kind, const std::string& key) const {
    return fmt::format("{}.{}.{}", address.name, kind, key);
  }
  [[noreturn]] void refuse(const std::string& doing, natsStatus status) const {
    static const std::regex kPlace("^\\([^)]*\\): ");  // of the library's source
    const char* const last = nats_GetLastError(nullptr);
    const std::string said =
        last == nullptr || *last == '\0' ? natsStatus_GetText(status) : std::regex_replace(last, kPlace, "");
    throw Error(
        ErrorKind::kIo, shown(address.server), fmt::format("{} ({})", doing, said),
        "Check that the NATS server runs there, with JetStream (nats-server -js), and that the network "
        "reaches it");
  }
  void expect(natsStatus status, const std::string& doing) const {
    if (status != NATS_OK) refuse(doing, status);
  }

  Clock::time_point last_found = Clock::now();
  Clock::time_point patient_until;

  /// Asks again, until then, while the server does not answer: what is asked may happen twice.
  template <class Ask>
  natsStatus patiently(const Ask& ask) const {
    natsStatus status = ask();
    while (is_away(status) && Clock::now() < patient_until) {
      std::this_thread::sleep_for(milliseconds(100));
      status = ask();
    }
    return status;
  }

  void connect();
  void add_stream(const std::string& name, const std::vector<std::string>& subjects, bool is_queue) const;
  void add_workers() const;
  /// A server that is killed may come back with tasks that were done already, and never deliver them: its stream was
  /// younger on the disk than its list of what was acknowledged. A new list delivers all, and what is sealed is found
  /// so.
  void deliver_anew_what_is_stuck() const;
  void put(const std::string& subject, const Json& json) const;
  /// The last message of a subject of the faults; nothing where there is none.
  std::optional<Json> last(const std::string& subject) const;
  void forget(const std::string& subject) const;
};

void Queue::Connection::connect() {
  Owned<natsOptions, natsOptions_Destroy> options;
  expect(natsOptions_Create(into(options)), "no connection can be made");
  natsOptions_SetURL(options.get(), address.server.c_str());
  natsOptions_SetName(options.get(), "freshet work");
  natsOptions_SetTimeout(options.get(), 2000);
  natsOptions_SetMaxReconnect(options.get(), -1);
  natsOptions_SetReconnectWait(options.get(), 250);
  natsOptions_SetReconnectJitter(options.get(), 100, 100);
  natsOptions_SetPingInterval(options.get(), 10'000);
  // Else what it cannot do is printed.
  natsOptions_SetErrorHandler(
      options.get(), [](natsConnection*, natsSubscription*, natsStatus, void*) {}, nullptr);
  expect(patiently([&] { return natsConnection_Connect(into(nats), options.get()); }),
         "no NATS server answers");
  jsOptions wait;
  jsOptions_Init(&wait);
  wait.Wait = kAnswerIn;
  expect(natsConnection_JetStream(into(jetstream), nats.get(), &wait), "no JetStream can be used");
}

void Queue::Connection::add_stream(const std::string& name, const std::vector<std::string>& subjects,
                                   bool is_queue) const {
  std::vector<const char*> names;
  for (const std::string& each : subjects) names.push_back(each.c_str());
  jsStreamConfig config;
  jsStreamConfig_Init(&config);
  config.Name = name.c_str();
  config.Subjects = names.data();
  config.SubjectsLen = static_cast<int>(names.size());
  config.Retention = is_queue ? js_WorkQueuePolicy : js_LimitsPolicy;
  config.MaxMsgsPerSubject = is_queue ? -1 : 1;
  jsErrCode code{};
  const natsStatus status =
      patiently([&] { return js_AddStream(nullptr, jetstream.get(), &config, nullptr, &code); });
  if (status == NATS_OK) return;
  if (code == JSStreamNameExistErr)
    throw Error(ErrorKind::kIo, shown(address.server), "has a stream \"" + name + "\" of another kind",
                "Name another queue: " + shown(address.server) + "/NAME");
  refuse("no queue can be made", status);
}

void Queue::Connection::add_workers() const {
  jsConsumerConfig config;
  jsConsumerConfig_Init(&config);
  config.Durable = kConsumer;
  config.AckPolicy = js_AckExplicit;
  config.AckWait = ack_wait.count() * 1'000'000;
  config.MaxDeliver = -1;
  config.MaxAckPending = -1;
  config.MaxWaiting = 100'000;
  expect(patiently([&] {
           return js_AddConsumer(nullptr, jetstream.get(), address.name.c_str(), &config, nullptr, nullptr);
         }),
         "no queue can be made");
}

void Queue::Connection::deliver_anew_what_is_stuck() const {
  OwnedStream stream;
  OwnedConsumer consumer;
  const char* const name = address.name.c_str();
  if (js_GetStreamInfo(into(stream), jetstream.get(), name, nullptr, nullptr) != NATS_OK) return;
  if (stream->State.Msgs == 0) return;
  if (js_GetConsumerInfo(into(consumer), jetstream.get(), name, kConsumer, nullptr, nullptr) != NATS_OK)
    return;
  if (consumer->NumAckPending > 0) return;
  js_DeleteConsumer(jetstream.get(), name, kConsumer, nullptr, nullptr);
  add_workers();
}

void Queue::Connection::put(const std::string& subject, const Json& json) const {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  expect(js_Publish(nullptr, jetstream.get(), subject.c_str(), text.data(), static_cast<int>(text.size()),
                    nullptr, nullptr),
         "a fault cannot be kept");
}

std::optional<Json> Queue::Connection::last(const std::string& subject) const {
  OwnedMessage message;
  jsErrCode code{};
  const natsStatus status =
      js_GetLastMsg(into(message), jetstream.get(), faults.c_str(), subject.c_str(), nullptr, &code);
  if (status == NATS_NOT_FOUND || code == JSNoMessageFoundErr) return std::nullopt;
  expect(status, "faults cannot be read");
  Json json = Json::parse(text_of(message.get()), nullptr, false);
  return json.is_object() ? std::optional(json) : std::nullopt;
}

void Queue::Connection::forget(const std::string& subject) const {
  jsOptions options;
  jsOptions_Init(&options);
  options.Wait = kAnswerIn;
  options.Stream.Purge.Subject = subject.c_str();
  expect(js_PurgeStream(jetstream.get(), faults.c_str(), &options, nullptr), "faults cannot be forgotten");
}

Queue::Queue(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Queue::Queue(Queue&&) noexcept = default;
Queue::~Queue() = default;

Queue Queue::open(const QueueOptions& options) {
  auto connection = std::make_unique<Connection>();
  connection->address = parse_address(options.url);
  connection->faults = connection->address.name + "-faults";
  connection->ack_wait = options.ack_wait;
  connection->patient_until = Clock::now() + options.patience;
  connection->connect();
  const std::string& name = connection->address.name;
  connection->add_stream(name, {name + ".task.*"}, true);
  connection->add_stream(connection->faults, {name + ".fault.*", name + ".dead.*"}, false);
  connection->add_workers();
  return Queue(std::move(connection));
}

bool Queue::put(const std::string& key, const std::string& text) {
  const Connection& c = *connection_;
  for (const char* kind : {"fault", "dead"}) c.forget(c.subject(kind, key));
  jsPubOptions options;
  jsPubOptions_Init(&options);
  options.ExpectNoMessage = true;
  jsErrCode code{};
  const natsStatus status = js_Publish(nullptr, c.jetstream.get(), c.subject("task", key).c_str(),
                                       text.data(), static_cast<int>(text.size()), &options, &code);
  if (code == JSStreamWrongLastSequenceErr) return false;
  c.expect(status, "a task cannot be put in");
  return true;
}

std::optional<Delivery> Queue::next(milliseconds patience) {
  Connection& c = *connection_;
  if (!c.workers) {
    jsSubOptions options;
    jsSubOptions_Init(&options);
    options.Stream = c.address.name.c_str();
    options.Consumer = kConsumer;
    if (js_PullSubscribe(into(c.workers), c.jetstream.get(), (c.address.name + ".task.*").c_str(), kConsumer,
                         nullptr, &options, nullptr) != NATS_OK) {
      std::this_thread::sleep_for(patience);
      return std::nullopt;
    }
  }
  natsMsgList list{};
  const Clock::time_point begin = Clock::now();
  const natsStatus status = natsSubscription_Fetch(&list, c.workers.get(), 1, patience.count(), nullptr);
  if (status != NATS_OK || list.Count < 1) {  // at once, where no server is connected
    if (Clock::now() - c.last_found > kStuckAfter) {
      try {
        c.deliver_anew_what_is_stuck();
      } catch (const Error&) {  // the server has gone; later, then
      }
      c.last_found = Clock::now();
    }
    std::this_thread::sleep_until(begin + patience);
    return std::nullopt;
  }
  c.last_found = Clock::now();
  auto message = std::make_unique<Delivery::Message>();
  message->message.reset(std::exchange(list.Msgs[0], nullptr));
  natsMsgList_Destroy(&list);
  message->text = text_of(message->message.get());
  Owned<jsMsgMetaData, jsMsgMetaData_Destroy> meta;
  if (natsMsg_GetMetaData(into(meta), message->message.get()) == NATS_OK) {
    message->times = meta->NumDelivered;
    message->sequence = meta->Sequence.Stream;
  }
  return Delivery(std::move(message));
}

std::uint64_t Queue::left() const {
  OwnedStream stream;
  connection_->expect(js_GetStreamInfo(into(stream), connection_->jetstream.get(),
                                       connection_->address.name.c_str(), nullptr, nullptr),
                      "its state cannot be read");
  return stream->State.Msgs;
}

QueueStatus Queue::status() const {
  constexpr std::size_t kMostDead = 100;
  const Connection& c = *connection_;
  QueueStatus status;
  OwnedConsumer consumer;
  c.expect(js_GetConsumerInfo(into(consumer), c.jetstream.get(), c.address.name.c_str(), kConsumer, nullptr,
                              nullptr),
           "its state cannot be read");
  const std::uint64_t all = left();
  status.in_hand =
      std::min(all, static_cast<std::uint64_t>(std::max<std::int64_t>(0, consumer->NumAckPending)));
  status.waiting = all - status.in_hand;
  jsOptions options;
  jsOptions_Init(&options);
  options.Wait = kAnswerIn;
  const std::string dead = c.subject("dead", "*");
  options.Stream.Info.SubjectsFilter = dead.c_str();
  OwnedStream faults;
  c.expect(js_GetStreamInfo(into(faults), c.jetstream.get(), c.faults.c_str(), &options, nullptr),
           "its state cannot be read");
  if (faults->State.Subjects == nullptr) return status;
  status.dead = static_cast<std::uint64_t>(faults->State.Subjects->Count);
  for (int i = 0; i < faults->State.Subjects->Count && status.dead_tasks.size() < kMostDead; ++i)
    if (const std::optional<Json> json = c.last(faults->State.Subjects->List[i].Subject))
      status.dead_tasks.push_back({text_in(*json, "task"), fault_of(*json)});
  return status;
}

Fault Queue::add_fault(const std::string& key, const Delivery& delivery, const std::string& message) {
  const Connection& c = *connection_;
  const std::string subject = c.subject("fault", key);
  Fault fault{.times = 1, .message = message.substr(0, kMaxFault)};
  // Of a task that was put in before, done, and is put in again, nothing counts.
  if (const std::optional<Json> before = c.last(subject);
      before && number_in(*before, "sequence") == delivery.message_->sequence)
    fault.times += fault_of(*before).times;
  c.put(subject,
        {{"times", fault.times}, {"fault", fault.message}, {"sequence", delivery.message_->sequence}});
  return fault;
}

void Queue::bury(const std::string& key, Delivery& delivery, const Fault& fault) {
  const Connection& c = *connection_;
  c.put(c.subject("dead", key),
        {{"task", delivery.text()}, {"times", fault.times}, {"fault", fault.message}});
  if (!delivery.done()) c.refuse("a task cannot be given up", NATS_TIMEOUT);
}

}  // namespace freshet::work
