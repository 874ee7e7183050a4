#include "hints/strokes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "freshet/error.h"
#include "hints/svg_path.h"
#include "hints/svg_scanner.h"
#include "hints/svg_strokes.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::hints {
namespace {

const cv::Size kPicture(200, 100);

std::vector<Stroke> svg(const std::string& body, const std::string& head = "viewBox='0 0 200 100'",
                        std::vector<std::string>* notices = nullptr) {
  return read_svg_strokes("<svg xmlns='http://www.w3.org/2000/svg' " + head + ">" + body + "</svg>", "a.svg",
                          kPicture, notices);
}

void expect_points(const Stroke& stroke, const std::vector<cv::Point2f>& expected) {
  ASSERT_EQ(stroke.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT(cv::norm(stroke.points[i] - expected[i]), 1e-3) << i << ": " << stroke.points[i];
}

/// Each subpath's first point and the end of each of its curves.
std::vector<std::vector<cv::Point2d>> ends(const char* d) {
  std::vector<std::vector<cv::Point2d>> all;
  for (const SvgSubpath& subpath : parse_svg_path(d)) {
    all.emplace_back();
    for (std::size_t i = 0; i < subpath.points.size(); i += 3) all.back().push_back(subpath.points[i]);
  }
  return all;
}

using Lines = std::vector<std::vector<cv::Point2d>>;

TEST(SvgPath, ReadsEveryCommandAndItsRepeats) {
  EXPECT_EQ(ends("M1 2L3 4 5 6"), (Lines{{{1, 2}, {3, 4}, {5, 6}}}));
  EXPECT_EQ(ends("M1 2 3 4"), (Lines{{{1, 2}, {3, 4}}})) << "further pairs of M are lines";
  EXPECT_EQ(ends("m1 2 3 4 5 6"), (Lines{{{1, 2}, {4, 6}, {9, 12}}}));
  EXPECT_EQ(ends("M1,2H5h-1V9v1 1"), (Lines{{{1, 2}, {5, 2}, {4, 2}, {4, 9}, {4, 10}, {4, 11}}}));
  EXPECT_EQ(ends("M0 0c1 1 2 2 3 3s4 4 5 5"), (Lines{{{0, 0}, {3, 3}, {8, 8}}}));
  EXPECT_EQ(ends("M0 0Q1 1 2 0T4 0 6 0"), (Lines{{{0, 0}, {2, 0}, {4, 0}, {6, 0}}}));
  EXPECT_EQ(ends("M0 0h4v4zl1 1"), (Lines{{{0, 0}, {4, 0}, {4, 4}, {0, 0}}, {{0, 0}, {1, 1}}}));
  EXPECT_EQ(ends("M0 0L1 1M5 5l1 0m2 2h1"), (Lines{{{0, 0}, {1, 1}}, {{5, 5}, {6, 5}}, {{8, 7}, {9, 7}}}));
  EXPECT_EQ(ends("M5 5"), Lines{}) << "a lone M draws nothing";
  EXPECT_EQ(ends(""), Lines{});
}

TEST(SvgPath, NumbersNeedNoSeparators) {
  EXPECT_EQ(ends("M1.5.5-3e2+4"), (Lines{{{1.5, 0.5}, {-300, 4}}}));
  EXPECT_EQ(ends(" \n\tm-.5-.25 ,1e-1,1E1"), (Lines{{{-0.5, -0.25}, {-0.4, 9.75}}}));
  EXPECT_EQ(ends("M0 0L1e-400 5."), (Lines{{{0, 0}, {0, 5}}}));
}

TEST(SvgPath, SmoothCurvesReflectTheControlPointBefore) {
  const auto s = parse_svg_path("M0 0C0 5 5 5 5 0S10-5 10 0")[0].points;
  EXPECT_EQ(s[4], cv::Point2d(5, -5));
  const auto alone = parse_svg_path("M2 3S10-5 10 0")[0].points;
  EXPECT_EQ(alone[1], cv::Point2d(2, 3)) << "without a curve before, the pen's place";
  const auto after_line = parse_svg_path("M0 0Q0 5 5 5L6 6T8 8")[0].points;
  EXPECT_EQ(after_line[7], cv::Point2d(6, 6));
}

TEST(SvgPath, ArcsLieOnTheirEllipse) {
  // Flags stand without separators, as optimisers write them.
  for (const char* d : {"M10 0A10 10 0 0 1 0 10", "M10 0a10 10 0 01-10 10", "M10 0A10,10,0,0,1,0,10"}) {
    const SvgSubpath arc = parse_svg_path(d)[0];
    EXPECT_EQ(arc.points.back(), cv::Point2d(0, 10));
    for (const cv::Point2f& point : flatten(arc, 0.01)) EXPECT_NEAR(cv::norm(point), 10, 0.02);
  }
  // The large arc the other way round.
  double turned = 0;
  const auto chain = flatten(parse_svg_path("M10 0A10 10 0 1 0 0 10")[0], 0.01);
  for (std::size_t i = 1; i < chain.size(); ++i) turned += std::asin(chain[i - 1].cross(chain[i]) / 100);
  EXPECT_NEAR(turned, -3 * CV_PI / 2, 0.02);
  // An ellipse turned by 90 degrees; radii that are too small grow; none make a line.
  for (const cv::Point2f& point : flatten(parse_svg_path("M0 20A20 5 90 0 1 0-20")[0], 0.01)) {
    EXPECT_NEAR(std::hypot(point.x / 5, point.y / 20), 1, 2e-3);
    EXPECT_LT(point.x, 1e-3) << "the sweep goes by the left";
  }
  for (const cv::Point2f& point : flatten(parse_svg_path("M-10 0A1 1 0 0 1 10 0")[0], 0.01))
    EXPECT_NEAR(cv::norm(point), 10, 0.02);
  EXPECT_EQ(flatten(parse_svg_path("M0 0A0 5 0 0 1 9 9")[0], 0.01).size(), 2u);
}

TEST(SvgPath, RefusesWhatIsMalformed) {
  for (const char* d : {"L1 1", "M1", "M1 1L", "M1 1L2", "M1 1 X", "M1 1L2 2Z3 3", "M1 1A1 1 0 2 0 5 5",
                        "M1 1Lnan 2", "M1 1Linf 2", "M1 1L1e999 2", "M.. 1", "1 1", "M1 1L--1 2"})
    EXPECT_THROW(parse_svg_path(d), SvgFault) << d;
}

TEST(SvgPath, FlattensToWithinTheTolerance) {
  const SvgSubpath curve = parse_svg_path("M0 0C0 100 100 100 100 0")[0];
  const auto chain = flatten(curve, 0.1), fine = flatten(curve, 1e-4);
  EXPECT_LT(chain.size(), 40u);
  for (const cv::Point2f& point : fine) {
    double nearest = 1e9;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const cv::Point2f way = chain[i] - chain[i - 1];
      const float t = std::clamp((point - chain[i - 1]).dot(way) / way.dot(way), 0.0f, 1.0f);
      nearest = std::min(nearest, cv::norm(point - (chain[i - 1] + way * t)));
    }
    EXPECT_LT(nearest, 0.1);
  }
}

TEST(SvgStrokes, ReadsLinesAndPolylines) {
  const auto strokes =
      svg("<line x1='1' y1='2' x2='50%' y2='4'/><polyline points='1,2 3,4 5-6'/>"
          "<polygon points='0 0 4 0 4 4'/><path id='fall' d='M0 0L9 9M5 5L6 6'/>");
  ASSERT_EQ(strokes.size(), 5u);
  expect_points(strokes[0], {{1, 2}, {100, 4}});
  expect_points(strokes[1], {{1, 2}, {3, 4}, {5, -6}});
  expect_points(strokes[2], {{0, 0}, {4, 0}, {4, 4}, {0, 0}});
  expect_points(strokes[4], {{5, 5}, {6, 6}});
  EXPECT_EQ(strokes[4].name, "path \"fall\", part 2");
}

TEST(SvgStrokes, AppliesTransformsOfElementsGroupsAndDocuments) {
  const char* line = "<path d='M0 0H10'/>";
  const auto one = [&](const std::string& transform) {
    return svg("<g transform='" + transform + "'>" + line + "</g>").at(0);
  };
  expect_points(one("translate(5)"), {{5, 0}, {15, 0}});
  expect_points(one("translate(5,6) scale(2)"), {{5, 6}, {25, 6}});
  expect_points(one("scale(2 3),translate(5 6)"), {{10, 18}, {30, 18}});
  expect_points(one("rotate(90)"), {{0, 0}, {0, 10}});
  expect_points(one("rotate(90 10 0)"), {{10, -10}, {10, 0}});
  expect_points(one("matrix(0 1 -1 0 3 4)"), {{3, 4}, {3, 14}});
  expect_points(one("skewY(45)"), {{0, 0}, {10, 10}});
  expect_points(svg("<path d='M0 0V10' transform='skewX(45)'/>").at(0), {{0, 0}, {10, 10}});
  expect_points(svg("<g transform='translate(1)'><g transform='scale(2)'><path transform='translate(3)' "
                    "d='M0 0h1'/></g></g>")
                    .at(0),
                {{7, 0}, {9, 0}});
  expect_points(
      svg("<svg x='10' y='20' width='40' height='20' viewBox='0 0 20 10'>" + std::string(line) + "</svg>")
          .at(0),
      {{10, 20}, {30, 20}});
}

TEST(SvgStrokes, PutsThePageOnThePicture) {
  const char* line = "<path d='M0 0L10 5'/>";
  expect_points(svg(line, "")[0], {{0, 0}, {10, 5}});
  expect_points(svg(line, "width='100' height='50'")[0], {{0, 0}, {20, 10}});
  expect_points(svg(line, "width='100mm' height='50mm' viewBox='0 0 100 50'")[0], {{0, 0}, {20, 10}});
  expect_points(svg(line, "width='2in' height='72pt'")[0], {{0, 0}, {10.4167f, 5.2083f}});
  expect_points(svg(line, "width='100%' height='100%' viewBox='-10 -5 100 50'")[0], {{20, 10}, {40, 20}});
  // The view box is fitted into a page of other proportions, here in its middle.
  expect_points(svg(line, "width='200' height='100' viewBox='0 0 100 100'")[0], {{50, 0}, {60, 5}});
  expect_points(svg(line, "width='200' height='100' viewBox='0 0 100 100' preserveAspectRatio='none'")[0],
                {{0, 0}, {20, 5}});
  EXPECT_THROW(svg(line, "width='210mm' height='297mm'"), Error);
}

TEST(SvgStrokes, FollowsThePictureThatTheDrawingShows) {
  // An A4 page with the picture somewhere on it, turned; a logo of other proportions does not count.
  const auto strokes =
      svg("<image width='300' height='300' href='logo.png'/>"
          "<g transform='translate(50 60) rotate(90)'><image x='10' y='20' width='100' height='50' "
          "xlink:href='data:image/png;base64,AAAA' xmlns:xlink='http://www.w3.org/1999/xlink'/>"
          "<path d='M10 20h50v25'/></g>",
          "width='210mm' height='297mm'");
  ASSERT_EQ(strokes.size(), 1u);
  expect_points(strokes[0], {{0, 0}, {100, 0}, {100, 50}});
}

TEST(SvgStrokes, LeavesOutWhatIsHiddenOrOnlyReferredTo) {
  std::vector<std::string> notices;
  const auto strokes = svg(
      "<style><![CDATA[ /* .seen{display:none} */ .cls-1, .cls-2 { fill:none; display : none } "
      ".pale{opacity:0}"
      "#secret{visibility:hidden} g > path {display:none} ]]></style>"
      "<defs><path d='M0 0h1'/></defs><clipPath><path d='M0 0h2'/></clipPath><marker><path d='M0 "
      "0h3'/></marker>"
      "<g style='display:none'><path d='M0 0h4'/></g><path display='none' d='M0 0h5'/>"
      "<g class='x cls-2'><path d='M0 0h6'/></g><path id='secret' d='M0 0h7'/><path class='pale' d='M0 0h8'/>"
      "<g visibility='hidden'><path d='M0 0h9'/><path visibility='visible' d='M0 0h10'/></g>"
      "<path class='cls-1' style='display:inline' d='M0 0h11'/><path class='seen' d='M0 0h12'/>"
      "<rect width='9' height='9'/><circle r='3'/><metadata><path d='M0 0h13'/></metadata>"
      "<sodipodi:namedview xmlns:sodipodi='s'><path d='M0 0h14'/></sodipodi:namedview>",
      "viewBox='0 0 200 100'", &notices);
  ASSERT_EQ(strokes.size(), 3u);
  expect_points(strokes[0], {{0, 0}, {10, 0}});
  expect_points(strokes[1], {{0, 0}, {11, 0}});
  expect_points(strokes[2], {{0, 0}, {12, 0}});
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("circle, rect"), std::string::npos);
}

