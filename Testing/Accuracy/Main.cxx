// SPDX-License-Identifier: BSD-3-Clause
// avianlidarAccuracy --suite NAME --out FOLDER [--scene NAME] [--check]
#include "Suites.h"

#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>

namespace
{
accuracy::Options parse(int argc, char* argv[])
{
  accuracy::Options options;
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word == "--check")
    {
      options.check = true;
      continue;
    }
    std::string* value = word == "--suite" ? &options.suite
      : word == "--out"                    ? &options.folder
      : word == "--scene"                  ? &options.scene
                                           : nullptr;
    if (!value || i + 1 >= argc)
    {
      throw std::invalid_argument("unknown argument or no value: " + word);
    }
    *value = argv[++i];
  }
  return options;
}
}

int main(int argc, char* argv[])
{
  try
  {
    const accuracy::Options options = parse(argc, argv);
    if (options.suite == "standard_errors")
    {
      return accuracy::suiteStandardErrors(options) ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    if (options.suite == "small_targets")
    {
      return accuracy::suiteSmallTargets(options) ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    throw std::invalid_argument("unknown suite \"" + options.suite + "\"");
  }
  catch (const std::exception& e)
  {
    std::cerr << "avianlidarAccuracy: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
}
