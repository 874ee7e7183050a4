// Where libnats was not there when the program was built.

#include "freshet/error.h"
#include "work/queue.h"

namespace freshet::work {
namespace {

[[noreturn]] void refuse(const std::string& where) {
  throw Error(ErrorKind::kIo, where, "this freshet was built without NATS",
              "Install libnats-dev, and configure and build it again");
}

}  // namespace

struct Delivery::Message {};
struct Queue::Connection {};

Delivery::Delivery(std::unique_ptr<Message> message) : message_(std::move(message)) {}
Delivery::Delivery(Delivery&&) noexcept = default;
Delivery::~Delivery() = default;
const std::string& Delivery::text() const { refuse("queue"); }
std::uint64_t Delivery::times() const { refuse("queue"); }
void Delivery::still_working() const { refuse("queue"); }
bool Delivery::done() { refuse("queue"); }
void Delivery::hand_back(std::chrono::milliseconds) { refuse("queue"); }

Queue::Queue(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Queue::Queue(Queue&&) noexcept = default;
Queue::~Queue() = default;
Queue Queue::open(const QueueOptions& options) { refuse(options.url); }
bool Queue::put(const std::string&, const std::string&) { refuse("queue"); }
std::optional<Delivery> Queue::next(std::chrono::milliseconds) { refuse("queue"); }
std::uint64_t Queue::left() const { refuse("queue"); }
QueueStatus Queue::status() const { refuse("queue"); }
Fault Queue::add_fault(const std::string&, const Delivery&, const std::string&) { refuse("queue"); }
void Queue::bury(const std::string&, Delivery&, const Fault&) { refuse("queue"); }

}  // namespace freshet::work
