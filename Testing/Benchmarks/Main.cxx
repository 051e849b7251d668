// SPDX-License-Identifier: BSD-3-Clause
// avianlidarBenchmarks --suite NAME --out FOLDER [--short | --smoke] [--scene NAME]
#include "Suites.h"

#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>

namespace benchmarks
{
namespace
{
struct Suite
{
  const char* name;
  bool (*run)(const Options&);
};

const Suite suites[] = {
  { "machine", suiteMachine },
  { "matrix", suiteMatrix },
  { "locators", suiteLocators },
  { "build", suiteBuild },
  { "figure9", suiteFigure9 },
  { "figure10", suiteFigure10 },
  { "figure11", suiteFigure11 },
  { "epsilon", suiteEpsilon },
  { "section5", suiteSection5 },
  { "growth", suiteGrowth },
  { "filter", suiteFilter },
  { "scan", suiteScan },
  { "front", suiteFront },
  { "memory", suiteMemory },
  { "movers", suiteMovers },
};

Options parse(int argc, char* argv[])
{
  Options options;
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    const auto value = [&]()
    {
      if (i + 1 >= argc)
      {
        throw std::invalid_argument(word + " wants a value");
      }
      return std::string(argv[++i]);
    };
    if (word == "--suite")
    {
      options.suite = value();
    }
    else if (word == "--out")
    {
      options.folder = value();
    }
    else if (word == "--scene")
    {
      options.scene = value();
    }
    else if (word == "--short")
    {
      options.brief = true;
    }
    else if (word == "--smoke")
    {
      options.smoke = true;
    }
    else
    {
      throw std::invalid_argument("unknown argument " + word);
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
    benchmarks::initializeRounds(argv[0]);
    std::filesystem::create_directories(options.folder);
    for (const benchmarks::Suite& suite : benchmarks::suites)
    {
      if (options.suite == suite.name)
      {
        return suite.run(options) ? EXIT_SUCCESS : EXIT_FAILURE;
      }
    }
    throw std::invalid_argument("unknown suite \"" + options.suite + "\"");
  }
  catch (const std::exception& e)
  {
    std::cerr << "avianlidarBenchmarks: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
}
