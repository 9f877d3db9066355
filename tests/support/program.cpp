#include "support/program.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "support/temporary_folder.hpp"

namespace saccade::test {
namespace {

std::string readFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

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

/// Runs the program and sends it `signal` after a time, if that is not 0.
ProgramRun runAndSignal(const std::vector<std::string>& arguments, int signal, double after_s) {
  const TemporaryFolder folder;
  const std::string output = folder / "stdout";
  const std::string talk = folder / "stderr";
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) becomeSaccade(arguments, output, talk);
  if (after_s > 0.0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
    ::kill(child, signal);
  }
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
  return runAndSignal(arguments, SIGINT, interrupt_after_s);
}

ProgramRun killSaccade(const std::vector<std::string>& arguments, double after_s) {
  return runAndSignal(arguments, SIGKILL, after_s);
}

}  // namespace saccade::test
