#include "work/task.h"

#include <gtest/gtest.h>

#include "tests/harness/fault.h"

namespace freshet::work {
namespace {

using Words = std::vector<std::string>;

TEST(Task, ShardsAndGatheringAreTheCommandsOwn) {
  const SharedCommand ingest({"ingest", "all.store", "clips", "--class", "water"});
  EXPECT_EQ(ingest.shard_words({3, 8}),
            (Words{"ingest", "all.store", "clips", "--class", "water", "--shard", "3/8", "--seal"}));
  EXPECT_EQ(ingest.gather_words(), (Words{"ingest", "all.store", "clips", "--class", "water", "--gather"}));
  const SharedCommand sweep({"synth", "sweep", "a.store", "fall.png", "-o", "out"});
  EXPECT_EQ(sweep.shard_words({1, 2}),
            (Words{"synth", "sweep", "a.store", "fall.png", "-o", "out", "--shard", "1/2"}));
}

TEST(Task, IsReadAsItWasWritten) {
  const Task task{SharedCommand({"ingest", "a b\".store", "Fälle"}), {3, 8}};
  const Task read = read_task(task.text());
  EXPECT_EQ(read.command.words(), task.command.words());
  EXPECT_EQ(read.shard.index, 3);
  EXPECT_EQ(read.shard.count, 8);
  EXPECT_EQ(read.key(), task.key());
  EXPECT_NE(task.key(), (Task{task.command, {4, 8}}).key());
  EXPECT_NE(task.key(), (Task{SharedCommand({"ingest", "a b\".store", "Fall"}), {3, 8}}).key());
}

TEST(Task, OnlySharedCommandsAreRunAndWithoutWhatIsNotTheirs) {
  for (const Words& words : std::vector<Words>{{},
                                               {"store", "remove", "a.store", "b"},
                                               {"synth"},
                                               {"synth", "animate"},
                                               {"ingest", "a.store", "b", "--shard", "1/2"},
                                               {"ingest", "a.store", "b", "--shard=1/2"},
                                               {"ingest", "a.store", "b", "--gather"},
                                               {"ingest", "a.store", "b", "-j4"},
                                               {"ingest", "a.store", "b", "--threads=4"},
                                               {"ingest", "a.store", "--", "b"},
                                               Words(1001, "ingest"),
                                               {"ingest", std::string(100'001, 'a')}})
    fault_of(ErrorKind::kUsage, [&] { SharedCommand{words}; });
}

TEST(Task, WhatIsNoneIsRefused) {
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("{}"), std::string("\xff"), std::string(100'000, '['),
        std::string(R"({"run": "ingest", "shard": [1, 2]})"),
        std::string(R"({"run": ["ingest", 1], "shard": [1, 2]})"),
        std::string(R"({"run": ["ingest"], "shard": [0, 2]})"),
        std::string(R"({"run": ["ingest"], "shard": [3, 2]})"),
        std::string(R"({"run": ["ingest"], "shard": [-1, 2]})"),
        std::string(R"({"run": ["ingest"], "shard": [1, 4294967297]})"),
        std::string(R"({"run": ["ingest"], "shard": [1, 2, 3]})"),
        std::string(R"({"run": ["ingest"], "shard": "1/2"})"), std::string(R"({"run": ["ingest"]})")})
    fault_of(ErrorKind::kInput, [&] { read_task(text); });
}

}  // namespace
}  // namespace freshet::work
