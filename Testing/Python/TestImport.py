# SPDX-License-Identifier: BSD-3-Clause
"""The package is found by its names, and its classes are VTK algorithms."""

import avianlidar
from avianlidar.vtkAvianLidar import vtkAvianLidarHSBColorMap
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

assert avianlidar.__version__
assert "vtkAvianLidar" in avianlidar.__all__
assert all(hasattr(avianlidar, name) for name in avianlidar.__all__)
assert isinstance(vtkAvianLidarHSBColorMap(), vtkAlgorithm)
