// SPDX-License-Identifier: BSD-3-Clause
// What the image tests share: a small town, a window with a legend, and the comparison with a
// baseline (Testing/Data/Baseline), which Testing/Python/pictures.py explains.
#ifndef TestImages_h
#define TestImages_h

#include "vtkActor.h"
#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarMaterial.h"
#include "vtkCamera.h"
#include "vtkCubeSource.h"
#include "vtkImageDifference.h"
#include "vtkLegendBoxActor.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkPNGWriter.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkScalarBarActor.h"
#include "vtkScalarsToColors.h"
#include "vtkTesting.h"
#include "vtkTextProperty.h"
#include "vtkWindowToImageFilter.h"

#include <vtksys/SystemTools.hxx>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace testimages
{
/// Largest difference of a picture from its baseline (MOST in Testing/Python/pictures.py).
constexpr double MostDifference = 5.0;

/// Twelve houses of four materials in a ring, fixed for ever.
inline vtkNew<vtkMultiBlockDataSet> MakeTown()
{
  vtkNew<vtkMultiBlockDataSet> town;
  for (int i = 0; i < 12; ++i)
  {
    const double angle = 2.0 * 3.14159265358979 * i / 12.0;
    const double distance = 60.0 + 12.0 * (i % 5);
    vtkNew<vtkCubeSource> house;
    house->SetCenter(distance * std::cos(angle), distance * std::sin(angle), 4.0);
    house->SetXLength(14.0 + 2.0 * (i % 3));
    house->SetYLength(12.0 + 3.0 * (i % 4));
    house->SetZLength(16.0);
    vtkNew<vtkAvianLidarMaterial> material;
    material->SetInputConnection(house->GetOutputPort());
    material->SetMaterial(i % 4);
    material->Update();
    vtkNew<vtkPolyData> block;
    block->ShallowCopy(material->GetOutputDataObject(0));
    town->SetBlock(i, block);
  }
  return town;
}

/// Beam source, tree and echo filter on the town.
struct Scan
{
  vtkNew<vtkAvianLidarBeamSource> beams;
  vtkNew<vtkAvianLidarCollisionTree> tree;
  vtkNew<vtkAvianLidarEchoFilter> echoes;

  explicit Scan(vtkMultiBlockDataSet* town)
  {
    this->beams->SetAzimuthStep(1.0);
    this->beams->SetNumberOfChannels(12);
    this->beams->SetElevationStep(0.75);
    this->tree->SetInputData(town);
    this->echoes->SetInputConnection(0, this->beams->GetOutputPort());
    this->echoes->SetInputConnection(1, this->tree->GetOutputPort());
  }
};

/// A white window of 400 x 300 pixels.
struct Window
{
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkRenderWindow> window;
  vtkNew<vtkRenderWindowInteractor> interactor;

  Window()
  {
    this->renderer->SetBackground(1.0, 1.0, 1.0);
    this->window->SetSize(400, 300);
    this->window->SetMultiSamples(0);
    this->window->AddRenderer(this->renderer);
    this->interactor->SetRenderWindow(this->window);
  }

  /// The edges of a surface, in one colour.
  void AddWireframe(vtkAlgorithmOutput* surface, double r, double g, double b)
  {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(surface);
    mapper->ScalarVisibilityOff();
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetRepresentationToWireframe();
    actor->GetProperty()->SetColor(r, g, b);
    actor->GetProperty()->LightingOff();
    this->renderer->AddActor(actor);
  }

  void LookFromAbove(double height)
  {
    vtkCamera* camera = this->renderer->GetActiveCamera();
    camera->SetPosition(0.0, 0.0, height);
    camera->SetFocalPoint(0.0, 0.0, 0.0);
    camera->SetViewUp(0.0, 1.0, 0.0);
    this->renderer->ResetCameraClippingRange();
  }

  /// A bar of the colours of a table, at the right or at the bottom.
  void AddLegend(vtkScalarsToColors* table, const char* title, bool atBottom = false)
  {
    vtkNew<vtkScalarBarActor> bar;
    if (atBottom)
    {
      bar->SetOrientationToHorizontal();
      bar->SetPosition(0.1, 0.02);
      bar->SetPosition2(0.8, 0.2);
    }
    bar->SetLookupTable(table);
    bar->SetTitle(title);
    bar->SetNumberOfLabels(4);
    bar->GetTitleTextProperty()->SetColor(0.0, 0.0, 0.0);
    bar->GetLabelTextProperty()->SetColor(0.0, 0.0, 0.0);
    this->renderer->AddActor2D(bar);
  }

  /// Compare with the test's baseline; -I keeps the window open instead.
  int Compare(int argc, char* argv[])
  {
    this->window->Render();
    vtkNew<vtkTesting> testing;
    testing->AddArguments(argc, const_cast<const char**>(argv));
    if (testing->IsInteractiveModeSpecified())
    {
      this->interactor->Start();
      return EXIT_SUCCESS;
    }
    const std::string baseline = testing->GetValidImageFileName();
    const std::string name = baseline.substr(baseline.find_last_of('/') + 1);
    const std::string file = std::string(testing->GetTempDirectory()) + "/" + name;
    vtkNew<vtkWindowToImageFilter> picture;
    picture->SetInput(this->window);
    picture->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputConnection(picture->GetOutputPort());
    writer->Write();
    if (!vtksys::SystemTools::FileExists(baseline))
    {
      std::cerr << "no baseline " << baseline << "; this picture is " << file << '\n';
      return EXIT_FAILURE;
    }
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(baseline.c_str());
    vtkNew<vtkImageDifference> difference;
    difference->SetInputConnection(picture->GetOutputPort());
    difference->SetImageConnection(reader->GetOutputPort());
    difference->SetThreshold(10);
    difference->AllowShiftOff();
    difference->AveragingOff();
    difference->Update();
    const double error = difference->GetThresholdedError();
    std::cout << file << ": image error " << error << ", allowed " << MostDifference << '\n';
    if (const char* const all = std::getenv("AVIANLIDAR_PICTURES"))
    {
      std::ofstream(all, std::ios::app) << name << ' ' << error << '\n';
      return EXIT_SUCCESS;
    }
    return error <= MostDifference ? EXIT_SUCCESS : EXIT_FAILURE;
  }
};

/// Compare a picture of the town in black and, in blue, the bounding volumes of level 3 of its
/// tree.
inline int CompareTree(int boundingVolume, int argc, char* argv[])
{
  auto town = MakeTown();
  Scan scan(town);
  scan.tree->SetBoundingVolume(boundingVolume);
  scan.tree->SetDisplayLevel(3);
  Window window;
  window.AddWireframe(scan.tree->GetOutputPort(0), 0.0, 0.0, 0.0);
  window.AddWireframe(scan.tree->GetOutputPort(1), 0.1, 0.3, 0.9);
  vtkNew<vtkLegendBoxActor> legend;
  legend->SetNumberOfEntries(2);
  vtkNew<vtkCubeSource> symbol;
  symbol->Update();
  double black[] = { 0.0, 0.0, 0.0 };
  double blue[] = { 0.1, 0.3, 0.9 };
  legend->SetEntry(0, symbol->GetOutput(), "town", black);
  legend->SetEntry(1, symbol->GetOutput(), "level 3", blue);
  window.renderer->AddActor2D(legend);
  vtkCamera* camera = window.renderer->GetActiveCamera();
  camera->SetPosition(0.0, -330.0, 220.0);
  camera->SetFocalPoint(0.0, 0.0, 0.0);
  camera->SetViewUp(0.0, 0.0, 1.0);
  window.renderer->ResetCameraClippingRange();
  return window.Compare(argc, argv);
}
}

#endif
