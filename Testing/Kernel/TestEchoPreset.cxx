// SPDX-License-Identifier: BSD-3-Clause
#include "EchoSettings.h"

#include <gtest/gtest.h>

namespace
{
using namespace avianlidar;

TEST(EchoPreset, CustomChangesNothing)
{
  EchoSettings settings;
  settings.raysPerBeam = 7;
  settings.numberOfConnections = 5;
  EXPECT_EQ(applyPreset(EchoPreset::Custom, settings), "");
  EXPECT_EQ(settings.raysPerBeam, 7);
  EXPECT_EQ(settings.numberOfConnections, 5);
}

TEST(EchoPreset, WhatIsNotFidelityStays)
{
  for (int preset = 1; preset <= 3; ++preset)
  {
    EchoSettings settings;
    settings.seed = 17;
    settings.attenuationCoefficient = 1e-3;
    settings.reflectanceModel = ReflectanceModel::Microfacet;
    settings.noise = false;
    settings.returnMode = ReturnMode::Last;
    settings.beamSamples = BeamSampleSource::Rays;
    EXPECT_EQ(applyPreset(static_cast<EchoPreset>(preset), settings), "");
    EXPECT_EQ(checkSettings(settings), "");
    EXPECT_EQ(settings.seed, 17);
    EXPECT_EQ(settings.attenuationCoefficient, 1e-3);
    EXPECT_EQ(settings.reflectanceModel, ReflectanceModel::Microfacet);
    EXPECT_FALSE(settings.noise);
    EXPECT_EQ(settings.returnMode, ReturnMode::Last);
    EXPECT_EQ(settings.beamSamples, BeamSampleSource::Rays);
  }
}

TEST(EchoPreset, TheSettingsBeforeDoNotMatter)
{
  for (int preset = 1; preset <= 3; ++preset)
  {
    EchoSettings one;
    EchoSettings other;
    other.raysPerBeam = 0;
    other.sampling = Sampling::MonteCarlo;
    other.numberOfReflections = 9;
    other.numberOfConnections = -1;
    applyPreset(static_cast<EchoPreset>(preset), one);
    applyPreset(static_cast<EchoPreset>(preset), other);
    EXPECT_EQ(checkSettings(other), "");
    EXPECT_EQ(one.raysPerBeam, other.raysPerBeam);
    EXPECT_EQ(one.sampling, other.sampling);
    EXPECT_EQ(one.numberOfReflections, other.numberOfReflections);
    EXPECT_EQ(one.numberOfConnections, other.numberOfConnections);
  }
}

TEST(EchoPreset, RaysAndConnections)
{
  const int numbers[][2] = { { 25, 0 }, { 200, 2 }, { 3200, 8 } };
  for (int preset = 1; preset <= 3; ++preset)
  {
    EchoSettings settings;
    applyPreset(static_cast<EchoPreset>(preset), settings);
    EXPECT_EQ(settings.raysPerBeam, numbers[preset - 1][0]);
    EXPECT_EQ(settings.numberOfConnections, numbers[preset - 1][1]);
    EXPECT_EQ(settings.numberOfReflections, 2);
    EXPECT_EQ(settings.sampling, Sampling::Stratified);
  }
}

TEST(EchoPreset, AnotherNumberIsNamed)
{
  for (const int preset : { -1, 4, 1000 })
  {
    EchoSettings settings;
    const std::string problem = applyPreset(static_cast<EchoPreset>(preset), settings);
    EXPECT_NE(problem.find("Preset"), std::string::npos);
    EXPECT_NE(problem.find(std::to_string(preset)), std::string::npos) << problem;
    EXPECT_EQ(settings.raysPerBeam, EchoSettings().raysPerBeam);
  }
}
}
