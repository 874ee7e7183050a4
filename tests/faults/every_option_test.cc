// Every option of every command changes a result or a message, or is refused by name. Commands and options are those
// that the executable's own help lists: one without a row here fails.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/faults/campaign.h"
#include "tests/faults/command_tree.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// How a command runs for all of its options that have no row with a base of their own.
const std::map<std::string, std::string> kBases{
    {"ingest", "ingest new.store clip1.mkv clip2.mkv --force"},
    {"index", "index f.store"},
    {"store info", "store info f.store"},
    {"store verify", "store verify f.store"},
    {"store digest", "store digest f.store"},
    {"store framemd5", "store framemd5 f.store clip1.mkv"},
    {"store page", "store page f.store -o out.html"},
    {"store export", "store export f.store clip1.mkv -o out.mkv"},
    {"store compact", "store compact f.store"},
    {"store remove", "store remove f.store clip1.mkv"},
    {"store merge", "store merge one.store rest.store -o new.store"},
    {"store repair", "store repair f.store -o new.store"},
    {"store starter", "store starter --recipe recipe.toml -o new.store"},
    {"query candidates", "query candidates f.store still.png --whole --frames 8 --json"},
    {"query label", "query label f.store still.png --whole --frames 8 -o out.json"},
    {"query kind", "query kind still.png"},
    {"query bench", "query bench f.store --index exact --pieces 4 --seconds 0.01 --no-label --no-filters"},
    {"synth animate", "synth animate f.store still.png --whole --frames 4 -o out/%03d.png"},
    {"synth sweep", "synth sweep f.store still.png --whole --frames 3 --vary speed=2 -o out"},
    {"synth judge", "synth judge fall.mkv still.png --whole"},
    {"synth matte", "synth matte disc.png --box 20,10,50,50 --edge none -o out.png"},
    {"synth simulate", "synth simulate plume.toml --size 32x40 --grid 32 --frames 2 -o out"},
    {"synth stills", "synth stills stills --seconds 1 --fps 8 -o out/%03d.png"},
    {"synth transfer",
     "synth transfer --exemplar look.png --alpha-sequence design/alpha --flow-sequence design/flow --frames "
     "2 "
     "-o out/%03d.png"},
    {"synth scene", "synth scene scene.toml -o out/%03d.png"},
    {"synth layers", "synth layers scene.toml -o out.ora"},
    {"synth flowlines", "synth flowlines fall.mkv --frames 4 --patch 16 -o out/%03d.png"},
    {"synth tour", "synth tour fall.mkv --frames 4 -o out/%03d.png"},
    {"work", "work --queue nats://127.0.0.1:1 --status"},
    {"studio",
     "studio --folder projects --no-browser --no-starter --listen 127.0.0.1 --page page --port PORT"}};

enum class Does : std::uint8_t {
  kChanges,    // a file, or what is said
  kRefuses,    // the run, by its name
  kElsewhere,  // as the test that the row names says
  kResource,   // no result, by promise: what is no number is refused by its name
};

/// What is given for an option, beside what other words of the base. Words of the base that `option` or `beside` gives
/// are left out of it, its picture is wide.png where that is beside; a beside that begins with "=" is the base itself.
struct Row {
  std::string command;  // "": of every command that has the option, unless another row is of that command
  std::string option, beside = "";
  Does does = Does::kChanges;
};

const char* const kMoving = "--matte matte.png --boundary moving --frames 6";
const char* const kCrowded = "wide.png --candidates 8 --lambda 0";
const char* const kEdited = "--lines lines.svg --edited edited.svg";
const char* const kPaper = "--method paper";

