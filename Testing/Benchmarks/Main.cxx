// SPDX-License-Identifier: BSD-3-Clause
// avianlidarBenchmarks --suite NAME --out FOLDER [--short | --smoke] [--scene NAME]
#include "Suites.h"

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <stdexcept>

namespace benchmarks
{
namespace
{
const std::map<std::string, bool (*)(const Options&)> suites = {
  { "machine", suiteMachine },
  { "matrix", suiteMatrix },
  { "locators", suiteLocators },
  { "build", suiteBuild },
  { "figure9", suiteFigure9 },
  { "figure10", suiteFigure10 },
  { "figure11", suiteFigure11 },
  { "epsilon", suiteEpsilon },
  { "section5", suiteSection5 },
  { "filter", suiteFilter },
  { "scan", suiteScan },
  { "memory", suiteMemory },
  { "movers", suiteMovers },
};

Options parse(int argc, char* argv[])
{
  Options options;
  const std::map<std::string, bool*> switches = { { "--short", &options.brief },
    { "--smoke", &options.smoke } };
  const std::map<std::string, std::string*> values = { { "--suite", &options.suite },
    { "--out", &options.folder }, { "--scene", &options.scene } };
  for (int i = 1; i < argc; ++i)
  {
    if (switches.count(argv[i]))
    {
      *switches.at(argv[i]) = true;
    }
    else if (values.count(argv[i]) && i + 1 < argc)
    {
      *values.at(argv[i]) = argv[i + 1];
      ++i;
    }
    else
    {
      throw std::invalid_argument("unknown argument or no value: " + std::string(argv[i]));
    }
  }
  return options;
}
}
}

int main(int argc, char* argv[])
{
  try
  {
    const benchmarks::Options options = benchmarks::parse(argc, argv);
    std::filesystem::create_directories(options.folder);
    if (!benchmarks::suites.count(options.suite))
    {
      throw std::invalid_argument("unknown suite \"" + options.suite + "\"");
    }
    return benchmarks::suites.at(options.suite)(options) ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  catch (const std::exception& e)
  {
    std::cerr << "avianlidarBenchmarks: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
}
