// What the public classes promise by their types alone: none is null, none is emptied by a move.

#include <gtest/gtest.h>

#include <filesystem>
#include <stop_token>
#include <string>
#include <type_traits>

#include "freshet/animate.h"
#include "freshet/error.h"
#include "freshet/footage.h"
#include "freshet/ingest.h"
#include "freshet/picture.h"
#include "freshet/sample.h"
#include "freshet/ways/flowlines.h"
#include "freshet/ways/scene.h"
#include "freshet/ways/simulate.h"
#include "freshet/ways/stills.h"
#include "freshet/ways/tour.h"
#include "freshet/ways/transfer.h"
#include "tests/harness/fault.h"

namespace freshet {
namespace {

template <class T>
constexpr bool never_null = !std::is_default_constructible_v<T>;
static_assert(never_null<Store> && never_null<Search> && never_null<Labelling>);
static_assert(never_null<Footage> && never_null<Sampler>);
static_assert(never_null<VideoWriter> && never_null<Simulation> && never_null<Tour>);
static_assert(never_null<FlowLines> && never_null<SceneFilm> && never_null<StillsFilm>);
static_assert(!std::is_move_constructible_v<VideoWriter> && !std::is_move_constructible_v<Simulation> &&
              !std::is_move_constructible_v<Tour> && !std::is_move_constructible_v<FlowLines> &&
              !std::is_move_constructible_v<SceneFilm> && !std::is_move_constructible_v<StillsFilm>);

TEST(PublicTypes, WhatIsMissingIsNamedByAnError) {
  EXPECT_EQ(kind_of([] { Store("/no/such.store"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { read_picture("/no/such.png"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { VideoWriter("/no/such/folder/a.mp4", {64, 64}); }), ErrorKind::kIo);
  EXPECT_EQ(kind_of([] { VideoWriter("a.unknown", {64, 64}); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([] { Simulation({.scene = "no such scene"}); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([] { Tour("/no/film.mp4"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { Tour("/no/film.mp4", {.move = "spin"}); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([] {
              transfer({.alpha = "/no/alpha", .flow = "/no/flow"}, {.exemplar = "/no.png"},
                       [](const cv::Mat&) {});
            }),
            ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { FlowLines("/no/clip.mp4"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { FlowLines("/no/clip.mp4", {.patch_px = 2}); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([] { SceneFilm("/no/scene.toml"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { StillsFilm("/no/stills"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([] { StillsFilm("/no/stills", {.camera = "drone"}); }), ErrorKind::kUsage);
  const std::filesystem::path clips[] = {"/no/such/clips"};
  EXPECT_EQ(kind_of([&] { add_clips("/tmp/never-made.store", clips); }), ErrorKind::kInput);
  EXPECT_FALSE(std::filesystem::exists("/tmp/never-made.store"));
}

}  // namespace
}  // namespace freshet
