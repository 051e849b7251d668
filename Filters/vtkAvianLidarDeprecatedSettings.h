// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarDeprecatedSettings.h
 * @brief Setters of vtkAvianLidarScanFilter and vtkAvianLidarCollisionTree that are gone, for one
 * version: each warns and says what to do instead.
 *
 * The filters include this header and call the macros in their public parts. Delete these lines
 * with the header.
 */
#ifndef vtkAvianLidarDeprecatedSettings_h
#define vtkAvianLidarDeprecatedSettings_h

#include "vtkSetGet.h" // For warnings

/// SetPlaneIntegration() sets BeamSamples; the others have no effect.
#define vtkAvianLidarDeprecatedSettingsMacro()                                                     \
  void SetPlaneIntegration(bool on)                                                                \
  {                                                                                                \
    vtkWarningMacro("SetPlaneIntegration is deprecated, use SetBeamSamplesTo"                      \
      << (on ? "Cells" : "Rays") << " instead");                                                   \
    this->SetBeamSamples(on ? BEAM_SAMPLES_CELLS : BEAM_SAMPLES_RAYS);                             \
  }                                                                                                \
  vtkBooleanMacro(PlaneIntegration, bool);                                                         \
  void SetRefineNearLimit(bool)                                                                    \
  {                                                                                                \
    vtkWarningMacro("SetRefineNearLimit is deprecated and has no effect: no beam is refined, "     \
                    "more RaysPerBeam make all beams more accurate");                              \
  }                                                                                                \
  vtkBooleanMacro(RefineNearLimit, bool);                                                          \
  void SetTargetRelativeError(double)                                                              \
  {                                                                                                \
    vtkWarningMacro("SetTargetRelativeError is deprecated and has no effect: no beam is refined, " \
                    "more RaysPerBeam make all beams more accurate");                              \
  }                                                                                                \
  void SetSmallTargets(bool)                                                                       \
  {                                                                                                \
    vtkWarningMacro("SetSmallTargets is deprecated and has no effect: with BeamSamples at Cells "  \
                    "small objects always get more rays, with Rays never");                        \
  }                                                                                                \
  vtkBooleanMacro(SmallTargets, bool)

/// Has no effect.
#define vtkAvianLidarDeprecatedEmbedTreeMacro()                                                    \
  void SetEmbedTree(bool)                                                                          \
  {                                                                                                \
    vtkWarningMacro("SetEmbedTree is deprecated and has no effect: whoever reads surfaces from a " \
                    "file builds their tree");                                                     \
  }                                                                                                \
  vtkBooleanMacro(EmbedTree, bool)

#endif
