// bench/quality/blind_look.cc — which of several films of one picture does a person like best, not knowing whose it is?
//
//   bench_blind_look FOLDER --film river:ours=ours.mp4 --film river:real=clip.mp4 --film sea:ours=.. [--seed 7]
//
// FOLDER/index.html shows each scene's films in a shuffled order, under letters; whoever looks at it says which looks
// most like the real thing and which least, and what is wrong, and copies the answers out as text. The key lies beside
// the folder, in FOLDER-key.json, so that the folder can be handed on as it is. All films of a scene are written anew
// in one size, length, rate and coding: a file's name, size or colours of its own tell nothing.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "bench/quality/quality_footage.h"
#include "freshet/error.h"
#include "media/video/video_writer.h"
#include "report/html_text.h"
#include "report/page.h"

namespace {

using namespace freshet;
namespace fs = std::filesystem;

struct Film {
  std::string who;
  fs::path path;
};
using Scenes = std::map<std::string, std::vector<Film>>;

// clang-format off
constexpr std::string_view kTemplate =
#include "embedded/blind_look.html"
    ;
// clang-format on

Scenes scenes_of(const std::vector<std::string>& named) {
  Scenes scenes;
  for (const std::string& text : named) {
    const std::size_t colon = text.find(':'), equals = text.find('=', colon == std::string::npos ? 0 : colon);
    if (colon == std::string::npos || equals == std::string::npos || colon == 0)
      throw Error(ErrorKind::kUsage, "--film " + text, "SCENE:WHO=VIDEO expected");
    scenes[text.substr(0, colon)].push_back(
        {text.substr(colon + 1, equals - colon - 1), text.substr(equals + 1)});
  }
  return scenes;
}

/// All of a scene's films under letters, in one size, length and rate; which letter is whose.
nlohmann::json write_scene(const fs::path& folder, const std::string& prefix, std::vector<Film> films,
                           std::mt19937& random, int width) {
  // Not std::shuffle, whose draws are the library's own.
  for (std::size_t i = films.size(); i-- > 1;) std::swap(films[i], films[random() % (i + 1)]);
  std::vector<std::vector<cv::Mat>> frames;
  std::size_t shortest = SIZE_MAX;
  double fps = 1e9;
  for (const Film& film : films) {
    double own = 25;
    frames.push_back(bench::read_video(film.path, width, &own));
    shortest = std::min(shortest, frames.back().size());
    fps = std::min(fps, own);
  }
  const cv::Size size = frames.front().front().size();
  nlohmann::json key;
  for (std::size_t i = 0; i < films.size(); ++i) {
    const std::string letter(1, static_cast<char>('A' + i));
    media::VideoWriter writer(folder / (prefix + letter + ".mp4"), size,
                              {.fps_num = std::lround(fps * 1000), .fps_den = 1000, .crf = 14});
    cv::Mat same;
    for (std::size_t t = 0; t < shortest; ++t) {
      cv::resize(frames[i][t], same, size, 0, 0, cv::INTER_AREA);
      writer.write(same);
    }
    writer.finish();
    key[letter] = {{"who", films[i].who}, {"file", films[i].path.string()}};
  }
  return key;
}

std::string section_of(const std::string& scene, const std::string& prefix, std::size_t films) {
  const std::string id = report::html_text(scene);
  std::string text = fmt::format("<section data-scene=\"{0}\"><h2>{0}</h2><div class=\"films\">\n", id);
  for (std::size_t i = 0; i < films; ++i)
    text += fmt::format(
        "<figure><video src=\"{0}{1}.mp4\" muted loop playsinline controls "
        "preload=\"auto\"></video><figcaption>"
        "<b>{1}</b><label><input type=\"radio\" name=\"best-{2}\" value=\"{1}\"> most real</label>"
        "<label><input type=\"radio\" name=\"worst-{2}\" value=\"{1}\"> "
        "least</label></figcaption></figure>\n",
        prefix, static_cast<char>('A' + i), id);
  return text + "</div><textarea rows=\"2\" placeholder=\"What gives it away?\"></textarea></section>\n";
}

void run(const fs::path& folder, const std::vector<std::string>& named, unsigned seed, int width) {
  const Scenes scenes = scenes_of(named);
  std::mt19937 random(seed);
  fs::create_directories(folder);
  std::string sections;
  nlohmann::json key;
  int number = 0;
  for (const auto& [scene, films] : scenes) {
    if (films.size() < 2 || films.size() > 26)
      throw Error(ErrorKind::kUsage, "scene " + scene, "2 to 26 films expected");
    const std::string prefix = fmt::format("s{}", ++number);
    key[scene] = write_scene(folder, prefix, films, random, width);
    sections += section_of(scene, prefix, films.size());
  }
  std::ofstream(folder / "index.html") << report::page_html(
      "Which of these is most like the real thing?", report::filled(kTemplate, {{"sections", sections}}));
  fs::path beside = folder.lexically_normal();
  if (!beside.has_filename()) beside = beside.parent_path();
  beside += "-key.json";
  std::ofstream(beside) << key.dump(1) << '\n';
  fmt::print("{} and, apart from it, {}\n", (folder / "index.html").string(), beside.string());
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  std::vector<std::string> films;
  unsigned seed = 7;
  int width = 640;
  bench::Arguments app("Writes a page on which films of one scene are judged without knowing whose they are");
  app.option("folder", folder, "Where the page is written").required();
  app.option("--film", films, "SCENE:WHO=VIDEO; the films of one scene stand beside each other").required();
  app.option("--seed", seed, "Of the order");
  app.option("--width", width, "Longer side, px").between(64, 4096);
  app.parse(argc, argv);
  try {
    run(folder, films, seed, width);
    return 0;
  } catch (const std::exception& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