TEST(SvgStrokes, TakesSpeedsFromElementsAndGroups) {
  const auto strokes =
      svg("<g data-speed='80'><path d='M0 0h9'/><path data-speed='20' d='M0 0h9'/></g><path d='M0 0h9'/>");
  EXPECT_EQ(strokes[0].speed_px_per_s, 80);
  EXPECT_EQ(strokes[1].speed_px_per_s, 20);
  EXPECT_EQ(strokes[2].speed_px_per_s, std::nullopt);
  EXPECT_THROW(svg("<path data-speed='fast' d='M0 0h9'/>"), Error);
  EXPECT_THROW(svg("<path data-speed='20px' d='M0 0h9'/>"), Error);
  const auto changing = svg("<path data-speed='20, 40 10' d='M0 0h9'/>");
  EXPECT_EQ(speed_at(changing[0], 0.25), 30);
  EXPECT_EQ(speed_at(changing[0], 1), 10);
  EXPECT_EQ(speed_at(strokes[0], 0.7), 80);
}

TEST(SvgStrokes, ReadsPrefixedNamesAndDocumentTypesWithoutExpandingThem) {
  const auto strokes = read_svg_strokes(
      "\xef\xbb\xbf<?xml version='1.0' encoding='utf-8'?>\n<!-- Generator: Adobe Illustrator -->"
      "<!DOCTYPE svg:svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd' "
      "["
      "<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'><!ENTITY c '&b;&b;&b;&b;&b;&b;&b;'>]>"
      "<svg:svg xmlns:svg='http://www.w3.org/2000/svg' width='200px' height='100px'><svg:desc>&c;</svg:desc>"
      "<svg:g><svg:path d='M1 1h5'/></svg:g><path d='M0 0h1'/></svg:svg>",
      "a.svg", kPicture, nullptr);
  ASSERT_EQ(strokes.size(), 1u);
  expect_points(strokes[0], {{1, 1}, {6, 1}});
}

