#include <chrono>
#include <filesystem>
#include <iostream>
#include <malloc.h>
#include <memory>
#include <optional>
#include <thread>

#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "saccade/inspection/session_view.hpp"
#include "saccade/inspection/view_server.hpp"
#include "terminal.hpp"
#include "view_page.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string first, second;
  int port = 0;
};

/// The program keeps the memory it frees, which suits one frame after the other. Of a server's threads each would keep
/// a heap of its own as large as its largest answer: three times the memory on a kitchen.
void keepOneHeap() {
  constexpr int kMmapThreshold_bytes = 1 << 20, kTrimThreshold_bytes = 16 << 20;
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, kMmapThreshold_bytes);
  mallopt(M_TRIM_THRESHOLD, kTrimThreshold_bytes);
}

void run(const Options& options) {
  keepOneHeap();
  const bool compares = !options.second.empty();
  SessionView view(compares ? options.second : options.first,
                   compares ? std::optional<std::filesystem::path>(options.first) : std::nullopt);
  catchInterrupts();
  const ViewServer server(view, viewPage(), options.port);
  std::cerr << "open this address in a browser on this machine; Ctrl-C ends\n";
  std::cout << server.url() << std::endl;
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

}  // namespace

void addView(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "view", "Show a session in a browser: map, attention memory, objects, frames; or what differs between two");
  command->add_option("SESSION", options->first, "a *.saccade file; one that is being explored is followed")
      ->required();
  command->add_option("LATER", options->second,
                      "a later session of the same world frame: it is shown, with what differs from SESSION");
  command->add_option("--port", options->port, "port on the loopback interface (0: any that is free)")
      ->check(CLI::Range(0, 65535));
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
