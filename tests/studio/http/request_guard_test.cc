#include "studio/http/request_guard.h"

#include <gtest/gtest.h>

namespace freshet::studio {
namespace {

std::string guard_host() { return "127.0.0.1:80"; }

const RequestGuard& guard() {
  static const RequestGuard made(
      "secret", {"127.0.0.1:80", "localhost:80"},
      [](std::string_view method, std::string_view) { return method == "PUT" ? 1u << 20 : 0; });
  return made;
}

RequestHead head_of(std::string method, std::string path) {
  RequestHead head;
  head.method = std::move(method);
  head.path = std::move(path);
  head.host = guard_host();
  return head;
}

RequestHead good() { return head_of("GET", "/secret/api/home"); }

int status(const RequestHead& head) {
  const std::optional<Refusal> refusal = guard().refusal(head);
  return refusal ? refusal->status : 200;
}

TEST(RequestGuard, LetsItsOwnPageIn) {
  RequestHead head = good();
  EXPECT_EQ(status(head), 200);
  head.host = "localhost:80";
  head.origin = "http://localhost:80";
  head.fetch_site = "same-origin";
  EXPECT_EQ(status(head), 200);
}

TEST(RequestGuard, RefusesAnAddressThatWasMadeToPointHere) {
  for (const char* host : {"evil.example", "127.0.0.1", "127.0.0.1:81", "", "127.0.0.1:80.evil.example"}) {
    RequestHead head = good();
    head.host = host;
    EXPECT_EQ(status(head), 403) << host;
  }
}

TEST(RequestGuard, RefusesOtherPages) {
  for (const char* origin : {"http://evil.example", "https://127.0.0.1:80", "http://127.0.0.1:81", "null"}) {
    RequestHead head = good();
    head.origin = origin;
    EXPECT_EQ(status(head), 403) << origin;
  }
  RequestHead head = good();
  head.fetch_site = "cross-site";
  EXPECT_EQ(status(head), 403);
  head.path = "/secret/";  // a link that opens the page does nothing else
  EXPECT_EQ(status(head), 200);
}

TEST(RequestGuard, RefusesWhoDoesNotKnowTheToken) {
  for (const char* path :
       {"/", "", "/secre/api/home", "/secret1/api/home", "/SECRET/", "/api/home", "//secret/"}) {
    RequestHead head = good();
    head.path = path;
    EXPECT_EQ(status(head), 403) << path;
  }
}

/// The status of a PUT that says it is so long.
int status_of_length(std::string length) {
  RequestHead head = head_of("PUT", "/secret/api/projects/a/document");
  head.content_length = std::move(length);
  return status(head);
}

TEST(RequestGuard, BoundsWhatIsSent) {
  EXPECT_EQ(status_of_length("1000"), 200);
  EXPECT_EQ(status_of_length("5368709120"), 413);
  EXPECT_EQ(status_of_length("99999999999999999999999"), 400);
  EXPECT_EQ(status_of_length("-1"), 400);
  EXPECT_EQ(status_of_length({}), 411);
  RequestHead chunked = head_of("PUT", "/secret/api/projects/a/document");
  chunked.transfer_encoding = std::string("chunked");
  EXPECT_EQ(status(chunked), 411);
  EXPECT_EQ(status(head_of("TRACE", "/secret/api/home")), 405);
  RequestHead talkative = good();
  talkative.content_length = std::to_string(1);
  EXPECT_EQ(status(talkative), 413);
}

TEST(RequestGuard, TakesABodyOnlyAsItIs) {
  RequestHead head = head_of("PUT", "/secret/api/projects/a/document");
  head.content_length = std::string("10");
  for (const char* type : {"", "application/json", "application/x-www-form-urlencoded"}) {
    head.content_type = type;
    EXPECT_EQ(status(head), 200) << type;
  }
  head.content_encoding = std::string("gzip");
  EXPECT_EQ(status(head), 415);
  head.content_encoding = std::string("identity");
  EXPECT_EQ(status(head), 200);
  head.content_type = std::string("multipart/form-data; boundary=x");
  EXPECT_EQ(status(head), 415);
}

TEST(RequestGuard, DrawsTokensThatDiffer) {
  EXPECT_EQ(fresh_token().size(), 32u);
  EXPECT_NE(fresh_token(), fresh_token());
}

}  // namespace
}  // namespace freshet::studio