TEST(SvgStrokes, RefusesWhatIsHostileOrMalformed) {
  EXPECT_THROW(svg("<path d='M0 0L5'/>"), Error);
  EXPECT_THROW(svg("<g transform='spin(4)'><path d='M0 0h1'/></g>"), Error);
  EXPECT_THROW(svg("<g transform='matrix(1 2 3)'><path d='M0 0h1'/></g>"), Error);
  EXPECT_THROW(svg("<line x1='1furlong'/>"), Error);
  EXPECT_THROW(svg("<path d='M0 0h1'/>", "viewBox='0 0 0 0'"), Error);
  EXPECT_THROW(svg("<path d='M0 0h1e9' transform='scale(1e9)'/>"), Error);
  EXPECT_THROW(svg("<path d='M0 0h1'/>", "width='1e9' height='1e-9'"), Error);
  EXPECT_THROW(svg("<unclosed>"), Error);
  EXPECT_THROW(read_svg_strokes("<html/>", "a.svg", kPicture, nullptr), Error);
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<g>";
  EXPECT_THROW(svg(deep + "<path d='M0 0h1'/>"), Error);
  std::string closed = deep;
  for (int i = 0; i < 100000; ++i) closed += "</g>";
  EXPECT_THROW(svg(closed), Error);
  std::string many = "M0 0";
  for (int i = 0; i < 1200000; ++i) many += "h1";
  EXPECT_THROW(svg("<path d='" + many + "'/>"), Error);
}