const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {"", "--threads 1", "", Does::kResource},
      {"", "--memory 100", "", Does::kResource},
      {"", "--json"},
      {"", "--overwrite"},
      {"", "--output other/%03d.png"},
      // What is looked for.
      {"", "--matte matte.png"},
      {"query candidates", "--whole", "=query candidates f.store cut.png --frames 8 --json"},
      {"query label", "--whole", "=query label f.store cut.png --frames 8 -o out.json"},
      {"synth animate", "--whole", "=synth animate f.store cut.png --frames 4 -o out/%03d.png"},
      {"synth sweep", "--whole", "=synth sweep f.store cut.png --frames 3 --vary speed=2 -o out"},
      {"query kind", "--whole", "=query kind cut.png"},
      {"synth judge", "--whole", "=synth judge fall.mkv still.png"},
      {"", "--hold hold.png"},
      // Neither of the two has an index of its own.
      {"query candidates", "--store right.store",
       "=query candidates left.store still.png --whole --frames 8"},
      {"query label", "--store right.store",
       "=query label left.store still.png --whole --frames 8 -o out.json"},
      {"synth animate", "--store right.store",
       "=synth animate left.store still.png --whole --frames 4 -o out/%03d.png"},
      {"synth sweep", "--store right.store",
       "=synth sweep left.store still.png --whole --frames 3 --vary speed=2 -o out"},
      {"", "--class one"},
      {"", "--direction left"},
      {"", "--exclude clip1.mkv"},
      {"", "--frames 5"},
      {"", "--fps 20"},
      {"", "--tolerance 2", "--direction left --hint-search narrow"},
      {"", "--candidates 2"},
      {"", "--coherent 0", "--candidates 2"},
      {"", "--min-scale 1"},
      {"", "--max-rotation 0"},
      {"", "--piece-scale 2"},
      {"", "--index flann-kdtree"},
      {"", "--checks 1", "--index flann-kdtree --candidates 2 --coherent 0"},
      {"", "--hint none"},
      {"", "--hint-search narrow", "--direction left"},
      {"", "--speed-tolerance 1.01", "--strokes strokes.svg --hint-search narrow"},
      {"", "--speed-white 50", "--speed-map grey.png"},
      {"", "--horizon 20"},
      {"", "--strokes strokes.svg"},
      {"", "--orientation-map hues.png"},
      {"", "--speed-map grey.png"},
      {"", "--draw drawn.png"},
      {"query candidates", "--draw drawn.png", "--direction left"},
      {"", "--orientation-out hues.out.png"},
      {"", "--speed-out speeds.out.png"},
      {"", "--sheet sheet.png"},
      {"", "--map map.png"},
      // How labels are chosen.
      {"", "--as-printed"},
      {"", "--hint-weight 0", "--direction left"},
      {"", "--solver icm", "--lambda 3"},
      {"", "--iterations 1", "wide.png --lambda 3"},
      {"", "--costs power"},
      {"", "--lambda 3"},
      {"", "--sigma 30", "--lambda 3"},
      {"", "--vote 60"},
      {"", "--reuse 0", kCrowded},
      {"", "--crowd 0", kCrowded},
      {"", "--rho 300", "--lambda 30"},
      {"", "--assignment assignment.json"},
      {"", "--cache kept"},
      {"", "--cache-size 1", "", Does::kRefuses},
      // How frames are made and written.
      {"", "--depth 16"},
      {"", "--preset archive", "-o out.mkv"},
      {"", "--start-number 7"},
      {"", "--range 1-2"},
      {"", "--width 48"},
      {"", "--layer fluid", "--matte matte.png"},
      {"", "--alpha premultiplied", "--matte matte.png --layer fluid -o out/%03d.tif"},
      {"", "--matte-out mattes/%03d.png"},
      {"", "--motion-out motion/%03d.flo"},
      {"", "--loop", "--frames 16 --exclude clip1.mkv clip2.mkv clip3.mkv"},
      {"", "--speed 2"},
      {"synth animate", "--speed 2"},
      {"synth animate", "--speed natural"},
      {"synth animate", "--takes 2"},
      {"", "--retiming-map grey.png"},
      {"", "--boundary moving", "--matte matte.png"},
      {"", "--background ground.png", kMoving},
      {"", "--tau 0", kMoving},
      {"", "--inpaint outward", kMoving},
      {"", "--method paper"},
      {"", "--resampling nearest", "--method paper --speed 0.5"},
      {"", "--shutter 5", kPaper},
      {"", "--softness 1", kPaper},
      {"", "--variation 0"},
      {"", "--renewal 0"},
      {"", "--standing 0", "--exclude clip2.mkv"},
      {"", "--detail-life 0.05"},
      {"", "--glitter 0", "",
       Does::kElsewhere},  // tests/synth/animate/carried/carried_renderer_test.cc: of water that glitters
      {"", "--flames own", "--method forms --matte matte.png"},
      {"", "--layout stands", "--matte matte.png"},
      {"", "--blend paper", kPaper},
      {"", "--low-band remove", kPaper},
      {"", "--matching none", kPaper},
      {"", "--max-gain 1", kPaper},
      // ingest
      {"ingest", "--class two"},
      {"ingest", "--licence CC0"},
      {"ingest", "--sources sources.toml"},
      {"synth animate", "--credits credits.txt"},
      {"ingest", "--force"},
      {"ingest", "--dry-run"},
      {"ingest", "--page page.html", "--dry-run"},
      {"ingest", "--overwrite", "--dry-run --page page.html"},
      {"ingest", "--sdr", "",
       Does::kElsewhere},  // tests/media/frame/repair_test.cc, tests/tools/bad_input/bad_clip_test.cc: of HDR
      {"ingest", "--deinterlace", "=ingest new.store planes.mp4 --force"},
      {"ingest", "--deblock", "=ingest new.store planes.mp4 --force"},
      {"ingest", "--shard 1/2"},
      {"ingest", "--seal", "=ingest new.store clip1.mkv clip2.mkv --force --shard 1/2"},
      {"ingest", "--gather", "",
       Does::kElsewhere},  // tests/tools/same_store_test.cc: of what shards have left
      {"ingest", "--no-index"},
      {"ingest", "--no-flann"},
      {"ingest", "--scales 1"},
      {"ingest", "--rotations 0"},
      {"ingest", "--no-flips"},
      {"ingest", "--patch 32"},
      {"ingest", "--stride 12"},
      {"ingest", "--steady", "",
       Does::kElsewhere},  // tests/ingest/survey_test.cc: of what a moving camera filmed
      {"ingest", "--min-coverage 0.95"},
      {"ingest", "--min-motion 0.5"},
      {"ingest", "--flow tv-l1"},
      {"ingest", "--flow-step 4"},
      {"ingest", "--cell 8"},
      {"ingest", "--bands 4"},
      {"ingest", "--words 20"},
      // index, query
      {"index", "--flann kmeans"},
      {"index", "--no-flann"},
      {"index", "--rebuild"},
      {"index", "--samples 1000", "--rebuild"},
      {"query bench", "--pictures still.png"},
      {"query bench", "--index scan"},
      {"query bench", "--rows 20"},
      {"query bench", "--pieces 3"},
      {"query bench", "--limit 0.01", "",
       Does::kElsewhere},  // tests/query/benchmark/: how much it stops depends on the machine
      {"query bench", "--seconds 0.1", "--index exact --json"},
      {"query bench", "--check 1", "--json"},
      {"query bench", "--no-label"},
      {"query bench", "--no-filters"},
      {"query bench", "--json"},
      {"query bench", "--page page.html"},
      {"query bench", "--overwrite", "--page page.html"},
      {"query label", "--map map.png"},
      {"query label", "--overwrite"},
      {"query label", "--output other.json"},
      {"query candidates", "--overwrite", "--sheet sheet.png"},
      {"store page", "--output other.html"},
      {"store page", "--picture still.png"},
      {"", "--signed-by maker.pub", "",
       Does::kElsewhere},  // tests/tools/signed_store_test.cc: of stores that their maker signed
      {"store page", "--matte matte.png", "--picture still.png"},
      {"store export", "--output other.mkv"},
      {"store merge", "--output other.store"},
      {"store repair", "--output other.store"},
      {"store starter", "--output other.store"},
      {"store starter", "--recipe a", "",
       Does::kElsewhere},  // tests/tools/command_line_test.cc: without, it is long
      {"store starter", "--print-recipe", "=store starter"},
      // sweep
      {"synth sweep", "--vary speed=1,2"},
      {"synth sweep", "--output other"},
      {"synth sweep", "--depth 16", "--preset archive"},
      {"synth sweep", "--preset edit"},
      {"synth sweep", "--shard 1/2"},
      {"synth sweep", "--gather", "",
       Does::kElsewhere},  // tests/tools/sweep_test.cc: of what shards have left
      {"synth sweep", "--speed 2", "--vary candidates=3"},
      {"synth sweep", "--resampling nearest", "--method paper --speed 0.5 --vary candidates=3"},
      // judge
      {"synth judge", "--class fire"},
      {"synth judge", "--output sheet.png"},
      {"synth judge", "--overwrite", "-o sheet.png"},
      // matte
      {"synth matte", "--output other.png"},
      {"synth matte", "--scribbles scribbles.png"},
      {"synth matte", "--marks marks.json"},
      {"synth matte", "--box 24,14,44,44"},
      {"synth matte", "--auto f.store"},
      {"synth matte", "--class one", "--auto f.store"},
      {"synth matte", "--exclude clip1.mkv clip2.mkv", "--auto f.store"},
      {"synth matte", "--edge guided"},
      {"synth matte", "--edge-width 20", "--edge guided"},
      {"synth matte", "--iterations 0",
       "=synth matte soft.png --scribbles scribbles.png --edge none -o out.png"},
      // simulate
      {"synth simulate", "--output other"},
      {"synth simulate", "--print-scene plume", "=synth simulate"},
      {"synth simulate", "--keys", "=synth simulate"},
      {"synth simulate", "--size 40x40"},
      {"synth simulate", "--frames 3"},
      {"synth simulate", "--fps 12"},
      {"synth simulate", "--seed 5"},
      {"synth simulate", "--grid 20"},
      {"synth simulate", "--steps 3"},
      {"synth simulate", "--alpha mattes/%03d.png"},
      {"synth simulate", "--alpha-bits 16"},
      {"synth simulate", "--motion motion/%03d.flo"},
      {"synth simulate", "--emitters emitters/%03d.png", "-o out.mkv"},
      // stills
      {"synth stills", "--seconds 2"},
      {"synth stills", "--fps 12"},
      {"synth stills", "--preview", "=synth stills stills --seconds 1 -o out/%03d.png"},
      {"synth stills", "--camera hand"},
      {"synth stills", "--level on"},
      {"synth stills", "--flow-side 64"},
      {"synth stills", "--page page.html"},
      {"synth stills", "--regions regions.png"},
      {"synth stills", "--scribbles still_scribbles.png"},
      {"synth stills", "--one-region"},
      {"synth stills", "--as-printed", "--one-region"},
      {"synth stills", "--distance l2"},
      {"synth stills", "--normalise sum", "--seconds 10 --step 0.1"},
      {"synth stills", "--split 2"},
      {"synth stills", "--feather 60", "--regions regions.png"},
      {"synth stills", "--edits edits.toml"},
      {"synth stills", "--keys", "=synth stills"},
      {"synth stills", "--step 0.1"},
      {"synth stills", "--speed 3"},
      {"synth stills", "--loop"},
      {"synth stills", "--sigma 100", "--seconds 10 --step 0.1"},
      {"synth stills", "--irregularity 1", "--seconds 4"},
      {"synth stills", "--even-turns", "--seconds 4 --irregularity 1"},
      {"synth stills", "--no-dead-ends", "--one-region --edits circle.toml --seconds 4 --step 0.3"},
      {"synth stills", "--cut-above 1", "--one-region --distance l2 --seconds 4 --step 0.1"},
      {"synth stills", "--seed 9", "--seconds 4"},
      // transfer
      {"synth transfer", "--exemplar still.png"},
      {"synth transfer", "--store f.store", "--exemplar stored.mp4"},
      {"synth transfer", "--exemplar-alpha look_mask.png"},
      {"synth transfer", "--ground black", "--exemplar still.png"},
      {"synth transfer", "--exemplar-scale 0.5"},
      {"synth transfer", "--stabilise", "--exemplar clip1.mkv"},
      {"synth transfer", "--design design", "=synth transfer --exemplar look.png --frames 2 -o out/%03d.png"},
      {"synth transfer", "--alpha-sequence masks"},
      {"synth transfer", "--flow-sequence still_flow"},
      {"synth transfer", "--frames 1"},
      {"synth transfer", "--bits 16"},
      {"synth transfer", "--fps 12", "-o out.mkv"},
      {"synth transfer", "--over still.png", "--composite whole/%03d.png"},
      {"synth transfer", "--composite whole/%03d.png", "--over still.png"},
      {"synth transfer", "--blend add", "--over still.png --composite whole/%03d.png"},
      {"synth transfer", "--at 9,9", "--over still.png --composite whole/%03d.png"},
      {"synth transfer", "--restart", "", Does::kElsewhere},  // tests/tools/transfer_test.cc: a stopped run
      {"synth transfer", "--patch 7"},
      {"synth transfer", "--lambda 0.9"},
      {"synth transfer", "--eta 0"},
      {"synth transfer", "--curvature 4"},
      {"synth transfer", "--divergence 4", "--exemplar clip1.mkv"},
      {"synth transfer", "--blur-radius 1"},
      {"synth transfer", "--lower 0.4"},
      {"synth transfer", "--upper 0.6"},
      {"synth transfer", "--levels 1"},
      {"synth transfer", "--iterations 1"},
      {"synth transfer", "--passes 1", "--uniformity off"},
      {"synth transfer", "--motion-blur 2"},
      {"synth transfer", "--rotations 4"},
      {"synth transfer", "--uniformity off"},
      {"synth transfer", "--initialise random"},
      {"synth transfer", "--search exact", "--uniformity off"},
      {"synth transfer", "--seed 9"},
      // scene, layers
      {"synth scene", "--init still.png", "=synth scene -o out.toml"},
      {"synth scene", "--keys", "=synth scene"},
      {"synth scene", "--layers-out layers/{layer}.%03d.png"},
      {"synth layers", "--output other.ora"},
      {"synth layers", "--bits 16"},
      {"synth layers", "--edge hard", "--edge-width 20"},
      {"synth layers", "--edge-width 20"},
      {"synth layers", "--uncover 1"},
      {"synth layers", "--search 8"},
      {"synth layers", "--refill lake.png"},
      {"synth layers", "--refill-search 8", "--refill lake.png"},
      // flowlines
      {"synth flowlines", "--store f.store",
       "=synth flowlines --clip clip1.mkv --frames 8 --patch 16 -o out/%03d.png"},
      {"synth flowlines", "--clip clip2.mkv",
       "=synth flowlines --store f.store --frames 8 --patch 16 -o out/%03d.png"},
      {"synth flowlines", "--loop", "--frames 40"},
      {"synth flowlines", "--from 4"},
      {"synth flowlines", "--input-frames 20"},
      {"synth flowlines", "--moving-camera", "=synth flowlines shaken --frames 8 --patch 16 -o out/%03d.png"},
      {"synth flowlines", "--fps 12", "-o out.mkv"},
      {"synth flowlines", "--matte fall_matte.png"},
      {"synth flowlines", "--layer fluid", kEdited},
      {"synth flowlines", "--alpha premultiplied",
       "--lines lines.svg --edited edited.svg --ground black --layer fluid -o out/%03d.tif"},
      {"synth flowlines", "--lines lines.svg"},
      {"synth flowlines", "--as-printed", "--lines lines.svg"},
      {"synth flowlines", "--repeats in-turn", "--frames 60"},
      {"synth flowlines", "--spacing 12"},
      {"synth flowlines", "--lines-out lines.out.svg"},
      {"synth flowlines", "--edited edited.svg", "--lines lines.svg"},
      {"synth flowlines", "--correspondence stretched", kEdited},
      {"synth flowlines", "--join 3", kEdited},
      {"synth flowlines", "--ground black", kEdited},
      {"synth flowlines", "--background ground.png", kEdited},
      {"synth flowlines", "--on-background", kEdited},
      {"synth flowlines", "--patch 40"},
      {"synth flowlines", "--dynamics non-stationary"},
      {"synth flowlines", "--entries 8"},
      {"synth flowlines", "--strand 16"},
      {"synth flowlines", "--blend feather"},
      {"synth flowlines", "--seed 9"},
      // tour
      {"synth tour", "--move pan"},
      {"synth tour", "--amount 0.5"},
      {"synth tour", "--fps 12"},
      {"synth tour", "--size 48x36"},
      {"synth tour", "--film-end hold", "--frames 40"},
      {"synth tour", "--depth-out depths/%03d.exr"},
      {"synth tour", "--keys", "=synth tour"},
      // With a server: tests/work_test.sh.
      {"work", "--queue nats://localhost", "", Does::kElsewhere},
      {"work", "--submit tasks.toml", "", Does::kElsewhere},
      {"work", "--status", "", Does::kElsewhere},
      {"work", "--json", "", Does::kElsewhere},
      {"work", "--folder shared", "", Does::kElsewhere},
      {"work", "--until-empty", "", Does::kElsewhere},
      {"work", "--tries 2", "", Does::kElsewhere},
      {"work", "--ack-wait 2", "", Does::kElsewhere},
      // studio
      {"studio", "--folder others"},
      {"studio", "--port OTHER"},
      {"studio", "--listen 0.0.0.0"},
      {"studio", "--page nothing", "=studio --folder projects --no-browser --no-starter --port PORT"},
      {"studio", "--no-starter"},
      {"studio", "--no-browser"}};
  return all;
}

