# SPDX-License-Identifier: BSD-3-Clause
"""Prints three checksums: of a scan with noise, of a coverage map and of a bird that flies through ten scans, over
triangles that are made without libm. Systems whose libraries differ print the same ones."""
import hashlib

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
TRIANGLES = [corners
             for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
             for corners in ((a, b, c), (a, c, d))]
MATERIALS = ("Wall", "Glass", "Metal", "Wood")
SHOWN = 8  # digits


def town(count=60):
    """Boxes about the sensor, by whole numbers."""
    scene = al.Scene(([(-900, -900, -3), (900, -900, -3), (900, 900, -3), (-900, 900, -3)], [(0, 1, 2), (0, 2, 3)]),
                     material="Grass")
    for i in range(count):
        x, y = (37 * i * i + 11) % 601 - 300, (53 * i * i + 200) % 599 - 299
        if max(abs(x), abs(y)) > 30:
            size = np.array([3 + i % 17, 5 + i % 11, 4 + i % 23])
            scene.add((CORNERS * size + (x, y, -3), TRIANGLES), material=MATERIALS[i % 4], name=f"house {i}")
    return scene


def checksum(data):
    """Checksums of all arrays over points, by name."""
    digest = hashlib.sha256()
    arrays = data.GetPointData()
    for name in sorted(arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())):
        values = vtk_to_numpy(arrays.GetArray(name))
        digest.update(f"{name} {values.dtype} {values.shape} ".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()[:SHOWN]


def main():
    scene = town()
    print("scan", checksum(al.Scan(scene, al.Sensor("Airport16")).echoes.data))
    places = [(20 * x, 20 * y, 40) for x in range(-15, 16) for y in range(-15, 16)]
    print("coverage", checksum(al.Coverage(scene, al.Sensor("Search905"), places=places).data))
    gull = al.vtkAvianLidar.vtkAvianLidarBirdSource()
    gull.Update()
    track = [(-60 + 12 * i, 80 - 3 * i, 6 + i) for i in range(11)]
    scan = al.Scan(scene, al.Sensor("Search905", number_of_revolutions=10),
                   movers=[al.mover(gull.GetOutput(), track, times=range(11))])
    rate = scan.sensor.rotation_rate
    steps = []
    for k in range(10):
        scan.algorithm.UpdateTimeStep(k / rate)
        steps.append(checksum(scan.algorithm.GetOutput()))
    print("sequence", hashlib.sha256("".join(steps).encode()).hexdigest()[:SHOWN])


if __name__ == "__main__":
    main()
