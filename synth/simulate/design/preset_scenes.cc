// synth/simulate/design/preset_scenes.cc — scenes to begin with.
#include <array>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/simulate/design/scene_file.h"

namespace freshet::synth::simulate {
namespace {

struct Named {
  const char *name, *summary, *text;
};

constexpr std::array kDesigns{
    Named{"plume", "smoke that rises from a vent and curls", R"(size = [640, 480]  # px of what is written
frames = 150
fps = 25
seed = 1
grid = 192         # cells of the simulation along the height, apart from the size
steps = 2          # of the simulation per frame
warm_up = 2.0      # seconds simulated before frame 0

[fluid]
buoyancy = 1.6     # heights/s^2 upwards for heat 1
top_speed = 0.75   # heights/s
vorticity = 1.2    # 1/s
dissipation = 0.15 # fraction of the density lost per second
cooling = 0.2      # fraction of the heat lost per second

[sides]
bottom = "closed"

[look]
opacity = 3.0

[[emitter]]
name = "vent"
shape = "disc"
position = [0.5, 0.96]
radius = 0.06
softness = 0.02
velocity = [0.0, -0.45]
heat = 1.0
jitter = 0.7
lump = 0.05

[[force]]
kind = "turbulence"
size = 0.2
strength = 0.7

[[force]]
kind = "wind"
velocity = [0.08, 0.0]
strength = 0.25
)"},
    Named{"fireball", "a blast that rises and rolls into a mushroom", R"(size = [640, 480]
frames = 120
fps = 25
seed = 1
grid = 208
steps = 3

[fluid]
buoyancy = 1.5
top_speed = 0.45
vorticity = 0.8
dissipation = 0.12
burning = 0.06
cooling = 0.3

[sides]
bottom = "closed"

[look]
opacity = 4.0
thin = [0.7, 0.13, 0.02]
dense = [1.0, 0.5, 0.12]
glow = 0.8

[[emitter]]
name = "blast"
shape = "disc"
position = [0.5, 0.88]
radius = 0.08
softness = 0.02
from = 0.0
to = 0.45
rate = [[0.0, 1.0], [0.3, 1.3], [0.45, 0.9]]
velocity = [0.0, -0.5]
heat = 1.1
expansion = 7.0
jitter = 0.4
lump = 0.08

[[emitter]]
name = "stem"
shape = "disc"
position = [0.5, 0.93]
radius = 0.04
softness = 0.015
from = 0.25
to = 2.2
rate = [[0.25, 0.9], [2.2, 0.2]]
velocity = [0.0, -0.5]
heat = 0.7
jitter = 0.7
lump = 0.04

[[force]]
kind = "turbulence"
size = 0.2
strength = 0.35
)"},
    Named{"firepit", "tongues of flame over a bed of logs", R"(size = [640, 480]
frames = 150
fps = 25
seed = 1
grid = 192
steps = 3
warm_up = 1.5

[fluid]
buoyancy = 4.5
top_speed = 1.3
vorticity = 0.5
burning = 0.6
still_air = 1.5
cooling = 0.5

[sides]
bottom = "closed"

[look]
opacity = 4.0
thin = [0.8, 0.16, 0.02]
dense = [1.0, 0.62, 0.2]
glow = 1.0

[[emitter]]
name = "bed"
shape = "polygon"  # thin at its ends
corners = [[0.32, 0.935], [0.38, 0.905], [0.5, 0.885], [0.62, 0.905], [0.68, 0.935], [0.6, 0.945], [0.4, 0.945]]
softness = 0.03
rate = 1.3
velocity = [0.0, -0.5]
heat = 1.0
expansion = 2.5
jitter = 1.0
lump = 0.09

[[obstacle]]
name = "log"
shape = "line"
start = [0.31, 0.965]
end = [0.69, 0.955]
width = 0.03

[[force]]
kind = "turbulence"
size = 0.15
strength = 1.5
change = 2.5
)"},
    Named{"waterfall-pool", "water that falls over a brink into a pool and spreads", R"(size = [640, 480]
frames = 150
fps = 25
seed = 1
grid = 160
steps = 4
warm_up = 3.0

[fluid]
gravity = 1.5      # heights/s^2 downwards for density 1
weight = 30        # times heavier than the air
vorticity = 0.3
burning = 0.25
drag = 0.5
still_air = 1.0

[sides]
bottom = "closed"

[look]
opacity = 3.0
thin = [0.2, 0.32, 0.42]
dense = [0.8, 0.84, 0.95]

[[emitter]]
name = "brink"
shape = "line"
start = [0.4, 0.02]
end = [0.56, 0.02]
width = 0.04
softness = 0.01
velocity = [0.0, 0.5]
jitter = 0.5
lump = 0.05

[[emitter]]
name = "pool"      # stays full: what splashes up falls back
shape = "polygon"
corners = [[0.0, 0.9], [1.0, 0.9], [1.0, 1.0], [0.0, 1.0]]
jitter = 0.0

[[obstacle]]
name = "left rim"
shape = "polygon"
corners = [[-0.1, 0.84], [0.03, 0.84], [0.05, 1.1], [-0.1, 1.1]]

[[obstacle]]
name = "right rim"
shape = "polygon"
corners = [[1.1, 0.84], [0.97, 0.84], [0.95, 1.1], [1.1, 1.1]]

[[force]]
kind = "turbulence"
size = 0.08
strength = 1.0
change = 2.0
)"},
    Named{"dragon-breath", "a jet of fire that shoots sideways and billows", R"(size = [640, 360]
frames = 200
fps = 25
seed = 1
grid = 192
steps = 5

[fluid]
buoyancy = 1.0
weight = 1.5       # times heavier than the air: it shoots on
vorticity = 0.8
dissipation = 0.4
burning = 0.15
cooling = 0.4

[look]
opacity = 4.0
thin = [0.75, 0.14, 0.02]
dense = [1.0, 0.55, 0.15]
glow = 0.9

[[emitter]]
name = "mouth"
shape = "polygon"
corners = [[0.02, 0.513], [0.1, 0.474], [0.1, 0.566]]  # it widens on its way
softness = 0.012
to = 7.2
rate = [[0.0, 0.4], [0.4, 1.2], [6.6, 1.2], [7.2, 0.3]]
velocity = [2.0, 0.12]
heat = 0.8
expansion = 2.0
jitter = 1.0
lump = 0.06

[[force]]
kind = "turbulence"
size = 0.12
strength = 4.0
change = 3.0

[[force]]
kind = "wind"
velocity = [0.7, -0.05]
strength = 0.5
)"}};

std::string clip_summary(SceneKind kind) {
  switch (kind) {
    case SceneKind::kSmoke:
      return "a clip of smoke, lit, from a few vents";
    case SceneKind::kFire:
      return "a clip of flames with sparks";
    case SceneKind::kInk:
      return "a clip of ink in water";
    case SceneKind::kWaterfall:
      return "a clip of a waterfall over rock, from the front";
    case SceneKind::kRiver:
      return "a clip of a river with rocks";
    case SceneKind::kClouds:
      return "a clip of clouds in the wind";
    case SceneKind::kDesign:
      break;
  }
  return {};
}

}  // namespace

std::vector<PresetScene> preset_scenes() {
  std::vector<PresetScene> result;
  for (const Named& each : kDesigns) result.push_back({each.name, each.summary});
  for (const SceneKind kind : all_clip_kinds())
    result.push_back({std::string(scene_kind_name(kind)), clip_summary(kind)});
  return result;
}

std::string preset_scene(std::string_view name) {
  for (const Named& each : kDesigns)
    if (name == each.name) return fmt::format("# {}: {}\n{}", each.name, each.summary, each.text);
  std::string names;
  for (const PresetScene& each : preset_scenes()) names += (names.empty() ? "" : ", ") + each.name;
  for (const SceneKind kind : all_clip_kinds()) {
    if (name != scene_kind_name(kind)) continue;
    const SceneOptions scene;
    return fmt::format(
        "# {}: {}. The seed decides its sources, winds, speeds and colours\nclip = \"{}\"\nsize = [{}, {}]\n"
        "frames = {}\nfps = {}\nseed = {}\n",
        name, clip_summary(kind), name, scene.size.width, scene.size.height, scene.frames, scene.fps,
        scene.seed);
  }
  throw Error(ErrorKind::kUsage, "preset", fmt::format("'{}' is not known", name),
              fmt::format("Choose one of {}, or give a scene file (.toml)", names));
}

std::string scene_keys() {
  return R"(Keys of a scene file (TOML). A place is [fraction of the width, fraction of the height] of the picture,
y down; lengths are fractions of its height, speeds heights per second, seconds count from frame 0.

size = [640, 360]   px of what is written, 16 to 4096 a side
frames = 120        fps = 25         seed = 1
clip = "smoke"      a ready-made clip (smoke, fire, ink, waterfall, river, clouds): nothing below then
grid = 192          cells of the simulation along the height, 16 to 2048, whatever the size
steps = 2           of the simulation per frame, 1 to 32: more for fast fluid
warm_up = 0         seconds simulated before frame 0

[fluid]
buoyancy = 0        heights/s^2 upwards for heat 1
gravity = 0         heights/s^2 downwards for density 1
weight = 1          times heavier than the air, to 100: falls and shoots on as water does
top_speed = 0       heights/s at which drag holds against them; 0: none
vorticity = 1       vorticity confinement, 1/s: curls
dissipation = 0     fraction of the density lost per second
burning = 0         density lost per second, whatever there is: tongues
cooling = 0         fraction of the heat lost per second
viscosity = 0       heights^2/s, to 0.01
drag = 0            fraction of the velocity lost per second
still_air = 0       the same where there is no fluid

[sides]
left = "open"       or "closed"; right, top, bottom likewise

[look]
opacity = 3         alpha is 1 - exp(-opacity x density)
thin, dense         colours of the preview, [red, green, blue], linear
glow = 0            0: lit, 1: shines

[[emitter]]         as many as wanted; so are [[obstacle]] and [[force]]
name = "vent"       for messages and design.json
shape = "disc"      position, radius (0.05)
shape = "line"      start, end, width (0.02)
shape = "polygon"   corners = [[x, y], ...]
shape = "picture"   picture = "mask.png", beside the scene: white inside, laid over the whole picture
softness = 0        how far the rim fades
move = [[second, dx, dy], ...]   moved so far then, straight between
from, to            seconds; all the time without them
rate = 1            density that the shape is held filled with, or [[second, rate], ...]
velocity = [0, 0]   [right, down], heights/s; [0, 0] does not drive the fluid
heat = 0            what buoyancy acts on
expansion = 0       growth of the area inside, a fraction per second: a blast
jitter = 0.3        0: even, 1: gusts and lumps
lump = 0.05         size of the lumps

[[obstacle]]        name, shape and its keys, softness, move, from, to

[[force]]           from, to, strength (1), and
kind = "wind"       velocity; strength is the fraction made up per second
kind = "point"      position, radius (0.2) where it is strongest; heights/s^2, below 0 pushes away
kind = "vortex"     position, radius; heights/s^2, anticlockwise
kind = "turbulence" size (0.1), change (1 per second), everywhere = false (only in fluid); heights/s^2
)";
}

}  // namespace freshet::synth::simulate