class StrokeFile : public testing::Test {
 protected:
  std::string fault(const std::string& text) {
    const std::string said = fault_of([&] { read(text); });
    EXPECT_NE(said.find("strokes.file: "), std::string::npos);
    return said;
  }
  std::vector<Stroke> read(const std::string& text) {
    std::ofstream(folder_.path() / "strokes.file", std::ios::binary) << text;
    return read_strokes(folder_.path() / "strokes.file", kPicture);
  }
  std::string json(const std::string& strokes) {
    return R"({"format":"freshet-strokes","version":1,"strokes":[)" + strokes + "]}";
  }
  ScratchFolder folder_;
};

TEST_F(StrokeFile, ReadsJson) {
  const auto strokes = read(json(R"({"points":[[1,2],[3.5,4]],"speed":80},{"points":[[0,0],[9,9]]})"));
  ASSERT_EQ(strokes.size(), 2u);
  expect_points(strokes[0], {{1, 2}, {3.5, 4}});
  EXPECT_EQ(strokes[0].speed_px_per_s, 80);
  EXPECT_EQ(strokes[1].speed_px_per_s, std::nullopt);
}

TEST_F(StrokeFile, ReadsSpeedsAlongAStrokeOfJsonAsOfSvg) {
  const auto falling = read(json(R"({"points":[[50,0],[50,80]],"speed":[20,60,100]})"));
  const auto drawn = read("<svg><path data-speed='20 60 100' d='M50 0V80'/></svg>");
  ASSERT_EQ(falling.size(), 1u);
  for (const double share : {0.0, 0.25, 0.5, 1.0})
    EXPECT_EQ(speed_at(falling[0], share), speed_at(drawn[0], share));
  EXPECT_EQ(speed_at(falling[0], 0.25), 40);
  EXPECT_EQ(speed_at(read(json(R"({"points":[[1,2],[3,4]],"speed":[7]})"))[0], 1), 7);
}