/// Files that commands read, beside the campaign's.
class Material {
 public:
  explicit Material(const Campaign& c) : c_(c) {
    const cv::Size size(96, 72);
    cv::Mat still(size, CV_8UC3), white(size, CV_8U, cv::Scalar(255));
    cv::RNG(3).fill(still, cv::RNG::UNIFORM, 40, 210);
    cv::GaussianBlur(still, still, {}, 1.2);
    cv::rectangle(still, {20, 10, 50, 50}, cv::Scalar(200, 120, 40), 5);
    cv::ellipse(still, {45, 40}, {8, 14}, 0, 0, 360, cv::Scalar(30, 130, 250), cv::FILLED);  // a flame
    put("still.png", still);
    cv::Mat wide;
    cv::resize(still, wide, {}, 2, 2, cv::INTER_CUBIC);
    put("wide.png", wide);
    cv::Mat matte = part(size, {20, 10, 50, 50}), cut;
    cv::GaussianBlur(matte, matte, {}, 2);  // soft: alpha between none and all
    put("matte.png", matte);
    cv::merge(std::vector<cv::Mat>{still, matte}, cut);
    put("cut.png", cut);
    cv::Mat disc(size, CV_8UC3, cv::Scalar(40, 120, 60));
    cv::circle(disc, {45, 35}, 20, cv::Scalar(220, 190, 150), cv::FILLED, cv::LINE_AA);
    cv::Mat grain(size, CV_8UC3);
    cv::RNG(7).fill(grain, cv::RNG::UNIFORM, 0, 25);
    put("disc.png", disc + grain);
    cv::Mat soft(size, CV_8UC3), noise(size, CV_16SC3);  // no outline that a first cut would find
    cv::RNG(6).fill(noise, cv::RNG::NORMAL, 0, 14);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double inside = std::clamp((30 - std::hypot(x - 45, y - 35)) / 20, 0.0, 1.0);
        const cv::Vec3d behind(60 + x, 120, 60 + y), before(200, 170, 140);
        for (int k = 0; k < 3; ++k)
          soft.at<cv::Vec3b>(y, x)[k] = cv::saturate_cast<std::uint8_t>(
              behind[k] + inside * (before[k] - behind[k]) + noise.at<cv::Vec3s>(y, x)[k]);
      }
    put("soft.png", soft);
    put("hold.png", part(size, {0, 0, 40, 30}));
    put("lake.png", part(size, {0, 40, 96, 32}));
    put("tree.png", part(size, {20, 6, 24, 44}));
    put("ground.png", cv::Mat(size, CV_8UC3, cv::Scalar(90, 40, 10)));
    cv::Mat grey(size, CV_8U);
    for (int x = 0; x < size.width; ++x) grey.col(x).setTo(2 * x + 30);
    put("grey.png", grey);
    put("hues.png", cv::Mat(size, CV_8UC3, cv::Scalar(0, 0, 255)));
    cv::Mat scribbles(size, CV_8UC4, cv::Scalar::all(0));
    cv::rectangle(scribbles, {30, 20, 12, 12}, {255, 255, 255, 255}, cv::FILLED);
    cv::rectangle(scribbles, {80, 0, 12, 60}, {0, 0, 0, 255}, cv::FILLED);
    put("scribbles.png", scribbles);
    write("marks.json",
          R"({"format": "freshet-marks", "version": 1, "marks": [{"is": "fluid", "box": [26, 16, 20, 20]},
 {"is": "background", "box": [76, 0, 18, 60]}]})");
    write("sources.toml", "[[clip]]\nname = \"clip1.mkv\"\nauthor = \"Ada\"\n");
    write("strokes.svg", svg(size, R"(<path data-speed="40" d="M80,50 L10,20"/>)"));
    scene();
    stills();
    transfer();
    flowlines();
    must({"synth", "simulate", "river", "--size", "96x96", "--frames", "24", "-o", "planes.mp4"});
    fs::create_directory(c.folder / "more");
    fs::copy_file(c.folder / "planes.mp4", c.folder / "more" / "stored.mp4");
    must({"ingest", "every.store", "more/stored.mp4", "--force", "--class", "two"});
    must({"ingest", "every.store", "clip1.mkv", "--force", "--class", "one"});
    must({"ingest", "every.store", "clip2.mkv", "clip3.mkv", "--force", "--class", "two"});
    must({"index", "every.store", "--flann", "kdtree"});
    must({"ingest", "left.store", "clip1.mkv", "--force", "--no-index"});
    must({"ingest", "right.store", "clip2.mkv", "--force", "--no-index"});
    write("both.stores", "left.store\nright.store\n");
    must({"index", "both.stores"});
    write(
        "recipe.toml",
        "size = [64, 48]\nframes = 16\nfps = 25\n[[clip]]\nname = \"water/a\"\nclip = \"river\"\nseed = 1\n");
    must({"query", "label", "every.store", "still.png", "--whole", "--frames", "8", "--direction", "left",
          "-o", "assignment.json"});
    store_ = text_of(c.folder / "every.store");
    fs::create_directory(c.folder / "bin");
    fs::create_directory(c.folder / "page");
    write("page/index.html", "<title>Freshet</title>");
    write("bin/xdg-open", "#!/bin/sh\n: > opened\n");
    fs::permissions(c.folder / "bin/xdg-open", fs::perms::owner_all);
    for (const auto& entry : fs::directory_iterator(c.folder.path())) mine_.insert(entry.path().filename());
  }

  /// Nothing is left of what other runs wrote.
  void lay_out() const {
    for (const auto& entry : fs::directory_iterator(c_.folder.path()))
      if (!mine_.contains(entry.path().filename())) fs::remove_all(entry.path());
    c_.begin_with("every.store", "f.store");
  }
  /// What a run wrote, by name.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(c_.folder.path())) {
      const std::string name = fs::relative(entry.path(), c_.folder.path());
      if (mine_.contains(*fs::path(name).begin()) || name.ends_with("-lock") || !entry.is_regular_file())
        continue;
      if (name == "f.store" && text_of(entry.path()) == store_) {
        found[name] = "as it was";
      } else if (name.ends_with(".store")) {
        found[name] = c_.run({"store", "digest", name}).out;
        for (const std::string& line : lines_of(c_.run({"store", "info", name}).out))
          found[name + ": " + line] = "";
      } else {
        found[name] = text_of(entry.path());
      }
    }
    return found;
  }

 private:
  static cv::Mat part(cv::Size size, const cv::Rect& white) {
    cv::Mat mask(size, CV_8U, cv::Scalar(0));
    mask(white).setTo(255);
    return mask;
  }
  static std::string svg(cv::Size size, const std::string& paths) {
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(size.width) +
           "\" height=\"" + std::to_string(size.height) + "\">" + paths + "</svg>";
  }
  void put(const std::string& name, const cv::Mat& picture) const {
    fs::create_directories((c_.folder / name).parent_path());
    ASSERT_TRUE(cv::imwrite((c_.folder / name).string(), picture)) << name;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(c_.folder / name) << text;
  }
  void must(const Words& words) const {
    const Outcome outcome = c_.run(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void scene() const {
    write("scene.toml", R"(picture = "still.png"
frames = 4
fps = 4
loop = true
[wind]
speed = 8
[[layer]]
name = "tree"
matte = "tree.png"
motion = "tree"
mass = 1
armature = [32, 50, 32, 8]
[[layer]]
name = "lake"
matte = "lake.png"
motion = "water"
horizon = [0, 2, 96, 2]
tile = 64
)");
  }
  void stills() const {
    cv::Mat ground(96, 160, CV_8UC3);
    cv::RNG(5).fill(ground, cv::RNG::UNIFORM, 20, 120);
    cv::GaussianBlur(ground, ground, {}, 2);
    const int order[7] = {3, 0, 4, 1, 2, 6, 5};
    for (int i = 0; i < 7; ++i) {
      cv::Mat still = ground.clone();
      cv::circle(still, {28 + 16 * order[i], 30}, 12, cv::Scalar(210, 230, 250), cv::FILLED, cv::LINE_AA);
      cv::circle(still, {132 - 16 * order[i], 74}, 9, cv::Scalar(20, 40, 250), cv::FILLED, cv::LINE_AA);
      still.convertTo(still, -1, 1, i);
      put("stills/" + std::to_string(i) + ".png", still);
    }
    cv::Mat regions(96, 160, CV_8UC3, cv::Scalar(0, 255, 0));
    regions.rowRange(50, 96).setTo(cv::Scalar(0, 0, 255));
    put("regions.png", regions);
    cv::Mat scribbles(96, 160, CV_8UC4, cv::Scalar::all(0));
    cv::rectangle(scribbles, {20, 22, 110, 14}, {255, 255, 255, 255}, cv::FILLED);
    cv::rectangle(scribbles, {0, 88, 160, 8}, {0, 0, 0, 255}, cv::FILLED);
    put("still_scribbles.png", scribbles);
    write("edits.toml", "speed = 0.5\n");
    std::string cut;  // all steps but those of a circle of three, and of a dead end
    for (int a = 0; a < 7; ++a)
      for (int b = a + 1; b < 7; ++b)
        if (b > a + 1 && (a > 0 || b > 2))
          cut += (cut.empty() ? "[\"" : ", [\"") + std::to_string(a) + ".png\", \"" + std::to_string(b) +
                 ".png\"]";
    write("circle.toml", "cut = [" + cut + R"(]
order = [["0.png", "1.png", "2.png", "0.png"], ["2.png", "3.png", "4.png"]]
)");
  }
  void transfer() const {
    write("plume.toml", c_.run({"synth", "simulate", "--print-scene", "plume"}).out);
    must({"synth", "simulate", "plume.toml", "--size", "48x60", "--grid", "32", "--frames", "2", "-o",
          "design"});
    cv::Mat look(72, 72, CV_8UC4), mask(72, 72, CV_8U, cv::Scalar(0));
    cv::RNG(8).fill(look, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(look, look, {}, 1);
    cv::circle(mask, {36, 36}, 30, 255, cv::FILLED, cv::LINE_AA);
    cv::insertChannel(mask, look, 3);
    put("look.png", look);
    put("look_mask.png", part({72, 72}, {6, 6, 56, 40}));
    for (int i = 0; i < 2; ++i) {
      put("masks/" + std::to_string(i) + ".png", part({48, 60}, {8, 6 + 2 * i, 28, 40}));
      fs::create_directories(c_.folder / "still_flow");
      const std::int32_t sides[2] = {48, 60};
      const std::vector<float> vectors(std::size_t{2} * 48 * 60, 1.5f);
      std::ofstream(c_.folder / "still_flow" / (std::to_string(i) + ".flo"), std::ios::binary)
          .write("PIEH", 4)
          .write(reinterpret_cast<const char*>(sides), sizeof sides)
          .write(reinterpret_cast<const char*>(vectors.data()),
                 static_cast<std::streamsize>(vectors.size() * sizeof(float)));
    }
  }
  void flowlines() const {
    must({"synth", "simulate", "waterfall", "--size", "96x72", "--frames", "24", "--seed", "3", "-o",
          "fall.mkv"});
    const cv::Size size(96, 72);
    put("fall_matte.png", part(size, {30, 0, 24, 72}));
    cv::Mat wide(72, 160, CV_8UC3);
    cv::RNG(4).fill(wide, cv::RNG::UNIFORM, 20, 230);
    cv::GaussianBlur(wide, wide, {}, 1.5);
    for (int i = 0; i < 24; ++i)
      put("shaken/" + std::to_string(100 + i) + ".png", wide(cv::Rect(2 * i, 0, 96, 72)));
    write("lines.svg", svg(size, R"(<path id="a" d="M36,4 V68"/><path id="b" d="M56,4 V68"/>)"));
    write("edited.svg", svg(size, R"(<path id="a" d="M36,4 L50,66"/><path id="b" d="M56,4 L74,56"/>)"));
  }

  const Campaign& c_;
  std::set<std::string> mine_;
  std::string store_;  // bytes of every.store
};

/// What a run leaves and says, but for what differs from run to run.
struct Trace {
  int exit_code = 0;
  std::string err;
  std::map<std::string, std::string> parts;  // files, and the lines of stdout and stderr
};

const Material& material() {
  static const Material made(campaign());
  return made;
}

std::string with_ports(const std::string& word) {
  const int port = 20000 + 2 * (::getpid() % 6000);  // below those that the system gives to others
  return word == "PORT" ? std::to_string(port) : word == "OTHER" ? std::to_string(port + 1) : word;
}

Trace run(Words words, bool twice) {
  const Campaign& c = campaign();
  material().lay_out();
  for (std::string& word : words) word = with_ports(word);
  Outcome outcome;
  if (words[0] == "studio") {
    outcome = c.run_for({.seconds = 10,
                         .until = "http://",
                         .rest_ms = 700,  // in which a browser is begun
                         .environment = {"DISPLAY=:9", "FRESHET_STUDIO_TOKEN=t",
                                         "XDG_CACHE_HOME=/dev/null",  // where no starter store can be made
                                         "PATH=" + (c.folder / "bin").string() + ":/usr/bin:/bin"}},
                        words);
    // Whatever said its address was stopped in order.
    if (outcome.out.find("http://") != std::string::npos) {
      EXPECT_EQ(outcome.signal, SIGINT) << outcome.err;
    }
  } else {
    if (twice) {
      Words first = words;
      std::erase(first, "--overwrite");
      c.run(first);
    }
    outcome = c.run(words);
  }
  Trace trace{outcome.exit_code, outcome.err, material().files()};
  std::map<std::string, int> seen;
  static const std::regex kTime(R"(\d+(\.\d+)? ?(s|ms|h|frames/s|MB/s|us)\b|\d+\.\d+)");
  // JSON by key and value, so that what it says of seconds stands alone.
  std::string said = outcome.out + "\n";
  for (const std::string& line :
       lines_of(outcome.err))  // else progress, of which what is said depends on time
    if (line.starts_with("freshet: ")) said += line + "\n";
  if (said.starts_with("{")) said = std::regex_replace(said, std::regex("[,{}]"), "\n");
  for (const std::string& line : lines_of(said)) {
    if (line.starts_with("[") || line.find_first_not_of(" ") == std::string::npos) continue;
    const std::string steady = std::regex_replace(line, kTime, "#");
    trace.parts["said: " + steady + std::to_string(seen[steady]++)] = line;
  }
  return trace;
}

/// Words without an option and its values.
Words without(const Words& words, const Option& option, const std::string& short_name) {
  Words left;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] != option.name && words[i] != short_name) {
      left.push_back(words[i]);
      continue;
    }
    if (!option.is_flag) ++i;
  }
  return left;
}

