#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs vtkAvianLidarEchoFilter on every case of oracles.py and prints a table of its errors; --page brings it into
Documentation/results/oracles.md. For another simulator, this is the file to write anew.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Testing/Oracles/run_filter.py [--page]
"""
import math
import pathlib
import re
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersSources import vtkSphereSource

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import oracles  # noqa: E402

PAGE = HERE.parents[1] / "Documentation/results/oracles.md"
RAYS = 100000
FACETS = 1000   # around the sphere: cosines of facets are off by less than 1e-5
INTEGRATED_RAYS = 10000  # integrated beams trace none; a glint needs many nodes
SPEED_OF_LIGHT = 299792458.0
# What a case tests is the energy of a beam, so range units are long enough to hold all of it.
ONE_UNIT = 1e-4


def polydata(points):
    data, places = vtkPolyData(), vtkPoints()
    places.SetData(numpy_to_vtk(np.array(points, dtype=float), deep=True))
    data.SetPoints(places)
    return data


def beam(case, sampling_interval=ONE_UNIT, pulse_width=0.0):
    """One beam as the echo filter wants it."""
    given = case["beam"]
    data = polydata([given["origin_m"]])
    vertex = vtkCellArray()
    vertex.InsertNextCell(1, [0])
    data.SetVerts(vertex)
    direction = numpy_to_vtk(np.array([given["direction"]]), deep=True)
    direction.SetName("direction")
    data.GetPointData().AddArray(direction)
    sensor = {"half_beamwidth": given["half_beamwidth_rad"],
              "beam_profile": ("uniform", "gaussian").index(given["profile"]),
              "pulse_energy": given["pulse_energy_J"], "pulse_width": pulse_width, "frequency": 3.313e14,
              "sampling_interval": sampling_interval, "range_gate": 1e5, "noise_photon_rate": 0.0,
              "lower_energy_limit": 0.0, "upper_energy_limit": 1.0, "receiver_aperture": 0.0}
    for name, value in sensor.items():
        array = vtkDoubleArray()
        array.SetName(name)
        array.InsertNextValue(value)
        data.GetFieldData().AddArray(array)
    return data


def surfaces(case):
    """The scene with its coefficients."""
    if "sphere" in case["scene"]:
        ball = vtkSphereSource()
        ball.SetCenter(case["scene"]["sphere"]["centre_m"])
        ball.SetRadius(case["scene"]["sphere"]["radius_m"])
        ball.SetThetaResolution(FACETS)
        ball.SetPhiResolution(FACETS // 2)
        ball.SetOutputPointsPrecision(vtkSphereSource.DOUBLE_PRECISION)
        ball.Update()
        data = ball.GetOutput()
    else:
        corners = np.array(case["scene"]["triangles"])
        data, cells = polydata(corners.reshape(-1, 3)), vtkCellArray()
        cells.SetData(3, numpy_to_vtkIdTypeArray(np.arange(3 * len(corners), dtype=np.int64), deep=True))
        data.SetPolys(cells)
    count = data.GetNumberOfPolys()
    for name, value in {**case["material"], "object_id": 0, "material_id": 4}.items():
        kind = np.int32 if name.endswith("_id") else float
        array = numpy_to_vtk(np.full(count, value, kind), deep=True)
        array.SetName(name)
        data.GetCellData().AddArray(array)
    return data


def scan(case, sensor, rays=RAYS, integrate=False, **properties):
    """Echoes of the beam as {name: array}. Integrated, only paths over two reflections may trace any ray."""
    lidar = vtkAvianLidarEchoFilter()
    lidar.SetInputData(0, sensor)
    lidar.SetSurfacesData(surfaces(case))
    lidar.SetRaysPerBeam(rays)
    lidar.SetAttenuationCoefficient(case["attenuation_per_m"])
    lidar.SetNumberOfReflections(case["reflections"])
    lidar.SetLightEnergyConstraint(False)
    lidar.SetBeamSamples(lidar.BEAM_SAMPLES_CELLS if integrate else lidar.BEAM_SAMPLES_RAYS)
    for name, value in properties.items():
        getattr(lidar, f"Set{name}")(value)
    lidar.Update()
    assert not integrate or case["reflections"] > 1 or lidar.GetNumberOfTracedRays() == 0, case["name"]
    points = lidar.GetOutput().GetPointData()
    return {points.GetArrayName(i): vtk_to_numpy(points.GetArray(i)) for i in range(points.GetNumberOfArrays())}


def row(case, quantity, expected, found, error, how):
    """`error` is the standard error that the filter or the spread over seeds gives."""
    return {"case": case["name"], "quantity": quantity, "expected": expected, "found": found, "standard_error": error,
            "how": how}


def of_energy(case, how="sampled", **more):
    echoes = scan(case, beam(case), **more)
    assert len(echoes["energy_received"]) == 1, (case["name"], len(echoes["energy_received"]))
    expected = case["expected"]
    rows = [row(case, "energy (J)", expected["energy_J"], echoes["energy_received"][0], echoes["energy_std_error"][0],
                how)]
    if "mean_range_m" in expected:
        # The spread of ranges within the footprint, as if each ray counted for itself.
        t = case["beam"]["half_beamwidth_rad"]
        normal_range = expected["mean_range_m"]
        cosine = expected["energy_J"] / (case["beam"]["pulse_energy_J"] * case["material"]["kd"])
        slope = math.sqrt(max(1 / cosine**2 - 1, 0))
        rows.append(row(case, "mean range (m)", normal_range, echoes["distance_m"][0],
                        0.0 if how == "integrated" else normal_range * (t * slope / 2 + t * t) / math.sqrt(RAYS), how))
    return rows


def of_waveform(case, how="sampled", **more):
    """Range units one by one; of the spread pulse, whose first and last unit have no name in the output, the others."""
    rows, tau = [], case["waveform"]["sampling_interval_s"]
    for (label, units), width in zip(case["waveform"]["units"].items(), (0.0, tau)):
        echoes = scan(case, beam(case, tau, width), ReturnMode=vtkAvianLidarEchoFilter.RETURN_MODE_RANGE_UNITS, **more)
        number = np.floor(2 * echoes["distance_m"] / (SPEED_OF_LIGHT * tau)).astype(int)
        for unit, expected in list(units.items())[1 if width else 0:-1 if width else None]:
            at = np.flatnonzero(number == int(unit))
            assert len(at) == 1, (case["name"], unit, len(at))
            rows.append(row(case, f"unit {unit}, {label} (J)", expected, echoes["energy_received"][at[0]],
                            echoes["energy_std_error"][at[0]], how))
    return rows


def of_connections(case, how="sampled", seeds=40, rays=1000, **more):
    """The mean over seeds of what came over two reflections. These paths are sampled in integrated beams, too: they start
    from rays that are located on the visible polygons."""
    found = []
    for seed in range(seeds):
        echoes = scan(case, beam(case), rays, NumberOfConnections=rays - 1, Seed=seed, **more)
        found.append(echoes["return_energy"] @ echoes["secondary_share"])
    return [row(case, f"secondary energy, {seeds} seeds (J)", case["expected"]["secondary_energy_J"], np.mean(found),
                np.std(found, ddof=1) / math.sqrt(seeds), how)]


def results():
    """One row for each number."""
    rows = []
    for case in oracles.compute()["cases"]:
        connects = "secondary_energy_J" in case["expected"]
        rows += of_connections(case) if connects else of_energy(case)
        if "waveform" in case:
            rows += of_waveform(case)
        if "sphere" not in case["scene"]:  # of too many triangles
            given = {"how": "integrated", "integrate": True}
            if connects:
                rows += of_connections(case, **given)
                continue
            given["rays"] = INTEGRATED_RAYS
            rows += of_energy(case, **given) + (of_waveform(case, **given) if "waveform" in case else [])
    return rows


def side_by_side(rows):
    """{(case, quantity): {"sampled": row, "integrated": row}}, as the page has them."""
    found = {}
    for r in rows:
        found.setdefault((r["case"], r["quantity"]), {})[r["how"]] = r
    return found


def errors(r):
    """Relative error and error in standard errors, as text; empty without a row."""
    if r is None:
        return "", ""
    error = r["found"] - r["expected"]
    return f"{error / r['expected']:.1e}", f"{error / r['standard_error']:.1f}" if r["standard_error"] > 0 else "-"


def table(rows):
    lines = ["| case | quantity | oracle | sampled: relative error | in standard errors | integrated: relative error | "
             "in bounds |", "|---|---|---:|---:|---:|---:|---:|"]
    for (case, quantity), both in side_by_side(rows).items():
        cells = [*errors(both.get("sampled")), *errors(both.get("integrated"))]
        expected = next(iter(both.values()))["expected"]
        lines.append(f"| {case} | {quantity} | {expected:.10g} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main():
    text = table(results())
    print(text)
    if "--page" in sys.argv[1:]:
        page = PAGE.read_text(encoding="utf-8")
        block = r"(<!-- table: oracles -->\n).*?(<!-- end -->)"
        PAGE.write_text(re.sub(block, lambda m: m[1] + text + m[2], page, flags=re.S), encoding="utf-8")


if __name__ == "__main__":
    main()
