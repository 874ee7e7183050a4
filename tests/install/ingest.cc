// Adds clips to a store, and lists what it holds.   ingest STORE CLIPS
#include <freshet/ingest.h>
#include <freshet/store.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const freshet::Job job{.progress = [](const freshet::Progress& at) {
    std::cerr << at.stage << ' ' << at.done << '/' << at.of << '\n';
  }};
  const std::filesystem::path clips[] = {argv[2]};
  const freshet::IngestReport report = freshet::add_clips(argv[1], clips, {.licence = "CC0"}, job);
  for (const freshet::IngestedClip& clip : report.clips)
    for (const std::string& reason : clip.reasons) std::cerr << clip.name << ": " << reason << '\n';
  const freshet::Store store(argv[1]);
  for (const freshet::Clip& clip : store.clips()) std::cout << clip.name << ' ' << clip.patches << '\n';
  std::cout << store.digest() << '\n';
  return store.verify().empty() && !report.stopped ? 0 : 1;
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
