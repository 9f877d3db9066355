#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"Attentional exploration of RGB-D scenes with a memory in the map"};
  CLI11_PARSE(app, argc, argv);
  return 0;
}
