# SPDX-License-Identifier: BSD-3-Clause
"""Avian-lidar echoes of ground objects.

    import avianlidar as al

    scene = al.load_scene(al.example_scene())
    sensor = al.Sensor("Airport16", position=(0, 0, 3))        # metres east, north, up
    scan = al.Scan(scene, sensor, rays_per_beam=200)
    print(scan["distance_m"].mean(), scan.echoes.units)        # NumPy arrays, not copied
    scan.attenuation_coefficient = 8.8e-5                      # 1/m: the hits of the rays are kept
    scan.save("echoes.vtp")
    scan.plot_range_image()                                    # with Matplotlib

These helpers are built on wrapped VTK classes. `Sensor.algorithm`, `Scan.algorithm`, `Scene.tree` and `Cloud.data` give
the VTK objects:

    from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter
"""

from ._advice import Advice
from ._cloud import Cloud
from ._coverage import Coverage, places_of
from ._files import load_cloud, save
from ._pipeline import Error
from ._plot import hue_colors, plot_map, plot_range_image
from ._recording import Recording, load_clouds
from ._scan import Scan
from ._scene import Scene, example_scene, load_scene, materials, mesh, mover
from ._sensor import Sensor, trajectory
from ._version import __version__
from .apps.coverage._design_page import Designs
from .apps.sequences._flights import read_tracks
from .apps.sequences._sequence import Sequence
from .apps.sequences._tracks import BirdTracks
from .apps.sequences._trajectory import read_trajectory

__all__ = ["Advice", "BirdTracks", "Cloud", "Coverage", "Designs", "Error", "Recording", "Scan", "Scene", "Sensor",
           "Sequence", "example_scene", "hue_colors", "load_cloud", "load_clouds", "load_scene", "materials", "mesh",
           "mover", "places_of", "plot_map", "plot_range_image", "read_tracks", "read_trajectory", "save", "trajectory",
           "vtkAvianLidar"]