TEST_F(StrokeFile, TellsSvgByItsContent) { EXPECT_EQ(read(" \n<svg><path d='M0 0h5'/></svg>").size(), 1u); }

TEST_F(StrokeFile, NamesWhatIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "neither JSON nor SVG"},
      {"points", "neither JSON nor SVG"},
      {"\x1f\x8b", "compressed"},
      {"{", "not a JSON file"},
      {"[]", "an object expected"},
      {"{}", "\"format\""},
      {R"({"format":"freshet-strokes"})", "\"version\""},
      {R"({"format":"freshet-strokes","version":1,"strokes":{}})", "\"strokes\" is not a list"},
      {R"({"format":"freshet-strokes","version":1,"strokes":[]})", "no stroke in it"},
      {"<svg><rect/></svg>", "no stroke in it"},
      {"<svg><path d='M5 5L5 5'/></svg>", "path at (5, 5) has no length"},
      {"<svg><path id='far' d='M500 5L600 5'/></svg>", "path \"far\" lies outside the picture: x 500 to 600"},
  };
  for (const auto& [text, part] : wrong) EXPECT_NE(fault(text).find(part), std::string::npos) << fault(text);
  const std::pair<const char*, const char*> strokes[] = {
      {R"({"points":[]})", "stroke 1 without any point has no length"},
      {R"({"points":[[7,8]]})", "stroke 1 at (7, 8) has no length"},
      {R"({"points":[[1,2],[3,4]]},{"points":[[7,8],[7,8]]})", "stroke 2 at (7, 8) has no length"},
      {R"({"points":[[300,8],[400,9]]})", "the picture has 200 x 100 px"},
      {R"({"points":[[-100,50],[50,250]]})", "lies outside the picture"},
      {R"({"points":[[1,2],[3,"a"]]})", "two numbers"},
      {R"({"points":[[1,2],[3]]})", "two numbers"},
      {R"({"points":[[1,2],[3,1e300]]})", "two numbers"},
      {R"({"points":[[1,2],[3,4]],"speed":-1})", "speed of -1"},
      {R"({"points":[[1,2],[3,4]],"speed":"fast"})", "\"speed\""},
      {R"({"points":[[1,2],[3,4]],"speed":[]})", "has 0 numbers"},
      {R"({"points":[[1,2],[3,4]],"speed":[5,"fast"]})", "\"speed\""},
      {R"({"points":[[1,2],[3,4]],"speed":[5,-2]})", "speed of -2"},
      {R"({"points":4})", "\"points\""},
      {"4", "\"points\""},
  };
  for (const auto& [text, part] : strokes)
    EXPECT_NE(fault(json(text)).find(part), std::string::npos) << text << "\n" << fault(json(text));
  EXPECT_NO_THROW(read(json(R"({"points":[[-50,50],[250,50]]})"))) << "a stroke may cross the picture";
  EXPECT_THROW(read_strokes(folder_.path() / "none.json", kPicture), Error);
  EXPECT_THROW(read_strokes(folder_.path(), kPicture), Error);
}

}  // namespace
}  // namespace freshet::hints
