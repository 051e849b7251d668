// SPDX-License-Identifier: BSD-3-Clause
// avianlidarBenchmarks SUITE FOLDER [--short | --smoke]: one suite, whose results go to the folder.
#include "Suites.h"

#include <cstdlib>
#include <exception>
#include <iostream>
#include <map>

int main(int argc, char* argv[])
{
  using namespace benchmarks;
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
  const std::string form = argc > 3 ? argv[3] : "";
  if (argc < 3 || !suites.count(argv[1]))
  {
    std::cerr << "usage: avianlidarBenchmarks SUITE FOLDER [--short | --smoke]\n";
    return EXIT_FAILURE;
  }
  try
  {
    const Options options{ argv[1], argv[2], form == "--short", form == "--smoke" };
    return suites.at(options.suite)(options) ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  catch (const std::exception& e)
  {
    std::cerr << "avianlidarBenchmarks: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
}
