// SPDX-License-Identifier: BSD-3-Clause
// Patterns with wildcards.
#include "Glob.h"

#include <gtest/gtest.h>

using avianlidar::globMatches;

TEST(Glob, PlainTextFitsItself)
{
  EXPECT_TRUE(globMatches("", ""));
  EXPECT_TRUE(globMatches("hangar", "hangar"));
  EXPECT_FALSE(globMatches("hangar", "Hangar"));
  EXPECT_FALSE(globMatches("hangar", "hangar 1"));
  EXPECT_FALSE(globMatches("", "hangar"));
}

TEST(Glob, StarStandsForAnyText)
{
  EXPECT_TRUE(globMatches("*", ""));
  EXPECT_TRUE(globMatches("*", "a/b.c"));
  EXPECT_TRUE(globMatches("hangar*", "hangar"));
  EXPECT_TRUE(globMatches("*ang*r*", "hangar 1"));
  EXPECT_TRUE(globMatches("*aab", "aaab")); // the star has to give way
  EXPECT_FALSE(globMatches("*aab", "aaba"));
  EXPECT_TRUE(globMatches("**", "x"));
}

TEST(Glob, QuestionMarkStandsForOneCharacter)
{
  EXPECT_TRUE(globMatches("T?", "T1"));
  EXPECT_FALSE(globMatches("T?", "T"));
  EXPECT_FALSE(globMatches("T?", "T12"));
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
