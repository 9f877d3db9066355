#include "saccade/attention/saliency.hpp"

#include <iostream>
#include <memory>

#include <opencv2/imgcodecs.hpp>

#include "commands.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string image;
  std::string output;
  std::string config;
  std::vector<std::string> settings;
  bool print_config = false;
};

void run(const Options& options) {
  SaliencyConfig config;
  if (!options.config.empty()) applyConfigFile(options.config, describing(config));
  applyConfigSettings(options.settings, describing(config));
  if (options.print_config) {
    std::cout << printConfig(describing(config), true);
    return;
  }
  if (options.image.empty() || options.output.empty()) {
    throw std::invalid_argument("saliency: expected an IMAGE and -o OUTPUT");
  }
  const cv::Mat3b image = cv::imread(options.image, cv::IMREAD_COLOR);
  if (image.empty()) throw IoError(options.image, "an image that can be read", "none");
  SaliencyModel model(config);
  cv::Mat1w map;
  model.compute(image).convertTo(map, CV_16U, 65535.0);
  bool written = false;
  try {
    written = cv::imwrite(options.output, map);
  } catch (const cv::Exception&) {  // an unknown file name extension
    written = false;
  }
  if (!written) throw IoError(options.output, "a picture file (.png) that can be written", "none");
}

}  // namespace

void addSaliency(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("saliency", "Write the saliency map of one picture as a 16-bit PNG");
  command->add_option("IMAGE", options->image, "a colour picture");
  command->add_option("-o,--output", options->output, "the map: a PNG, 16 bits, 65535 = most salient");
  command->add_option("--config", options->config, "YAML file with settings");
  command->add_option("--set", options->settings, "one setting, for example center_sigma=2")->expected(1)->take_all();
  command->add_flag("--print-config", options->print_config, "print the effective settings and stop");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
