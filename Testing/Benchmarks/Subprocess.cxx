// SPDX-License-Identifier: BSD-3-Clause
#include "Subprocess.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <stdexcept>

namespace benchmarks
{
namespace
{
[[noreturn]] void runAndExit(
  const std::function<std::vector<double>()>& work, unsigned seconds, int out)
{
  alarm(seconds); // its default action ends the process
  const rlimit none{ 0, 0 };
  setrlimit(RLIMIT_CORE, &none);
  int code = EXIT_FAILURE;
  try
  {
    const std::vector<double> numbers = work();
    const auto bytes = static_cast<ssize_t>(numbers.size() * sizeof(double));
    code = write(out, numbers.data(), bytes) == bytes ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  catch (const std::exception&)
  {
    code = EXIT_FAILURE;
  }
  _exit(code);
}
}

std::optional<std::vector<double>> inSubprocess(
  const std::function<std::vector<double>()>& work, unsigned seconds)
{
  int ends[2];
  if (pipe(ends) != 0)
  {
    throw std::runtime_error("no pipe");
  }
  const pid_t child = fork();
  if (child < 0)
  {
    throw std::runtime_error("no process");
  }
  if (child == 0)
  {
    close(ends[0]);
    runAndExit(work, seconds, ends[1]);
  }
  close(ends[1]);
  std::vector<double> numbers;
  double number;
  while (read(ends[0], &number, sizeof number) == static_cast<ssize_t>(sizeof number))
  {
    numbers.push_back(number);
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != EXIT_SUCCESS)
  {
    return std::nullopt;
  }
  return numbers;
}
}
