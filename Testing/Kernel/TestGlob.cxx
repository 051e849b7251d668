// SPDX-License-Identifier: BSD-3-Clause
// Patterns with wildcards.
#include "Glob.h"

#include <gtest/gtest.h>

using avianlidar::globMatches;

TEST(Glob, StarsStandForAnyTextAndQuestionMarksForOneCharacter)
{
  const struct
  {
    const char *pattern, *text;
    bool matches;
  } cases[] = { { "", "", true }, { "hangar", "hangar", true }, { "hangar", "Hangar", false },
    { "hangar", "hangar 1", false }, { "", "hangar", false }, { "*", "", true },
    { "*", "a/b.c", true }, { "hangar*", "hangar", true }, { "*ang*r*", "hangar 1", true },
    { "*aab", "aaab", true }, // the star has to give way
    { "*aab", "aaba", false }, { "**", "x", true }, { "T?", "T1", true }, { "T?", "T", false },
    { "T?", "T12", false } };
  for (const auto& c : cases)
  {
    EXPECT_EQ(globMatches(c.pattern, c.text), c.matches) << c.pattern << ' ' << c.text;
  }
}

TEST(Glob, ManyStarsStayFast)
{
  std::string pattern;
  for (int i = 0; i < 30; ++i)
  {
    pattern += "*a";
  }
  EXPECT_FALSE(globMatches(pattern + "b", std::string(2000, 'a')));
}
