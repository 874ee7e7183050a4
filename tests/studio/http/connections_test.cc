#include "studio/http/connections.h"

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/studio/http/raw_client.h"

namespace freshet::studio {
namespace {

/// Connections whose heads are answered by "HTTP/1.1 200 OK", or kept.
class Serving {
 public:
  explicit Serving(ConnectionLimits limits, bool keeps = false) : connections_("127.0.0.1", 0, limits) {
    thread_ = std::thread([this, keeps] {
      connections_.serve([&](std::shared_ptr<Connection> connection) {
        ++heads_;
        last_ = connection->received();
        if (keeps)
          kept_.push_back(connection);
        else
          ::send(connection->socket(), "HTTP/1.1 200 OK\r\n\r\n", 19, MSG_NOSIGNAL);
      });
      kept_.clear();
    });
  }
  ~Serving() {
    connections_.stop();
    thread_.join();
  }
  int port() const { return connections_.port(); }
  int heads() const { return heads_; }
  const std::string& last() const { return last_; }  // read after an answer

 private:
  Connections connections_;
  std::atomic<int> heads_{0};
  std::string last_;
  std::vector<std::shared_ptr<Connection>> kept_;
  std::thread thread_;
};

TEST(Connections, HandOverAHeadHoweverItComes) {
  const Serving serving({});
  const std::string head = "GET / HTTP/1.1\r\nA: b\r\n\r\n";
  {
    const RawClient client(serving.port());
    client.send(head + "body");
    EXPECT_TRUE(client.read_all().starts_with("HTTP/1.1 200"));
    EXPECT_EQ(serving.last(), head + "body");
  }
  const RawClient client(serving.port());
  for (const char byte : head) {
    client.send(std::string(1, byte));
    ::usleep(500);
  }
  EXPECT_TRUE(client.read_all().starts_with("HTTP/1.1 200"));
  EXPECT_EQ(serving.last(), head);
}

TEST(Connections, CloseAHeadThatIsLate) {
  const Serving serving({.head_deadline = std::chrono::milliseconds(300)});
  const RawClient slow(serving.port()), late(serving.port()), silent(serving.port());
  slow.send("GET / HTTP/1.1\r\nX: ");
  late.send("GET");
  const auto begin = std::chrono::steady_clock::now();
  while (slow.send("a") && !slow.has_answer(20)) continue;  // bytes keep coming
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_TRUE(late.read_all().starts_with("HTTP/1.1 408"));
  EXPECT_EQ(silent.read_all(),
            "");  // a browser's, ahead of its request: a 408 would be that request's answer
  EXPECT_EQ(serving.heads(), 0);
}

TEST(Connections, BoundAHead) {
  const Serving serving({.max_head_bytes = 4096, .max_headers = 10});
  const RawClient large(serving.port());
  large.send("GET / HTTP/1.1\r\nX: " + std::string(5000, 'a'));
  EXPECT_TRUE(large.read_all().starts_with("HTTP/1.1 431"));
  const RawClient many(serving.port());
  std::string headers;
  for (int i = 0; i < 12; ++i) headers += "X: y\r\n";
  many.send("GET / HTTP/1.1\r\n" + headers);
  EXPECT_TRUE(many.read_all().starts_with("HTTP/1.1 431"));
  const RawClient whole(serving.port());  // a head that is whole at once, but too long
  whole.send("GET / HTTP/1.1\r\nX: " + std::string(5000, 'a') + "\r\n\r\n");
  EXPECT_TRUE(whole.read_all().starts_with("HTTP/1.1 431"));
  EXPECT_EQ(serving.heads(), 0);
}

TEST(Connections, TheOldestHeadGivesWayToANewOne) {
  const Serving serving({.max_heads_per_peer = 3});
  std::vector<RawClient> slow;
  for (int i = 0; i < 3; ++i) {
    slow.emplace_back(serving.port()).send("GET / HTTP/1.1\r\nX: ");
    ::usleep(20'000);
  }
  EXPECT_FALSE(slow[0].has_answer(50));
  slow.emplace_back(serving.port());
  EXPECT_TRUE(slow[0].read_all().starts_with("HTTP/1.1 503"));
  EXPECT_FALSE(slow[1].has_answer(50));
  const RawClient good(serving.port());
  good.send("GET / HTTP/1.1\r\n\r\n");
  EXPECT_TRUE(good.read_all().starts_with("HTTP/1.1 200"));
}

TEST(Connections, AreBoundedTogether) {
  const Serving serving({.max_connections = 3}, true);
  std::vector<RawClient> clients;
  for (int i = 0; i < 3; ++i) {
    clients.emplace_back(serving.port()).send("GET / HTTP/1.1\r\n\r\n");
    while (serving.heads() <= i) ::usleep(1000);
  }
  const RawClient one_more(serving.port());
  EXPECT_TRUE(one_more.read_all().starts_with("HTTP/1.1 503"));
  EXPECT_FALSE(clients[0].has_answer(50)) << "a request whose head was whole is kept";
}

TEST(Connections, SayWhatCannotBeListenedOn) {
  const Connections taken("127.0.0.1", 0);
  EXPECT_THROW(Connections("127.0.0.1", taken.port()), std::exception);
  EXPECT_THROW(Connections("no.such.host.invalid", 0), std::exception);
}

}  // namespace
}  // namespace freshet::studio
