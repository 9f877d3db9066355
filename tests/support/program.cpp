#include "support/program.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <functional>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "support/file_bytes.hpp"
#include "support/temporary_folder.hpp"

namespace saccade::test {
namespace {

[[noreturn]] void becomeSaccade(const std::vector<std::string>& arguments, const std::string& output,
                                const std::string& talk) {
  const int out = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = ::open(talk.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  std::vector<char*> argv = {const_cast<char*>(SACCADE_PROGRAM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  ::execv(SACCADE_PROGRAM, argv.data());
  ::_exit(127);
}

/// Runs the program; `meanwhile` may send it signals before its end is waited for.
ProgramRun runWhile(const std::vector<std::string>& arguments, const std::function<void(pid_t)>& meanwhile) {
  const TemporaryFolder folder;
  const std::string output = folder / "stdout";
  const std::string talk = folder / "stderr";
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) becomeSaccade(arguments, output, talk);
  meanwhile(child);
  int status = 0;
  ::waitpid(child, &status, 0);
  ProgramRun run;
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.output = readFile(output);
  run.talk = readFile(talk);
  return run;
}

}  // namespace

ProgramRun runSaccade(const std::vector<std::string>& arguments, double interrupt_after_s) {
  return runWhile(arguments, [&](pid_t child) {
    if (interrupt_after_s <= 0.0) return;
    std::this_thread::sleep_for(std::chrono::duration<double>(interrupt_after_s));
    ::kill(child, SIGINT);
  });
}

ProgramRun killSaccade(const std::vector<std::string>& arguments, const std::filesystem::path& file, double after_s) {
  return runWhile(arguments, [&](pid_t child) {
    constexpr auto kPoll = std::chrono::milliseconds(5);
    constexpr int kMostPolls = 12'000;  // a minute
    for (int i = 0; i < kMostPolls && !file.empty() && !std::filesystem::exists(file); ++i) {
      std::this_thread::sleep_for(kPoll);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
    ::kill(child, SIGKILL);
  });
}

}  // namespace saccade::test