class EveryOption : public testing::TestWithParam<std::string> {};

/// What is wrong with a row; empty when nothing is.
std::string judge_row(const std::vector<Option>& options, const Row& row,
                      std::map<Words, std::array<Trace, 2>>& bases) {
  const Words given = words_of(row.option);
  const auto option_named = [&](const std::string& name) {
    return std::ranges::find_if(options, [&](const Option& option) {
      return option.name == name || (name == "-o" && option.name == "--output");
    });
  };
  const auto short_of = [](const std::string& name) { return name == "--output" ? "-o" : name; };
  Words base;
  if (row.beside.starts_with("=")) {
    base = words_of(row.beside.substr(1));
  } else {
    base = words_of(kBases.at(row.command));
    const Words beside = words_of(row.beside);
    for (const std::string& word : beside)
      if (const auto option = option_named(word); word.starts_with("-") && option != options.end())
        base = without(base, *option, short_of(option->name));
    if (std::ranges::find(beside, "--matte") != beside.end()) std::erase(base, "--whole");
    const bool wide = !beside.empty() && beside.front() == "wide.png";
    if (wide) std::ranges::replace(base, "still.png", "wide.png");
    base.insert(base.end(), beside.begin() + (wide ? 1 : 0), beside.end());
  }
  const auto option = option_named(given[0]);
  base = without(base, *option, short_of(option->name));
  if (given[0] == "--matte") std::erase(base, "--whole");
  Words with = base;
  with.insert(with.end(), given.begin(), given.end());
  if (row.does == Does::kElsewhere) return "";
  if (row.does != Does::kChanges) {
    if (row.does == Does::kResource) {
      with.back() = "nan";
    }
    const Trace trace = run(with, false);
    return trace.exit_code == 2 && trace.err.find(given[0]) != std::string::npos
               ? ""
               : "not refused: " + trace.err;
  }
  const bool twice = given[0] == "--overwrite";
  Words key = base;
  if (twice) key.emplace_back("(twice)");
  if (!bases.contains(key)) bases[key] = {run(base, twice), run(base, twice)};
  const auto& [once, again] = bases.at(key);
  const Trace trace = run(with, twice);
  const bool stopped = row.command == "studio" || given[0] == "--page";
  if (trace.exit_code != 0 && !stopped) return "exit " + std::to_string(trace.exit_code) + ": " + trace.err;
  if (trace.exit_code != once.exit_code) return "";
  // What two runs of the base have alike, this run has not, or it has more.
  for (const auto& [name, text] : once.parts) {
    const auto other = again.parts.find(name), third = trace.parts.find(name);
    if (other == again.parts.end()) continue;
    if (third == trace.parts.end() || (other->second == text && third->second != text)) return "";
  }
  for (const auto& [name, text] : trace.parts)
    if (!once.parts.contains(name) && !again.parts.contains(name)) return "";
  return "it changes nothing";
}

