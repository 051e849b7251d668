// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarMedium
 * @brief Makes a medium for a part of the scene. A medium, such as ground fog, a fog bank, a shower
 * or the crown of a tree, weakens light and sends light back.
 *
 * - Input port 0 (optional, for SHAPE_SURFACE): vtkPolyData, the closed surface that bounds the
 *   medium, m, with triangles wound either way.
 * - Output port 0: vtkPolyData, the surface that bounds the medium, for translucent display. The
 *   field data make this surface a medium for all filters that take surfaces: `medium` (description
 *   as JSON), `object_names` and `object_classes` ("air", or "vegetation" for foliage).
 *
 * Kind says what the medium is. One quantity says how dense the medium is: Visibility, RainRate,
 * LeafAreaDensity or, with BackscatterRatio, Extinction. Documentation/guide/weather.md and
 * Filters/Media/media.json say which quantity belongs to a kind, with sources and assumptions.
 *
 * A bad value or an open surface gives an empty output and an error that names the key of the
 * description. Setters accept any value. Each rank requests the whole surface.
 *
 * The output is combined with the scene, in ParaView by Group Datasets:
 *
 * @code
 * fog->SetVisibility(300);
 * fog->Update();
 * scene->SetBlock(1, fog->GetOutput());
 * @endcode
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarCoverage, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarMedium_h
#define vtkAvianLidarMedium_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarMedium : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarMedium* New();
  vtkTypeMacro(vtkAvianLidarMedium, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Kinds
  {
    KIND_HAZE = 0,
    KIND_FOG = 1,
    KIND_DRIZZLE = 2,
    KIND_RAIN = 3,
    KIND_SNOW = 4,
    KIND_FOLIAGE = 5,
    KIND_CUSTOM = 6
  };

  enum Shapes
  {
    SHAPE_EVERYWHERE = 0,
    SHAPE_LAYER = 1,
    SHAPE_BOX = 2,
    SHAPE_ELLIPSOID = 3,
    SHAPE_SURFACE = 4
  };

  ///@{
  /// Kind of the medium. Default KIND_FOG.
  vtkAvianLidarPropertyMacro(Kind, int, KIND_FOG);
  void SetKindToHaze() { this->SetKind(KIND_HAZE); }
  void SetKindToFog() { this->SetKind(KIND_FOG); }
  void SetKindToDrizzle() { this->SetKind(KIND_DRIZZLE); }
  void SetKindToRain() { this->SetKind(KIND_RAIN); }
  void SetKindToSnow() { this->SetKind(KIND_SNOW); }
  void SetKindToFoliage() { this->SetKind(KIND_FOLIAGE); }
  void SetKindToCustom() { this->SetKind(KIND_CUSTOM); }
  ///@}

  /// Visibility in the medium, m, 0.001 to 1e9. Default 300.
  vtkAvianLidarPropertyMacro(Visibility, double, 300.0);

  /// Rain rate, mm/h, 1e-6 to 500. Default 10.
  vtkAvianLidarPropertyMacro(RainRate, double, 10.0);

  /// One-sided leaf area per volume, m2/m3, 1e-6 to 1000. Default 1 (assumed; crowns: 0.3 to 3).
  vtkAvianLidarPropertyMacro(LeafAreaDensity, double, 1.0);

  /// Extinction mu of KIND_CUSTOM, 1/m, 0 to 1e30. Default 0.01.
  vtkAvianLidarPropertyMacro(Extinction, double, 0.01);

  /// Ratio S of extinction to backscatter of KIND_CUSTOM, sr, 0.001 to 1e9. Default 18.8.
  vtkAvianLidarPropertyMacro(BackscatterRatio, double, 18.8);

  /// Share of drops or leaves that change from scan to scan, 1, 0 to 1, or -1. With -1, the
  /// default, the kind sets the share (1 for drops and flakes, 0.3 for leaves, assumed). Not used
  /// for haze and fog.
  vtkAvianLidarPropertyMacro(RenewedShare, double, -1.0);

  ///@{
  /// Region of the medium: everywhere; in a layer between Bottom and Top; in a box or ellipsoid of
  /// Lengths about Center, turned by Heading; inside the surface of the input. Default SHAPE_LAYER.
  vtkAvianLidarPropertyMacro(Shape, int, SHAPE_LAYER);
  void SetShapeToEverywhere() { this->SetShape(SHAPE_EVERYWHERE); }
  void SetShapeToLayer() { this->SetShape(SHAPE_LAYER); }
  void SetShapeToBox() { this->SetShape(SHAPE_BOX); }
  void SetShapeToEllipsoid() { this->SetShape(SHAPE_ELLIPSOID); }
  void SetShapeToSurface() { this->SetShape(SHAPE_SURFACE); }
  ///@}

  /// Lower limit of a layer, m, below Top. Default -1000.
  vtkAvianLidarPropertyMacro(Bottom, double, -1000.0);

  /// Upper limit of a layer, m. Default 20.
  vtkAvianLidarPropertyMacro(Top, double, 20.0);

  /// Height above Top over which the density of a layer falls to 1/e, m, 0 to 1e6. Default 5.
  vtkAvianLidarPropertyMacro(Softness, double, 5.0);

  /// Centre of a box or an ellipsoid, m. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Center, 3, 0.0, 0.0, 0.0);

  /// Lengths of the sides of a box or of the full axes of an ellipsoid, m, 2e-6 to 2e7. Default
  /// (100, 100, 20).
  vtkAvianLidarVectorMacro(Lengths, 3, 100.0, 100.0, 20.0);

  /// Direction of the second length, deg from north, clockwise. Default 0.
  vtkAvianLidarPropertyMacro(Heading, double, 0.0);

  /// Velocity, m/s. The medium is in its given place at time 0 of the beams. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Velocity, 3, 0.0, 0.0, 0.0);

  /// Name of the medium and, for foliage, of the object; empty: name of the block. Default
  /// "medium".
  vtkAvianLidarPropertyMacro(Name, std::string, "medium");

  /// Side of the displayed part of a layer or of SHAPE_EVERYWHERE, m, above 0 to 1e9. Default 2000.
  vtkAvianLidarPropertyMacro(DisplaySize, double, 2000.0);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarMedium() = default;
  ~vtkAvianLidarMedium() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarMedium(const vtkAvianLidarMedium&) = delete;
  void operator=(const vtkAvianLidarMedium&) = delete;

  std::string Description() const;
};

#endif
