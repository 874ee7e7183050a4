#include "report/page.h"

#include <gtest/gtest.h>

#include "report/data_address.h"

namespace freshet::report {
namespace {

TEST(Page, TemplatesAreFilledOnceAndOnlyWhereTheyAsk) {
  EXPECT_EQ(filled("a {{x}} b {{y}}{{x}}", {{"x", "1"}, {"y", "{{x}}"}}), "a 1 b {{x}}1")
      << "values are not looked into";
  EXPECT_EQ(filled("{{none}} {{x", {{"x", "1"}}), "{{none}} {{x") << "what has no value stays";
  EXPECT_EQ(filled("", {}), "");
}

TEST(Page, IsOneWholeFileThatNeedsNothingElse) {
  const std::string page = page_html("a <title>", "<p>body</p>\n");
  EXPECT_EQ(page.find("<!doctype html>"), 0u);
  EXPECT_NE(page.find("<title>a &lt;title&gt;</title>"), std::string::npos);
  EXPECT_NE(page.find("<h1>a &lt;title&gt;</h1>\n<p>body</p>\n"), std::string::npos);
  EXPECT_NE(page.find("--paper"), std::string::npos) << "the charts' colours";
  for (const char* outside : {"{{", "http", "src=", "href="})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

TEST(Page, BytesBecomeAnAddress) {
  const auto address = [](std::string_view text) {
    return data_address("text/plain", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(address(""), "data:text/plain;base64,");
  EXPECT_EQ(address("f"), "data:text/plain;base64,Zg==");  // RFC 4648, 10
  EXPECT_EQ(address("fooba"), "data:text/plain;base64,Zm9vYmE=");
  EXPECT_EQ(address("foobar"), "data:text/plain;base64,Zm9vYmFy");
}

TEST(Page, ATableHasItsHeadsAndCells) {
  HtmlTable table({"name", "ms"});
  table.add({"a &lt; b", "3"});
  EXPECT_NE(table.html().find("<th scope=\"col\">ms</th>"), std::string::npos);
  EXPECT_NE(table.html().find("<tr><td>a &lt; b</td><td>3</td></tr>"), std::string::npos);
}

}  // namespace
}  // namespace freshet::report