TEST_P(EveryOption, ChangesAResultOrAMessageOrIsRefusedByName) {
  const std::string& command = GetParam();
  const std::vector<Option> options = options_of(campaign(), command);
  ASSERT_TRUE(kBases.contains(command)) << "add a base for it";
  ASSERT_FALSE(options.empty());
  std::map<Words, std::array<Trace, 2>> bases;
  for (const Option& option : options) {
    std::vector<Row> fitting;
    for (const bool own : {true, false})
      for (const Row& row : rows())
        if (words_of(row.option).front() == option.name &&
            (own ? row.command == command : row.command.empty()) && (own || fitting.empty()))
          fitting.push_back(row);
    EXPECT_FALSE(fitting.empty()) << command << " " << option.name << ": add a row for it";
    for (Row& row : fitting) {
      row.command = command;
      EXPECT_EQ(judge_row(options, row, bases), "")
          << command << " " << row.option << " (" << row.beside << ")";
    }
  }
}

std::vector<std::string> based_commands() {
  std::vector<std::string> names;
  for (const auto& [name, base] : kBases) names.push_back(name);
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name;
  for (const std::string& word : words_of(info.param))
    name += static_cast<char>(std::toupper(word[0])) + word.substr(1);
  return name;
}

INSTANTIATE_TEST_SUITE_P(Of, EveryOption, testing::ValuesIn(based_commands()), test_name);

TEST(EveryCommand, IsWalked) {
  for (const std::string& command : commands_of(campaign())) EXPECT_TRUE(kBases.contains(command)) << command;
  EXPECT_EQ(commands_of(campaign()).size(), kBases.size());
}

}  // namespace
}  // namespace freshet::tools
