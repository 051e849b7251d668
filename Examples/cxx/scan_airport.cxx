// SPDX-License-Identifier: BSD-3-Clause
// Scans a scene file once, and writes the received echoes as VTK data.
//
//     scan_airport <scene.lidarscene.json> <echoes.vtp> [<visibility in m>]
#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarHSBColorMap.h"
#include "vtkAvianLidarSceneReader.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataWriter.h"

#include <cstdlib>
#include <iostream>

int main(int argc, char* argv[])
{
  if (argc < 3)
  {
    std::cerr << "expected: " << argv[0]
              << " <scene.lidarscene.json> <echoes.vtp> [<visibility in m>]\n";
    return EXIT_FAILURE;
  }

  vtkNew<vtkAvianLidarSceneReader> scene;
  scene->SetFileName(argv[1]);
  scene->Update();
  vtkDataArray* place = scene->GetOutputDataObject(0)->GetFieldData()->GetArray("lidar_position");
  if (!place)
  {
    std::cerr << argv[1] << ": cannot be read, or has no position of the lidar\n";
    return EXIT_FAILURE;
  }

  vtkNew<vtkAvianLidarBeamSource> sensor;
  sensor->SetPresetToAirport16();
  sensor->SetPosition(place->GetTuple3(0));

  vtkNew<vtkAvianLidarCollisionTree> tree;
  tree->SetInputConnection(scene->GetOutputPort());

  vtkNew<vtkAvianLidarEchoFilter> lidar;
  lidar->SetInputConnection(0, sensor->GetOutputPort());
  lidar->SetInputConnection(1, tree->GetOutputPort());
  lidar->SetVisibility(argc > 3 ? std::atof(argv[3]) : 23000.0); // visibility, m

  vtkNew<vtkAvianLidarHSBColorMap> colours;
  colours->SetInputConnection(lidar->GetOutputPort());

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputConnection(colours->GetOutputPort());
  writer->SetFileName(argv[2]);
  // VTK with today's libexpat cannot read files with the default data mode, Appended.
  writer->SetDataModeToBinary();
  if (!writer->Write()) // updates the whole pipeline
  {
    return EXIT_FAILURE;
  }

  vtkPolyData* echoes = vtkPolyData::SafeDownCast(colours->GetOutputDataObject(0));
  vtkDataArray* energy = echoes->GetPointData()->GetArray("energy"); // energies, J
  double total = 0.0;
  for (vtkIdType i = 0; i < echoes->GetNumberOfPoints(); ++i)
  {
    total += energy->GetComponent(i, 0);
  }
  std::cout << echoes->GetNumberOfPoints() << " echoes, " << total << " J\n";
  return EXIT_SUCCESS;
}
